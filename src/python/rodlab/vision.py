"""Rods in images, and their distance from a pattern."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._command import File, answer, curve_file, folder, read_columns
from ._rodlab import ScenarioError

Array = NDArray[np.float64]


def trace(
    image: ArrayLike | File,
    colour: str | Sequence[str] = "auto",
    *,
    least_area: int = 60,
    strands: int | None = None,
    region: ArrayLike | None = None,
    least_length: float = 0.0,
) -> list[Array]:
    """Find the centrelines of the rods in an image.

    Parameters
    ----------
    image
        An RGB image, h × w × 3, uint8; or a file.
    colour
        Which colours are rod: ``"auto"``, ``"pen"``, ``"black"``, ``"white"``, a hue such as
        ``"red"``, or ``"#rrggbb"``; or several of these.
    least_area
        Parts with fewer pixels are noise.
    strands
        Number of rods: the strands that look most like rods are kept.
    region
        Part of the image that is searched, pixels: ``(u, v, width, height)``, or the corners of a
        polygon, k × 2.
    least_length
        Shorter strands are left out, pixels.

    Returns
    -------
    list
        For each rod an array k × 2 of pixels u (to the right) and v (down).
    """
    colours = [colour] if isinstance(colour, str) else list(colour)
    part = None if region is None else _region(region)
    if isinstance(image, (str, PathLike)):
        return _trace_file(
            image,
            colours,
            least_area=least_area,
            strands=strands,
            region=part,
            least_length=least_length,
        )
    pixels = np.asarray(image)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8:
        raise ScenarioError(
            f"image: {pixels.dtype} of the shape {pixels.shape}; allowed: uint8 of (h, w, 3)"
        )
    pixels = np.ascontiguousarray(pixels)
    return _rodlab.trace(pixels, colours, least_area, strands, part, least_length)


def _region(region: ArrayLike) -> str:
    """The text of a region: numbers with commas, corners with spaces between them."""
    corners = np.atleast_2d(np.asarray(region, dtype=np.float64))
    return " ".join(",".join(f"{number:.17g}" for number in corner) for corner in corners)


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


def _trace_file(image: File, colours: list[str], **options: Any) -> list[Array]:
    rules = [f"--colour={rule}" for rule in colours]
    with folder(None) as directory:
        answer("trace", str(Path(image)), *rules, out=directory, json=True, **options)
        columns = read_columns(directory / "centrelines.csv")
    pixels = np.column_stack([columns["u_px"], columns["v_px"]])
    strands = columns["strand"]
    return [pixels[strands == strand] for strand in np.unique(strands)]
