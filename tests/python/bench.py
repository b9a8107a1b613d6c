"""Costs of the Python interface: calls, steps, batches. Run it on an idle machine.

    python tests/python/bench.py

Processor time counts all threads; ratios are of runs that alternate.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

from rodlab import _rodlab

BEAM = """
experiment = "scene"
material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { end = "100 s", step = "1 ms" }
rods = [{ name = "beam", radius = "5 mm", edges = 50, shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] } }]
clamps = [{ rod = "beam", at = "start" }]
loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
"""

WIRE = """
experiment = "scene"
material = { youngs_modulus = "20 MPa", poissons_ratio = 0.5, density = 1200.0 }
time = { end = "1000 s", step = "10 ms", scheme = "implicit-euler" }
rods = [{ name = "wire", radius = "3 mm", edges = 48, shape = { kind = "straight", start = [0, 0, 0], end = [0.6, 0, 0] } }]
clamps = [{ rod = "wire", at = "start" }, { rod = "wire", at = "end" }]
loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
"""


def calls() -> None:
    """Print the cost of reading a number and an array."""
    simulation = _rodlab.Simulation(_rodlab.Scenario.loads(BEAM))
    for name in ("time", "positions", "velocities"):
        start = time.perf_counter()
        for _ in range(20_000):
            getattr(simulation, name)
        print(f"{name:<12}{(time.perf_counter() - start) / 20_000 * 1e6:6.2f} µs a call")


def steps() -> None:
    """Print the cost of steps one by one over that of one call for all."""
    scenario = _rodlab.Scenario.loads(BEAM)
    ratios = []
    for _ in range(7):
        simulation = _rodlab.Simulation(scenario)
        simulation.run(0.2)
        state = simulation.save()
        start = time.process_time()
        simulation.run(2.2)
        whole = time.process_time() - start
        simulation.restore(state)
        start = time.process_time()
        for _ in range(2000):
            simulation.step()
            simulation.positions
        ratios.append((time.process_time() - start) / whole)
    print(f"steps with positions over a whole run: {statistics.median(ratios):.3f}")


def batches() -> None:
    """Print the rate of a batch of wires whose two ends are moved at each step."""
    wires, count = 64, 200
    batch = _rodlab.Batch(_rodlab.Scenario.loads(WIRE), wires)
    single = _rodlab.Simulation(_rodlab.Scenario.loads(WIRE))
    ends = [single.clamp_pose(clamp)[:3, 3] for clamp in (0, 1)]
    phases = np.linspace(0, 2 * np.pi, wires, endpoint=False)

    def move(k: int) -> None:
        for clamp, end in enumerate(ends):
            turn = 2 * np.pi * 0.5 * k * 0.01 + phases + clamp
            offset = np.stack([0.1 * (1 - 2 * clamp) * np.ones(wires), 0.05 * np.sin(turn), 0.05 * np.cos(turn)], axis=1)
            batch.move_clamp(clamp, end + min(1.0, k / 100) * offset)

    for k in range(100):
        move(k)
        batch.step()
    wall, processor = time.perf_counter(), time.process_time()
    for k in range(100, 100 + count):
        move(k)
        batch.step()
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    print(f"failures: {sum(failure is not None for failure in batch.failures)}")
    rate = wires * count / processor
    print(f"{rate:.0f} wire-steps a second of processor time; 10⁶ in {1e6 * wall / (wires * count):.1f} s of wall time")


if __name__ == "__main__":
    calls()
    steps()
    batches()
