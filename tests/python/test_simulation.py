"""Steps, arrays, clamps and states of a simulation."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest
from conftest import BENDING_STIFFNESS, LENGTH, WEIGHT_PER_LENGTH, cantilever

import rodlab


def advance(simulation: rodlab.Simulation, steps: int) -> bytes:
    for _ in range(steps):
        simulation.step()
    return simulation.positions.tobytes() + simulation.velocities.tobytes()


def test_a_cantilever_sags_as_in_theory() -> None:
    simulation = cantilever(mode="static").simulate()
    simulation.find_equilibrium()
    sag = WEIGHT_PER_LENGTH * LENGTH**4 / (8 * BENDING_STIFFNESS)
    assert simulation.rods["beam"].tip[2] == pytest.approx(-sag, rel=1e-3)
    weight = WEIGHT_PER_LENGTH * LENGTH
    assert simulation.clamps[0].force == pytest.approx([0, 0, weight], rel=1e-6, abs=1e-6 * weight)
    moment = weight * LENGTH / 2
    assert simulation.clamps[0].moment[1] == pytest.approx(-moment, rel=2e-3)


def test_a_force_that_is_written_deflects_the_tip_as_the_elastica() -> None:
    simulation = cantilever(80, gravity=0, mode="static").simulate()
    simulation.rods["beam"].forces[-1] = [0, 0, BENDING_STIFFNESS / LENGTH**2]
    simulation.find_equilibrium()
    # Bisshopp and Drucker 1945, P L²/EI = 1.
    expected = [(1 - 0.05643) * LENGTH, 0, 0.30172 * LENGTH]
    assert simulation.rods["beam"].tip == pytest.approx(expected, abs=3e-4 * LENGTH)
    assert simulation.clamps[0].force[2] == pytest.approx(-BENDING_STIFFNESS / LENGTH**2, rel=1e-5)
    simulation.forces = np.zeros_like(simulation.forces)
    simulation.find_equilibrium()
    assert simulation.rods["beam"].tip == pytest.approx([LENGTH, 0, 0], abs=1e-5 * LENGTH)


def test_a_natural_curvature_that_is_written_bends_the_rod_into_an_arc() -> None:
    simulation = cantilever(80, gravity=0, mode="static").simulate(natural_curvature=True)
    curvature = 2.0
    simulation.natural_curvature[:] = [curvature, 0]
    simulation.find_equilibrium()
    height = (1 - math.cos(curvature * LENGTH)) / curvature
    reach = math.sin(curvature * LENGTH) / curvature
    tip = simulation.rods["beam"].tip
    assert tip[0] == pytest.approx(reach, rel=1e-3)
    assert math.hypot(tip[1], tip[2]) == pytest.approx(height, rel=2e-2)


def test_arrays_have_a_row_for_each_node() -> None:
    simulation = cantilever(12).simulate(natural_curvature=True)
    simulation.step()
    shapes = {
        "positions": (13, 3),
        "velocities": (13, 3),
        "directors": (13, 3),
        "edge_angles": (13,),
        "twists": (13,),
        "curvatures": (13,),
        "moments": (13, 2),
        "tensions": (13,),
        "forces": (13, 3),
        "torques": (13,),
        "natural_curvature": (13, 2),
        "contact_forces": (13, 3),
        "fluid_forces": (13, 3),
    }
    for name, shape in shapes.items():
        array = getattr(simulation, name)
        assert array.shape == shape, name
        assert array.dtype == np.float64, name
    beam = simulation.rods["beam"]
    assert len(beam) == 13
    for name in ["positions", "velocities", "forces", "moments"]:
        assert np.array_equal(getattr(beam, name), getattr(simulation, name), equal_nan=True)
    assert np.array_equal(beam.tip, simulation.positions[-1])
    out = np.empty((13, 3))
    simulation.read_positions(out)
    assert np.array_equal(out, simulation.positions)


def test_positions_that_were_read_stay(simulation: rodlab.Simulation) -> None:
    before = simulation.positions
    kept = before.copy()
    simulation.step()
    assert np.array_equal(before, kept)
    assert not np.array_equal(simulation.positions, kept)


def test_time_advances_by_steps(simulation: rodlab.Simulation) -> None:
    assert simulation.time == 0
    assert simulation.step_size == 1e-3
    assert simulation.end == 1.0
    report = simulation.step()
    # Backward differences of third order begin with small steps.
    assert 0 < report.time == simulation.time <= 1e-3
    assert report.newton_iterations >= 1
    before = simulation.time
    assert simulation.step(2e-3).steps >= 2
    assert simulation.time == pytest.approx(before + 2e-3)
    simulation.run(until=0.01)
    assert simulation.time == pytest.approx(0.01)


def test_energy_is_that_of_the_fall(simulation: rodlab.Simulation) -> None:
    simulation.run(0.02)
    energies = simulation.energies
    assert energies["kinetic"] > 0
    assert energies["gravitational"] < 0
    assert sum(energies.values()) == pytest.approx(0, abs=0.05 * energies["kinetic"])


def test_a_clamp_is_moved_to_a_pose(simulation: rodlab.Simulation) -> None:
    clamp = simulation.clamps["beam.start"]
    assert clamp.node == 0
    pose = clamp.pose
    assert pose.shape == (4, 4)
    assert pose[:3, 2] == pytest.approx([1, 0, 0])
    assert pose[:3, 3] == pytest.approx([0, 0, 0])
    turn = np.eye(4)
    angle = 0.05
    turn[:3, :3] = [
        [math.cos(angle), 0, math.sin(angle)],
        [0, 1, 0],
        [-math.sin(angle), 0, math.cos(angle)],
    ]
    turn[:3, 3] = [0.001, 0, 0.002]
    clamp.pose = turn @ pose
    simulation.step()
    assert clamp.pose == pytest.approx(turn @ pose, abs=1e-12)
    assert simulation.positions[0] == pytest.approx([0.001, 0, 0.002], abs=1e-12)
    clamp.position = [0.002, 0, 0.002]
    simulation.step()
    assert simulation.positions[0] == pytest.approx([0.002, 0, 0.002], abs=1e-12)
    before = simulation.positions[0].copy()
    simulation.step()
    assert np.array_equal(simulation.positions[0], before)


def test_a_grasp_holds_a_node_until_its_release(simulation: rodlab.Simulation) -> None:
    tip = simulation.rods["beam"].tip.copy()
    hand = simulation.grasp("beam", "end", frame=False)
    assert hand.node == 12
    simulation.run(0.02)
    assert simulation.rods["beam"].tip == pytest.approx(tip, abs=1e-12)
    hand.position = tip + [0, 0, 1e-3]
    simulation.step()
    assert simulation.rods["beam"].tip[2] == pytest.approx(tip[2] + 1e-3)
    assert hand.force.shape == hand.moment.shape == (3,)
    held = simulation.rods["beam"].tip.copy()
    hand.release()
    assert hand.node is None
    simulation.run(0.05)
    assert np.linalg.norm(simulation.rods["beam"].tip - held) > 1e-5


def test_handles_of_a_scene_stand_for_rods_and_clamps() -> None:
    scene = cantilever(4)
    hose = scene.add_rod(np.linspace([0, 1, 0], [0.1, 1, 0], 4), radius=1e-3, name="hose")
    clamp = scene.add_clamp(hose, 2)
    simulation = scene.simulate()
    assert list(simulation.rods) == ["beam", "hose"]
    assert simulation.rods[hose].nodes == slice(5, 9)
    assert simulation.clamps[clamp].node == 7
    assert simulation.clamps["hose.2"].node == 7
    assert simulation.clamps["beam.0"].name == "beam.start"
    assert [clamp.node for clamp in simulation.clamps] == [0, 7]
    simulation.grasp(hose, 0)
    assert simulation.clamps.names() == ["beam.start", "hose.2", "hose.start"]
    simulation.clamps["hose.2"].release()
    assert simulation.clamps.names() == ["beam.start", None, "hose.start"]
    simulation.rods[hose].forces = [0, 0, 1e-3]
    assert np.array_equal(simulation.forces[:5], np.zeros((5, 3)))
    assert np.array_equal(simulation.forces[5:], np.tile([0, 0, 1e-3], (4, 1)))


def test_a_load_is_scaled() -> None:
    simulation = cantilever(gravity=9.81, mode="static").simulate()
    simulation.find_equilibrium()
    full = simulation.rods["beam"].tip[2]
    simulation.set_load_factor(0, 0.5)
    simulation.find_equilibrium()
    assert simulation.rods["beam"].tip[2] == pytest.approx(full / 2, rel=1e-3)


def test_probes_are_named_with_their_units() -> None:
    scene = cantilever(8)
    scene.add_probe("position", "tip", rod="beam", at="end")
    simulation = scene.simulate()
    simulation.step()
    probes = simulation.probes()
    tip = [probes[f"tip_{axis}_m"] for axis in "xyz"]
    assert tip == simulation.rods["beam"].tip.tolist()


def test_contacts_are_pairs_with_forces_that_carry_the_weight() -> None:
    scene = rodlab.Scene()
    scene.set_material(youngs_modulus="10 MPa", poissons_ratio=0.5, density=1000)
    across = scene.add_rod(np.linspace([0, -0.05, 0], [0, 0.05, 0], 11), radius=2e-3, held=True)
    upper = scene.add_rod(np.linspace([-0.05, 0, 4.1e-3], [0.05, 0, 4.1e-3], 12), radius=2e-3)
    scene.set_contact(model="imc", friction=0.3)
    scene.add_load("gravity", acceleration=[0, 0, -9.81])
    scene.add_load("drag", translation=0.5)
    scene.set_time(step="1 ms", end="1 s")
    simulation = scene.simulate()
    simulation.run(0.3)
    contacts = simulation.contacts
    assert len(contacts) > 0
    count = len(contacts)
    assert contacts.nodes.shape == (count, 4)
    assert contacts.points.shape == contacts.forces.shape == contacts.normals.shape == (count, 3)
    assert contacts.distances.shape == (count,)
    assert np.linalg.norm(contacts.normals, axis=1) == pytest.approx(np.ones(count))
    on_upper = simulation.contact_forces[simulation.rods[upper].nodes].sum(axis=0)
    on_across = simulation.contact_forces[simulation.rods[across].nodes].sum(axis=0)
    assert on_upper[2] > 0
    assert on_upper == pytest.approx(-on_across, abs=1e-9)


def test_a_state_that_is_restored_continues_bit_for_bit(simulation: rodlab.Simulation) -> None:
    simulation.forces[-1] = [0, 0.01, 0]
    simulation.clamps[0].position = [0, 0, 1e-3]
    advance(simulation, 5)
    state = simulation.save()
    assert state.time == simulation.time
    expected = advance(simulation, 20)
    simulation.restore(state)
    assert advance(simulation, 20) == expected
    simulation.restore(pickle.loads(pickle.dumps(state)))
    assert advance(simulation, 20) == expected


@pytest.mark.parametrize(
    "duplicate", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))]
)
def test_a_duplicate_continues_bit_for_bit(simulation, duplicate) -> None:
    simulation.forces[-1] = [0, 0.01, 0]
    simulation.grasp("beam", 6)
    advance(simulation, 5)
    other = duplicate(simulation)
    assert other.time == simulation.time
    expected = advance(simulation, 20)
    assert advance(other, 20) == expected


def test_a_trial_leaves_no_trace(simulation: rodlab.Simulation) -> None:
    advance(simulation, 5)
    with simulation.trial() as state:
        advance(simulation, 5)
        assert simulation.time > state.time
    assert simulation.time == state.time
    other = cantilever(12).simulate()
    assert advance(simulation, 5) == advance(other, 10)


def test_a_path_of_equilibria_is_followed() -> None:
    simulation = rodlab.Simulation("michell_ring")
    path = simulation.follow(2.0)
    points = len(path["parameter"])
    assert path["parameter"][-1] == pytest.approx(2)
    assert (np.diff(path["parameter"]) > 0).all()
    assert path["positions"].shape == (points, 201, 3)
    assert len(path["kind"]) == len(path["unstable_modes"]) == points
    assert set(path["unstable_modes"]) == {0}


def test_a_batch_equals_single_simulations() -> None:
    scenes = [cantilever(8), cantilever(8).with_keys(**{"rods.beam.radius": 3e-3})]
    batch = rodlab.Batch(scenes)
    for _ in range(10):
        batch.step()
    assert len(batch) == 2
    assert batch.positions.shape == batch.velocities.shape == (2, 9, 3)
    for scene, positions in zip(scenes, batch.positions, strict=True):
        simulation = scene.simulate()
        advance(simulation, 10)
        assert np.array_equal(simulation.positions, positions)
    assert batch.failures == [None, None]
    batch.reset([0])
    assert batch.times == pytest.approx([0, 0.01])
    batch.step(count=5)
    assert batch.times == pytest.approx([0.005, 0.015])
    batch = rodlab.Batch(cantilever(8), 3)
    batch.forces[1, -1] = [0, 0, 1]
    batch.move_clamp(0, np.array([[0, 0, 0], [0, 0, 0], [1e-3, 0, 0]]))
    batch.step()
    assert not np.array_equal(batch.positions[0], batch.positions[1])
    assert batch.positions[2, 0] == pytest.approx([1e-3, 0, 0])
    state = batch.save(1)
    batch.restore(0, state)
    assert np.array_equal(batch.positions[0], batch.positions[1])


def test_states_are_restored_across_grasps_and_releases(simulation: rodlab.Simulation) -> None:
    advance(simulation, 5)
    state = simulation.save()
    expected = advance(simulation, 10)
    simulation.restore(state)
    with simulation.trial():
        simulation.grasp("beam", 6)
        simulation.clamps[0].release()
        advance(simulation, 3)
        changed = simulation.save()
        later = advance(simulation, 10)
    assert simulation.clamps.names() == ["beam.start"]
    assert advance(simulation, 10) == expected
    simulation.restore(changed)
    assert simulation.clamps.names() == [None, "beam.6"]
    assert advance(simulation, 10) == later


def test_a_state_of_a_grasp_is_restored_in_other_simulations(simulation: rodlab.Simulation) -> None:
    advance(simulation, 5)
    before = simulation.save()
    hand = simulation.grasp("beam", "end")
    hand.position = hand.position + [0, 0, 1e-3]
    advance(simulation, 1)
    held = simulation.save()
    hand.position = hand.position + [0, 0, 1e-3]
    expected = advance(simulation, 5)
    other = cantilever(12).simulate(natural_curvature=True)
    other.grasp("beam", 5)
    other.restore(pickle.loads(pickle.dumps(held)))
    hand = other.clamps["beam.end"]
    hand.position = hand.position + [0, 0, 1e-3]
    assert advance(other, 5) == expected
    batch = rodlab.Batch(cantilever(12), 2)
    batch.restore(1, held)
    simulation.restore(held)
    simulation.step()
    batch.step()
    assert np.array_equal(batch.positions[1], simulation.positions)
    other.restore(before)
    assert other.clamps.names() == ["beam.start"]
    assert advance(other, 5) == advance(cantilever(12).simulate(), 10)
    with pytest.raises(rodlab.ScenarioError, match="other actuations"):
        cantilever(12).simulate().restore(other.save())


def test_forces_that_were_written_are_part_of_a_state(simulation: rodlab.Simulation) -> None:
    simulation.forces[-1] = [0, 0.01, 0]
    state = simulation.save()
    expected = advance(simulation, 5)
    simulation.forces = np.zeros((13, 3))
    simulation.restore(state)
    assert simulation.forces[-1].tolist() == [0, 0.01, 0]
    assert advance(simulation, 5) == expected


def test_a_release_cancels_the_motion_of_its_clamp(simulation: rodlab.Simulation) -> None:
    hand = simulation.grasp("beam", "end")
    hand.position = simulation.rods["beam"].tip + [0, 0, 1e-3]
    hand.release()
    simulation.step()
