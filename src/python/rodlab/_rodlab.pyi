"""The compiled part of `rodlab`. Quantities are in SI units; arrays are float64."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, final

from typing_extensions import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ConvergenceError as ConvergenceError
from .errors import PhysicsError as PhysicsError
from .errors import RodlabError as RodlabError
from .errors import ScenarioError as ScenarioError

__all__ = [
    "__version__",
    "Batch",
    "Contacts",
    "Scenario",
    "Simulation",
    "State",
    "StepReport",
    "command",
    "demonstrations",
    "main",
    "run",
    "trace",
    "RodlabError",
    "ScenarioError",
    "ConvergenceError",
    "PhysicsError",
]

__version__: str

_Array = NDArray[np.float64]

def main(arguments: Sequence[str]) -> int:
    """Run the command line, and return its exit code."""

def command(arguments: Sequence[str]) -> str:
    """Run the command line, and return its standard output; a failure raises its exception."""

def demonstrations(arguments: Sequence[str]) -> dict[str, Any] | None:
    """Return the demonstrations that a command line requests; None for any other command."""

@final
class Scenario:
    """A scenario: everything that a file describes, with defaults filled in."""

    @staticmethod
    def load(path: str | PathLike[str], overrides: Sequence[str] | None = None) -> Scenario: ...
    @staticmethod
    def loads(text: str, overrides: Sequence[str] | None = None, name: str = "scenario", directory: str | PathLike[str] | None = None) -> Scenario: ...
    @staticmethod
    def from_dict(table: Mapping[str, Any], overrides: Sequence[str] | None = None, name: str = "scenario", directory: str | PathLike[str] | None = None) -> Scenario: ...
    def __deepcopy__(self, _memo: object, /) -> Scenario: ...
    @property
    def name(self) -> str: ...
    @property
    def experiment(self) -> str: ...
    def sensitivity(self, to: Sequence[str], of: Sequence[str]) -> dict[str, Any]:
        """Differentiate the c columns of probes with respect to k keys at the t outputs.

        Returns `times` (t, s), `columns`, `keys`, `units`, `key_values` (k), `values` (t × c) and `derivatives` (t × k × c).
        """
    def field_sensitivity(self, fields: Sequence[str], of: Sequence[str], parts: int) -> dict[str, Any]:
        """Differentiate the c columns of probes at the end with respect to f components of fields at n nodes, in p parts of the motion.

        Returns `columns`, `values` (c), `fields` (f), `units` (f), `rods` (n), `nodes` (n), `arc_lengths` (n, m), `ends` (p, s) and
        `derivatives` (p × n × f × c).
        """
    def to_toml(self) -> str:
        """Return the resolved scenario as TOML."""

@final
class StepReport:
    """Report on a step. Times in s, energies in J."""

    time: float
    step: float
    steps: int
    newton_iterations: int
    contacts: int
    retries: int
    ended: str | None

@final
class Contacts:
    """Pairs in contact at the last step, m of them."""

    nodes: NDArray[np.int64]
    """Nodes of each pair, m × 4: ends of the first edge, then of the second."""
    points: _Array
    """Places of the contacts, m × 3, m."""
    forces: _Array
    """Forces on the first of each pair, friction included, m × 3, N."""
    normals: _Array
    """Unit vectors from the second body to the first, m × 3."""
    distances: _Array
    """Distances of centrelines, m, m."""
    def __len__(self) -> int: ...

@final
class State:
    """All data that determine the future of a simulation. Can be pickled."""

    def __copy__(self, /) -> State: ...
    def __deepcopy__(self, _memo: object, /) -> State: ...
    @property
    def time(self) -> float: ...

@final
class Simulation:
    """A scene in motion with n nodes in total, rod after rod."""

    def __new__(cls, scenario: Scenario, natural_curvature: bool = False) -> Self:
        """Set up the scene at time zero; `natural_curvature` makes the array of that name available."""
    # Motion.
    def step(self, duration: float | None = None) -> StepReport:
        """Advance by `duration` (s), by default by the step of the scenario; if that is automatic, by one step."""
    def run(self, until: float) -> StepReport:
        """Advance to the time `until` (s), with steps of the scenario's size."""
    def find_equilibrium(self) -> StepReport: ...
    def follow(self, to: float | None = None, step: float | None = None) -> dict[str, Any]:
        """Follow the equilibria along the scenario's [continuation], p points.

        Returns `parameter` (p), `positions` (p × n × 3, m), `unstable_modes` (p) and `kind` (a list of p words).
        """
    # State.
    @property
    def scenario(self) -> Scenario: ...
    @property
    def time(self) -> float: ...
    @property
    def end(self) -> float | None:
        """End of the motion in the scenario, s."""
    @property
    def ended(self) -> str | None:
        """Reason, if the scenario's own condition ended the motion."""
    @property
    def step_size(self) -> float | None:
        """Step of the scenario, s; None if it is automatic."""
    @property
    def rod_names(self) -> list[str]: ...
    @property
    def rod_slices(self) -> list[tuple[int, int]]: ...
    @property
    def clamp_names(self) -> list[str]: ...
    @property
    def clamp_nodes(self) -> list[int | None]: ...
    @property
    def positions(self) -> _Array:
        """Positions of the nodes, n × 3, m."""
    @property
    def velocities(self) -> _Array:
        """Velocities of the nodes, n × 3, m/s."""
    @property
    def directors(self) -> _Array:
        """First material directors of the edges that start at the nodes, n × 3; zero at nodes without such an edge."""
    @property
    def edge_angles(self) -> _Array:
        """Angles of these edges about their tangents, n, rad."""
    @property
    def twists(self) -> _Array:
        """Twist per length at the nodes, n, rad/m."""
    @property
    def curvatures(self) -> _Array:
        """Curvature of the centreline at the nodes, n, 1/m; NaN at free ends."""
    @property
    def moments(self) -> _Array:
        """Size of the bending moment and the twisting moment at the nodes, n × 2, N m; NaN at free ends."""
    @property
    def tensions(self) -> _Array:
        """Tension of the edges that start at the nodes, n, N; NaN at nodes without such an edge."""
    def read_positions(self, out: _Array) -> None:
        """Write the positions into an existing array n × 3."""
    # Actions, which hold from the next step on.
    @property
    def forces(self) -> _Array:
        """Forces on the nodes in addition to the scenario's loads, n × 3, N: an array to write to."""
    @forces.setter
    def forces(self, forces: ArrayLike) -> None: ...
    @property
    def torques(self) -> _Array:
        """Moments about the tangents of the edges that start at the nodes, n, N m: an array to write to."""
    @torques.setter
    def torques(self, torques: ArrayLike) -> None: ...
    @property
    def natural_curvature(self) -> _Array:
        """Natural curvature κ₁, κ₂ at the nodes in addition to that of the rods, n × 2, 1/m: an array to write to."""
    @natural_curvature.setter
    def natural_curvature(self, curvature: ArrayLike) -> None: ...
    def clamp_pose(self, clamp: int) -> _Array:
        """Pose of a clamp, 4 × 4: its columns are the directors d₁ and d₂, the tangent, and the position in m."""
    def move_clamp(self, clamp: int, pose: ArrayLike) -> None:
        """Move a clamp to a pose, 4 × 4, or to a position, 3, during the next call of `step` or `run`."""
    def grasp(self, node: int, position: bool = True, frame: bool = True) -> int:
        """Grasp a node at its current place, and return the number of the new clamp."""
    def release(self, clamp: int) -> None: ...
    def set_load_factor(self, load: int, factor: float) -> None: ...
    # Measurements.
    def reaction(self, clamp: int) -> _Array:
        """Force and moment that a clamp exerts, 6, N and N m."""
    @property
    def contacts(self) -> Contacts: ...
    @property
    def contact_forces(self) -> _Array:
        """Contact force on each node, n × 3, N."""
    @property
    def fluid_forces(self) -> _Array:
        """Force of the fluid on each node, n × 3, N."""
    @property
    def energies(self) -> dict[str, float]:
        """Kinetic, stretching, bending, twisting, contact and gravitational energy, J."""
    def probes(self) -> dict[str, float]:
        """The scenario's probes and the columns of its experiment now; names end with their units."""
    def gradient(self, to: Sequence[str], of: Sequence[str]) -> dict[str, Any]:
        """Differentiate probes with respect to keys at the current time; the result is like that of `Scenario.sensitivity`."""
    @property
    def remarks(self) -> list[str]: ...
    # States.
    def save(self) -> State: ...
    def restore(self, state: State) -> None: ...

