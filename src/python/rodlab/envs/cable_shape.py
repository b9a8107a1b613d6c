"""Lay a cable on a table along a curve."""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from .. import _rodlab
from .base import RodEnv, spread
from .cable import TOLERANCE, cable_scene, resample, smooth_curve, straight
from .gripper import Array, Gripper
from .parameters import Range
from .raster import GRIPPER, ROD, TARGET, Canvas

EDGES = 40
SEEN = 14
SPEED = 0.15
RATE = 2.0


class CableShape(RodEnv):
    """Move one end of a cable on a table with friction so that the cable takes the shape of a curve.

    The cable lies straight along x. A gripper holds its end, node 40, and may lift it; the other end is free. Each node has
    a target at the same arc length of a smooth curve. A control step is 100 ms; an episode has 150 of them.

    Observation (127)
        Positions of 14 nodes over the length L (42); their velocities over 0.15 m/s (42); x, y of their targets over L (28);
        the frame of the gripper: d₁, tangent (6), position over L (3); position of the gripper less that of its target over
        L (3); mean distance, the largest distance, and the height of the gripper over L (3).

    Action (4 with `control="plane"`, 6 with `control="pose"`), from -1 to 1
        Velocity of the gripper in x, y, z, times 0.15 m/s (3); its angular velocity about z, or about x, y, z, times
        2 rad/s (1 or 3).

    Reward
        -d/L - 0.01 |action|², with the mean distance d of the nodes from their targets; 10 more at success, and -10 for a
        step that fails.

    Termination
        Success: for 5 steps in a row d < 0.03 L and no node is higher than 3 cm. Failure: the engine raises.

    Randomised parameters
        =================  ===================  ===============================================
        name               range                meaning
        =================  ===================  ===============================================
        length             0.35 to 0.5 m        length L
        radius             1.5 to 2.5 mm            radius of the cable
        density            1000 to 1500 kg/m³   density
        bending_length     20 to 35 mm          (E r² / (8 ρ g))^(1/3), the gravito-bending length
        friction           0.3 to 0.8           friction with the table and with itself
        target_x, _y       -0.05 to 0.05 m      start of the target
        target_heading     -0.4 to 0.4 rad      its direction there
        bend_1             -1.5 to 1.5 rad      turn of the target from end to end
        bend_2             -0.8 to 0.8 rad      turn of its middle
        bend_3             -0.4 to 0.4 rad      turn of its waves
        =================  ===================  ===============================================

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
    horizon : int, optional
        Control steps in an episode, by default 150.
    control : {"plane", "pose"}
        Whether the gripper turns about the vertical only, or about all axes.

    Notes
    -----
    Two further options of `reset` replace the drawn start and target: `points`, 41 × 3, places of the nodes in m, and
    `target`, n × 2, a curve in m, as long as the cable.
    """

    ranges = {
        "length": Range(0.35, 0.5, "m"),
        "radius": Range(0.0015, 0.0025, "m"),
        "density": Range(1000.0, 1500.0, "kg/m³"),
        "bending_length": Range(0.02, 0.035, "m"),
        "friction": Range(0.3, 0.8),
        "target_x": Range(-0.05, 0.05, "m"),
        "target_y": Range(-0.05, 0.05, "m"),
        "target_heading": Range(-0.4, 0.4, "rad"),
        "bend_1": Range(-1.5, 1.5, "rad"),
        "bend_2": Range(-0.8, 0.8, "rad"),
        "bend_3": Range(-0.4, 0.4, "rad"),
    }
    period = 0.1
    substep = 0.02
    default_horizon = 150
    accepted_options = frozenset({"parameters", "points", "target"})

    def __init__(
        self,
        render_mode: str | None = None,
        horizon: int | None = None,
        control: Literal["plane", "pose"] = "plane",
    ) -> None:
        if control not in ("plane", "pose"):
            raise ValueError(f'control is {control!r}; it can be "plane" or "pose"')
        actions = 4 if control == "plane" else 6
        super().__init__(render_mode, horizon)
        self._set_spaces(actions, 8 * SEEN + 15)
        self.control = control
        self._seen = spread(EDGES + 1, SEEN)
        self.target = np.zeros((EDGES + 1, 2))
        self._points: Array = np.zeros((EDGES + 1, 3))
        self._held = 0

    def _options(self, options: Mapping[str, Any]) -> None:
        values = self.parameters
        length, height = values["length"], values["radius"] + 0.3 * TOLERANCE
        if "points" in options:
            self._points = np.array(options["points"], dtype=np.float64)
            if self._points.shape != (EDGES + 1, 3):
                raise ValueError(f"points has the shape {self._points.shape}; it must be {(EDGES + 1, 3)}")
        else:
            self._points = straight([0.0, 0.0, height], [length, 0.0, height], EDGES)
        if "target" in options:
            curve = np.array(options["target"], dtype=np.float64)
            if curve.ndim != 2 or curve.shape[1] != 2 or len(curve) < 2:
                raise ValueError(f"target has the shape {curve.shape}; it must be (n, 2) with n of at least 2")
            self.target = resample(curve, EDGES + 1)
        else:
            bends = [values["bend_1"], values["bend_2"], values["bend_3"]]
            start = [values["target_x"], values["target_y"]]
            self.target = smooth_curve(length, start, values["target_heading"], bends, EDGES)

    def _scenario(self) -> dict[str, Any]:
        clamps = [{"rod": "cable", "at": "end"}]
        end = self.horizon * self.period
        return cable_scene(self.parameters, self._points, clamps=clamps, step=self.substep, end=end)

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        length = self.parameters["length"]
        low = np.array([-0.6 * length, -length, self.parameters["radius"] + 0.3 * TOLERANCE])
        high = np.array([1.4 * length, length, 0.4 * length])
        self.gripper = Gripper(0, simulation.clamp_pose(0), low, high)
        self._held = 0

    def _act(self, action: Array) -> dict[int, Array]:
        rate = np.array([0.0, 0.0, action[3]]) if self.control == "plane" else action[3:]
        return {0: self.gripper.move(SPEED * action[:3], RATE * rate, self.period)}

    def _distances(self) -> Array:
        flat = np.linalg.norm(self.positions[:, :2] - self.target, axis=1)
        return np.asarray(np.hypot(flat, self.positions[:, 2] - self.parameters["radius"]))

    def _observe(self) -> Array:
        length = self.parameters["length"]
        pose = self.gripper.pose
        distances = self._distances()
        goal = np.append(self.target[-1], self.parameters["radius"])
        return np.concatenate(
            [
                self.positions[self._seen].ravel() / length,
                self.velocities[self._seen].ravel() / SPEED,
                self.target[self._seen].ravel() / length,
                pose[:3, 0],
                pose[:3, 2],
                pose[:3, 3] / length,
                (pose[:3, 3] - goal) / length,
                np.array([distances.mean(), distances.max(), pose[2, 3]]) / length,
            ]
        )

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        length = self.parameters["length"]
        distance = float(self._distances().mean())
        near = distance < 0.03 * length and float(self.positions[:, 2].max()) < 0.03
        self._held = self._held + 1 if near else 0
        return -distance / length - 0.01 * float(action @ action), self._held >= 5, {"distance": distance}

    def _draw(self) -> Canvas:
        length = self.parameters["length"]
        canvas = Canvas([1.0, 0.0, 0.0], [0.0, 0.9, 0.436], [0.4 * length, 0.0, 0.0], 2.0 * length)
        flat = np.column_stack([self.target, np.zeros(len(self.target))])
        canvas.line(flat, 0.0015, TARGET)
        canvas.line(self.positions, self.parameters["radius"], ROD)
        canvas.dots(self.gripper.pose[:3, 3], 0.008, GRIPPER)
        return canvas
