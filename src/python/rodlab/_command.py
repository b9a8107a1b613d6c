"""Commands of the command line as functions."""

from __future__ import annotations

import csv
import json
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._values import vector_rows

Array = NDArray[np.float64]
Quantity = float | str
"""A number in SI units, or text with a unit."""
File = str | PathLike[str]


def answer(*words: str, **options: Any) -> dict[str, Any]:
    """Run a command whose output is JSON, and return it with its lists of numbers as arrays."""
    result = arrays(json.loads(_rodlab.command([*words, *flags(**options)])))
    assert isinstance(result, dict)
    return result


def flags(**options: Any) -> list[str]:
    """Write options as flags: `suspended_length=2` as `--suspended-length=2`; None omits an option."""
    words = []
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        words.append(flag if value is True else f"{flag}={text(value, name)}")
    return words


def text(value: Any, name: str) -> str:
    """Write the value of an option as the command line reads it."""
    if isinstance(value, str):
        return value
    if isinstance(value, PathLike):
        return str(fspath(value))
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Sequence):
        return ",".join(text(item, name) for item in value)
    raise TypeError(f"{name}: a {type(value).__name__} is not a value of an option")


def arrays(value: Any) -> Any:
    """Replace lists of numbers by arrays, at any depth."""
    if isinstance(value, dict):
        return {name: arrays(item) for name, item in value.items()}
    if not isinstance(value, list):
        return value
    if value and all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in value):
        return np.array(value, dtype=np.float64)
    return [arrays(item) for item in value]


@contextmanager
def folder(out: File | None) -> Iterator[Path]:
    """Yield the directory `out`, or a temporary one that is removed at the end."""
    if out is not None:
        yield Path(out)
        return
    with tempfile.TemporaryDirectory(prefix="rodlab-") as temporary:
        yield Path(temporary) / "out"


@contextmanager
def curve_file(curve: ArrayLike | File, name: str) -> Iterator[str]:
    """Yield the name of a file with a plane curve: `curve` itself, or a file written from an array k × 2 in m."""
    if isinstance(curve, (str, PathLike)):
        yield fspath(curve)
        return
    points = vector_rows(curve, name, columns=2)
    with tempfile.TemporaryDirectory(prefix="rodlab-") as temporary:
        path = Path(temporary) / f"{name}.csv"
        write_columns(path, ["x_m", "y_m"], points)
        yield str(path)


def write_columns(path: Path, names: Sequence[str], rows: Array) -> None:
    """Write an array as a CSV file with a column for each name."""
    lines = [",".join(names), *(",".join(map(repr, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_columns(path: Path) -> dict[str, Array]:
    """Read the numeric columns of a CSV file; an empty cell is NaN."""
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        names = next(reader)
        rows = list(reader)
    columns: dict[str, Array] = {}
    for index, name in enumerate(names):
        try:
            cells = [float(row[index]) if row[index] else np.nan for row in rows]
        except ValueError:
            continue
        columns[name] = np.array(cells, dtype=np.float64)
    return columns


def needed(module: str, extra: str) -> Any:
    """Import an optional package, or raise an error that names the extra with it."""
    try:
        return __import__(module)
    except ImportError as error:
        raise ImportError(f"{module} is not installed: pip install 'rodlab[{extra}]'") from error
