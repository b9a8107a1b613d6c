"""Simulations of slender elastic rods: scenes, steps, runs, sweeps, plans.

Quantities are numbers in SI units, or text with a unit such as ``"5 mm"``. Arrays are float64.

>>> import rodlab
>>> scene = rodlab.Scene()
>>> scene.set_material(youngs_modulus="10 MPa", poissons_ratio=0.5, density=1000)
>>> beam = scene.add_rod([[0, 0, 0], [0.3, 0, 0]], radius="4 mm", edges=40)
>>> clamp = scene.add_clamp(beam, "start")
>>> load = scene.add_load("gravity", acceleration=[0, 0, -9.81])
>>> simulation = scene.simulate()
>>> report = simulation.find_equilibrium()
>>> simulation.rods[beam].tip
"""

from __future__ import annotations

import sys
from typing import NoReturn

from . import _rodlab, plan, solve
from ._rodlab import (
    Contacts,
    ConvergenceError,
    PhysicsError,
    RodlabError,
    Scenario,
    ScenarioError,
    State,
    StepReport,
)
from .batch import Batch
from .runs import Nodes, Results, results, run, sweep
from .scene import Part, Rod, Scene
from .simulation import Clamp, RodView, Simulation
from .vision import score, trace

__all__ = [
    "Batch",
    "Clamp",
    "Contacts",
    "ConvergenceError",
    "Nodes",
    "Part",
    "PhysicsError",
    "Results",
    "Rod",
    "RodView",
    "RodlabError",
    "Scenario",
    "ScenarioError",
    "Scene",
    "Simulation",
    "State",
    "StepReport",
    "load",
    "loads",
    "main",
    "plan",
    "results",
    "run",
    "score",
    "solve",
    "sweep",
    "trace",
]

load = Scene.load
loads = Scene.loads


def main() -> NoReturn:
    """Run the command line with the arguments of this process, and exit with its code."""
    sys.exit(_rodlab.main(["rodlab", *sys.argv[1:]]))
