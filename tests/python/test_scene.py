"""Scenes that are built equal those from files, and the same checks apply."""

from __future__ import annotations

import copy
import importlib.metadata
import pickle
from pathlib import Path

import numpy as np
import pytest
from conftest import SCENARIOS, cantilever

import rodlab
from rodlab._values import read_toml, write_toml

# A sweep is not one scenario.
FILES = sorted(path.stem for path in SCENARIOS.glob("*.toml") if "[sweep" not in path.read_text())


@pytest.mark.parametrize("name", FILES)
def test_tables_of_a_shipped_scenario_equal_its_file(name: str) -> None:
    path = SCENARIOS / f"{name}.toml"
    tables = read_toml(path.read_text())
    from_file = rodlab.Scenario.load(path)
    from_tables = rodlab.Scenario.from_dict(tables, name=name, directory=SCENARIOS)
    assert from_tables.to_toml() == from_file.to_toml()


@pytest.mark.parametrize("name", FILES)
def test_a_saved_scene_equals_its_file(name: str, tmp_path: Path) -> None:
    scene = rodlab.load(SCENARIOS / f"{name}.toml")
    scene.save(tmp_path / f"{name}.toml")
    assert rodlab.load(tmp_path / f"{name}.toml").scenario.to_toml() == scene.scenario.to_toml()


def test_a_built_scene_equals_its_file() -> None:
    scene = rodlab.Scene(title="Heavy cantilever", name="heavy_cantilever")
    scene.set_material(youngs_modulus="100 MPa", poissons_ratio=0.5, density=np.float64(1000))
    shape = {"kind": "straight", "start": [0, 0, 0], "end": np.array([1, 0, 0])}
    beam = scene.add_rod(shape=shape, radius="5 mm", edges=np.int64(50), name="beam")
    scene.add_clamp(beam, "start")
    scene.add_load("gravity", acceleration=(0, 0, -9.81))
    scene.set_time(mode="static")
    built = scene.scenario.to_toml()
    assert built == rodlab.load(SCENARIOS / "heavy_cantilever.toml").scenario.to_toml()


def test_every_method_that_adds_a_part_writes_its_table() -> None:
    scene = rodlab.Scene()
    scene.set_material(youngs_modulus="1 MPa", poissons_ratio=0.5, density=1000)
    scene.set_solver(maximum_iterations=30)
    scene.set_contact(model="imc", friction=0.2)
    scene.set_fluid(model="resistive", viscosity=0.1)
    scene.set_output(interval="10 ms")
    scene.set_time(step="1 ms", end="20 ms")
    points = np.linspace([0, 0, 0.1], [0.1, 0, 0.1], 11)
    first = scene.add_rod(points, radius="1 mm", natural_shape="straight")
    second = scene.add_rod(points + [0.1, 0, 0], radius="1 mm", natural_shape=points)
    third = scene.add_rod(points + [0, 0.1, 0], radius="1 mm", material={"density": 900})
    scene.add_joint("rigid", (first, second), ("end", "start"))
    scene.add_spring((second, third), ("end", "end"), "2 N/m", rest_length="1 cm", name="tie")
    scene.add_body(third, "end", "1 g")
    scene.add_obstacle({"kind": "sphere", "centre": [1, 1, 1], "radius": 0.1})
    scene.add_plane()
    clamp = scene.add_clamp(first, "start", hold="position")
    scene.add_load("force", rod=third, at="end", force=[0, 0, 1e-3])
    probe = scene.add_probe("position", "tip", rod=second, at="end")
    assert [first.name, second.name, third.name] == ["rod_1", "rod_2", "rod_3"]
    assert clamp.name == "rod_1.start"
    assert probe.name == "tip"
    lists = ["rods", "joints", "bodies", "obstacles", "planes", "clamps", "loads", "probes"]
    assert [len(scene.to_dict()[name]) for name in lists] == [3, 2, 1, 1, 1, 1, 1, 1]
    text = scene.to_toml()
    assert rodlab.loads(text).scenario.to_toml() == scene.scenario.to_toml()


