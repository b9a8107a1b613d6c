"""Problems that are solved exactly, as ``rodlab solve`` does.

Answers are dicts; their lists of numbers are arrays. ``rodlab solve grasp --help`` and the like
describe the problems.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from ._command import File, Quantity, answer

Answer = dict[str, Any]


def helix(direction: ArrayLike, *, method: str | None = None, edges: int | None = None) -> Answer:
    """Solve for the first loss of stability of a helical rod with clamped ends.

    Parameters
    ----------
    direction
        Direction (κ, τ, ω) of curvature, torsion and twisting moment of a rod of length 1 and
        bending stiffness 1, 3.
    method
        ``"theory"`` (the default), or ``"der"``: by the discrete rod with `edges` edges.

    Returns
    -------
    dict
        ``critical`` is the size of (κ, τ, ω) at which the rod loses stability, or None.
    """
    return answer("solve", "helix", direction=direction, method=method, edges=edges)


def grasp(
    suspended_length: float,
    curvature: float,
    *,
    stretch: float | None = None,
    method: str | None = None,
    edges: int | None = None,
    all: bool = False,
) -> Answer:
    """Solve for the pose of a gripper that lays a rod on a table.

    Parameters
    ----------
    suspended_length
        Suspended length over the gravito-bending length L_gb.
    curvature
        Curvature of the pattern at the contact node times L_gb, positive to the left.
    stretch
        Stretching stiffness times L_gb²/EI; by default the rod does not stretch.
    method
        ``"theory"`` (the default), or ``"der"``: by the discrete rod with `edges` edges.
    all
        Whether all ``solutions`` are returned, starting with the one returned otherwise.

    Returns
    -------
    dict
        ``position`` and ``quaternion`` of the gripper, ``contact_force``, ``stable`` and others:
        lengths in L_gb, forces in EI/L_gb².
    """
    return answer(
        "solve",
        "grasp",
        suspended_length=suspended_length,
        curvature=curvature,
        stretch=stretch,
        method=method,
        edges=edges,
        all=all,
    )


def fold(
    x: float, z: float, *, method: str | None = None, edges: int | None = None, all: bool = False
) -> Answer:
    """Solve for the shape of a sheet that is folded by its edge.

    Parameters
    ----------
    x, z
        How far the edge has moved towards the sheet and upwards, over the gravito-bending length.
    method
        ``"theory"`` (the default), or ``"der"``: by the discrete rod with `edges` edges.
    all
        Whether all ``solutions`` are returned, starting with the one returned otherwise.

    Returns
    -------
    dict
        ``alpha`` (rad), ``suspended_length`` (L_gb), ``horizontal_force`` and ``vertical_force``
        (EI/L_gb² per width), ``lambda``, ``stable``.
    """
    return answer("solve", "fold", x=x, z=z, method=method, edges=edges, all=all)


def knot(
    unknotting_number: int,
    *,
    radius: Quantity | None = None,
    end_spin: str | None = None,
    poissons_ratio: float | None = None,
    tilt: float | None = None,
    ratio: float | None = None,
    offset: float | None = None,
) -> Answer:
    """Solve for the size at which a tightened overhand knot inverts.

    Parameters
    ----------
    unknotting_number
        Unknotting number of the knot.
    radius
        Radius of the rod, m; adds lengths in m to the answer.
    end_spin
        Whether the ends of the loop are ``"clamped"`` (the default) or ``"free"`` to spin.
    poissons_ratio
        Poisson's ratio of the rod, by default 0.5.
    tilt
        Angle between the braid and the ends of the loop, degrees, by default 60.
    ratio
        Length of the braid over that of the loop, by default 0.7.
    offset
        Distance of the loop's ends from the axis in radii, by default 0.

    Returns
    -------
    dict
        ``length_normalized``, the length of braid and loop in radii, and ``rotation_rad``.
    """
    return answer(
        "solve",
        "knot-inversion",
        unknotting_number=unknotting_number,
        radius=radius,
        end_spin=end_spin,
        poissons_ratio=poissons_ratio,
        tilt=tilt,
        ratio=ratio,
        offset=offset,
    )


def loop_height(gravito_bending_length: Quantity) -> Answer:
    """Solve for the height (m) of the loop of a heavy rod folded over onto itself on a table."""
    return answer("solve", "loop-height", gravito_bending_length=gravito_bending_length)


def hanging_plate(length: Quantity, gravito_bending_length: Quantity) -> Answer:
    """Solve for the drop (m) of the free end of a strip whose other end is held horizontally."""
    return answer(
        "solve", "hanging-plate", length=length, gravito_bending_length=gravito_bending_length
    )


def fk(cell: File, joints: ArrayLike, *, arm: str | None = None) -> Answer:
    """Solve for the pose of the hand of an arm.

    Parameters
    ----------
    cell
        The cell file.
    joints
        Joint positions from base to hand, rad or m.
    arm
        Name of the arm, if the cell has several.

    Returns
    -------
    dict
        ``position`` (3, m) and ``quaternion`` (w, x, y, z) in the frame of the arm's base.
    """
    return answer("solve", "fk", cell=cell, joints=joints, arm=arm)


def ik(
    cell: File,
    pose: ArrayLike,
    *,
    arm: str | None = None,
    start: ArrayLike | None = None,
    all: bool = False,
    samples: int | None = None,
) -> Answer:
    """Solve for joint positions that bring the hand of an arm to a pose.

    Parameters
    ----------
    cell
        The cell file.
    pose
        Pose (x, y, z, qw, qx, qy, qz) in the frame of the arm's base, m.
    arm
        Name of the arm, if the cell has several.
    start
        Joint positions to begin at, by default those of ``home``.
    all
        Whether all ``branches`` are returned; of arms with more than six joints, `samples` of them.

    Returns
    -------
    dict
        ``joints``, ``residual``, ``manipulability`` and others.
    """
    options = {"cell": cell, "pose": pose, "arm": arm, "all": all, "samples": samples, "from": start}
    return answer("solve", "ik", **options)
