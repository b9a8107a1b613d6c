"""Derivatives of probes, and keys that are fitted to measurements."""

from __future__ import annotations

import csv
import json
import math

import numpy as np
import pytest
from conftest import BENDING_STIFFNESS, LENGTH, SCENARIOS, cantilever

import rodlab
from rodlab import _rodlab

MODULUS = "material.youngs_modulus"
VISCOSITY = "material.viscosity"


def probed(edges: int = 16, **time: object) -> rodlab.Scene:
    """Return a cantilever with a probe at its tip."""
    scene = cantilever(edges, **time)
    scene.set_material(viscosity=1e6)
    scene.add_probe("position", "tip", rod="beam", at="end")
    return scene


def markers(simulation: rodlab.Simulation, nodes: list[int], times: np.ndarray, noise: float) -> dict:
    """Return noisy positions of nodes as columns."""
    random = np.random.default_rng(1)
    rows: dict[str, list] = {name: [] for name in ["time_s", "marker", "node", "x_m", "y_m", "z_m"]}
    for time in times:
        simulation.run(time)
        for node in nodes:
            place = simulation.positions[node] + noise * random.standard_normal(3)
            for name, value in zip(rows, [time, f"m{node}", node, *place], strict=True):
                rows[name].append(value)
    return rows


def test_derivatives_of_a_motion_are_those_by_differences() -> None:
    scene = probed(step="1 ms", end="0.02 s")
    scene.set_solver(force_tolerance=1e-12, displacement_tolerance=1e-10)
    keys = [MODULUS, "rods.beam.radius", "material.density"]
    found = rodlab.sensitivity(scene, keys, "tip")
    assert found.columns == ["tip_x_m", "tip_y_m", "tip_z_m"]
    assert found.keys == keys and found.units == ["Pa", "m", "kg/m^3"]
    times = len(found.times)
    assert found.values.shape == (times, 3)
    assert found.derivatives.shape == found.elasticities.shape == (times, 3, 3)
    for number, key in enumerate(keys):
        value = float(found.key_values[number])
        tips = []
        for factor in (1 + 1e-4, 1 - 1e-4):
            other = scene.with_keys(**{key: value * factor}).simulate()
            # Steps end at the outputs.
            for time in found.times:
                other.run(time)
            tips.append(other.rods["beam"].tip)
        expected = (tips[0] - tips[1]) / (2e-4 * value)
        assert found.derivatives[-1, number, 2] == pytest.approx(expected[2], rel=1e-4)
    elasticity = found.key_values * found.derivatives[-1, :, 2] / found.values[-1, 2]
    assert np.allclose(found.elasticities[-1, :, 2], elasticity)


