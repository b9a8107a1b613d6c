"""Runs and sweeps, and the directories of their results."""

from __future__ import annotations

import csv
import html
import json
import tempfile
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _rodlab
from ._command import File, flags, needed, text
from ._rodlab import ScenarioError
from .scene import Scene

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, import-not-found, unused-ignore]
    import xarray  # type: ignore[import-untyped, import-not-found, unused-ignore]

Array = NDArray[np.float64]

_PAGE_OUTPUTS = 300
"""Largest number of outputs in the 3-D page of a notebook, which stores the page."""


def run(
    scene: Scene | File,
    out: File | None = None,
    *,
    force: bool = False,
    progress: bool = False,
    **keys: Any,
) -> Results:
    """Run a scene as ``rodlab run`` does, to the same bytes.

    A run that was interrupted is resumed; a finished one is not repeated.

    Parameters
    ----------
    scene
        A `Scene`, a scenario file, or a preset.
    out
        Directory of the results; by default ``results/<name of the scene>``.
    force
        Whether earlier results in `out` are discarded.
    progress
        Whether progress is printed.
    **keys
        Values of dotted keys, which replace those of the scene.
    """
    scene = _with_keys(scene, keys)
    out = Path("results") / scene.name if out is None else Path(out)
    _rodlab.run(scene.scenario, str(out), force=force, progress=progress)
    return Results(out)


def sweep(
    scene: Scene | File,
    vary: Mapping[str, Any] | None = None,
    out: File | None = None,
    *,
    jobs: int | None = None,
    force: bool = False,
    **keys: Any,
) -> Results:
    """Run a scene for every combination of values, as ``rodlab run --vary`` does.

    Cases that are finished are not repeated. A case that fails does not stop the others.

    Parameters
    ----------
    scene
        A `Scene`, a scenario file, or a preset; a file may have a ``[sweep]`` of its own.
    vary
        For each dotted key a list of values, or text ``"FROM:TO:STEP"``.
    out
        Directory of the results; by default ``results/<name of the scene>``.
    jobs
        Cases to run at a time; by default as many as there are cores.
    force
        Whether earlier results in `out` are discarded.
    **keys
        Values of dotted keys, which replace those of the scene.
    """
    scene = _with_keys(scene, keys)
    out = Path("results") / scene.name if out is None else Path(out)
    varied = [f"{key}={text(values, key)}" for key, values in (vary or {}).items()]
    words = [word for item in varied for word in ("--vary", item)]
    with scene.file() as (path, settings):
        options = flags(out=out, jobs=jobs, force=force, quiet=True, json=True)
        _rodlab.command(["run", path, *settings, *words, *options])
    return Results(out)


def results(directory: File) -> Results:
    """Open the results of a run or a sweep, finished or still running."""
    return Results(directory)


class Nodes(NamedTuple):
    """Positions of all nodes at all outputs."""

    times: Array
    """Times of the outputs, t, s."""
    positions: Array
    """Positions, t × n × 3, m."""
    angles: Array
    """Angles of the edges about their tangents, t × n, rad."""
    rods: dict[str, slice]
    """Nodes of each rod."""


