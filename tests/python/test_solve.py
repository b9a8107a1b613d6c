"""Solvers, plans and images through Python."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import SCENARIOS

import rodlab

CELL = SCENARIOS / "cells" / "six_joints.toml"


def test_solvers_return_arrays() -> None:
    assert rodlab.solve.helix([1, 1, -1])["critical"] == pytest.approx(6.790424, abs=1e-5)
    grasp = rodlab.solve.grasp(10, 0.5)
    assert grasp["position"].shape == (3,)
    assert np.linalg.norm(grasp["quaternion"]) == pytest.approx(1)
    assert len(rodlab.solve.grasp(10, 0.5, all=True)["solutions"]) > 1
    assert rodlab.solve.fold(3.4, 1.7)["lambda"] == pytest.approx(0.24005, abs=1e-4)
    assert rodlab.solve.knot(3)["length_normalized"] == pytest.approx(143.75, abs=0.1)
    assert rodlab.solve.loop_height("3 cm")["height_m"] == pytest.approx(0.03427, abs=1e-4)
    assert rodlab.solve.hanging_plate(0.2, 0.1)["drop_m"] == pytest.approx(0.08503, abs=1e-4)


def test_an_arm_reaches_the_pose_that_is_solved_for() -> None:
    pose = np.array([0.4, 0.1, 0.2, 0, 1, 0, 0])
    joints = rodlab.solve.ik(CELL, pose)["joints"]
    hand = rodlab.solve.fk(CELL, joints)
    assert hand["position"] == pytest.approx(pose[:3], abs=1e-9)
    assert abs(hand["quaternion"] @ pose[3:]) == pytest.approx(1)
    assert rodlab.solve.ik(CELL, pose, start=joints)["joints"] == pytest.approx(joints)
    assert len(rodlab.solve.ik(CELL, pose, all=True)["branches"]) == 8
    with pytest.raises(rodlab.ConvergenceError):
        rodlab.solve.ik(CELL, [9, 0, 0, 1, 0, 0, 0])


def test_a_drawn_array_is_planned(tmp_path) -> None:
    angle = np.linspace(0, 3, 60)
    pattern = np.column_stack([0.1 * angle, 0.03 * np.sin(2 * angle)])
    plan = rodlab.plan.deployment(pattern, "pink_vps", tmp_path / "plan")
    assert plan["poses"].shape == (len(plan["times"]), 7)
    assert (np.diff(plan["times"]) > 0).all()
    assert (tmp_path / "plan" / "landing.toml").is_file()
    motion = rodlab.plan.joints(plan["poses"], CELL, place="auto")
    assert len(motion["joints"]) == 6
    assert all(len(values) == len(motion["times"]) for values in motion["joints"].values())


def test_a_fold_is_planned() -> None:
    plan = rodlab.plan.fold(SCENARIOS / "papers" / "a4.toml", "half")
    assert plan["poses"].shape == (len(plan["times"]), 7)
    assert (plan["poses"][:, 2] >= 0).all()


def test_curves_are_compared() -> None:
    line = np.column_stack([np.linspace(0, 1, 50), np.zeros(50)])
    score = rodlab.score(line, line + [0, 1e-3])
    assert score["by_nearest_point"]["mean_m"] == pytest.approx(1e-3)
    assert rodlab.score(line, line + [0, 1e-3], align=True)["by_arc_length"]["mean_m"] < 1e-9


def test_rods_are_traced_in_an_array_as_in_a_file() -> None:
    image = pytest.importorskip("PIL.Image")
    photograph = SCENARIOS / "photographs" / "rods.jpg"
    from_file = rodlab.trace(photograph)
    assert len(from_file) == 3
    assert all(curve.shape[1] == 2 for curve in from_file)
    pixels = np.full((100, 200, 3), 255, dtype=np.uint8)
    pixels[48:53, 20:180] = [200, 0, 0]
    (line,) = rodlab.trace(pixels, "red")
    assert line[:, 1] == pytest.approx(np.full(len(line), 50.0), abs=0.6)
    from_array = rodlab.trace(np.asarray(image.open(photograph).convert("RGB")))
    assert len(from_array) == len(from_file)


def test_number_region_and_colours_select_traced_rods(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    pixels = np.full((120, 200, 3), 255, dtype=np.uint8)
    pixels[18:23, 20:180] = [200, 0, 0]
    pixels[58:63, 20:140] = [200, 0, 0]
    pixels[98:103, 20:100] = [0, 0, 200]
    file = tmp_path / "rods.png"
    image.fromarray(pixels).save(file)
    for source in (pixels, file):
        assert len(rodlab.trace(source, ["red", "blue"])) == 3
        assert len(rodlab.trace(source, "red", strands=1)) == 1
        assert len(rodlab.trace(source, "red", least_length=140)) == 1
        (lower,) = rodlab.trace(source, "red", region=(0, 40, 200, 40))
        assert lower[:, 1] == pytest.approx(np.full(len(lower), 60.0), abs=0.6)
        (left,) = rodlab.trace(source, "blue", region=[(0, 80), (60, 80), (60, 119), (0, 119)])
        assert left[:, 0].max() < 61
        with pytest.raises(rodlab.ScenarioError, match="region"):
            rodlab.trace(source, "red", region=(0, 0, 0, 40))
