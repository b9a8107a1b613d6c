"""Scenes: scenario files as Python objects, read from files or built part by part."""

from __future__ import annotations

import copy
import html
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from . import _rodlab
from ._command import File, Quantity, answer
from ._rodlab import Scenario, ScenarioError
from ._values import Table, overrides, plain, read_toml, table, vector_rows, write_toml

if TYPE_CHECKING:
    from .simulation import Simulation

Place = str | int
"""``"start"``, ``"end"``, or the number of a node, counted from zero."""

# Keys that name files in any table, and keys that name files in one table.
_FILE_KEYS = frozenset({"file", "follow", "points_file", "rods_file"})
_FILES = frozenset({"start.from", "knot.curve", "sweep.points", "extends", "include"})


@dataclass(frozen=True)
class Part:
    """A part of a scene; it stands for its name wherever a name is expected.

    Attributes
    ----------
    name
        Its name; that of a clamp is its place, such as ``"beam.end"``.
    table
        The list of the scene that holds it, such as ``"rods"``.
    index
        Its number in this list, from 0.
    """

    name: str | None
    table: str
    index: int


@dataclass(frozen=True)
class Rod(Part):
    """A rod of a scene."""

    name: str


class Scene:
    """A scenario: rods, clamps, loads, contact, fluid, and how they are simulated.

    A scene holds the tables of a scenario file, and the same checks apply: `scenario`, `simulate`
    and `check` raise `ScenarioError` with the key that is wrong.

    Values are numbers in SI units, text with a unit (``"5 mm"``), booleans, arrays, lists, dicts,
    and parts of the scene in place of their names. Keys with the value None are left out.
    ``rodlab explain rods`` and ``rodlab explain rods.radius`` describe the keys.

    Parameters
    ----------
    experiment
        What is simulated: ``"scene"``, ``"flagella"``, ``"knot-tightening"`` and so on.
    name
        Name of the scenario; its results are in ``results/<name>`` by default.
    directory
        Directory from which names of files in the scene begin.
    **tables
        Other top-level keys and tables, such as ``title`` or ``parameters``.
    """

    def __init__(
        self, experiment: str = "scene", *, name: str = "scene", directory: File = ".", **tables: Any
    ) -> None:
        self.name = name
        self._directory = Path(directory)
        self._table: Table = table({"experiment": experiment, **tables}, "")
        # A scene from a file refers to the file until a part is added; until then only keys change.
        # `_table` of such a scene is the file with these keys; it is empty until it is needed.
        self._file: str | None = None
        self._overrides: dict[str, Any] = {}
        self._scenario: Scenario | None = None

    # Reading.
    @classmethod
    def load(cls, path: File, **keys: Any) -> Scene:
        """Read a scenario file or a preset.

        Parameters
        ----------
        path
            The file, or the name of a preset (``rodlab presets scenario``).
        **keys
            Values of dotted keys: ``load("beam.toml", **{"rods.beam.radius": "5 mm"})``. None
            removes a key.
        """
        path = fspath(path)
        scene = cls(name=Path(path).stem, directory=Path(path).parent)
        # A preset is not a file.
        scene._file = str(Path(path).absolute()) if Path(path).is_file() else path
        scene._overrides = table(keys, "")
        # Report faults of the file here.
        scene._table = scene._expanded()
        for key, value in keys.items():
            if value is None:
                scene[key] = None
        return scene

    @classmethod
    def loads(cls, text: str, *, name: str = "scene", directory: File = ".", **keys: Any) -> Scene:
        """Read a scenario from TOML text; names of files in it are relative to `directory`."""
        written = overrides(table(keys, ""))
        # Report faults of the text here, with their lines.
        scenario = Scenario.loads(text, written, name=name, directory=fspath(directory))
        scene = cls(name=name, directory=directory)
        scene._table = read_toml(text)
        for key, value in keys.items():
            scene[key] = value
        scene._scenario = scenario
        return scene

    @classmethod
    def from_dict(
        cls, tables: Mapping[str, Any], *, name: str = "scene", directory: File = "."
    ) -> Scene:
        """Make a scene from the tables of a scenario file."""
        scene = cls(name=name, directory=directory)
        scene._table = table(tables, "")
        return scene

    # Parts.
    def add_rod(
        self,
        points: ArrayLike | None = None,
        *,
        shape: Mapping[str, Any] | None = None,
        radius: Quantity | None = None,
        name: str | None = None,
        edges: int | str | None = None,
        closed: bool | None = None,
        material: Mapping[str, Any] | None = None,
        natural_shape: str | Mapping[str, Any] | ArrayLike | None = None,
        **keys: Any,
    ) -> Rod:
        """Add a rod.

        Parameters
        ----------
        points
            Its centreline as a polyline, k × 3, m. Instead of `shape`.
        shape
            Its centreline as a table: ``{"kind": "straight", "start": [0, 0, 0], ...}``.
        radius
            Radius, m.
        name
            By default ``rod_1``, ``rod_2`` and so on.
        edges
            Number of edges; by default those of the polyline.
        closed
            Whether the last node is joined to the first.
        material
            ``youngs_modulus`` (Pa), ``poissons_ratio``, ``density`` (kg/m³); keys that are left out
            are those of `set_material`.
        natural_shape
            The shape without stress: ``"as-placed"``, ``"straight"``, a table, or a polyline k × 3, m.
        **keys
            Other keys of ``[[rods]]``, such as ``cross_section``, ``twist`` or ``velocity``.
        """
        if (points is None) == (shape is None):
            raise ScenarioError("add_rod: give either points or shape")
        if points is not None:
            shape = _polyline(points, "points")
        if natural_shape is not None and not isinstance(natural_shape, (str, Mapping)):
            natural_shape = _polyline(natural_shape, "natural_shape")
        number = len(self._own().get("rods", ())) + 1
        name = f"rod_{number}" if name is None else name
        own = {
            "name": name,
            "radius": radius,
            "edges": edges,
            "shape": shape,
            "natural_shape": natural_shape,
            "closed": closed,
            "material": material,
        }
        part = self.add("rods", **own, **keys)
        return Rod(name, part.table, part.index)

    def add_clamp(self, rod: Rod | str, at: Place = "start", **keys: Any) -> Part:
        """Add a clamp that holds a node: its position and frame, or what ``hold`` names.

        Other keys, such as ``move`` and ``turn``, are those of ``[[clamps]]``.
        """
        part = self.add("clamps", rod=rod, at=at, **keys)
        return Part(f"{plain(rod, 'rod')}.{at}", part.table, part.index)

    def add_joint(
        self, kind: str, rods: Sequence[Rod | str], at: Sequence[Place], **keys: Any
    ) -> Part:
        """Add a joint of a node of one rod and a node of another.

        Parameters
        ----------
        kind
            ``"ball"``, ``"rigid"``, ``"hinge"``, ``"slide"`` or ``"spring"``.
        rods
            The two rods.
        at
            A node of each: ``("end", 4)``.
        **keys
            Other keys of ``[[joints]]``, such as ``name`` or ``break_at``.
        """
        return self.add("joints", kind=kind, rods=list(rods), at=list(at), **keys)

    def add_spring(
        self,
        rods: Sequence[Rod | str],
        at: Sequence[Place],
        stiffness: Quantity,
        *,
        rest_length: Quantity | None = None,
        **keys: Any,
    ) -> Part:
        """Add a spring between two nodes: `stiffness` in N/m, `rest_length` in m."""
        keys = {"stiffness": stiffness, "rest_length": rest_length, **keys}
        return self.add_joint("spring", rods, at, **keys)

    def add_body(
        self, rod: Rod | str, at: Place, mass: Quantity | None = None, **keys: Any
    ) -> Part:
        """Add a mass (kg) at a node, or with ``shape`` a rigid body that is welded to it."""
        return self.add("bodies", rod=rod, at=at, mass=mass, **keys)

    def add_obstacle(self, shape: Mapping[str, Any], **keys: Any) -> Part:
        """Add a rigid body that rods may touch: ``{"kind": "sphere", ...}``."""
        return self.add("obstacles", shape=shape, **keys)

    def add_plane(
        self, point: ArrayLike = (0.0, 0.0, 0.0), normal: ArrayLike = (0.0, 0.0, 1.0), **keys: Any
    ) -> Part:
        """Add a rigid half space below a plane: a `point` (m) and the `normal` out of it."""
        return self.add("planes", point=point, normal=normal, **keys)

    def add_load(self, kind: str, **keys: Any) -> Part:
        """Add a load: ``"gravity"``, ``"force"``, ``"moment"``, ``"distributed"`` or ``"drag"``."""
        return self.add("loads", kind=kind, **keys)

    def add_probe(self, kind: str, name: str, **keys: Any) -> Part:
        """Add a probe: columns of the results that begin with `name`."""
        return self.add("probes", kind=kind, name=name, **keys)

    def add(self, list_name: str, **keys: Any) -> Part:
        """Add an element to a list of tables of the scenario, such as ``"actuation"``.

        The other methods ``add_...`` do this for one list each.
        """
        elements = self._own().get(_text(list_name), [])
        if not isinstance(elements, list):
            raise ScenarioError(f"{list_name}: a {type(elements).__name__}, not a list of tables")
        element = table(keys, f"{list_name}.{len(elements)}")
        elements.append(element)
        self._table[list_name] = elements
        return Part(element.get("name"), list_name, len(elements) - 1)

    # Tables.
    def set_material(self, **keys: Any) -> None:
        """Set the material of all rods: ``youngs_modulus``, ``poissons_ratio``, ``density``, ..."""
        self.set("material", **keys)

    def set_contact(self, **keys: Any) -> None:
        """Set the contact: ``model``, ``friction``, ..."""
        self.set("contact", **keys)

    def set_fluid(self, **keys: Any) -> None:
        """Set the fluid: ``model``, ``viscosity``, ..."""
        self.set("fluid", **keys)

    def set_time(self, **keys: Any) -> None:
        """Set the time: ``mode``, ``step``, ``end``, ``scheme``, ..."""
        self.set("time", **keys)

    def set_solver(self, **keys: Any) -> None:
        """Set the tolerances of Newton's method: ``force_tolerance``, ``maximum_iterations``, ..."""
        self.set("solver", **keys)

    def set_output(self, **keys: Any) -> None:
        """Set the output of runs: ``interval``, ``nodes``, ``forces``, ``vtk``."""
        self.set("output", **keys)

    def set(self, table_name: str, **keys: Any) -> None:
        """Set keys of a table; other keys are unchanged. The methods ``set_...`` do this for one table each."""
        present = self._own().get(_text(table_name), {})
        if not isinstance(present, dict):
            raise ScenarioError(f"{table_name}: a {type(present).__name__}, not a table")
        self._table[table_name] = present | table(keys, table_name)

    # Keys.
    def __getitem__(self, key: str) -> Any:
        """Return the value of a dotted key, such as ``"rods.beam.radius"``, as it was given."""
        if key in self._overrides:
            return copy.deepcopy(self._overrides[key])
        value: Any = self._tables()
        steps = _steps(key)
        for number, step in enumerate(steps):
            value = _element(value, step, ".".join(steps[: number + 1]))
        return copy.deepcopy(value)

    def __setitem__(self, key: str, value: Any) -> None:
        if value is None:
            if key in self:
                del self[key]
            return
        self._set(key, value)
        self._scenario = None

    def __delitem__(self, key: str) -> None:
        self[key]
        if self._file is None and key in self._overrides:
            del self._overrides[key]
            self._scenario = None
            return
        *parents, last = _steps(key)
        place: Any = self._own()
        for number, step in enumerate(parents):
            place = _element(place, step, ".".join(parents[: number + 1]))
        del place[_number(place, last, key) if isinstance(place, list) else last]

    def __contains__(self, key: object) -> bool:
        try:
            self[str(key)]
        except KeyError:
            return False
        return True

    def with_keys(self, **keys: Any) -> Scene:
        """Return a copy of the scene with other values of dotted keys; None removes a key."""
        other = copy.copy(self)
        other._table = copy.deepcopy(self._table)
        other._overrides = dict(self._overrides)
        for key, value in keys.items():
            other[key] = value
        return other

    def _set(self, key: str, value: Any) -> None:
        value = plain(value, key)
        if self._file is not None:
            self._overrides[key] = value
            self._table = {}
            return
        *parents, last = _steps(key)
        if {"extends", "include"} & self._table.keys() and key not in self:
            # The element may be in a file that this file extends.
            self._overrides[key] = value
            return
        place: Any = self._table
        for number, step in enumerate(parents):
            if isinstance(place, dict):
                place.setdefault(step, {})
            place = _element(place, step, ".".join(parents[: number + 1]))
        if isinstance(place, list):
            place[_number(place, last, key)] = value
        elif isinstance(place, dict):
            place[last] = value
        else:
            raise KeyError(f"{key}: {'.'.join(parents)} is not a table")

    # Use.
    @property
    def scenario(self) -> Scenario:
        """The checked scenario, with defaults filled in."""
        if self._scenario is None:
            written = overrides(self._overrides)
            if self._file is not None:
                self._scenario = Scenario.load(self._file, written)
            else:
                self._scenario = Scenario.from_dict(
                    self._table, written, name=self.name, directory=str(self._directory)
                )
        return self._scenario

    def simulate(self, *, natural_curvature: bool = False) -> Simulation:
        """Return a simulation of the scene, at its start.

        With `natural_curvature`, the array of that name is available.
        """
        from .simulation import Simulation

        return Simulation(self, natural_curvature=natural_curvature)

    def check(self) -> dict[str, Any]:
        """Check the scene, and return derived numbers: stiffnesses, periods, an advised time step.

        The cost of a run is estimated by a trial of at most a second.
        """
        with self.file() as (path, settings):
            return answer("check", path, *settings, json=True)

    def to_dict(self) -> Table:
        """Return a copy of the tables of the scenario file."""
        return copy.deepcopy(self._tables())

    def to_toml(self) -> str:
        """Return the scene as a scenario file; names of files in it are absolute."""
        if self._file is None and self._overrides:
            # Keys of an extended file were set, and only the resolved scenario has them.
            return self.scenario.to_toml()
        return write_toml(_with_absolute_files(self._tables(), self._directory, ""))

    def save(self, path: File) -> None:
        """Write the scene as a scenario file."""
        Path(path).write_text(self.to_toml(), encoding="utf-8")

    @contextmanager
    def file(self) -> Iterator[tuple[str, list[str]]]:
        """Yield a file of the scene and the ``--set`` flags for the command line."""
        if self._file is not None:
            flags = [word for item in overrides(self._overrides) for word in ("--set", item)]
            yield self._file, flags
            return
        with tempfile.TemporaryDirectory(prefix="rodlab-") as folder:
            path = Path(folder) / f"{self.name}.toml"
            self.save(path)
            yield str(path), []

    def __repr__(self) -> str:
        return f"<Scene {self.name!r}>"

    def _repr_html_(self) -> str:
        tables = self._tables()
        lists = {name: items for name, items in tables.items() if isinstance(items, list)}
        counts = [f"{name}: {len(items)}" for name, items in lists.items()]
        title = html.escape(str(tables.get("title", self.name)))
        text = html.escape(write_toml(tables))
        about = html.escape(", ".join([str(tables.get("experiment", "")), *counts]))
        return f"<details><summary><b>{title}</b> ({about})</summary><pre>{text}</pre></details>"

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_scenario": None}

    def _expanded(self) -> Table:
        """Return the tables of a file, including those of the files that it extends and includes."""
        with self.file() as (path, settings):
            return read_toml(_rodlab.command(["expand", path, *settings, "--quiet"]))

    def _tables(self) -> Table:
        """Return the tables."""
        if self._file is not None and not self._table:
            self._table = self._expanded()
        return self._table

    def _own(self) -> Table:
        """Return the tables for changes; from now on they are independent of a file."""
        if self._file is not None:
            self._tables()
            self._file = None
            self._overrides = {}
        self._scenario = None
        return self._table