class Results:
    """The directory of a run or a sweep.

    Parameters
    ----------
    directory
        Directory that holds ``manifest.json``.
    """

    def __init__(self, directory: File) -> None:
        self.directory = Path(directory)
        """Where the results are."""
        if not (self.directory / "manifest.json").is_file():
            raise ScenarioError(
                f"not a results directory: {self.directory} (manifest.json is missing)"
            )

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """The manifest: version, command line, times, rods, status of every case."""
        text = (self.directory / "manifest.json").read_text(encoding="utf-8")
        manifest = json.loads(text)
        assert isinstance(manifest, dict)
        return manifest

    @property
    def report(self) -> dict[str, Any]:
        """Status, outcome and cost of the run; for a sweep, those of every case by its id."""
        cases: dict[str, Any] = self.manifest.get("cases", {})
        return cases if self.is_sweep else cases.get("main", {})

    @property
    def is_sweep(self) -> bool:
        """Whether these are the results of a sweep."""
        return (self.directory / "cases").is_dir()

    def cases(self) -> dict[str, Results]:
        """Return the results of each case of a sweep by its id; cases without results are omitted."""
        with open(self._file("summary.csv"), newline="", encoding="utf-8") as file:
            names = [row["case"] for row in csv.DictReader(file)]
        folders = {name: self.directory / "cases" / name for name in names}
        return {
            name: Results(folder)
            for name, folder in folders.items()
            if (folder / "manifest.json").is_file()
        }

    def summary(self) -> pandas.DataFrame:
        """Return ``summary.csv``: a row for each case with its outcomes."""
        return self._read("summary.csv")

    def series(self) -> pandas.DataFrame:
        """Return ``series.csv``: a row for each output; for a sweep, with a first column ``case``."""
        if not self.is_sweep:
            return self._read("series.csv")
        frames = []
        for name, case in self.cases().items():
            if (case.directory / "series.csv").is_file():
                frames.append(case.series())
                frames[-1].insert(0, "case", name)
        if not frames:
            raise ScenarioError(f"no case of {self.directory} has a series.csv")
        frame: pandas.DataFrame = needed("pandas", "data").concat(frames, ignore_index=True)
        return frame

    def nodes(self) -> Nodes:
        """Return ``nodes.csv`` as arrays. For a sweep, use those of its `cases`."""
        path = self._file("nodes.csv")
        with open(path, encoding="utf-8") as file:
            head = file.readline().rstrip("\n").split(",")
        names = ["time_s", "x_m", "y_m", "z_m", "theta_rad"]
        columns = [head.index(name) for name in names]
        rows = np.loadtxt(
            path, delimiter=",", skiprows=1, usecols=columns, ndmin=2, converters=_number
        )
        rods = {}
        first = 0
        for rod in self.manifest["rods"]:
            rods[rod["name"]] = slice(first, first + rod["nodes"])
            first += rod["nodes"]
        # A run in progress may have written part of an output.
        outputs = len(rows) // first
        table = rows[: outputs * first].reshape(outputs, first, len(names))
        return Nodes(table[:, 0, 0].copy(), table[:, :, 1:4].copy(), table[:, :, 4].copy(), rods)

    def dataset(self) -> xarray.Dataset:
        """Return `nodes` as a dataset of xarray, with dimensions time, node and axis."""
        times, positions, angles, rods = self.nodes()
        names = np.concatenate([[name] * (nodes.stop - nodes.start) for name, nodes in rods.items()])
        dataset: xarray.Dataset = needed("xarray", "data").Dataset(
            {
                "position": (("time", "node", "axis"), positions, {"units": "m"}),
                "angle": (("time", "node"), angles, {"units": "rad"}),
            },
            coords={
                "time": ("time", times, {"units": "s"}),
                "rod": ("node", names),
                "axis": ["x", "y", "z"],
            },
        )
        return dataset

    def figures(self) -> list[Path]:
        """Draw the figures as ``rodlab plot`` does, and return their files, SVG and PNG."""
        lines = _rodlab.command(["plot", str(self.directory), "--quiet"]).splitlines()
        paths = [Path(line) for line in lines]
        return [path for path in paths if path.suffix in {".svg", ".png"} and path.is_file()]

    def view(self) -> Path:
        """Write the 3-D page as ``rodlab view`` does, and return its file."""
        _rodlab.command(["view", str(self.directory), "--quiet"])
        return self.directory / "view.html"

    def __repr__(self) -> str:
        return f"<Results {str(self.directory)!r}>"

    def _repr_html_(self) -> str:
        with tempfile.TemporaryDirectory(prefix="rodlab-") as folder:
            page = Path(folder) / "view.html"
            options = flags(out=page, outputs=_PAGE_OUTPUTS, quiet=True)
            try:
                _rodlab.command(["view", str(self.directory), *options])
            except _rodlab.RodlabError as error:
                # Results without rods, such as those of `helix-stability`, have no page.
                return f"<pre>{html.escape(f'{self!r}: {error}')}</pre>"
            content = html.escape(page.read_text(encoding="utf-8"))
        return f'<iframe srcdoc="{content}" width="100%" height="520" style="border:0"></iframe>'

    def _file(self, name: str) -> Path:
        path = self.directory / name
        if not path.is_file():
            advice = "; see cases()" if self.is_sweep else ""
            raise ScenarioError(f"{self.directory} has no {name}{advice}")
        return path

    def _read(self, name: str) -> pandas.DataFrame:
        path = self._file(name)
        module = needed("pandas", "data")
        # From version 3 on, numbers are read exactly by default.
        is_exact = int(module.__version__.split(".")[0]) >= 3
        options = {} if is_exact else {"float_precision": "round_trip"}
        frame: pandas.DataFrame = module.read_csv(path, **options)
        return frame


def _number(cell: str) -> float:
    return float(cell) if cell else np.nan


def _with_keys(scene: Scene | File, keys: Mapping[str, Any]) -> Scene:
    """Return the scene with other values of keys; the given scene is unchanged."""
    if isinstance(scene, Scene):
        return scene.with_keys(**keys) if keys else scene
    return Scene.load(scene, **keys)