@final
class Batch:
    """Simulations that are stepped together on all cores: c cases with n nodes each."""

    def __new__(cls, scenarios: Sequence[Scenario] | Scenario, count: int | None = None) -> Self: ...
    def __len__(self) -> int: ...
    def step(self, duration: float | None = None, count: int = 1) -> None:
        """Advance all cases by `count` times `duration` (s). A case that fails stays at its last step; see `failures`."""
    def run(self, until: float) -> None: ...
    @property
    def failures(self) -> list[str | None]: ...
    @property
    def times(self) -> _Array: ...
    @property
    def positions(self) -> _Array:
        """Positions, c × n × 3, m."""
    @property
    def velocities(self) -> _Array: ...
    @property
    def forces(self) -> _Array:
        """Forces in addition to the scenario's loads, c × n × 3, N: an array to write to."""
    def move_clamp(self, clamp: int, poses: ArrayLike) -> None:
        """Move a clamp of all cases to poses, c × 4 × 4, or positions, c × 3, during the next step."""
    def save(self, case: int) -> State: ...
    def restore(self, case: int, state: State) -> None: ...
    def reset(self, cases: Sequence[int] | None = None) -> None:
        """Reset cases to the start of their scenarios."""

def run(scenario: Scenario, out: str | PathLike[str], force: bool = False, progress: bool = False) -> str:
    """Run a scenario as `rodlab run` does, and return its outcome as JSON."""

def trace(
    image: NDArray[np.uint8],
    colours: list[str],
    least_area: int,
    strands: int | None,
    region: str | None,
    least_length: float,
) -> list[_Array]:
    """Trace the rods of an RGB image, h × w × 3; a centreline is an array k × 2 of pixels u, v."""