def test_keys_are_read_and_set_by_their_dotted_names() -> None:
    scene = cantilever()
    scene["rods.beam.radius"] = "5 mm"
    assert scene["rods.beam.radius"] == scene["rods.0.radius"] == "5 mm"
    assert "radius = 0.005" in scene.scenario.to_toml()
    scene["output.interval"] = 0.25
    assert scene["output"] == {"interval": 0.25}
    assert "rods.beam.twist" not in scene
    with pytest.raises(KeyError, match="rods.bean: no such element; there are beam"):
        scene["rods.bean.radius"] = 1
    with pytest.raises(KeyError, match="rods.beam.mass: not set"):
        scene["rods.beam.mass"]


def test_a_key_is_removed_by_none() -> None:
    scene = cantilever(step="1 ms", end="1 s")
    static = scene.with_keys(**{"time.mode": "static", "time.step": None, "time.end": None})
    assert static["time"] == {"mode": "static"}
    assert scene["time.end"] == "1 s"
    file = rodlab.load(SCENARIOS / "elastic_pendulum.toml", **{"time.scheme": None})
    assert file["time.end"] == rodlab.load("elastic_pendulum")["time.end"]
    file["time.end"] = 0.5
    del file["time.end"]
    assert "time.end" not in file
    with pytest.raises(KeyError, match="time.end: not set"):
        del file["time.end"]


def test_a_sweep_is_read_but_not_simulated() -> None:
    scene = rodlab.load(SCENARIOS / "cantilever_sweep.toml")
    assert scene["rods.beam.radius"] == "3 mm"
    with pytest.raises(rodlab.ScenarioError, match="found a sweep"):
        scene.simulate()


def test_keys_of_a_file_are_those_that_it_extends() -> None:
    scene = rodlab.load(SCENARIOS / "cantilever_sweep.toml", **{"rods.beam.radius": "6 mm"})
    assert scene["rods.beam.radius"] == "6 mm"
    assert scene["material.density"] == 1000.0
    text = 'extends = "heavy_cantilever.toml"\n'
    keys = {"rods.beam.radius": "7 mm"}
    extended = rodlab.loads(text, directory=SCENARIOS, **keys)
    extended["rods.beam.edges"] = 20
    resolved = read_toml(extended.to_toml())
    assert resolved["rods"][0]["radius"] == 7e-3
    assert resolved["rods"][0]["edges"] == 20


def test_parts_are_added_to_a_preset() -> None:
    scene = rodlab.load("heavy_cantilever")
    scene.add_load("force", rod="beam", at="end", force=[0, 0, 1])
    assert len(scene.to_dict()["loads"]) == 2
    assert scene["rods.beam.radius"] == "5 mm"
    assert scene.name == "heavy_cantilever"


def test_names_of_files_follow_the_scene(tmp_path: Path) -> None:
    (tmp_path / "curve.csv").write_text("x,y,z\n0,0,0\n0.1,0,0\n0.2,0.1,0\n")
    scene = rodlab.Scene(directory=tmp_path)
    scene.set_material(youngs_modulus="1 MPa", poissons_ratio=0.5, density=1000)
    scene.add_rod(shape={"kind": "points", "file": "curve.csv"}, radius="1 mm")
    scene.set_time(mode="static")
    assert str(tmp_path / "curve.csv") in scene.to_toml()
    assert scene.simulate().positions.shape == (3, 3)


def test_a_scene_is_copied_and_pickled() -> None:
    scene = cantilever()
    assert scene.scenario.to_toml() == pickle.loads(pickle.dumps(scene)).scenario.to_toml()
    other = copy.deepcopy(scene)
    other["rods.beam.radius"] = 1e-3
    assert scene["rods.beam.radius"] == 4e-3
    varied = scene.with_keys(**{"rods.beam.radius": 2e-3})
    assert (scene["rods.beam.radius"], varied["rods.beam.radius"]) == (4e-3, 2e-3)


