"""Simulations: steps, arrays, grasps, states."""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._command import File
from ._rodlab import Contacts, Scenario, ScenarioError, State, StepReport
from ._values import names
from .scene import Part, Place, Scene, scene_of

Array = NDArray[np.float64]


class Simulation:
    """A scene in motion, with n nodes in all, rod after rod.

    Arrays that are read are those after the last step. `forces`, `torques` and `natural_curvature`
    are arrays to write to; they hold from the next step on, until they are changed again.

    A step that fails raises an exception, and the state is that of the last accepted step. Only one
    thread may use a simulation at a time; steps of several simulations run in parallel.

    Parameters
    ----------
    scene
        A `Scene`, a resolved `Scenario`, a scenario file, or the name of a preset.
    natural_curvature
        Whether the array `natural_curvature` is available.
    """

    __slots__ = ("_clamps", "_core", "_rods")

    def __init__(
        self, scene: Scene | Scenario | File, *, natural_curvature: bool = False
    ) -> None:
        scenario = scene if isinstance(scene, Scenario) else scene_of(scene).scenario
        self._wrap(_rodlab.Simulation(scenario, natural_curvature))

    def _wrap(self, core: _rodlab.Simulation) -> None:
        self._core = core
        self._rods = Rods(core)
        self._clamps = Clamps(core, self._rods)

    # Motion.
    def step(self, duration: float | None = None) -> StepReport:
        """Advance by `duration` (s), by default by one step of the scenario."""
        return self._core.step(duration)

    def run(self, until: float) -> StepReport:
        """Advance to the time `until` (s), with steps of the scenario's size."""
        return self._core.run(until)

    def find_equilibrium(self) -> StepReport:
        """Move to the static equilibrium under the current loads and clamps."""
        return self._core.find_equilibrium()

    def follow(self, to: float | None = None, step: float | None = None) -> dict[str, Any]:
        """Follow the equilibria along the path of the scenario's ``[continuation]``, p points.

        Parameters
        ----------
        to
            Parameter at which the path ends; by default that of the scenario.
        step
            Size of the first step.

        Returns
        -------
        dict
            ``parameter`` (p), ``positions`` (p × n × 3, m), ``unstable_modes`` (p), and ``kind``: a
            list of words such as ``"regular"`` or ``"fold"``.
        """
        return self._core.follow(to, step)

    @property
    def time(self) -> float:
        """Time, s."""
        return self._core.time

    @property
    def end(self) -> float | None:
        """End of the motion in the scenario, s."""
        return self._core.end

    @property
    def ended(self) -> str | None:
        """Reason, if the scenario's own condition ended the motion."""
        return self._core.ended

    @property
    def step_size(self) -> float | None:
        """Time step of the scenario, s; None if it is automatic."""
        return self._core.step_size

    @property
    def scenario(self) -> Scenario:
        """The scenario that is simulated."""
        return self._core.scenario

    # Configuration.
    @property
    def rods(self) -> Rods:
        """The rods by name, or by handle of a `Scene`."""
        return self._rods

    @property
    def clamps(self) -> Clamps:
        """The clamps by number, by place such as ``"beam.end"``, or by handle of a `Scene`."""
        return self._clamps

    @property
    def positions(self) -> Array:
        """Positions of the nodes, n × 3, m."""
        return self._core.positions

    @property
    def velocities(self) -> Array:
        """Velocities of the nodes, n × 3, m/s."""
        return self._core.velocities

    @property
    def directors(self) -> Array:
        """First material directors of the edges that start at the nodes, n × 3."""
        return self._core.directors

    @property
    def edge_angles(self) -> Array:
        """Angles of these edges about their tangents, n, rad."""
        return self._core.edge_angles

    @property
    def twists(self) -> Array:
        """Twist per length at the nodes, n, rad/m."""
        return self._core.twists

    @property
    def curvatures(self) -> Array:
        """Curvature of the centreline at the nodes, n, 1/m; NaN at free ends."""
        return self._core.curvatures

    @property
    def moments(self) -> Array:
        """Size of the bending moment and the twisting moment, n × 2, N m; NaN at free ends."""
        return self._core.moments

    @property
    def tensions(self) -> Array:
        """Tensions of the edges that start at the nodes, n, N; NaN at nodes without such an edge."""
        return self._core.tensions

    def read_positions(self, out: Array) -> None:
        """Write the positions into an existing array n × 3."""
        self._core.read_positions(out)

    # Actions.
    @property
    def forces(self) -> Array:
        """Forces on the nodes in addition to the scenario's loads, n × 3, N: an array to write to."""
        return self._core.forces

    @forces.setter
    def forces(self, forces: ArrayLike) -> None:
        self._core.forces = forces

    @property
    def torques(self) -> Array:
        """Moments about the tangents of the edges that start at the nodes, n, N m: an array to write to."""
        return self._core.torques

    @torques.setter
    def torques(self, torques: ArrayLike) -> None:
        self._core.torques = torques

    @property
    def natural_curvature(self) -> Array:
        """Natural curvatures κ₁ and κ₂ in addition to those of the rods, n × 2, 1/m: an array to write to."""
        return self._core.natural_curvature

    @natural_curvature.setter
    def natural_curvature(self, curvature: ArrayLike) -> None:
        self._core.natural_curvature = curvature

    def grasp(
        self, rod: Part | str, at: Place = "end", *, position: bool = True, frame: bool = True
    ) -> Clamp:
        """Grasp a node at its current place.

        Parameters
        ----------
        rod, at
            The rod, and its node: ``"start"``, ``"end"`` or a number from zero.
        position, frame
            Whether the position and the material frame are held.

        Returns
        -------
        Clamp
            A clamp that can be moved and released.
        """
        if not position and not frame:
            raise ScenarioError("grasp: hold the position, the frame, or both")
        node = self.rods[rod].node(at)
        number = self._core.grasp(node, position=position, frame=frame)
        return Clamp(self._core, self._rods, number)

    def set_load_factor(self, load: int, factor: float) -> None:
        """Multiply a load of the scenario, counted from zero, by a factor."""
        self._core.set_load_factor(load, factor)

    # Measurements.
    @property
    def contacts(self) -> Contacts:
        """Pairs in contact at the last step."""
        return self._core.contacts

    @property
    def contact_forces(self) -> Array:
        """Contact force on each node, n × 3, N."""
        return self._core.contact_forces

    @property
    def fluid_forces(self) -> Array:
        """Force of the fluid on each node, n × 3, N."""
        return self._core.fluid_forces

    @property
    def energies(self) -> dict[str, float]:
        """Kinetic, stretching, bending, twisting, contact and gravitational energy, J."""
        return self._core.energies

    def probes(self) -> dict[str, float]:
        """Return the scenario's probes and the columns of its experiment, by name with unit."""
        return self._core.probes()

    def gradient(
        self, to: str | Sequence[str], of: str | Sequence[str] = ()
    ) -> dict[str, dict[str, float]]:
        """Differentiate probes at the current time with respect to keys of the scenario.

        The motion is repeated with its derivatives, by the Newton matrices of its steps, from the
        start to the present time, in steps of the scenario's size. See also `rodlab.sensitivity`.

        Parameters
        ----------
        to
            Keys with respect to which is differentiated, such as ``"rods.beam.radius"``.
        of
            Probes, or columns of them; by default all.

        Returns
        -------
        dict
            For each column of the probes a dict with the derivative over each key, in the unit of
            the column over that of the key; not a number where the probe has no value.

        Raises
        ------
        ScenarioError
            For a key that is not a number or changes the steps, for a scenario without derivatives,
            and after an action: derivatives exist only for the motion that the scenario prescribes.
        """
        found = self._core.gradient(names(to), names(of))
        rows = found["derivatives"][-1]
        return {
            column: dict(zip(found["keys"], rows[:, index].tolist(), strict=True))
            for index, column in enumerate(found["columns"])
        }

    @property
    def remarks(self) -> list[str]:
        """Remarks on the run, such as strains beyond the theory."""
        return self._core.remarks

    # States.
    def save(self) -> State:
        """Return all data that determine the future of the simulation."""
        return self._core.save()

    def restore(self, state: State) -> None:
        """Put the simulation into a state that it, or another of the same scenario, has saved.

        Nodes may have been grasped and released before or since: clamps are those of the state.

        Raises
        ------
        ScenarioError
            For a state of another scenario, and for one that was saved with the array
            `natural_curvature` where this simulation has none.
        """
        self._core.restore(state)

    @contextlib.contextmanager
    def trial(self) -> Iterator[State]:
        """Restore the current state at the end of a block: ``with simulation.trial(): ...``."""
        state = self.save()
        try:
            yield state
        finally:
            self.restore(state)

    def __copy__(self) -> Simulation:
        return _simulation_around(copy.copy(self._core))

    def __deepcopy__(self, memo: dict[int, Any]) -> Simulation:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        return _simulation_around, (self._core,)

    def __repr__(self) -> str:
        rods = len(self._core.rod_names)
        return f"<Simulation of {self.scenario.name!r}: {rods} rods, t = {self.time:.6g} s>"


