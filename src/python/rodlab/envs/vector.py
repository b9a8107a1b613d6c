"""Vectorised environments, stepped together on all cores."""

from collections.abc import Sequence
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from .. import _rodlab
from .base import Observation, RodEnv
from .cable_shape import CableShape
from .cantilever_reach import CantileverReach
from .flagellum_speed import FlagellumSpeed
from .folding import Folding
from .gripper import Array
from .knot_state import KnotState
from .peg_placement import PegPlacement

Flags = NDArray[np.bool_]


class RodVectorEnv(VectorEnv[Observation, NDArray[np.float32], NDArray[Any]]):
    """Copies of an environment whose scenes are stepped together by `rodlab.Batch`.

    Each case gives the same bytes as the environment on its own, with the seed that `SyncVectorEnv` would pass to it.
    A case that has ended is reset according to `autoreset_mode`. A reset rebuilds the batch with the new scene of that case,
    and puts the other cases back to their states.

    Parameters
    ----------
    num_envs : int
        Number of copies.
    render_mode : {None, "rgb_array"}
    autoreset_mode : gymnasium.vector.AutoresetMode or str
        By default a case is reset in the step after its end, which ignores its action and returns the reward 0.
    **arguments
        Arguments of the environment.
    """

    single: ClassVar[type[RodEnv]]
    """The environment that is copied."""

    def __init__(
        self,
        num_envs: int = 1,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **arguments: Any,
    ) -> None:
        super().__init__()
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}; it must be at least 1")
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.envs: list[RodEnv] = [self.single(render_mode=render_mode, **arguments) for _ in range(num_envs)]
        self.metadata = {**self.single.metadata, "autoreset_mode": self.autoreset_mode}
        self.single_action_space = self.envs[0].action_space
        self.single_observation_space = self.envs[0].observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._scenarios: list[_rodlab.Scenario | None] = [None] * num_envs
        self._batch: _rodlab.Batch | None = None
        self._observations = np.zeros(self.observation_space.shape or (), np.float32)
        self._ended: Flags = np.zeros(num_envs, np.bool_)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode in all cases, or in those of `options["reset_mask"]`.

        Parameters
        ----------
        seed : int or sequence of int, optional
            Seed of the first case, from which the others count up, or one for each.
        options : dict, optional
            Options of the environment, and `reset_mask`, array of bool, the cases to reset.
        """
        count = self.num_envs
        if seed is None:
            seeds: list[int | None] = [None] * count
        elif isinstance(seed, int | np.integer):
            seeds = [int(seed) + case for case in range(count)]
        else:
            seeds = list(seed)
        if len(seeds) != count:
            raise ValueError(f"there are {len(seeds)} seeds for {count} environments")
        options = dict(options or {})
        mask = np.asarray(options.pop("reset_mask", np.ones(count, np.bool_)))
        if mask.shape != (count,) or mask.dtype != np.bool_ or not mask.any():
            raise ValueError(f"reset_mask must have the shape {(count,)}, the type bool, and a value that is true")
        infos = self._restart(np.flatnonzero(mask).tolist(), seeds, options)
        return self._observations.copy(), infos

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Observation, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Advance all cases by a control period.

        Parameters
        ----------
        actions : array, cases × actions

        Returns
        -------
        observations : array, cases × observations, float32
        rewards : array, cases
        terminations, truncations : arrays of bool, cases
        infos : dict
        """
        batch = self._batch
        if batch is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        values = np.asarray(actions)
        if values.shape != self.action_space.shape:
            raise ValueError(f"actions have the shape {values.shape}; it must be {self.action_space.shape}")
        waiting = self._ended.copy()
        if self.autoreset_mode == AutoresetMode.DISABLED and waiting.any():
            raise gymnasium.error.ResetNeeded("reset the cases that have ended before step")
        rewards = np.zeros(self.num_envs)
        terminations = np.zeros(self.num_envs, np.bool_)
        truncations = np.zeros(self.num_envs, np.bool_)
        infos: dict[str, Any] = {}
        details: dict[int, dict[str, Any]] = {}
        failures = self._advance(batch, values, waiting)
        positions, velocities = batch.positions, batch.velocities
        for case, env in enumerate(self.envs):
            if waiting[case]:
                continue
            result = env.outcome(positions[case], velocities[case], failures[case])
            self._observations[case], rewards[case], terminations[case], truncations[case], info = result
            details[case] = info
            infos = self._add_info(infos, info, case)
        self._ended = terminations | truncations
        restarted = np.flatnonzero(waiting)
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            restarted = np.flatnonzero(self._ended)
            for case in restarted.tolist():
                final = {"final_obs": self._observations[case].copy(), "final_info": details[case]}
                infos = self._add_info(infos, final, case)
        if len(restarted):
            infos = self._restart(restarted.tolist(), [None] * self.num_envs, {}, infos)
        return self._observations.copy(), rewards, terminations, truncations, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a picture of each case if the mode is "rgb_array"."""
        if self.render_mode is None:
            return None
        return tuple(env.picture() for env in self.envs)

    def close_extras(self, **kwargs: Any) -> None:
        """Release the simulations."""
        self._batch = None

    def _advance(self, batch: _rodlab.Batch, actions: NDArray[np.float32], waiting: Flags) -> list[str | None]:
        """Step the batch through a control period, and return the failures."""
        poses: dict[int, Array] = {}
        for case, env in enumerate(self.envs):
            # A case that waits for its reset is stepped with the others, but its results are ignored.
            action = np.zeros(actions.shape[1:], np.float32) if waiting[case] else actions[case]
            for clamp, pose in env.command(action).items():
                poses.setdefault(clamp, np.empty((self.num_envs, 4, 4)))[case] = pose
        for clamp, those in poses.items():
            batch.move_clamp(clamp, those)
        batch.step(self.single.period)
        return batch.failures

    def _restart(
        self,
        cases: Sequence[int],
        seeds: Sequence[int | None],
        options: dict[str, Any],
        infos: dict[str, Any] | None = None,
    ) -> dict[str, Any]:
        """Begin an episode in some cases, and return the details."""
        infos = {} if infos is None else infos
        states: list[_rodlab.State | None] = [None] * self.num_envs
        if self._batch is not None:
            states = [None if case in cases else self._batch.save(case) for case in range(self.num_envs)]
        elif len(cases) < self.num_envs:
            raise gymnasium.error.ResetNeeded("reset all cases first")
        for case in cases:
            env = self.envs[case]
            self._scenarios[case], simulation = env.prepare(seed=seeds[case], options=dict(options))
            states[case] = simulation.save()
            env.close()
            self._observations[case] = env.observation()
            infos = self._add_info(infos, env.start_info(), case)
            self._ended[case] = False
        batch = _rodlab.Batch([scenario for scenario in self._scenarios if scenario is not None])
        for case, state in enumerate(states):
            if state is not None:
                batch.restore(case, state)
        self._batch = batch
        return infos


class CantileverReachVectorEnv(RodVectorEnv):
    """Copies of `CantileverReach`."""

    single = CantileverReach


class CableShapeVectorEnv(RodVectorEnv):
    """Copies of `CableShape`."""

    single = CableShape


class PegPlacementVectorEnv(RodVectorEnv):
    """Copies of `PegPlacement`."""

    single = PegPlacement


class FoldingVectorEnv(RodVectorEnv):
    """Copies of `Folding`."""

    single = Folding


_BATCHED: dict[str, type[RodVectorEnv]] = {
    "CantileverReach": CantileverReachVectorEnv,
    "CableShape": CableShapeVectorEnv,
    "PegPlacement": PegPlacementVectorEnv,
    "Folding": FoldingVectorEnv,
}
_SINGLE: dict[str, type[RodEnv]] = {"KnotState": KnotState, "FlagellumSpeed": FlagellumSpeed}


def make_vec(name: str, num_envs: int = 1, **arguments: Any) -> VectorEnv[Any, Any, Any]:
    """Make copies of an environment.

    Parameters
    ----------
    name : str
        Such as "CableShape" or "rodlab/CableShape-v0".
    num_envs : int
        Number of copies.
    **arguments
        Arguments of the environment, and `autoreset_mode`.

    Returns
    -------
    gymnasium.vector.VectorEnv
        A `RodVectorEnv`, which uses all cores. `KnotState` and `FlagellumSpeed` measure reactions, which a batch does not
        have; for these it is a `SyncVectorEnv`.

    Raises
    ------
    ValueError
        If there is no such environment.
    """
    short = name.removeprefix("rodlab/").removesuffix("-v0")
    if short in _BATCHED:
        return _BATCHED[short](num_envs=num_envs, **arguments)
    if short not in _SINGLE:
        raise ValueError(f"no such environment: {name}; there are {', '.join([*_BATCHED, *_SINGLE])}")
    single = _SINGLE[short]
    mode = arguments.pop("autoreset_mode", AutoresetMode.NEXT_STEP)
    return SyncVectorEnv([lambda: single(**arguments) for _ in range(num_envs)], autoreset_mode=mode)
