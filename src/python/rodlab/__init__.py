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
from typing import Any, NoReturn

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
    __version__,
)
from .batch import Batch
from .identification import (
    Derivatives,
    FieldDerivatives,
    Identified,
    field_sensitivity,
    identify,
    sensitivity,
)
from .runs import Nodes, Results, results, run, sweep
from .scene import Part, Rod, Scene
from .simulation import Clamp, RodView, Simulation
from .vision import score, trace

__all__ = [
    "__version__",
    "Batch",
    "Clamp",
    "Contacts",
    "ConvergenceError",
    "Derivatives",
    "FieldDerivatives",
    "Identified",
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
    "field_sensitivity",
    "identify",
    "load",
    "loads",
    "main",
    "plan",
    "results",
    "run",
    "score",
    "sensitivity",
    "solve",
    "sweep",
    "trace",
]

load = Scene.load
loads = Scene.loads


def main() -> NoReturn:
    """Run the command line with the arguments of this process, and exit with its code."""
    words = ["rodlab", *sys.argv[1:]]
    wanted = _rodlab.demonstrations(words)
    if wanted is None:
        sys.exit(_rodlab.main(words))
    sys.exit(_write_demonstrations(**wanted))


def _write_demonstrations(*, quiet: bool, **wanted: Any) -> int:
    """Carry out ``rodlab dataset --format``, and return the exit code."""
    try:
        from .demonstrations import demonstrations

        summaries = demonstrations(**wanted, progress=not quiet)
    except (ValueError, ModuleNotFoundError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"interrupted; {wanted['out']} is not complete", file=sys.stderr)
        return 130
    solved = sum(bool(summary["success"]) for summary in summaries)
    print(f"{len(summaries)} episodes, {solved} with success, in {wanted['out']}")
    return 0
