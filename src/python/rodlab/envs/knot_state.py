"""Pull an overhand knot to a given size without pulling too hard."""

from typing import Any

import numpy as np

from .. import _rodlab
from .base import RodEnv, spread
from .gripper import Array, Gripper
from .parameters import Range
from .raster import GRIPPER, ROD, TARGET, Canvas

NODES = 81
SEEN = 21
LENGTH = 0.6
SPEED = 0.02
SETTLING_STEPS = 30


class KnotState(RodEnv):
    """Move both ends of a rod with an overhand knot until the knot has a given size, without exceeding a force.

    The rod is 0.6 m long. The ends are held on the x axis and move along it. The size H of the knot is the largest distance
    of a node from that axis. The target is a part of the size at the start: less than 1 tightens the knot, more than 1
    loosens it. A control step is 100 ms; an episode has 80 of them.

    Observation (70)
        Positions of 21 nodes over 0.6 m (63); traction of both ends over the allowed force (2); H and its target over 0.6 m
        (2); their difference over the target (1); distance of the ends over 0.6 m (1); largest bending strain over 0.5 (1).

    Action (2), from -1 to 1
        Speed of the first and of the second end, outwards, times 20 mm/s.

    Reward
        -|H - H*|/H* - max(F/F* - 1, 0) - 0.01 |action|², with the target H*, the larger traction F and the allowed force F*;
        10 more at success, and -10 for a step that fails.

    Termination
        Success: for 5 steps in a row |H - H*| < 0.04 H* and F < F*. Failure: F > 1.5 F*, bending strain above 0.5, or the
        engine raises.

    Randomised parameters
        ================  ===================  ===============================================
        name              range                meaning
        ================  ===================  ===============================================
        radius            2.5 to 3.5 mm        radius of the rod
        youngs_modulus    0.2 to 1 MPa         Young's modulus E
        density           1000 to 1300 kg/m³   density
        friction          0.05 to 0.3          friction μ of the rod with itself
        end_to_end        0.24 to 0.3 m        distance of the ends at the start
        target            0.45 to 1.25         target over the size at the start
        force             1.2 to 2.5           allowed force over (0.2 + 4 μ) E I / (H*/2)²
        ================  ===================  ===============================================

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
    horizon : int, optional
        Control steps in an episode, by default 80.

    Notes
    -----
    A slow pull takes at most about (0.2 + 4 μ) E I / (H*/2)². The bending strain is the largest curvature times the radius.
    Tractions are measured, so this environment is not stepped by `rodlab.Batch`.
    """

    ranges = {
        "radius": Range(0.0025, 0.0035, "m"),
        "youngs_modulus": Range(2e5, 1e6, "Pa", logarithmic=True),
        "density": Range(1000.0, 1300.0, "kg/m³"),
        "friction": Range(0.05, 0.3),
        "end_to_end": Range(0.24, 0.3, "m"),
        "target": Range(0.45, 1.25),
        "force": Range(1.2, 2.5),
    }
    period = 0.1
    substep = 0.02
    default_horizon = 80
    batched = False

    def __init__(self, render_mode: str | None = None, horizon: int | None = None) -> None:
        super().__init__(render_mode, horizon)
        self._set_spaces(2, 3 * SEEN + 7)
        self._seen = spread(NODES, SEEN)
        self.target = 0.0
        self.allowed_force = np.inf
        self.tractions = np.zeros(2)
        self._held = 0

    def _tied(self) -> Array:
        """Return the nodes of a loose overhand knot, 81 × 3, m."""
        values = self.parameters
        # Use a thicker rod with twice as many edges, so that no corners of the coarse curve overlap.
        table = {
            "experiment": "knot-tightening",
            "material": self._material(),
            "rod": {"radius": 1.05 * values["radius"], "nodes": 2 * NODES - 1},
            "knot": {"unknotting_number": 1, "length": LENGTH, "end_to_end": values["end_to_end"], "pull_speed": SPEED},
            "contact": self._contact(),
            "time": {"step": self.substep, "end": 1.0},
        }
        return np.array(_rodlab.Simulation(_rodlab.Scenario.from_dict(table)).positions[::2])

    def _material(self) -> dict[str, float]:
        values = self.parameters
        return {"youngs_modulus": values["youngs_modulus"], "poissons_ratio": 0.5, "density": values["density"]}

    def _contact(self) -> dict[str, Any]:
        return {
            "model": "imc",
            "friction": self.parameters["friction"],
            "distance_tolerance": 3e-4,
            "slip_tolerance": 5e-3,
            "stiffness_factor": 1e5,
        }

    def _scenario(self) -> dict[str, Any]:
        values = self.parameters
        return {
            "experiment": "scene",
            "material": self._material(),
            "rods": [
                {
                    "name": "knot",
                    "radius": values["radius"],
                    "natural_shape": "straight",
                    "edges": NODES - 1,
                    "shape": {"kind": "points", "points": self._tied().tolist()},
                }
            ],
            "clamps": [{"rod": "knot", "at": "start"}, {"rod": "knot", "at": "end"}],
            "loads": [{"kind": "drag", "translation": 3.0 * values["density"] * np.pi * values["radius"] ** 2}],
            "contact": self._contact(),
            "time": {
                "scheme": "implicit-euler",
                "step": self.substep,
                "end": SETTLING_STEPS * self.substep + self.horizon * self.period,
            },
        }

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        for _ in range(SETTLING_STEPS):
            simulation.step(self.substep)
        positions = np.array(simulation.positions)
        values = self.parameters
        self.target = values["target"] * _size(positions)
        stiffness = values["youngs_modulus"] * np.pi * values["radius"] ** 4 / 4.0
        needed = (0.2 + 4.0 * values["friction"]) * stiffness / (0.5 * self.target) ** 2
        self.allowed_force = values["force"] * needed
        limits = [(np.array([-0.5 * LENGTH, 0.0, 0.0]), np.array([-0.1 * LENGTH, 0.0, 0.0]))]
        limits.append((-limits[0][1], -limits[0][0]))
        self._grippers = [
            Gripper(clamp, simulation.clamp_pose(clamp), low, high) for clamp, (low, high) in enumerate(limits)
        ]
        self._held = 0

    def _act(self, action: Array) -> dict[int, Array]:
        still = np.zeros(3)
        return {
            gripper.clamp: gripper.move(np.array([outwards * SPEED * speed, 0.0, 0.0]), still, self.period)
            for gripper, outwards, speed in zip(self._grippers, (-1.0, 1.0), action, strict=True)
        }

    def _measure(self, simulation: _rodlab.Simulation) -> None:
        self.tractions = np.array([-simulation.reaction(0)[0], simulation.reaction(1)[0]])

    def _strain(self) -> float:
        """Return the largest bending strain."""
        edges = np.diff(self.positions, axis=0)
        lengths = np.linalg.norm(edges, axis=1)
        tangents = edges / lengths[:, np.newaxis]
        cosine = np.clip(np.sum(tangents[1:] * tangents[:-1], axis=1), -0.999, 1.0)
        curvature = 2.0 * np.sqrt((1.0 - cosine) / (1.0 + cosine)) / (0.5 * (lengths[1:] + lengths[:-1]))
        return float(curvature.max()) * self.parameters["radius"]

    def _observe(self) -> Array:
        size = _size(self.positions)
        ends = float(np.linalg.norm(self.positions[-1] - self.positions[0]))
        return np.concatenate(
            [
                self.positions[self._seen].ravel() / LENGTH,
                self.tractions / self.allowed_force,
                [size / LENGTH, self.target / LENGTH, (size - self.target) / self.target, ends / LENGTH],
                [self._strain() / 0.5],
            ]
        )

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        error = abs(_size(self.positions) - self.target) / self.target
        force = float(self.tractions.max())
        excess = max(force / self.allowed_force - 1.0, 0.0)
        self._held = self._held + 1 if error < 0.04 and excess == 0.0 else 0
        reward = -error - excess - 0.01 * float(action @ action)
        return reward, self._held >= 5, {"error": error, "traction": force}

    def _lost(self) -> bool:
        return float(self.tractions.max()) > 1.5 * self.allowed_force or self._strain() > 0.5

    def _draw(self) -> Canvas:
        canvas = Canvas([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0], 1.1 * LENGTH)
        for side in (-1.0, 1.0):
            height = side * self.target
            canvas.line([[-0.1, height, 0.0], [0.1, height, 0.0]], 0.0, TARGET)
        canvas.line(self.positions, self.parameters["radius"], ROD)
        canvas.dots(self.positions[[0, -1]], 0.008, GRIPPER)
        return canvas


def _size(positions: Array) -> float:
    """Return the largest distance of a node from the line through the ends, m."""
    axis = positions[-1] - positions[0]
    axis = axis / np.linalg.norm(axis)
    relative = positions - positions[0]
    return float(np.linalg.norm(relative - np.outer(relative @ axis, axis), axis=1).max())