def _simulation_around(core: _rodlab.Simulation) -> Simulation:
    simulation = Simulation.__new__(Simulation)
    simulation._wrap(core)
    return simulation


class RodView:
    """A rod of a simulation, with k nodes. Its arrays are rows of those of the simulation."""

    __slots__ = ("_core", "name", "nodes")

    def __init__(self, core: _rodlab.Simulation, name: str, nodes: slice) -> None:
        self._core = core
        self.name = name
        """Name of the rod."""
        self.nodes = nodes
        """Rows of the rod in the arrays of the simulation."""

    def __len__(self) -> int:
        return int(self.nodes.stop) - int(self.nodes.start)

    def node(self, at: Place) -> int:
        """Return the number in the simulation of a node of the rod."""
        if at == "start":
            return int(self.nodes.start)
        if at == "end":
            return int(self.nodes.stop) - 1
        # Accept numbers of numpy, which have __index__; True is not a node.
        if isinstance(at, (str, bool)) or not hasattr(at, "__index__"):
            raise ScenarioError(f"at: {at!r}; allowed: 'start', 'end', or the number of a node")
        if not 0 <= at < len(self):
            raise ScenarioError(f"at: {at} is out of range; {self.name} has {len(self)} nodes")
        return int(self.nodes.start) + at.__index__()

    @property
    def positions(self) -> Array:
        """Positions of the nodes, k × 3, m."""
        return self._core.positions[self.nodes]

    @property
    def tip(self) -> Array:
        """Position of the last node, 3, m."""
        tip: Array = self.positions[-1]
        return tip

    @property
    def velocities(self) -> Array:
        """Velocities of the nodes, k × 3, m/s."""
        return self._core.velocities[self.nodes]

    @property
    def directors(self) -> Array:
        """First material directors of the edges that start at the nodes, k × 3."""
        return self._core.directors[self.nodes]

    @property
    def twists(self) -> Array:
        """Twist per length at the nodes, k, rad/m."""
        return self._core.twists[self.nodes]

    @property
    def curvatures(self) -> Array:
        """Curvature of the centreline at the nodes, k, 1/m."""
        return self._core.curvatures[self.nodes]

    @property
    def moments(self) -> Array:
        """Size of the bending moment and the twisting moment at the nodes, k × 2, N m."""
        return self._core.moments[self.nodes]

    @property
    def tensions(self) -> Array:
        """Tensions of the edges that start at the nodes, k, N."""
        return self._core.tensions[self.nodes]

    @property
    def forces(self) -> Array:
        """Forces on the nodes in addition to the scenario's loads, k × 3, N: an array to write to."""
        return self._core.forces[self.nodes]

    @forces.setter
    def forces(self, forces: ArrayLike) -> None:
        self._core.forces[self.nodes] = forces

    @property
    def torques(self) -> Array:
        """Moments about the tangents of the edges that start at the nodes, k, N m: an array to write to."""
        return self._core.torques[self.nodes]

    @torques.setter
    def torques(self, torques: ArrayLike) -> None:
        self._core.torques[self.nodes] = torques

    @property
    def natural_curvature(self) -> Array:
        """Natural curvatures κ₁ and κ₂ in addition to those of the rod, k × 2, 1/m: an array to write to."""
        return self._core.natural_curvature[self.nodes]

    @natural_curvature.setter
    def natural_curvature(self, curvature: ArrayLike) -> None:
        self._core.natural_curvature[self.nodes] = curvature

    def __repr__(self) -> str:
        return f"<RodView {self.name!r}: {len(self)} nodes>"