def scene_of(scene: Scene | File) -> Scene:
    """Return a scene; a name is that of a file or a preset."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, (str, PathLike)):
        return Scene.load(scene)
    raise TypeError(f"scene: a {type(scene).__name__}; allowed: a Scene, a file, or a preset")


def _polyline(points: Any, key: str) -> Table:
    return {"kind": "points", "points": vector_rows(points, key, columns=3).tolist()}


def _text(name: str) -> str:
    if not isinstance(name, str):
        raise TypeError(f"the name of a table is text, not {name!r}")
    return name


def _steps(key: str) -> list[str]:
    if not isinstance(key, str) or not key or "" in key.split("."):
        raise KeyError(f"not a dotted key: {key!r}")
    return key.split(".")


def _element(value: Any, step: str, path: str) -> Any:
    if isinstance(value, list):
        return value[_number(value, step, path)]
    if isinstance(value, dict) and step in value:
        return value[step]
    present = f"; there are {', '.join(value)}" if isinstance(value, dict) and value else ""
    raise KeyError(f"{path}: not set{present}")


def _number(elements: list[Any], step: str, path: str) -> int:
    """Return the number of an element of a list, given by its number or its name."""
    if step.isdecimal() and int(step) < len(elements):
        return int(step)
    names = [item.get("name") if isinstance(item, dict) else None for item in elements]
    if step in names:
        return names.index(step)
    present = ", ".join(name for name in names if name) or f"{len(elements)} without names"
    raise KeyError(f"{path}: no such element; there are {present}")


def _with_absolute_files(value: Any, directory: Path, path: str) -> Any:
    """Make names of files absolute, so that the file of the scene may be in any directory."""
    if isinstance(value, dict):
        prefix = f"{path}." if path else ""
        return {
            key: _with_absolute_files(item, directory, f"{prefix}{key}")
            for key, item in value.items()
        }
    if isinstance(value, list):
        return [_with_absolute_files(item, directory, path) for item in value]
    names_file = path in _FILES or path.rsplit(".", 1)[-1] in _FILE_KEYS
    if isinstance(value, str) and names_file:
        return str((directory / value).absolute())
    return value
