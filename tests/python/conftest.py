"""Scenes that the tests share."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import rodlab

SCENARIOS = Path(__file__).parents[2] / "scenarios"

LENGTH = 0.3
RADIUS = 4e-3
YOUNGS_MODULUS = 1e9
DENSITY = 1000.0
GRAVITY = 9.81
BENDING_STIFFNESS = YOUNGS_MODULUS * math.pi * RADIUS**4 / 4
WEIGHT_PER_LENGTH = DENSITY * math.pi * RADIUS**2 * GRAVITY


def cantilever(edges: int = 40, *, gravity: float = GRAVITY, **time: object) -> rodlab.Scene:
    """Return a horizontal rod that is clamped at its start."""
    scene = rodlab.Scene(name="cantilever")
    scene.set_material(youngs_modulus=YOUNGS_MODULUS, poissons_ratio=0.5, density=DENSITY)
    points = np.linspace([0, 0, 0], [LENGTH, 0, 0], edges + 1)
    beam = scene.add_rod(points, radius=RADIUS, name="beam")
    scene.add_clamp(beam, "start")
    if gravity:
        scene.add_load("gravity", acceleration=[0, 0, -gravity])
    scene.set_time(**(time or {"step": "1 ms", "end": "1 s"}))
    return scene


@pytest.fixture
def simulation() -> rodlab.Simulation:
    return cantilever(12).simulate()
