"""Plans of trajectories, as ``rodlab plan`` makes them.

Answers are dicts; their lists of numbers are arrays. The planned path is added to them: ``times``
(k, s) and ``poses`` (k × 7: x, y, z in m, and the quaternion w, x, y, z).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._command import File, answer, curve_file, folder, read_columns, write_columns
from ._values import vector_rows

Answer = dict[str, Any]

_POSE = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]


def deployment(
    pattern: ArrayLike | File, rod: File | None = None, out: File | None = None, **options: Any
) -> Answer:
    """Plan the path of a gripper that lays a rod along a pattern.

    Parameters
    ----------
    pattern
        An array k × 2 of points in m; a file (SVG, CSV, a photograph); or text such as
        ``"circle:0.1"``.
    rod
        The rod: a file or a preset such as ``"green_vps"``.
    out
        Directory for the files of the plan; by default they are not kept.
    **options
        Other options of ``rodlab plan deployment``: ``scheme="intuitive"``, ``lead_in="none"``.

    Returns
    -------
    dict
        Friction demand, lengths and others, with ``times`` and ``poses``.
    """
    with curve_file(pattern, "pattern") as path, folder(out) as directory:
        plan = answer("plan", "deployment", pattern=path, rod=rod, out=directory, **options)
        return plan | _path_in(directory)


def fold(paper: File, crease: float | str = "half", out: File | None = None, **options: Any) -> Answer:
    """Plan the path of a gripper that folds a sheet with little sliding.

    Parameters
    ----------
    paper
        The sheet: a file or a preset such as ``"a4"``.
    crease
        ``"half"``, ``"diagonal-strip"``, or how far the edge is brought, m.
    out
        Directory for the files of the plan; by default they are not kept.
    **options
        Other options of ``rodlab plan fold``: ``objective="friction"``.

    Returns
    -------
    dict
        Friction demand, forces and others, with ``times`` and ``poses``.
    """
    with folder(out) as directory:
        plan = answer("plan", "fold", paper=paper, crease=crease, out=directory, **options)
        return plan | _path_in(directory)


def joints(poses: ArrayLike | File, cell: File, out: File | None = None, **options: Any) -> Answer:
    """Plan a joint trajectory along poses of the hand of an arm.

    Parameters
    ----------
    poses
        An array k × 7 (x, y, z in m, and the quaternion w, x, y, z), or a file of them.
    cell
        The cell file.
    out
        File for the trajectory; by default it is not kept.
    **options
        Other options of ``rodlab plan joints``: ``arm="left"``, ``place="auto"``.

    Returns
    -------
    dict
        Numbers about the motion, with ``times`` (m, s) and ``joints``: positions by the name of the
        joint, m, rad or m.
    """
    with folder(None) as directory:
        directory.mkdir()
        if isinstance(poses, (str, Path)):
            path = Path(poses)
        else:
            path = directory / "poses.csv"
            write_columns(path, _POSE, vector_rows(poses, "poses", columns=7))
        trajectory = directory / "joints.csv" if out is None else Path(out)
        plan = answer("plan", "joints", str(path), cell=cell, out=trajectory, **options)
        columns = read_columns(trajectory)
        return plan | {"times": columns.pop("time_s"), "joints": columns}


def _path_in(directory: Path) -> dict[str, NDArray[np.float64]]:
    columns = read_columns(directory / "trajectory.csv")
    return {"times": columns["time_s"], "poses": np.column_stack([columns[name] for name in _POSE])}
