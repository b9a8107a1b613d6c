"""Values of keys: from Python to plain data, and to TOML."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any, Protocol, runtime_checkable

import numpy as np

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # type: ignore[import-not-found, unused-ignore]

from ._rodlab import ScenarioError

Table = dict[str, Any]
"""A table of a scenario: plain values by key."""

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


@runtime_checkable
class Named(Protocol):
    """A part of a scene that can be used instead of its name."""

    @property
    def name(self) -> str | None: ...


def plain(value: Any, key: str) -> Any:
    """Convert a value to text, numbers, lists and dicts; `key` is its name in errors."""
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), key)
    if isinstance(value, bool):
        return value
    if isinstance(value, int):
        if not -(2**63) <= value < 2**63:
            raise ScenarioError(f"{key}: {value} has more than 64 bits")
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ScenarioError(f"{key}: {value} is not a finite number")
        return value
    if isinstance(value, Mapping):
        return table(value, key)
    if isinstance(value, (list, tuple, range)):
        return [plain(item, f"{key}.{index}") for index, item in enumerate(value)]
    if isinstance(value, PathLike):
        path = fspath(value)
        return path if isinstance(path, str) else path.decode()
    if isinstance(value, Named) and value.name is not None:
        return value.name
    raise TypeError(
        f"{key}: a {type(value).__name__} is not a value; allowed: numbers, text, booleans, "
        "arrays, lists, dicts, and parts that have a name"
    )


def table(keys: Mapping[str, Any], key: str) -> Table:
    """Convert a mapping to a table; keys with the value None are omitted."""
    result: Table = {}
    for name, value in keys.items():
        if not isinstance(name, str):
            raise TypeError(f"{key}: the key {name!r} is not text")
        if value is not None:
            result[name] = plain(value, f"{key}.{name}" if key else name)
    return result


def vector_rows(points: Any, key: str, columns: int, least: int = 2) -> np.ndarray[Any, Any]:
    """Convert `points` to an array k × `columns` of finite numbers with at least `least` rows."""
    try:
        array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{key}: not an array of numbers: {error}") from error
    if array.ndim != 2 or array.shape[1] != columns or array.shape[0] < least:
        raise ScenarioError(
            f"{key}: the shape is {array.shape}; allowed: (k, {columns}) with k of at least {least}"
        )
    if not np.isfinite(array).all():
        row = int(np.argwhere(~np.isfinite(array))[0, 0])
        raise ScenarioError(f"{key}: row {row} has a number that is not finite")
    return array


def names(given: str | Sequence[str]) -> list[str]:
    """Return one name or several as a list."""
    return [given] if isinstance(given, str) else list(given)


def overrides(keys: Mapping[str, Any]) -> list[str]:
    """Write keys and values as `--set` reads them: `key=value` in TOML."""
    return [f"{key}={inline(plain(value, key))}" for key, value in keys.items()]


def inline(value: Any) -> str:
    """Write a plain value as TOML in one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        pairs = ", ".join(f"{_key(name)} = {inline(item)}" for name, item in value.items())
        return f"{{ {pairs} }}" if pairs else "{}"
    if isinstance(value, Sequence):
        return "[" + ", ".join(map(inline, value)) + "]"
    # Dates and times, which a file may contain.
    return str(value)


def write_toml(table: Mapping[str, Any]) -> str:
    """Write a table as a TOML file: a section for each table and each element of its lists."""
    lines = [f"{_key(name)} = {inline(item)}" for name, item in table.items() if not _sections(item)]
    for name, item in table.items():
        head = f"[{_key(name)}]" if isinstance(item, Mapping) else f"[[{_key(name)}]]"
        for section in _sections(item):
            lines += ["", head]
            lines += [f"{_key(key)} = {inline(value)}" for key, value in section.items()]
    return "\n".join(lines) + "\n"


def read_toml(text: str) -> Table:
    """Read TOML."""
    try:
        table: Table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"not TOML: {error}") from error
    return table


def _sections(item: Any) -> list[Mapping[str, Any]]:
    """Return the tables that are separate sections of a file; empty for other values."""
    if isinstance(item, Mapping):
        return [item]
    if isinstance(item, list) and all(isinstance(element, Mapping) for element in item):
        return item
    return []


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else inline(name)
