"""Rods in images, and their distance from a pattern."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._command import File, answer, curve_file, folder, read_columns
from ._rodlab import ScenarioError

Array = NDArray[np.float64]


def trace(image: ArrayLike | File, colour: str = "auto", *, least_area: int = 60) -> list[Array]:
    """Find the centrelines of the rods in an image.

    Parameters
    ----------
    image
        An RGB image, h × w × 3, uint8; or a file.
    colour
        Which colours are rod: ``"auto"``, ``"pen"``, ``"black"``, ``"white"``, a hue such as
        ``"red"``, or ``"#rrggbb"``.
    least_area
        Parts with fewer pixels are noise.

    Returns
    -------
    list
        For each rod an array k × 2 of pixels u (to the right) and v (down).
    """
    if isinstance(image, (str, PathLike)):
        return _trace_file(image, colour, least_area)
    pixels = np.asarray(image)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8:
        raise ScenarioError(
            f"image: {pixels.dtype} of the shape {pixels.shape}; allowed: uint8 of (h, w, 3)"
        )
    return _rodlab.trace(np.ascontiguousarray(pixels), colour, least_area)


def score(
    result: ArrayLike | File, pattern: ArrayLike | File, *, out: File | None = None, **options: Any
) -> dict[str, Any]:
    """Compare a deployed curve with its pattern.

    Parameters
    ----------
    result
        The curve: an array k × 2 in m, a file, or a results directory of a deployment.
    pattern
        The pattern: an array k × 2 in m, an SVG drawing, or a CSV file.
    out
        File for a figure of both.
    **options
        Other options of ``rodlab score``: ``align=True``, ``points=100``, ``size="25 cm"``.

    Returns
    -------
    dict
        ``by_arc_length`` and ``by_nearest_point``, each with ``mean_m``, ``deviation_m`` and
        ``largest_m``; lengths of both curves.
    """
    with curve_file(result, "result") as curve, curve_file(pattern, "pattern") as wanted:
        return answer("score", curve, wanted, out=out, json=True, **options)


def _trace_file(image: File, colour: str, least_area: int) -> list[Array]:
    with folder(None) as directory:
        answer(
            "trace", str(Path(image)), colour=colour, least_area=least_area, out=directory, json=True
        )
        columns = read_columns(directory / "centrelines.csv")
    pixels = np.column_stack([columns["u_px"], columns["v_px"]])
    strands = columns["strand"]
    return [pixels[strands == strand] for strand in np.unique(strands)]
