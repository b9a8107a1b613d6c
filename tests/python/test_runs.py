"""Runs through Python write the bytes of the command line; results are read as tables."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import SCENARIOS, cantilever

import rodlab

pandas = pytest.importorskip("pandas")


def command_line(*words: object) -> None:
    subprocess.run([sys.executable, "-m", "rodlab", *map(str, words)], check=True)


def tables(directory: Path) -> dict[str, bytes]:
    """Return all tables except those that depend on the machine."""
    return {
        str(path.relative_to(directory)): path.read_bytes()
        for path in directory.rglob("*")
        if path.suffix in {".csv", ".toml"} and path.name != "timings.csv"
    }


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("heavy_cantilever", {}),
        ("elastic_pendulum", {"time.end": "0.2 s"}),
        ("mesh_obstacle", {"time.end": "0.02 s"}),
        ("flagella_quick", {"time.end": "0.05 s"}),
        ("michell_ring", {"continuation.to": 2}),
    ],
)
def test_a_run_writes_the_bytes_of_the_command_line(name, keys, tmp_path) -> None:
    path = SCENARIOS / f"{name}.toml"
    settings = [word for key, value in keys.items() for word in ("--set", f"{key}={value!r}")]
    command_line("run", path, *settings, "--out", tmp_path / "command", "--quiet")
    result = rodlab.run(path, tmp_path / "python", **keys)
    assert result.report["status"] == "finished"
    assert tables(tmp_path / "python") == tables(tmp_path / "command")


def test_a_sweep_writes_the_bytes_of_the_command_line(tmp_path) -> None:
    path = SCENARIOS / "heavy_cantilever.toml"
    varied = ["--vary", "rods.beam.radius=3mm,4mm,5mm"]
    command_line("run", path, *varied, "--out", tmp_path / "command", "--quiet")
    vary = {"rods.beam.radius": ["3mm", "4mm", "5mm"]}
    result = rodlab.sweep(path, vary, tmp_path / "python", jobs=2)
    assert tables(tmp_path / "python") == tables(tmp_path / "command")
    summary = result.summary()
    assert summary["rods.beam.radius"].tolist() == [0.003, 0.004, 0.005]
    assert list(result.cases()) == summary["case"].tolist()
    assert result.is_sweep
    assert result.series()["case"].tolist() == summary["case"].tolist()
    case = result.cases()[summary["case"][0]]
    assert case.nodes().positions.shape == (1, 51, 3)
    with pytest.raises(rodlab.ScenarioError, match="nodes.csv; see cases"):
        result.nodes()


def test_a_sweep_of_a_built_scene_varies_arrays(tmp_path) -> None:
    scene = cantilever(8, mode="static")
    vary = {"rods.beam.radius": np.array([3e-3, 4e-3]), "material.density": [900, 1000]}
    summary = rodlab.sweep(scene, vary, tmp_path / "out").summary()
    assert len(summary) == 4
    assert set(summary["status"]) == {"finished"}
    assert (summary["gravitational_energy_j"] < 0).all()


def test_a_finished_run_is_not_repeated(tmp_path) -> None:
    scene = cantilever(8, mode="static")
    first = rodlab.run(scene, tmp_path / "out").manifest
    assert rodlab.run(scene, tmp_path / "out").manifest == first
    with pytest.raises(rodlab.RodlabError, match="rods.beam.radius: 0.004, now 0.003"):
        rodlab.run(scene, tmp_path / "out", **{"rods.beam.radius": 3e-3})
    again = rodlab.run(scene, tmp_path / "out", force=True, **{"rods.beam.radius": 3e-3})
    assert again.manifest != first


def test_results_are_tables_and_arrays(tmp_path) -> None:
    scene = cantilever(8, step="1 ms", end="20 ms")
    scene.set_output(interval="5 ms")
    scene.add_probe("position", "tip", rod="beam", at="end")
    result = rodlab.run(scene, tmp_path / "out")
    series = result.series()
    assert series["time_s"].tolist() == pytest.approx([0, 0.005, 0.01, 0.015, 0.02])
    nodes = result.nodes()
    assert nodes.times.tolist() == series["time_s"].tolist()
    assert nodes.positions.shape == (5, 9, 3)
    assert nodes.angles.shape == (5, 9)
    assert nodes.rods == {"beam": slice(0, 9)}
    # Both tables give identical bits.
    assert nodes.positions[:, -1, 2].tolist() == series["tip_z_m"].tolist()
    assert result.summary()["status"].tolist() == ["finished"]
    opened = rodlab.results(tmp_path / "out")
    assert opened.report == result.report
    assert opened.cases() == {}


def test_a_run_equals_the_steps_of_a_simulation(tmp_path) -> None:
    scene = cantilever(8, step="1 ms", end="20 ms")
    scene.set_output(interval="20 ms")
    nodes = rodlab.run(scene, tmp_path / "out").nodes()
    simulation = scene.simulate()
    simulation.run(simulation.end)
    assert np.array_equal(simulation.positions, nodes.positions[-1])


def test_figures_and_pages_are_made(tmp_path) -> None:
    result = rodlab.run(cantilever(8, mode="static"), tmp_path / "out")
    figures = result.figures()
    assert {path.suffix for path in figures} == {".svg", ".png"}
    assert all(path.is_file() for path in figures)
    assert result.view().is_file()
    assert result._repr_html_().startswith("<iframe srcdoc=")


def test_a_dataset_has_dimensions(tmp_path) -> None:
    pytest.importorskip("xarray")
    dataset = rodlab.run(cantilever(8, mode="static"), tmp_path / "out").dataset()
    assert dict(dataset.sizes) == {"time": 1, "node": 9, "axis": 3}


def test_the_command_line_has_its_exit_codes() -> None:
    words = [sys.executable, "-m", "rodlab"]
    assert subprocess.run([*words, "--version"], capture_output=True).returncode == 0
    failed = subprocess.run([*words, "run", "nothing.toml"], capture_output=True, text=True)
    assert failed.returncode == 2
    assert "nothing.toml" in failed.stderr