class Rods(Mapping[str, RodView]):
    """The rods of a simulation by name; handles of a `Scene` can be used instead of names."""

    __slots__ = ("_rods",)

    def __init__(self, core: _rodlab.Simulation) -> None:
        names_and_nodes = zip(core.rod_names, core.rod_slices, strict=True)
        self._rods = {name: RodView(core, name, slice(*nodes)) for name, nodes in names_and_nodes}

    def __getitem__(self, rod: str | Part) -> RodView:
        name = rod.name if isinstance(rod, Part) else rod
        try:
            return self._rods[name]  # type: ignore[index]
        except KeyError:
            present = ", ".join(self._rods)
            raise KeyError(f"no rod is called {name!r}; there are {present}") from None

    def place(self, node: int | None) -> str | None:
        """Return the rod of a node and its number there: ``"beam.3"`` or ``"beam.end"``."""
        for name, rod in self._rods.items():
            if node is not None and rod.nodes.start <= node < rod.nodes.stop:
                number = node - rod.nodes.start
                ends = {len(rod) - 1: "end", 0: "start"}
                return f"{name}.{ends.get(number, number)}"
        return None

    def __iter__(self) -> Iterator[str]:
        return iter(self._rods)

    def __len__(self) -> int:
        return len(self._rods)


class Clamp:
    """A clamp of a simulation.

    A pose is a matrix 4 × 4 whose columns are the directors d₁ and d₂, the tangent, and the
    position in m.
    """

    __slots__ = ("_core", "_rods", "number")

    def __init__(self, core: _rodlab.Simulation, rods: Rods, number: int) -> None:
        self._core = core
        self._rods = rods
        self.number = number
        """Number of the clamp in the simulation, from zero."""

    @property
    def name(self) -> str | None:
        """Place of the clamp, such as ``"beam.end"``; None if it was released."""
        return self._rods.place(self.node)

    @property
    def node(self) -> int | None:
        """Number of the held node; None if it was released."""
        return self._core.clamp_nodes[self.number]

    @property
    def pose(self) -> Array:
        """Pose, 4 × 4. An assigned pose is reached during the next `step` or `run`."""
        return self._core.clamp_pose(self.number)

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        self._core.move_clamp(self.number, pose)

    @property
    def position(self) -> Array:
        """Position, 3, m. An assigned position is reached during the next `step` or `run`."""
        return self._core.clamp_pose(self.number)[:3, 3]

    @position.setter
    def position(self, position: ArrayLike) -> None:
        self._core.move_clamp(self.number, position)

    @property
    def force(self) -> Array:
        """Force that the clamp exerts, 3, N."""
        return self._core.reaction(self.number)[:3]

    @property
    def moment(self) -> Array:
        """Moment that the clamp exerts, 3, N m."""
        return self._core.reaction(self.number)[3:]

    def release(self) -> None:
        """Release the node."""
        self._core.release(self.number)

    def __repr__(self) -> str:
        return f"<Clamp {self.number}: {self.name or 'released'}>"


