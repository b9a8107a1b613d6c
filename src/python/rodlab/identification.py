"""Fits of keys of scenarios to measurements, and derivatives of probes."""

from __future__ import annotations

import csv
import html
import io
import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _rodlab
from ._command import File, Quantity, arrays, flags, folder, needed, text
from ._rodlab import ScenarioError
from ._values import names, overrides, table
from .scene import Scene, scene_of

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, import-not-found, unused-ignore]

Array = NDArray[np.float64]
Data = File | Mapping[str, Any]
"""A CSV file, or its columns: a data frame, or a dict of arrays."""


def identify(
    scene: Scene | File,
    data: Data | Sequence[Data],
    fit: str | Sequence[str],
    *,
    others: Sequence[tuple[Scene | File, Data | Sequence[Data]]] = (),
    markers: Data | None = None,
    bounds: Mapping[str, tuple[Quantity, Quantity]] | None = None,
    prior: Mapping[str, tuple[Quantity, Quantity]] | None = None,
    noise: Mapping[str, Quantity] | None = None,
    loss: Literal["squares", "huber"] | None = None,
    out: File | None = None,
    **keys: Any,
) -> Identified:
    """Fit keys of scenarios to measurements, as ``rodlab identify`` does.

    Parameters
    ----------
    scene
        A `Scene`, a scenario file, or a preset, which states a value of each key to start from.
    data
        Measurements on it, one table or several: a CSV file, a data frame, or a dict of columns.
        ``rodlab guide identification`` lists the columns, such as ``time_s``, ``marker``, ``node``,
        ``x_m``, ``y_m`` and ``z_m``. Numbers that are NaN were not measured.
    fit
        Keys to fit, such as ``"parameters.ei"`` or ``"material.viscosity"``; k of them.
    others
        Further pairs of a scene and its data, which share the keys.
    markers
        Where markers are on their rods: a table with ``marker``, ``rod``, and ``node`` or
        ``arc_length_m``.
    bounds
        Least and largest value of keys.
    prior
        Expected value and standard deviation of keys.
    noise
        Standard deviation of the noise of ``"position"`` (m) or of columns; by default that of the
        residuals.
    loss
        ``"squares"`` (the default), or ``"huber"`` for data with outliers.
    out
        Directory for the files of the command line; by default none is kept.
    **keys
        Values of dotted keys of all scenes, such as other starts.

    Returns
    -------
    Identified
        Values, standard errors, correlations, residuals, and the scene with the values.

    Raises
    ------
    ScenarioError
        For faults of a scene, of the data (with file and line) or of an argument.
    ConvergenceError
        If the fit has not converged. The files in `out` have its last estimate.
    """
    keys_to_fit = names(fit)
    with ExitStack() as stack:
        directory = stack.enter_context(folder(out))
        temporary = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="rodlab-")))
        tables = _Tables(temporary)
        settings = [word for item in overrides(table(keys, "")) for word in ("--set", item)]
        experiments: list[tuple[str, str]] = []
        pairs: list[tuple[Scene | File, Any]] = [(scene, data), *others]
        for one, measured in pairs:
            path, own = stack.enter_context(scene_of(one).file())
            if own and others:
                raise ScenarioError(
                    "others: keys of several scenes are set together; give them to identify, "
                    "not to load"
                )
            settings += own
            listed = [measured] if _is_one(measured) else measured
            experiments.append((path, ",".join(tables.file(item, "data") for item in listed)))
        (first, files), *further = experiments
        words = ["identify", first, "--data", files, "--fit", ",".join(keys_to_fit), *settings]
        for path, files in further:
            words += ["--with", f"{path}:{files}"]
        for key, (least, most) in (bounds or {}).items():
            words += ["--bounds", f"{key}={text(least, key)}:{text(most, key)}"]
        for key, (expected, deviation) in (prior or {}).items():
            words += ["--prior", f"{key}={text(expected, key)}+-{text(deviation, key)}"]
        for name, deviation in (noise or {}).items():
            words += ["--noise", f"{name}={text(deviation, name)}"]
        if markers is not None:
            words += ["--markers", tables.file(markers, "markers")]
        _rodlab.command([*words, *flags(loss=loss, out=directory, quiet=True)])
        return Identified(directory)


