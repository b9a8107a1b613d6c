"""The scene of a cable on a table, and curves for it to follow."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .gripper import Array

GRAVITY = 9.81
TOLERANCE = 1e-4
"""Distance from touching at which contact forces begin, m."""


def cable_scene(
    parameters: Mapping[str, float],
    points: Array,
    *,
    clamps: Sequence[Mapping[str, Any]],
    step: float,
    end: float,
    obstacles: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Return the scene of a naturally straight cable on the table z = 0.

    Its own weight stretches it by at most 0.4 %.

    Parameters
    ----------
    parameters : mapping of str to float
        `radius` (m), `density` (kg/m³), `bending_length` (m) and `friction`. The bending length L_gb is
        (E r² / (8 ρ g))^(1/3), with the radius r.
    points : array, n × 3
        Places of the nodes at the start, m.
    clamps, obstacles : sequence of mappings
        As in scenario files; the rod is "cable".
    step, end : float
        Time step and end of the motion, s.
    """
    radius, density = parameters["radius"], parameters["density"]
    modulus = 8.0 * density * GRAVITY * parameters["bending_length"] ** 3 / radius**2
    area, length = np.pi * radius**2, float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    scene: dict[str, Any] = {
        "experiment": "scene",
        "material": {"youngs_modulus": modulus, "poissons_ratio": 0.5, "density": density},
        "rods": [
            {
                "name": "cable",
                "radius": radius,
                "edges": len(points) - 1,
                # A cable hardly stretches, even if it bends easily.
                "stiffness": {"stretching": 300.0 * density * GRAVITY * area * length},
                "natural_shape": "straight",
                "shape": {"kind": "points", "points": points.tolist()},
            }
        ],
        "clamps": [dict(clamp) for clamp in clamps],
        "planes": [{"point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}],
        "loads": [
            {"kind": "gravity", "acceleration": [0.0, 0.0, -GRAVITY]},
            {"kind": "drag", "translation": 0.5 * density * area},
        ],
        "contact": {
            "model": "imc",
            "friction": parameters["friction"],
            "distance_tolerance": TOLERANCE,
            "slip_tolerance": 5e-4,
            "stiffness_factor": 1e4,
        },
        "time": {"scheme": "implicit-euler", "step": step, "end": end},
    }
    if obstacles:
        scene["obstacles"] = [dict(obstacle) for obstacle in obstacles]
    return scene


def straight(start: Sequence[float], end: Sequence[float], edges: int) -> Array:
    """Return the nodes of a straight rod, (edges + 1) × 3."""
    part = np.linspace(0.0, 1.0, edges + 1)[:, np.newaxis]
    return np.asarray((1.0 - part) * np.asarray(start) + part * np.asarray(end))


def smooth_curve(length: float, start: Sequence[float], heading: float, bends: Sequence[float], edges: int) -> Array:
    """Return a plane curve without curvature at its ends.

    The direction at the arc length s is heading + Σ bends[k] (1 - cos((k + 1) π s / L)) / 2.

    Parameters
    ----------
    length : float
        Length L, m.
    start : sequence, 2
        Its start, m.
    heading : float
        Direction at its start, rad.
    bends : sequence of float
        Turns in rad; the first is the angle between the ends.
    edges : int
        Number of edges.

    Returns
    -------
    array, (edges + 1) × 2
    """
    middle = (np.arange(edges) + 0.5) / edges
    angle = np.full(edges, float(heading))
    for index, bend in enumerate(bends):
        angle += 0.5 * bend * (1.0 - np.cos((index + 1) * np.pi * middle))
    steps = (length / edges) * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.vstack([np.zeros(2), np.cumsum(steps, axis=0)]) + np.asarray(start, dtype=np.float64)


def resample(points: Array, count: int) -> Array:
    """Return `count` points at equal distances along a polyline, n × d."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    places = np.linspace(0.0, lengths[-1], count)
    return np.column_stack([np.interp(places, lengths, points[:, axis]) for axis in range(points.shape[1])])


def winding_number(polygon: Array, point: Array) -> int:
    """Return the number of turns of a closed polygon, n × 2, around a point."""
    angles = np.arctan2(polygon[:, 1] - point[1], polygon[:, 0] - point[0])
    turns = np.diff(np.append(angles, angles[0]))
    turns = (turns + np.pi) % (2.0 * np.pi) - np.pi
    return int(np.rint(turns.sum() / (2.0 * np.pi)))
