"""Lay a cable between pegs on a table."""

from typing import Any

import numpy as np

from .. import _rodlab
from .base import RodEnv, spread
from .cable import TOLERANCE, cable_scene, straight, winding_number
from .gripper import Array, Gripper
from .parameters import Range
from .raster import FIXTURE, GRIPPER, ROD, TARGET, Canvas

EDGES = 45
SEEN = 12
PEGS = 3
PEG_RADIUS = 0.008
PEG_HEIGHT = 0.02
NEAR = 0.03
SPEED = 0.2
RATE = 2.0


class PegPlacement(RodEnv):
    """Lay a cable on a table between pegs, so that it passes each of them on a given side, and its end reaches a place.

    One end of the cable is pinned to the table at the origin. The cable lies straight along -y, away from the pegs, and a
    gripper holds the other end. Three pegs of radius 8 mm and height 2 cm stand near the x axis. A control step is 100 ms;
    an episode has 150 of them.

    Observation (101)
        Positions of 12 nodes over the length L (36); their velocities over 0.2 m/s (36); x, y of the pegs over L (6); their
        sides (3), 1 where the cable is to pass at larger y, -1 at smaller y; whether they are passed (3); place of the end's
        goal over L (2); the frame of the gripper: d₁, tangent (6), position over L (3); end less goal over L (3); place of
        the gap beside the first peg that is not passed, less the end, over L (3).

    Action (6), from -1 to 1
        Velocity of the gripper in x, y, z, times 0.2 m/s (3); its angular velocity about x, y, z, times 2 rad/s (3).

    Reward
        Share of the pegs passed, minus 1, minus d/L with the distance d of the end from its goal, minus 0.01 |action|²; 10
        more at success, and -10 for a step that fails.

    Termination
        Success: for 5 steps in a row all pegs are passed and d < 2 cm. Failure: the engine raises.

        A peg is passed where no part of it is between the cable and the prescribed curve: seen from above, the closed curve of
        both does not enclose it. The point of the cable nearest to it must be within 3 cm of its surface and below its top.

    Randomised parameters
        ==================  ===================  ===============================================
        name                range                meaning
        ==================  ===================  ===============================================
        length              0.45 to 0.55 m       length L
        radius              1.5 to 2.5 mm            radius of the cable
        density             1000 to 1500 kg/m³   density
        bending_length      20 to 30 mm          (E r² / (8 ρ g))^(1/3), the gravito-bending length
        friction            0.2 to 0.6           friction with the table, the pegs and itself
        peg_1_x … peg_3_x   -10 to 10 mm         place of a peg beside 0.24, 0.48, 0.72 times L
        peg_1_y … peg_3_y   -20 to 20 mm         place of a peg beside the x axis
        side_1 … side_3     -1 to 1              the sign is the side
        goal_y              -40 to 40 mm         y of the goal; its x is 0.92 L less 1 cm
        ==================  ===================  ===============================================

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
    horizon : int, optional
        Control steps in an episode, by default 150.
    """

    ranges = {
        "length": Range(0.45, 0.55, "m"),
        "radius": Range(0.0015, 0.0025, "m"),
        "density": Range(1000.0, 1500.0, "kg/m³"),
        "bending_length": Range(0.02, 0.03, "m"),
        "friction": Range(0.2, 0.6),
        **{f"peg_{peg}_x": Range(-0.01, 0.01, "m") for peg in (1, 2, 3)},
        **{f"peg_{peg}_y": Range(-0.02, 0.02, "m") for peg in (1, 2, 3)},
        **{f"side_{peg}": Range(-1.0, 1.0) for peg in (1, 2, 3)},
        "goal_y": Range(-0.04, 0.04, "m"),
    }
    period = 0.1
    substep = 0.02
    default_horizon = 150

    def __init__(self, render_mode: str | None = None, horizon: int | None = None) -> None:
        super().__init__(render_mode, horizon)
        self._set_spaces(6, 6 * SEEN + 29)
        self._seen = spread(EDGES + 1, SEEN)
        self.pegs = np.zeros((PEGS, 2))
        self.sides = np.ones(PEGS)
        self.goal = np.zeros(2)
        self.gaps = np.zeros((PEGS, 2))
        self.path = np.zeros((2, 2))
        self._held = 0

    def _scenario(self) -> dict[str, Any]:
        values = self.parameters
        length, height = values["length"], values["radius"] + 0.3 * TOLERANCE
        numbers = range(1, PEGS + 1)
        self.pegs = np.array(
            [[0.24 * number * length + values[f"peg_{number}_x"], values[f"peg_{number}_y"]] for number in numbers]
        )
        self.sides = np.array([1.0 if values[f"side_{number}"] >= 0.0 else -1.0 for number in numbers])
        self.goal = np.array([0.92 * length - 0.01, values["goal_y"]])
        clear = PEG_RADIUS + values["radius"] + 0.006
        self.gaps = self.pegs + np.column_stack([np.zeros(PEGS), self.sides * clear])
        self.path = _weave(np.vstack([np.zeros(2), self.gaps, self.goal]))
        obstacles = [
            {
                "name": f"peg_{number}",
                "shape": {
                    "kind": "capsule",
                    "start": [float(x), float(y), -PEG_RADIUS],
                    "end": [float(x), float(y), PEG_HEIGHT - PEG_RADIUS],
                    "radius": PEG_RADIUS,
                },
            }
            for number, (x, y) in zip(numbers, self.pegs, strict=True)
        ]
        return cable_scene(
            values,
            straight([0.0, 0.0, height], [0.0, -length, height], EDGES),
            clamps=[{"rod": "cable", "at": "start", "hold": "position"}, {"rod": "cable", "at": "end"}],
            obstacles=obstacles,
            step=self.substep,
            end=self.horizon * self.period,
        )

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        length, radius = self.parameters["length"], self.parameters["radius"]
        low = np.array([-0.5 * length, -length, radius + 0.3 * TOLERANCE])
        high = np.array([length, length, 0.9 * length])
        self.gripper = Gripper(1, simulation.clamp_pose(1), low, high)
        self._held = 0

    def _act(self, action: Array) -> dict[int, Array]:
        return {1: self.gripper.move(SPEED * action[:3], RATE * action[3:], self.period)}

    def passed(self) -> Array:
        """Return 1 for each peg that the cable passes as prescribed, otherwise 0."""
        flat = self.positions[:, :2]
        loop = np.vstack([flat, self.path[::-1]])
        result = np.zeros(PEGS)
        for index, peg in enumerate(self.pegs):
            distances = np.linalg.norm(flat - peg, axis=1)
            nearest = int(distances.argmin())
            beside = distances[nearest] < PEG_RADIUS + NEAR and self.positions[nearest, 2] < PEG_HEIGHT
            result[index] = float(beside and winding_number(loop, peg) == 0)
        return result

    def _observe(self) -> Array:
        length = self.parameters["length"]
        pose, end = self.gripper.pose, self.positions[-1]
        passed = self.passed()
        goal = np.append(self.goal, self.parameters["radius"])
        missing = np.flatnonzero(passed == 0.0)
        place = np.append(self.gaps[missing[0]], self.parameters["radius"]) if len(missing) else goal
        return np.concatenate(
            [
                self.positions[self._seen].ravel() / length,
                self.velocities[self._seen].ravel() / SPEED,
                self.pegs.ravel() / length,
                self.sides,
                passed,
                self.goal / length,
                pose[:3, 0],
                pose[:3, 2],
                pose[:3, 3] / length,
                (end - goal) / length,
                (place - end) / length,
            ]
        )

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        goal = np.append(self.goal, self.parameters["radius"])
        distance = float(np.linalg.norm(self.positions[-1] - goal))
        passed = int(self.passed().sum())
        self._held = self._held + 1 if passed == PEGS and distance < 0.02 else 0
        reward = passed / PEGS - 1.0 - distance / self.parameters["length"] - 0.01 * float(action @ action)
        return reward, self._held >= 5, {"distance": distance, "passed": passed}

    def _draw(self) -> Canvas:
        length = self.parameters["length"]
        canvas = Canvas([1.0, 0.0, 0.0], [0.0, 0.9, 0.436], [0.4 * length, 0.0, 0.0], 2.2 * length)
        canvas.line(np.column_stack([self.path, np.zeros(len(self.path))]), 0.001, TARGET)
        canvas.dots(np.append(self.goal, 0.0), 0.01, TARGET)
        for x, y in self.pegs:
            canvas.line([[x, y, 0.0], [x, y, PEG_HEIGHT - PEG_RADIUS]], PEG_RADIUS, FIXTURE)
        canvas.line(self.positions, self.parameters["radius"], ROD)
        canvas.dots(self.gripper.pose[:3, 3], 0.008, GRIPPER)
        return canvas


def _weave(points: Array) -> Array:
    """Return a smooth curve y(x), n × 2, through points with increasing x, with zero slope at each of them."""
    part = np.linspace(0.0, 1.0, 9)[:, np.newaxis]
    level = 0.5 - 0.5 * np.cos(np.pi * part)
    pieces = [
        np.hstack([(1.0 - part) * start[0] + part * end[0], (1.0 - level) * start[1] + level * end[1]])
        for start, end in zip(points[:-1], points[1:], strict=True)
    ]
    return np.vstack(pieces)