class Identified:
    """Keys that were fitted to measurements, k of them, with their errors.

    Parameters
    ----------
    directory
        Directory that ``rodlab identify`` has written. All of it is read.
    """

    def __init__(self, directory: File) -> None:
        path = Path(directory)
        if not (path / "identified.json").is_file():
            raise ScenarioError(f"not an identification: {path} (identified.json is missing)")
        report = json.loads((path / "identified.json").read_text(encoding="utf-8"))
        self._residuals = (path / "residuals.csv").read_text(encoding="utf-8")
        self._scenario = (path / "fitted.toml").read_text(encoding="utf-8")
        self.report: dict[str, Any] = arrays(report)
        """``identified.json``: estimates, noise, undetermined combinations, remarks."""
        self.figure = (path / "residuals.svg").read_text(encoding="utf-8")
        """The residuals as a figure, SVG."""
        found = report["parameters"]
        self.keys: list[str] = [one["key"] for one in found]
        """The keys."""
        self.units: dict[str, str] = {one["key"]: one["unit"] for one in found}
        """SI unit of each key; empty where it has none."""
        self.values: dict[str, float] = {one["key"]: one["value"] for one in found}
        """Estimate of each key, in its unit."""
        self.standard_errors: dict[str, float] = {
            one["key"]: _or_nan(one["standard_error"]) for one in found
        }
        """Standard error of each key, in its unit; not a number where the data do not determine it."""
        self.intervals: dict[str, Array] = {
            one["key"]: np.array(one["interval_95"] or [np.nan, np.nan]) for one in found
        }
        """Interval of each key that contains the true value with a probability of 95 %, 2."""
        self.correlations: Array = np.array(report["correlations"], dtype=np.float64)
        """Correlations of the errors, k × k."""
        self.noise: dict[str, float] = {
            one["group"]: one["standard_deviation"] for one in report["groups"]
        }
        """Standard deviation of the noise of each group of numbers, in the unit of these."""
        self.remarks: list[str] = report["remarks"]
        """Remarks, such as on data that the scenario does not describe."""
        self.undetermined: list[str] = [
            f"{one['words']}; {one['advice']}" for one in report["undetermined"]
        ]
        """Combinations of keys that the data do not determine, with an experiment that would."""

    def table(self) -> pandas.DataFrame:
        """Return a table with a row for each key: value, unit, standard error, interval, start."""
        rows = [
            {
                "key": one["key"],
                "value": one["value"],
                "unit": one["unit"],
                "standard_error": self.standard_errors[one["key"]],
                "low_95": self.intervals[one["key"]][0],
                "high_95": self.intervals[one["key"]][1],
                "start": one["start"],
            }
            for one in self.report["parameters"]
        ]
        frame: pandas.DataFrame = needed("pandas", "data").DataFrame(rows)
        return frame

    def residuals(self) -> dict[str, NDArray[Any]]:
        """Return the measured numbers, m of them, as columns.

        Returns
        -------
        dict
            ``measured``, ``predicted`` and ``residual`` in the unit of the number, ``standardised``
            (the residual over the standard deviation of its noise), ``time_s`` (NaN for equilibria)
            and ``line``, arrays m; ``scenario``, ``file`` and ``series``, arrays of m texts.
        """
        rows = list(csv.reader(io.StringIO(self._residuals)))
        columns: dict[str, NDArray[Any]] = {}
        for name, *cells in zip(*rows, strict=True):
            if name in {"scenario", "file", "series"}:
                columns[name] = np.array(cells)
            else:
                columns[name] = np.array([float(cell) if cell else np.nan for cell in cells])
        return columns

    @property
    def scene(self) -> Scene:
        """The first scene with the estimates."""
        return Scene.loads(self._scenario, name="fitted")

    def __repr__(self) -> str:
        parts = [f"{key} = {self.values[key]:.5g} ± {self.standard_errors[key]:.1g}" for key in self.keys]
        return f"<Identified: {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        rows = []
        for key in self.keys:
            value, error = self.values[key], self.standard_errors[key]
            cells = [key, f"{value:.5g}", f"{error:.1g}", self.units[key]]
            rows.append("".join(f"<td>{html.escape(cell)}</td>" for cell in cells))
        body = "".join(f"<tr>{row}</tr>" for row in rows)
        head = "<tr><th>key</th><th>value</th><th>standard error</th><th>unit</th></tr>"
        return f"<table>{head}{body}</table>{self.figure}"


@dataclass(frozen=True)
class Derivatives:
    """Probes and their derivatives over k keys at t times, in SI units; c columns of probes."""

    times: Array
    """Times of the outputs, t, s; one for an equilibrium."""
    columns: list[str]
    """Columns of the probes; names end with their units."""
    keys: list[str]
    """The keys."""
    units: list[str | None]
    """SI unit of each key."""
    key_values: Array
    """Value of each key, k."""
    values: Array
    """Values of the columns, t × c; NaN where a probe has no value."""
    derivatives: Array
    """Derivatives, t × k × c, in the unit of the column divided by that of the key."""

    @property
    def elasticities(self) -> Array:
        """Relative change of a column per relative change of a key, (p/y) dy/dp, t × k × c."""
        values = np.where(self.values == 0.0, np.nan, self.values)[:, np.newaxis, :]
        result: Array = self.key_values[:, np.newaxis] * self.derivatives / values
        return result

    def table(self) -> pandas.DataFrame:
        """Return ``sensitivity.csv``: time, then each column and its derivatives with respect to the keys."""
        columns: dict[str, Array] = {"time_s": self.times}
        for index, name in enumerate(self.columns):
            columns[name] = self.values[:, index]
            for key, of in enumerate(self.keys):
                columns[f"d_{name}_d_{of}"] = self.derivatives[:, key, index]
        frame: pandas.DataFrame = needed("pandas", "data").DataFrame(columns)
        return frame


