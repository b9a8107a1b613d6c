"""Fold a strip of a sheet on a table without sliding it."""

from typing import Any

import numpy as np

from .. import _rodlab
from .base import RodEnv, spread
from .gripper import Array, Gripper
from .parameters import Range
from .raster import GRIPPER, GROUND, ROD, TARGET, Canvas

EDGES = 40
SEEN = 14
GRAVITY = 9.81
TOLERANCE = 1e-4
SPEED = 0.1
RATE = 2.0


class Folding(RodEnv):
    """Bring the edge of a strip of a sheet to a place on the strip, so that it is folded, without sliding it.

    The strip lies along x on a table with friction; its free end is at the origin. A gripper holds the edge at the other end
    and turns it about y. The motion is planar. A control step is 100 ms; an episode has 120 of them.

    Observation (66)
        x, z of 14 nodes over the length L (28); their velocities in x, z over 0.1 m/s (28); place of the gripper over L (2),
        cosine and sine of its inclination (2); place of the edge's target over L (2); edge less target over L (2); slide of the
        free end over L (1); largest curvature of the strip times its thickness (1).

    Action (3), from -1 to 1
        Velocity of the gripper in x, z, times 0.1 m/s (2); its angular velocity, times 2 rad/s, positive where the edge turns
        upwards and over the strip (1).

    Reward
        -d/L - 5 s/L - 0.01 |action|², with the distance d of the edge from its target and the slide s of the free end; 10
        more at success, and -10 for a step that fails.

    Termination
        Success: for 5 steps in a row d < 0.03 L while s < 0.02 L. Failure: s > 0.25 L, or the engine raises.

    Randomised parameters
        ===============  ==================  ==================================================
        name             range               meaning
        ===============  ==================  ==================================================
        length           0.24 to 0.32 m      length L
        thickness        1.5 to 2.5 mm       thickness h
        width            20 to 40 mm         width of the strip
        density          800 to 1200 kg/m³   density
        bending_length   25 to 35 mm         (E h² / (24 ρ g))^(1/3), the gravito-bending length
        friction         0.4 to 0.9          friction with the table and of the layers
        target           0.05 to 0.3         place of the edge at the end, over L; x from the free end
        ===============  ==================  ==================================================

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
    horizon : int, optional
        Control steps in an episode, by default 120.
    """

    ranges = {
        "length": Range(0.24, 0.32, "m"),
        "thickness": Range(0.0015, 0.0025, "m"),
        "width": Range(0.02, 0.04, "m"),
        "density": Range(800.0, 1200.0, "kg/m³"),
        "bending_length": Range(0.025, 0.035, "m"),
        "friction": Range(0.4, 0.9),
        "target": Range(0.05, 0.3),
    }
    period = 0.1
    substep = 0.02
    default_horizon = 120

    def __init__(self, render_mode: str | None = None, horizon: int | None = None) -> None:
        super().__init__(render_mode, horizon)
        self._set_spaces(3, 4 * SEEN + 10)
        self._seen = spread(EDGES + 1, SEEN)
        self.target = np.zeros(2)
        self._start = 0.0
        self._held = 0

    def _scenario(self) -> dict[str, Any]:
        values = self.parameters
        thickness, density = values["thickness"], values["density"]
        modulus = 24.0 * density * GRAVITY * values["bending_length"] ** 3 / thickness**2
        height = 0.5 * thickness + 0.3 * TOLERANCE
        return {
            "experiment": "scene",
            "material": {"youngs_modulus": modulus, "poissons_ratio": 0.3, "density": density},
            "rods": [
                {
                    "name": "sheet",
                    "cross_section": {"kind": "rectangle", "thickness": thickness, "width": values["width"]},
                    "edges": EDGES,
                    "director": [0.0, 1.0, 0.0],
                    "shape": {"kind": "straight", "start": [0.0, 0.0, height], "end": [values["length"], 0.0, height]},
                }
            ],
            "clamps": [{"rod": "sheet", "at": "end"}],
            "planes": [{"point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}],
            "loads": [
                {"kind": "gravity", "acceleration": [0.0, 0.0, -GRAVITY]},
                {"kind": "drag", "translation": 0.5 * density * thickness * values["width"]},
            ],
            "contact": {
                "model": "imc",
                "friction": values["friction"],
                "distance_tolerance": TOLERANCE,
                "slip_tolerance": 5e-4,
                "stiffness_factor": 1e4,
            },
            "time": {"scheme": "implicit-euler", "step": self.substep, "end": self.horizon * self.period},
        }

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        length, thickness = self.parameters["length"], self.parameters["thickness"]
        self.target = np.array([self.parameters["target"] * length, 1.5 * thickness + 0.001])
        low = np.array([-0.2 * length, 0.0, 0.5 * thickness + 0.3 * TOLERANCE])
        high = np.array([1.1 * length, 0.0, 0.8 * length])
        self.gripper = Gripper(0, simulation.clamp_pose(0), low, high)
        self._start = float(simulation.positions[0, 0])
        self._held = 0

    def _act(self, action: Array) -> dict[int, Array]:
        velocity = SPEED * np.array([action[0], 0.0, action[1]])
        # The angle increases from +x to +z, so that the axis is -y.
        rate = RATE * np.array([0.0, -action[2], 0.0])
        return {0: self.gripper.move(velocity, rate, self.period)}

    def _slide(self) -> float:
        return abs(float(self.positions[0, 0]) - self._start)

    def _distance(self) -> Array:
        return np.asarray(self.positions[-1, [0, 2]] - self.target)

    def _curvature(self) -> float:
        """Return the largest curvature, 1/m."""
        edges = np.diff(self.positions[:, [0, 2]], axis=0)
        angles = np.arctan2(edges[:, 1], edges[:, 0])
        turns = (np.diff(angles) + np.pi) % (2.0 * np.pi) - np.pi
        return float(np.abs(turns).max()) * EDGES / self.parameters["length"]

    def _observe(self) -> Array:
        length = self.parameters["length"]
        pose = self.gripper.pose
        return np.concatenate(
            [
                self.positions[self._seen][:, [0, 2]].ravel() / length,
                self.velocities[self._seen][:, [0, 2]].ravel() / SPEED,
                pose[[0, 2], 3] / length,
                pose[[0, 2], 2],
                self.target / length,
                self._distance() / length,
                [self._slide() / length, self._curvature() * self.parameters["thickness"]],
            ]
        )

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        length = self.parameters["length"]
        distance, slide = float(np.linalg.norm(self._distance())), self._slide()
        self._held = self._held + 1 if distance < 0.03 * length and slide < 0.02 * length else 0
        reward = -(distance + 5.0 * slide) / length - 0.01 * float(action @ action)
        return reward, self._held >= 5, {"distance": distance, "slide": slide}

    def _lost(self) -> bool:
        return self._slide() > 0.25 * self.parameters["length"]

    def _draw(self) -> Canvas:
        length = self.parameters["length"]
        canvas = Canvas([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5 * length, 0.0, 0.3 * length], 1.5 * length)
        canvas.line([[-length, 0.0, -0.001], [2.0 * length, 0.0, -0.001]], 0.001, GROUND)
        canvas.dots([self.target[0], 0.0, self.target[1]], 0.005, TARGET)
        canvas.line(self.positions, 0.5 * self.parameters["thickness"], ROD)
        canvas.dots(self.gripper.pose[:3, 3], 0.004, GRIPPER)
        return canvas
