"""The base class of the environments."""

from collections.abc import Mapping
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from .. import _rodlab
from .gripper import Array
from .parameters import Range, draw_parameters
from .raster import Canvas

Observation = NDArray[np.float32]
Action = NDArray[np.float32]

OBSERVATION_BOUND = 20.0
"""Observations are cut off at this size; those of intact rods are far below."""


class RodEnv(gymnasium.Env[Observation, Action]):
    """A task with one simulated scene, stepped with a constant control period.

    A subclass states its ranges, its scene and its task by the methods that raise `NotImplementedError` here.
    All random numbers come from `np_random`. The same seed and the same actions give the same bytes.

    A step that does not converge, or that fails a physics check, ends the episode: `terminated` is true, the
    reward is `-failure_penalty`, and `info["failure"]` has the text of the error.

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
        With "rgb_array", `render` returns a picture, 256 × 256 × 3, uint8.
    horizon : int, optional
        Number of control steps after which an episode is truncated.

    Notes
    -----
    `reset(options={"parameters": {"friction": 0.4}})` fixes randomised parameters. `info["parameters"]` of `reset`
    has the values of the episode, in the units of the ranges.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 20}

    ranges: ClassVar[Mapping[str, Range]]
    """Randomised parameters, in the order in which they are drawn."""
    period: ClassVar[float]
    """Duration of a control step, s."""
    substep: ClassVar[float]
    """Time step of the engine, s."""
    default_horizon: ClassVar[int]
    """Number of control steps after which an episode is truncated."""
    failure_penalty: ClassVar[float] = 10.0
    """Reward of a failed step, with the sign changed."""
    success_reward: ClassVar[float] = 10.0
    """Additional reward of the step that solves the task."""
    batched: ClassVar[bool] = True
    """Whether positions and velocities are all that the task measures, so that `rodlab.Batch` can step it."""
    bends: bool = False
    """Whether the task sets the natural curvature of the rods."""
    accepted_options: ClassVar[frozenset[str]] = frozenset({"parameters"})
    """Keys of the options of `reset`."""

    def __init__(self, render_mode: str | None = None, horizon: int | None = None) -> None:
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise ValueError(f'render_mode is {render_mode!r}; it can be None or "rgb_array"')
        self.render_mode = render_mode
        self.horizon = self.default_horizon if horizon is None else int(horizon)
        if self.horizon < 1:
            raise ValueError(f"horizon is {self.horizon}; it must be at least 1")
        self.parameters: dict[str, float] = {}
        self.positions: Array = np.zeros((0, 3))
        self.velocities: Array = np.zeros((0, 3))
        self.steps = 0
        self._simulation: _rodlab.Simulation | None = None

    def _set_spaces(self, actions: int, observations: int) -> None:
        """Set the spaces from the numbers of values; a subclass calls this once."""
        self.action_space = spaces.Box(-1.0, 1.0, (actions,), np.float32)
        self.observation_space = spaces.Box(-OBSERVATION_BOUND, OBSERVATION_BOUND, (observations,), np.float32)

    # Methods that a subclass defines.

    def _scenario(self) -> dict[str, Any]:
        """Return the scene for `self.parameters`."""
        raise NotImplementedError

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        """Prepare the start of the scene, and set the goal and the grippers."""
        raise NotImplementedError

    def _act(self, action: Array) -> dict[int, Array]:
        """Return the poses of the clamps at the end of the control step, 4 × 4, by their numbers."""
        raise NotImplementedError

    def _observe(self) -> Array:
        """Return the observation of the current state."""
        raise NotImplementedError

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        """Return the reward of a step, whether the task is solved, and details."""
        raise NotImplementedError

    def _draw(self) -> Canvas:
        """Return the picture of the current state."""
        raise NotImplementedError

    def _actuate(self, simulation: _rodlab.Simulation) -> None:
        """Set actuation other than clamps, before the steps of the engine."""

    def _options(self, options: Mapping[str, Any]) -> None:
        """Use the options of `reset` other than the parameters."""

    def _measure(self, simulation: _rodlab.Simulation) -> None:
        """Measure more than positions and velocities after a step."""

    def _lost(self) -> bool:
        """Return whether the task has become impossible, which ends the episode as a failure."""
        return False

    # The interface of gymnasium.

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode.

        Parameters
        ----------
        seed : int, optional
            Seed of the random numbers of this and all later episodes.
        options : dict, optional
            `{"parameters": {name: value}}` fixes randomised parameters.

        Returns
        -------
        observation : array, float32
        info : dict
            `parameters`: values of the randomised parameters.
        """
        self.prepare(seed=seed, options=options)
        return self.observation(), self.start_info()

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Advance by a control period.

        Parameters
        ----------
        action : array
            Values from -1 to 1; values outside are cut off.

        Returns
        -------
        observation : array, float32
        reward : float
        terminated : bool
            The task is solved, or has failed.
        truncated : bool
            The horizon is reached.
        info : dict
            `success`, and `failure` where the episode has failed.
        """
        simulation = self._simulation
        if simulation is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        poses = self.command(action)
        failure = None
        try:
            for clamp, pose in poses.items():
                simulation.move_clamp(clamp, pose)
            self._actuate(simulation)
            simulation.step(self.period)
        except _rodlab.RodlabError as error:
            failure = str(error)
        self._measure(simulation)
        return self.outcome(simulation.positions, simulation.velocities, failure)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture of the present state, 256 × 256 × 3, if the mode is "rgb_array"."""
        if self.render_mode is None:
            return None
        return self.picture()

    def picture(self) -> NDArray[np.uint8]:
        """Return a picture of the present state, 256 × 256 × 3, whatever the mode."""
        if len(self.positions) == 0:
            raise gymnasium.error.ResetNeeded("call reset before render")
        return self._draw().image()

    def close(self) -> None:
        """Release the simulation."""
        self._simulation = None

    # The parts of `reset` and `step`, which the vectorised environment calls for each of its cases.

    def prepare(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[_rodlab.Scenario, _rodlab.Simulation]:
        """Draw the parameters of an episode, and return its scene at the start."""
        super().reset(seed=seed)
        options = options or {}
        unknown = sorted(set(options) - self.accepted_options)
        if unknown:
            known = ", ".join(sorted(self.accepted_options))
            raise ValueError(f"no such option: {', '.join(unknown)}; there are {known}")
        self.parameters = draw_parameters(self.ranges, self.np_random, options.get("parameters", {}))
        self._options(options)
        scenario = _rodlab.Scenario.from_dict(self._scenario(), name=type(self).__name__)
        simulation = _rodlab.Simulation(scenario, natural_curvature=self.bends)
        self.steps = 0
        self._begin(simulation)
        self._measure(simulation)
        self.positions = np.array(simulation.positions)
        self.velocities = np.array(simulation.velocities)
        self._simulation = simulation
        return scenario, simulation

    def command(self, action: Action) -> dict[int, Array]:
        """Check an action, and return the poses of the clamps at the end of the control step."""
        values = np.asarray(action, dtype=np.float64)
        if values.shape != self.action_space.shape:
            raise ValueError(f"action has the shape {values.shape}; it must be {self.action_space.shape}")
        if not np.all(np.isfinite(values)):
            raise ValueError("action has values that are not finite")
        self._action = np.clip(values, -1.0, 1.0)
        return self._act(self._action)

    def outcome(
        self, positions: Array, velocities: Array, failure: str | None
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Return the result of `step` for the state at the end of a control step."""
        self.positions = np.array(positions)
        self.velocities = np.array(velocities)
        self.steps += 1
        truncated = self.steps >= self.horizon
        if failure is not None:
            return self.observation(), -self.failure_penalty, True, truncated, {"success": False, "failure": failure}
        reward, success, details = self._judge(self._action)
        details["success"] = success
        if not success and self._lost():
            details["failure"] = "the task can no longer be solved"
            return self.observation(), -self.failure_penalty, True, truncated, details
        if success:
            reward += self.success_reward
        return self.observation(), float(reward), success, truncated, details

    def observation(self) -> Observation:
        """Return the observation of the current state."""
        values = np.clip(self._observe(), -OBSERVATION_BOUND, OBSERVATION_BOUND)
        return values.astype(np.float32)

    def start_info(self) -> dict[str, Any]:
        """Return the details at the start of an episode."""
        return {"parameters": dict(self.parameters)}


def spread(nodes: int, count: int) -> NDArray[np.int64]:
    """Return the numbers of `count` evenly spread nodes of a rod of `nodes` nodes, including both ends."""
    return np.rint(np.linspace(0, nodes - 1, count)).astype(np.int64)
