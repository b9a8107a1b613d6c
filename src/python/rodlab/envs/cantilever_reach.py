"""Reach a point with the tip of a heavy, flexible cantilever."""

from typing import Any

import numpy as np

from .. import _rodlab
from .base import RodEnv, spread
from .gripper import Array, Gripper
from .parameters import Range
from .raster import GRIPPER, ROD, TARGET, Canvas

EDGES = 30
SEEN = 11
GRAVITY = 9.81
SPEED = 0.3
RATE = 1.5
REACH = 0.2


class CantileverReach(RodEnv):
    """Move the clamp of a heavy cantilever so that its tip reaches a point and rests there.

    The rod starts at rest, clamped at the origin along x. The target is the place of the tip in the equilibrium of
    another pose of the clamp, so it can be reached. A control step is 50 ms; an episode has 100 of them.

    Observation (78)
        Positions of 11 nodes from the clamp to the tip over the length L (33); their velocities in m/s (33); tangent and
        director d₁ of the clamp (6); target over L (3); target less tip, over L (3).

    Action (6), from -1 to 1
        Velocity of the clamp in x, y, z, times 0.3 m/s (3); its angular velocity about x, y, z, times 1.5 rad/s (3). The
        clamp stays within 0.2 m of the origin in each direction.

    Reward
        -d/L - 0.01 |action|², with the distance d of the tip from the target; 10 more at success, and -10 for a step that
        fails.

    Termination
        Success: for 10 steps in a row d < 0.03 L and the tip is slower than 0.05 m/s. Failure: the engine raises.

    Randomised parameters
        ================  ===================  ==============================================
        name              range                meaning
        ================  ===================  ==============================================
        length            0.3 to 0.5 m         length L
        radius            2 to 4 mm            radius of the rod
        density           1000 to 1500 kg/m³   density
        load              1 to 10              weight over stiffness, ρ g A L³ / (E I)
        damping           2 to 5 1/s           drag per mass and velocity
        target_x, _y, _z  -0.15 to 0.15 m      place of the clamp when the tip is at the target
        target_yaw        -0.6 to 0.6 rad      turn of that clamp about z
        target_pitch      -0.5 to 0.5 rad      its turn upwards
        ================  ===================  ==============================================

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
    horizon : int, optional
        Control steps in an episode, by default 100.
    """

    ranges = {
        "length": Range(0.3, 0.5, "m"),
        "radius": Range(0.002, 0.004, "m"),
        "density": Range(1000.0, 1500.0, "kg/m³"),
        "load": Range(1.0, 10.0, logarithmic=True),
        "damping": Range(2.0, 5.0, "1/s"),
        "target_x": Range(-0.15, 0.15, "m"),
        "target_y": Range(-0.15, 0.15, "m"),
        "target_z": Range(-0.15, 0.15, "m"),
        "target_yaw": Range(-0.6, 0.6, "rad"),
        "target_pitch": Range(-0.5, 0.5, "rad"),
    }
    period = 0.05
    substep = 0.01
    default_horizon = 100

    def __init__(self, render_mode: str | None = None, horizon: int | None = None) -> None:
        super().__init__(render_mode, horizon)
        self._set_spaces(6, 6 * SEEN + 12)
        self._seen = spread(EDGES + 1, SEEN)
        self.target = np.zeros(3)
        self._held = 0

    def _scene(self, start: Array, direction: Array, mode: str) -> dict[str, Any]:
        values = self.parameters
        length, radius, density = values["length"], values["radius"], values["density"]
        modulus = 4.0 * density * GRAVITY * length**3 / (values["load"] * radius**2)
        end = start + length * direction
        time: dict[str, Any] = {"mode": mode}
        loads: list[dict[str, Any]] = [{"kind": "gravity", "acceleration": [0.0, 0.0, -GRAVITY]}]
        if mode == "dynamic":
            time |= {"scheme": "implicit-euler", "step": self.substep, "end": self.horizon * self.period}
            loads.append({"kind": "drag", "translation": values["damping"] * density * np.pi * radius**2})
        return {
            "experiment": "scene",
            "material": {"youngs_modulus": modulus, "poissons_ratio": 0.5, "density": density},
            "rods": [
                {
                    "name": "beam",
                    "radius": radius,
                    "edges": EDGES,
                    "shape": {"kind": "straight", "start": start.tolist(), "end": end.tolist()},
                }
            ],
            "clamps": [{"rod": "beam", "at": "start"}],
            "loads": loads,
            "time": time,
        }

    def _scenario(self) -> dict[str, Any]:
        return self._scene(np.zeros(3), np.array([1.0, 0.0, 0.0]), "dynamic")

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        values = self.parameters
        yaw, pitch = values["target_yaw"], values["target_pitch"]
        direction = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
        place = np.array([values["target_x"], values["target_y"], values["target_z"]])
        goal = _rodlab.Simulation(_rodlab.Scenario.from_dict(self._scene(place, direction, "static")))
        goal.find_equilibrium()
        self.target = np.array(goal.positions[-1])
        simulation.find_equilibrium()
        self.gripper = Gripper(0, simulation.clamp_pose(0), np.full(3, -REACH), np.full(3, REACH))
        self._held = 0

    def _act(self, action: Array) -> dict[int, Array]:
        return {0: self.gripper.move(SPEED * action[:3], RATE * action[3:], self.period)}

    def _observe(self) -> Array:
        length = self.parameters["length"]
        pose = self.gripper.pose
        return np.concatenate(
            [
                self.positions[self._seen].ravel() / length,
                self.velocities[self._seen].ravel(),
                pose[:3, 2],
                pose[:3, 0],
                self.target / length,
                (self.target - self.positions[-1]) / length,
            ]
        )

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        length = self.parameters["length"]
        distance = float(np.linalg.norm(self.target - self.positions[-1]))
        speed = float(np.linalg.norm(self.velocities[-1]))
        self._held = self._held + 1 if distance < 0.03 * length and speed < 0.05 else 0
        reward = -distance / length - 0.01 * float(action @ action)
        return reward, self._held >= 10, {"distance": distance}

    def _draw(self) -> Canvas:
        canvas = Canvas([1.0, 0.0, 0.0], [0.0, 0.35, 0.937], [0.2, 0.0, -0.1], 1.2)
        canvas.dots(self.target, 0.012, TARGET)
        canvas.dots(self.positions[0], 0.015, GRIPPER)
        canvas.line(self.positions, self.parameters["radius"], ROD)
        return canvas
