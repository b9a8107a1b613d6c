"""Bad calls raise exceptions that name the argument, and leave the simulation as it was."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest
from conftest import cantilever

import rodlab

NAN = float("nan")


@pytest.mark.parametrize(
    "call",
    [
        lambda simulation: simulation.step(NAN),
        lambda simulation: simulation.step(-1e-3),
        lambda simulation: simulation.step(0.0),
        lambda simulation: simulation.step(float("inf")),
        lambda simulation: simulation.step("1 ms"),
        lambda simulation: simulation.run(NAN),
        lambda simulation: simulation.run(-1.0),
        lambda simulation: simulation.run(float("inf")),
        lambda simulation: simulation.read_positions(np.empty((3, 3))),
        lambda simulation: simulation.read_positions(np.empty((13, 3), dtype=np.float32)),
        lambda simulation: simulation.read_positions([[0.0] * 3] * 13),
        lambda simulation: setattr(simulation, "forces", np.zeros((2, 3))),
        lambda simulation: setattr(simulation, "forces", "strong"),
        lambda simulation: setattr(simulation, "torques", np.zeros((13, 3))),
        lambda simulation: setattr(simulation, "natural_curvature", [1.0]),
        lambda simulation: setattr(simulation.rods["beam"], "forces", np.zeros((2, 2))),
        lambda simulation: setattr(simulation.clamps[0], "pose", np.eye(3)),
        lambda simulation: setattr(simulation.clamps[0], "pose", np.full((4, 4), NAN)),
        lambda simulation: setattr(simulation.clamps[0], "pose", np.zeros((4, 4))),
        lambda simulation: setattr(simulation.clamps[0], "pose", np.diag([2.0, 2.0, 2.0, 1.0])),
        lambda simulation: setattr(simulation.clamps[0], "position", [NAN, 0, 0]),
        lambda simulation: setattr(simulation.clamps[0], "position", [0, 0]),
        lambda simulation: setattr(simulation.clamps[0], "position", None),
        lambda simulation: simulation.clamps[1],
        lambda simulation: simulation.clamps[-1],
        lambda simulation: simulation.clamps["beam.end"],
        lambda simulation: simulation.clamps[1.5],
        lambda simulation: simulation.clamps[None],
        lambda simulation: simulation.rods["bean"],
        lambda simulation: simulation.grasp("bean"),
        lambda simulation: simulation.grasp("beam", "middle"),
        lambda simulation: simulation.grasp("beam", 13),
        lambda simulation: simulation.grasp("beam", -1),
        lambda simulation: simulation.grasp("beam", 1.5),
        lambda simulation: simulation.grasp("beam", 5, position=False, frame=False),
        lambda simulation: simulation.set_load_factor(1, 1.0),
        lambda simulation: simulation.set_load_factor(-1, 1.0),
        lambda simulation: simulation.set_load_factor(0, NAN),
        lambda simulation: simulation.restore(None),
        lambda simulation: simulation.restore(cantilever(5).simulate().save()),
        lambda simulation: simulation.follow(1.0),
        lambda simulation: rodlab.Simulation(3),
        lambda simulation: rodlab.Batch([]),
        lambda simulation: rodlab.Batch([cantilever(4), cantilever(5)]),
        lambda simulation: rodlab.Batch(cantilever(4), 0),
        lambda simulation: rodlab.Batch(cantilever(4), -1),
        lambda simulation: rodlab.trace(np.zeros((4, 4), dtype=np.uint8)),
        lambda simulation: rodlab.score([[0, 0, 0]], [[0, 0], [1, 1]]),
        lambda simulation: rodlab.results("/nowhere"),
        lambda simulation: rodlab.solve.helix([1, 2]),
        lambda simulation: rodlab.solve.grasp(NAN, 0.5),
    ],
)
def test_a_bad_call_raises_and_changes_nothing(simulation, call) -> None:
    simulation.step()
    positions = simulation.positions.copy()
    with pytest.raises(Exception) as caught:  # noqa: B017, PT011
        call(simulation)
    assert "panic" not in type(caught.value).__name__.lower()
    assert str(caught.value)
    assert np.array_equal(simulation.positions, positions)
    simulation.step()


def test_forces_that_are_not_numbers_fail_the_step(simulation: rodlab.Simulation) -> None:
    simulation.step()
    positions = simulation.positions.copy()
    simulation.forces[3, 1] = NAN
    with pytest.raises(rodlab.RodlabError, match="forces"):
        simulation.step()
    assert np.array_equal(simulation.positions, positions)
    simulation.forces[3, 1] = 0
    simulation.step()


def test_a_step_that_fails_leaves_the_state_before_it(simulation: rodlab.Simulation) -> None:
    simulation.step()
    positions = simulation.positions.copy()
    time_before = simulation.time
    # No rod can have this strain.
    simulation.forces[-1] = [1e15, 0, 0]
    with pytest.raises(rodlab.RodlabError):
        for _ in range(20):
            simulation.step()
            positions, time_before = simulation.positions.copy(), simulation.time
    assert simulation.time == time_before
    assert np.array_equal(simulation.positions, positions)


def test_a_release_ends_the_use_of_a_clamp(simulation: rodlab.Simulation) -> None:
    hand = simulation.grasp("beam", "end")
    hand.release()
    for use in [hand.release, lambda: hand.force, lambda: setattr(hand, "position", [0, 0, 0])]:
        with pytest.raises(rodlab.RodlabError):
            use()


def test_errors_have_the_exit_codes_of_the_command_line() -> None:
    kinds = [rodlab.ScenarioError, rodlab.ConvergenceError, rodlab.PhysicsError]
    assert all(issubclass(kind, rodlab.RodlabError) for kind in kinds)
    assert issubclass(rodlab.ScenarioError, ValueError)
    with pytest.raises(rodlab.ScenarioError) as caught:
        rodlab.load("no_such_preset")
    assert caught.value.exit_code == 2
    assert "\x1b[" not in str(caught.value)


def test_two_threads_on_one_simulation_raise() -> None:
    simulation = cantilever(100).simulate()
    errors: list[Exception] = []
    started = threading.Event()

    def run() -> None:
        started.set()
        try:
            simulation.run(0.5)
        except Exception as error:  # noqa: BLE001
            errors.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    started.wait()
    while thread.is_alive() and not errors:
        try:
            simulation.step()
        except Exception as error:  # noqa: BLE001
            errors.append(error)
    thread.join()
    assert errors
    assert all(isinstance(error, (rodlab.RodlabError, RuntimeError)) for error in errors)
    simulation.step()


def test_several_simulations_step_in_parallel() -> None:
    simulations = [cantilever(30).simulate() for _ in range(4)]
    threads = [threading.Thread(target=each.run, args=[0.05]) for each in simulations]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    alone = cantilever(30).simulate()
    alone.run(0.05)
    assert all(np.array_equal(each.positions, alone.positions) for each in simulations)


@pytest.fixture
def ctrl_c():
    """Make interrupts raise exceptions, even if the tests run in the background of a shell, which ignores interrupts."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")
@pytest.mark.parametrize("kind", ["simulation", "batch", "run", "sensitivity"])
def test_an_interrupt_ends_a_long_call(kind, tmp_path, ctrl_c) -> None:
    scene = cantilever(200, step="0.1 ms", end="1000 s")
    scene.add_probe("position", "tip", rod="beam", at="end")
    sent: list[float] = []

    def interrupt() -> None:
        sent.append(time.perf_counter())
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

    calls = {
        "simulation": lambda: scene.simulate().run(1000),
        "batch": lambda: rodlab.Batch(scene, 2).run(1000),
        "run": lambda: rodlab.run(scene, tmp_path / "out"),
        "sensitivity": lambda: rodlab.sensitivity(scene, "material.youngs_modulus"),
    }
    timer = threading.Timer(0.5, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        calls[kind]()
    ended = time.perf_counter()
    timer.join()
    # This takes a tenth of a second on an idle machine.
    assert ended - sent[0] < 5.0