def test_check_returns_derived_numbers() -> None:
    numbers = cantilever(mode="static").check()
    assert numbers["rods"][0]["bending_stiffness"].shape == (2,)
    assert numbers["degrees_of_freedom"] == 41 * 3 + 40 - 3


def test_text_for_notebooks_shows_the_tables() -> None:
    html = cantilever()._repr_html_()
    assert "rods: 1" in html
    assert "youngs_modulus" in html


@pytest.mark.parametrize(
    "value",
    [
        {"a": 1, "b c": [1.5, "x\n\"'\\\x7f"], "é": True},
        {"t": {"x": {"y": [1, [2, 3]], "z": {}}}, "l": [{"a": 1}, {"b": {"c": [{"d": 1}]}}]},
        {"small": 1e-300, "large": 1e300, "whole": 3.0, "negative": -0.0, "empty": []},
    ],
)
def test_tables_are_written_as_toml(value: dict[str, object]) -> None:
    assert read_toml(write_toml(value)) == value


@pytest.mark.parametrize(
    ("change", "kind", "message"),
    [
        (lambda scene: scene.add_rod([[0, 0], [1, 1]]), ValueError, r"points: the shape is \(2, 2\)"),
        (lambda scene: scene.add_rod([[0, 0, np.nan], [1, 1, 1]]), ValueError, "points: row 0"),
        (lambda scene: scene.add_rod("beam"), ValueError, "points: not an array"),
        (lambda scene: scene.add_rod(), ValueError, "either points or shape"),
        (lambda scene: scene.add_load("drag", translation=object()), TypeError, "loads.1.translation"),
        (lambda scene: scene.add_load("drag", translation=1 + 2j), TypeError, "loads.1.translation"),
        (lambda scene: scene.set_time(end=float("inf")), ValueError, "time.end: inf is not"),
        (lambda scene: scene.set_time(end=2**80), ValueError, "time.end: .* 64 bits"),
        (lambda scene: scene.set("material", density={1: 2}), TypeError, "the key 1 is not text"),
        (lambda scene: scene.set("rods", radius=1), ValueError, "rods: a list, not a table"),
        (lambda scene: scene.add("material", density=1), ValueError, "material: a dict, not a list"),
    ],
)
def test_a_wrong_argument_is_named_at_once(change, kind, message) -> None:
    scene = cantilever()
    before = scene.to_dict()
    with pytest.raises(kind, match=message):
        change(scene)
    assert scene.to_dict() == before


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("rods.beam.raduis", "5 mm", r"(?s)raduis.*radius"),
        ("rods.beam.radius", -1, r"(?s)radius.*out of range"),
        ("rods.beam.radius", "5 s", r"(?s)radius.*unit"),
        ("rods.beam.edges", 1.5, "edges"),
        ("clamps.0.rod", "bean", r"(?s)bean.*beam"),
        ("time.mode", "fast", "mode"),
        ("loads.0.acceleration", [0, 1], "acceleration"),
    ],
)
def test_a_wrong_key_is_named_as_in_files(key: str, value: object, message: str) -> None:
    scene = cantilever()
    scene[key] = value
    with pytest.raises(rodlab.ScenarioError, match=message) as caught:
        scene.simulate()
    assert caught.value.exit_code == 2


def test_files_that_are_missing_or_no_scenarios_are_errors(tmp_path: Path) -> None:
    with pytest.raises(rodlab.ScenarioError, match="nothing.toml"):
        rodlab.load(tmp_path / "nothing.toml")
    (tmp_path / "bad.toml").write_text("experiment = ")
    with pytest.raises(rodlab.ScenarioError, match="bad.toml"):
        rodlab.load(tmp_path / "bad.toml")
    with pytest.raises(rodlab.ScenarioError):
        rodlab.loads("experiment = 3")
    with pytest.raises(TypeError):
        rodlab.load(3)


def test_the_version_is_that_of_the_package() -> None:
    assert rodlab.__version__ == importlib.metadata.version("rodlab")
