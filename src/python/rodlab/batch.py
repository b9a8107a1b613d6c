"""Batches: many simulations that are stepped together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._command import File
from ._rodlab import Scenario, State
from .scene import Scene, scene_of

Array = NDArray[np.float64]


class Batch:
    """Simulations that are stepped together on all cores: c cases with n nodes each.

    Parameters
    ----------
    scenes
        One scene for all cases, or a scene for each of them; all have equally many nodes and clamps.
    count
        Number of cases; by default one for each scene.
    """

    __slots__ = ("_core",)

    def __init__(
        self, scenes: Scene | Scenario | File | Sequence[Scene | Scenario], count: int | None = None
    ) -> None:
        if isinstance(scenes, Sequence) and not isinstance(scenes, str):
            self._core = _rodlab.Batch([_scenario(scene) for scene in scenes], count)
        else:
            self._core = _rodlab.Batch(_scenario(scenes), count)

    def __len__(self) -> int:
        return len(self._core)

    def step(self, duration: float | None = None, count: int = 1) -> None:
        """Advance all cases by `count` steps of `duration` (s), by default that of the scenario.

        A case that fails stays at its last step; see `failures`.
        """
        self._core.step(duration, count)

    def run(self, until: float) -> None:
        """Advance all cases to the time `until` (s), with steps of the scenario's size."""
        self._core.run(until)

    @property
    def failures(self) -> list[str | None]:
        """Reason for the failure of each case; None for cases without failure."""
        return self._core.failures

    @property
    def times(self) -> Array:
        """Time of each case, c, s."""
        return self._core.times

    @property
    def positions(self) -> Array:
        """Positions, c × n × 3, m."""
        return self._core.positions

    @property
    def velocities(self) -> Array:
        """Velocities, c × n × 3, m/s."""
        return self._core.velocities

    @property
    def forces(self) -> Array:
        """Forces in addition to the scenario's loads, c × n × 3, N: an array to write to."""
        return self._core.forces

    def move_clamp(self, clamp: int, poses: ArrayLike) -> None:
        """Move a clamp of all cases to poses, c × 4 × 4, or positions, c × 3, m, in the next step."""
        self._core.move_clamp(clamp, poses)

    def save(self, case: int) -> State:
        """Return the state of a case."""
        return self._core.save(case)

    def restore(self, case: int, state: State) -> None:
        """Restore a state of a case."""
        self._core.restore(case, state)

    def reset(self, cases: Sequence[int] | None = None) -> None:
        """Reset cases, by default all, to the start of their scenarios."""
        self._core.reset(cases)


def _scenario(scene: Scene | Scenario | File) -> Scenario:
    return scene if isinstance(scene, Scenario) else scene_of(scene).scenario