class Clamps:
    """The clamps of a simulation by number, by place (``"beam.end"``), or by handle of a `Scene`."""

    __slots__ = ("_core", "_rods")

    def __init__(self, core: _rodlab.Simulation, rods: Rods) -> None:
        self._core = core
        self._rods = rods

    def __getitem__(self, clamp: int | str | Part) -> Clamp:
        name = clamp.name if isinstance(clamp, Part) else clamp
        if isinstance(name, str):
            return Clamp(self._core, self._rods, self._number(name))
        if name is None or isinstance(name, bool) or not hasattr(name, "__index__"):
            raise TypeError(f"a clamp is a number or a name, not {clamp!r}")
        number = name.__index__()
        if not 0 <= number < len(self):
            raise IndexError(f"clamp {number} is out of range; there are {len(self)}")
        return Clamp(self._core, self._rods, number)

    def _number(self, name: str) -> int:
        rod, _, place = name.rpartition(".")
        nodes = self._core.clamp_nodes
        try:
            return nodes.index(self._rods[rod].node(int(place) if place.isdecimal() else place))
        except (KeyError, ValueError):
            present = ", ".join(filter(None, self.names())) or "none"
            raise KeyError(f"no clamp is called {name!r}; there are {present}") from None

    def names(self) -> list[str | None]:
        """Return the places of the clamps, such as ``"beam.end"``; None for those released."""
        return [self._rods.place(node) for node in self._core.clamp_nodes]

    def __iter__(self) -> Iterator[Clamp]:
        return (Clamp(self._core, self._rods, number) for number in range(len(self)))

    def __len__(self) -> int:
        return len(self._core.clamp_nodes)