def sensitivity(
    scene: Scene | File, to: str | Sequence[str], of: str | Sequence[str] = (), **keys: Any
) -> Derivatives:
    """Differentiate probes of a scene with respect to its keys, as ``rodlab sensitivity`` does.

    Derivatives are those of the motion as it is computed, by the Newton matrices of its steps.

    Parameters
    ----------
    scene
        A `Scene`, a scenario file, or a preset. It needs probes (`Scene.add_probe`).
    to
        Keys with respect to which is differentiated, such as ``"rods.beam.radius"``; k of them.
    of
        Probes, or columns of them; by default all. They have c columns.
    **keys
        Values of dotted keys, which replace those of the scene.

    Returns
    -------
    Derivatives
        Values t × c and derivatives t × k × c at the t outputs of the run.

    Raises
    ------
    ScenarioError
        For a key that is not a number or changes the steps, and for a scene without derivatives.
    """
    scene = scene_of(scene).with_keys(**keys) if keys else scene_of(scene)
    return Derivatives(**scene.scenario.sensitivity(names(to), names(of)))


@dataclass(frozen=True)
class FieldDerivatives:
    """Probes at the end of a run and their derivatives with respect to fields, in SI units.

    There are c columns of probes, f components of fields, n nodes and p parts of the motion.
    """

    columns: list[str]
    """Columns of the probes; names end with their units."""
    values: Array
    """Values of the columns, c."""
    fields: list[str]
    """Components of the fields, f, such as ``"natural_curvature_1"``."""
    units: list[str | None]
    """SI unit of each component; relative changes have none."""
    rods: list[str]
    """Name of the rod of each node, n."""
    nodes: list[int]
    """Number of each node along its rod, n."""
    arc_lengths: Array
    """Distance of each node from the start of its rod as placed, n, m."""
    ends: Array
    """Ends of the parts of the motion, p, s."""
    derivatives: Array
    """Derivatives, p × n × f × c, in the unit of the column divided by that of the component."""


def field_sensitivity(
    scene: Scene | File,
    fields: str | Sequence[str],
    of: str | Sequence[str] = (),
    parts: int = 1,
    **keys: Any,
) -> FieldDerivatives:
    """Differentiate probes of a scene with respect to fields, at about the cost of one run.

    This is the adjoint mode of ``rodlab sensitivity --field``. Its derivatives over thousands of
    numbers serve optimisers of natural shapes and of forces over time.

    Parameters
    ----------
    scene
        A `Scene`, a scenario file, or a preset. It needs probes (`Scene.add_probe`).
    fields
        ``"natural_curvature"``, ``"natural_twist"``, ``"bending_stiffness"``,
        ``"twisting_stiffness"``, ``"stretching_stiffness"``, ``"force"``, ``"initial_velocity"``.
    of
        Probes, or columns of them; by default all. They have c columns.
    parts
        Parts of the motion, of the same length; the fields change in one of them each.
    **keys
        Values of dotted keys, which replace those of the scene.

    Returns
    -------
    FieldDerivatives
        Values c and derivatives p × n × f × c at the end of the run.

    Raises
    ------
    ScenarioError
        For an unknown field, and for a scene without such derivatives.
    """
    scene = scene_of(scene).with_keys(**keys) if keys else scene_of(scene)
    found = scene.scenario.field_sensitivity(names(fields), names(of), parts)
    return FieldDerivatives(**found)


class _Tables:
    """Writer of temporary files for tables in memory."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._count = 0

    def file(self, given: Any, name: str) -> str:
        """Return the name of a file with a table: `given` itself, or a new file."""
        if not _is_table(given):
            return text(given, name)
        columns = {str(column): np.asarray(given[column]) for column in given.keys()}
        shapes = {values.shape for values in columns.values()}
        if len(shapes) != 1 or len(next(iter(shapes))) != 1:
            found = ", ".join(f"{column}: {values.shape}" for column, values in columns.items())
            raise ScenarioError(f"{name}: expected columns of one length, found {found or 'none'}")
        self._count += 1
        number = "" if self._count == 1 else f"_{self._count}"
        path = self._directory / f"{name}{number}.csv"
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*map(_cells, columns.values()), strict=True))
        return str(path)


def _is_table(given: object) -> bool:
    """Return whether a value is a table of columns, such as a data frame."""
    return hasattr(given, "keys") and hasattr(given, "__getitem__")


def _is_one(given: object) -> bool:
    """Return whether a value is one table instead of a list of tables."""
    return _is_table(given) or isinstance(given, (str, PathLike))


def _cells(values: NDArray[Any]) -> Iterator[str]:
    """Write the values of a column; NaN becomes an empty cell."""
    for value in values.tolist():
        if value is None or value != value:
            yield ""
        else:
            yield value if isinstance(value, str) else repr(value)


def _or_nan(value: float | None) -> float:
    return np.nan if value is None else value