def test_derivatives_are_those_of_the_command_line(tmp_path) -> None:
    scene = probed(step="1 ms", end="0.02 s")
    found = rodlab.sensitivity(scene, [MODULUS], ["tip_z_m"])
    scene.save(tmp_path / "beam.toml")
    words = ["--of", "tip_z_m", "--to", MODULUS, "--out", str(tmp_path / "out")]
    _rodlab.command(["sensitivity", str(tmp_path / "beam.toml"), *words])
    with open(tmp_path / "out" / "sensitivity.csv", newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    assert names == ["time_s", "tip_z_m", f"d_tip_z_m_d_{MODULUS}"]
    written = np.array(rows, dtype=np.float64)
    assert np.array_equal(written[:, 0], found.times)
    assert np.array_equal(written[:, 1], found.values[:, 0])
    assert np.array_equal(written[:, 2], found.derivatives[:, 0, 0])
    pandas = pytest.importorskip("pandas")
    table = found.table()
    assert isinstance(table, pandas.DataFrame) and list(table) == names
    assert np.array_equal(table.to_numpy(), written)


def test_the_gradient_of_a_simulation_is_that_at_its_time() -> None:
    scene = probed(step="1 ms", end="0.02 s")
    scene.set_solver(force_tolerance=1e-12, displacement_tolerance=1e-10)
    simulation = scene.simulate()
    simulation.run(0.012)
    gradient = simulation.gradient([MODULUS, VISCOSITY], of="tip")
    assert list(gradient) == ["tip_x_m", "tip_y_m", "tip_z_m"]
    assert list(gradient["tip_z_m"]) == [MODULUS, VISCOSITY]
    tips = []
    for modulus in (1e9 * (1 + 1e-4), 1e9 * (1 - 1e-4)):
        other = scene.with_keys(**{MODULUS: modulus}).simulate()
        other.run(0.012)
        tips.append(other.rods["beam"].tip)
    for axis, expected in zip("xyz", (tips[0] - tips[1]) / 2e5, strict=True):
        assert gradient[f"tip_{axis}_m"][MODULUS] == pytest.approx(expected, rel=1e-4, abs=1e-20)
    before = simulation.positions.tobytes()
    simulation.gradient(MODULUS)
    assert simulation.positions.tobytes() == before


def test_the_gradient_of_an_equilibrium_is_that_of_beams() -> None:
    simulation = probed(40, gravity=9.81, mode="static").simulate()
    simulation.find_equilibrium()
    sag = -simulation.rods["beam"].tip[2]
    derivative = simulation.gradient(MODULUS, "tip_z_m")["tip_z_m"][MODULUS]
    # Deflections are small, so that they are proportional to 1/E.
    assert derivative == pytest.approx(sag / 1e9, rel=1e-2)
    assert BENDING_STIFFNESS > 0 and sag < 0.02 * LENGTH


def test_what_has_no_gradient_is_refused_with_the_reason() -> None:
    simulation = probed().simulate()
    with pytest.raises(rodlab.ScenarioError, match="no probe or column `top`"):
        simulation.gradient(MODULUS, of="top")
    with pytest.raises(rodlab.ScenarioError, match="youngs_modulus"):
        simulation.gradient("material.youngs_moduls")
    with pytest.raises(rodlab.ScenarioError, match="probes"):
        rodlab.sensitivity(cantilever(8), MODULUS)

    def push(one: rodlab.Simulation) -> None:
        one.forces[-1] = [0, 0, 1e-3]

    def lift(one: rodlab.Simulation) -> None:
        one.clamps[0].position = [0, 0, 1e-3]

    actions = [
        push,
        lift,
        lambda one: one.grasp("beam", "end"),
        lambda one: one.clamps[0].release(),
        lambda one: one.set_load_factor(0, 0.5),
        lambda one: one.find_equilibrium(),
    ]
    for act in actions:
        simulation = probed().simulate()
        state = simulation.save()
        act(simulation)
        with pytest.raises(rodlab.ScenarioError, match="the program has changed the motion"):
            simulation.gradient(MODULUS)
        simulation.restore(state)
        simulation.gradient(MODULUS)


def test_a_beam_is_identified_from_its_own_noisy_motion(tmp_path) -> None:
    noise = 2e-4
    scene = probed(step="2 ms", end="0.3 s")
    scene.set_material(youngs_modulus=2e7, viscosity=5e4)
    data = markers(scene.simulate(), [8, 16], np.arange(1, 31) * 0.01, noise)
    start = {MODULUS: 1.6e7, VISCOSITY: 8e4}
    out = tmp_path / "out"
    found = rodlab.identify(scene, data, [MODULUS, VISCOSITY], out=out, **start)
    assert found.keys == [MODULUS, VISCOSITY]
    for key, true in {MODULUS: 2e7, VISCOSITY: 5e4}.items():
        error = found.standard_errors[key]
        assert 0 < error < 0.1 * true
        assert abs(found.values[key] - true) < 4 * error
        low, high = found.intervals[key]
        assert low < found.values[key] < high
    assert found.correlations.shape == (2, 2)
    assert np.allclose(np.diag(found.correlations), 1) and np.allclose(found.correlations, found.correlations.T)
    (estimated,) = found.noise.values()
    assert estimated == pytest.approx(noise, rel=0.2)
    residuals = found.residuals()
    assert len(residuals["residual"]) == 180
    assert np.allclose(residuals["measured"] - residuals["predicted"], residuals["residual"])
    assert math.sqrt(np.mean(residuals["residual"] ** 2)) == pytest.approx(noise, rel=0.2)
    assert set(residuals["file"]) and residuals["series"].dtype.kind == "U"
    assert found.figure.lstrip().startswith("<") and "<svg" in found.figure
    assert "<table>" in found._repr_html_() and MODULUS in repr(found)
    fitted = [found.scene.simulate(), scene.with_keys(**found.values).simulate()]
    for simulation in fitted:
        simulation.run(0.1)
    assert np.allclose(fitted[0].positions, fitted[1].positions, rtol=0, atol=1e-9)
    assert json.loads((out / "identified.json").read_text())["converged"]
    pandas = pytest.importorskip("pandas")
    assert isinstance(found.table(), pandas.DataFrame)
    assert found.table()["value"].tolist() == list(found.values.values())


def test_an_identification_writes_the_bytes_of_the_command_line(tmp_path) -> None:
    pandas = pytest.importorskip("pandas")
    photograph = SCENARIOS / "wires" / "black_0.csv"
    scene, key = str(SCENARIOS / "wire_loop.toml"), "parameters.ei"
    words = ["--data", str(photograph), "--fit", key, "--prior", f"{key}=0.001+-0.001", "--quiet"]
    one, other = tmp_path / "one", tmp_path / "other"
    edges = {"rods.wire.edges": 40}
    _rodlab.command(["identify", scene, *words, "--set", "rods.wire.edges=40", "--out", str(one)])
    found = rodlab.identify(scene, photograph, key, prior={key: (1e-3, 1e-3)}, out=other, **edges)
    names = sorted(path.name for path in one.iterdir())
    assert names == sorted(path.name for path in other.iterdir())
    for name in names:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    # A data frame gives the same numbers.
    again = rodlab.identify(scene, pandas.read_csv(photograph), key, prior={key: (1e-3, 1e-3)}, **edges)
    assert again.values[key] == pytest.approx(found.values[key], rel=1e-9)


def test_faults_of_an_identification_are_named(tmp_path) -> None:
    scene = probed(step="2 ms", end="0.1 s")
    data = {"time_s": [0.01, 0.02], "marker": ["a", "a"], "node": [16, 16], "x_m": [0.3, 0.3], "y_m": [0, 0]}
    with pytest.raises(rodlab.ScenarioError, match="columns of one length"):
        rodlab.identify(scene, data | {"z_m": [0.0]}, MODULUS)
    with pytest.raises(rodlab.ScenarioError, match=r"data\.csv, line 3: .*far"):
        rodlab.identify(scene, data | {"x_m": ["0.3", "far"]}, MODULUS)
    complete = data | {"z_m": [0.0, -1e-4]}
    with pytest.raises(rodlab.ScenarioError, match="this key is not fitted"):
        rodlab.identify(scene, complete, MODULUS, bounds={VISCOSITY: (1, 2)})
    with pytest.raises(rodlab.ScenarioError, match="squares"):
        rodlab.identify(scene, complete, MODULUS, loss="cubes")  # type: ignore[arg-type]
    (tmp_path / "beam.toml").write_text(scene.to_toml())
    stiff = rodlab.load(tmp_path / "beam.toml", **{MODULUS: 2e9})
    with pytest.raises(rodlab.ScenarioError, match="keys of several scenes are set together"):
        rodlab.identify(stiff, complete, MODULUS, others=[(scene, complete)])
    with pytest.raises(rodlab.ScenarioError, match=r"identified\.json is missing"):
        rodlab.Identified(tmp_path)


def test_derivatives_over_fields_add_up_to_those_over_a_uniform_value() -> None:
    scene = probed(step="1 ms", end="0.02 s")
    found = rodlab.field_sensitivity(scene, ["natural_curvature", "force"], "tip", parts=2)
    assert found.fields == ["natural_curvature_1", "natural_curvature_2", "force_x", "force_y", "force_z"]
    assert found.units == ["1/m", "1/m", "N", "N", "N"]
    assert found.derivatives.shape == (2, 17, 5, 3) and found.ends.tolist() == [0.01, 0.02]
    assert found.nodes == list(range(17)) and set(found.rods) == {"beam"}
    at_tip = found.derivatives[:, 16, 4, :].sum(axis=0)
    scene.add_load("force", rod="beam", at=16, force=[0, 0, 0.0])
    forward = rodlab.sensitivity(scene, "loads.1.force.2", "tip")
    assert np.allclose(at_tip, forward.derivatives[-1, 0], rtol=1e-5, atol=1e-6 * abs(at_tip[2]))
    with pytest.raises(rodlab.ScenarioError, match="fields: unknown field `mass`; allowed: natural"):
        rodlab.field_sensitivity(scene, "mass")
