"""The command `rodlab dataset --format`, and the files that it writes."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("gymnasium")

COUNT = 2


def rodlab(*words: object) -> subprocess.CompletedProcess[str]:
    """Run the program of the installed package, or else the module."""
    script = Path(sys.executable).parent / "rodlab"
    program = [str(script)] if script.exists() else [sys.executable, "-m", "rodlab"]
    return subprocess.run([*program, *map(str, words)], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return directories with the same demonstrations in each format."""
    pytest.importorskip("pyarrow")
    folder = tmp_path_factory.mktemp("demonstrations")
    for form in ["npz", "parquet", "lerobot"]:
        run = rodlab("dataset", "Folding", "--format", form, "--count", COUNT, "--seed", 3, "--out", folder / form)
        assert run.returncode == 0, run.stderr
        assert run.stdout == f"{COUNT} episodes, {COUNT} with success, in {folder / form}\n"
        assert run.stderr.count("\n") == COUNT and "episode 2 of 2: seed 4, " in run.stderr
    return {form: folder / form for form in ["npz", "parquet", "lerobot"]}


def episodes(directory: Path) -> list[dict[str, np.ndarray]]:
    """Return the arrays of the episodes."""
    return [dict(np.load(path)) for path in sorted(directory.glob("episode_*.npz"))]


def test_arrays_of_an_episode_agree_in_length(written: dict[str, Path]) -> None:
    listed = json.loads((written["npz"] / "episodes.json").read_text())
    assert listed["task"] == "rodlab/Folding-v0"
    assert [episode["seed"] for episode in listed["episodes"]] == [3, 4]
    arrays = episodes(written["npz"])
    assert len(arrays) == COUNT
    for episode, summary in zip(arrays, listed["episodes"], strict=True):
        steps = summary["steps"]
        assert len(episode["observations"]) == len(episode["pictures"]) == steps + 1
        for name in ["actions", "rewards", "terminated", "truncated"]:
            assert len(episode[name]) == steps
        assert episode["pictures"].shape[1:] == (256, 256, 3)
        assert np.isclose(episode["rewards"].sum(), summary["return"])


def test_the_table_has_the_rows_of_the_arrays(written: dict[str, Path]) -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.read_parquet(written["parquet"] / "episodes.parquet")
    arrays = episodes(written["npz"])
    assert len(table) == sum(len(episode["actions"]) for episode in arrays)
    for number, episode in enumerate(arrays):
        rows = table[table["episode_index"] == number]
        assert rows["frame_index"].tolist() == list(range(len(episode["actions"])))
        assert np.array_equal(np.stack(rows["action"]), episode["actions"])
        assert np.array_equal(np.stack(rows["observation.state"]), episode["observations"][:-1])
        assert np.array_equal(rows["next.reward"], episode["rewards"].astype(np.float32))


def test_a_data_set_of_lerobot_agrees_with_its_descriptions(written: dict[str, Path]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    image = pytest.importorskip("PIL.Image")
    directory = written["lerobot"]
    info = json.loads((directory / "meta" / "info.json").read_text())
    arrays = episodes(written["npz"])
    frames = sum(len(episode["actions"]) for episode in arrays)
    assert info["codebase_version"] == "v2.1"
    assert (info["total_episodes"], info["total_frames"], info["total_chunks"]) == (COUNT, frames, 1)
    assert info["splits"] == {"train": f"0:{COUNT}"}
    assert info["video_path"] is None and info["total_videos"] == 0
    files = [info["data_path"].format(episode_chunk=0, episode_index=number) for number in range(COUNT)]
    assert sorted(str(path.relative_to(directory)) for path in directory.glob("data/*/*")) == files
    lengths = [json.loads(line)["length"] for line in (directory / "meta" / "episodes.jsonl").read_text().splitlines()]
    first = 0
    for name, episode, length in zip(files, arrays, lengths, strict=True):
        table = parquet.read_table(directory / name)
        assert table.num_rows == length == len(episode["actions"])
        assert set(table.column_names) == set(info["features"])
        assert table["index"].to_pylist() == list(range(first, first + length))
        assert np.allclose(table["timestamp"].to_numpy(), np.arange(length) / info["fps"])
        assert np.array_equal(np.stack(table["action"].to_pylist()), episode["actions"])
        for step in [0, length - 1]:
            content = table["observation.images.scene"][step].as_py()["bytes"]
            assert np.array_equal(np.asarray(image.open(io.BytesIO(content))), episode["pictures"][step])
        first += length


def test_bad_values_are_refused_with_what_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "kept").write_text("")
    refusals = {
        "dataset Folding --format csv": "[possible values: npz, parquet, lerobot]",
        "dataset Folding": "--format is needed; allowed: npz, parquet, lerobot",
        "dataset KnotState --format npz": "allowed: CableShape, Folding",
        "dataset folding_dataset --format npz": "allowed: CableShape, Folding",
        "dataset Folding --format npz --count 0": "1..",
        "dataset Folding --format npz --vary a=1": "cannot be used with",
        "dataset folding_dataset --seed 3": "--format <FORMAT>",
        f"dataset Folding --format npz --out {tmp_path}": "is not empty",
    }
    for words, allowed in refusals.items():
        run = rodlab(*words.split())
        assert run.returncode == 2, words
        assert allowed in run.stderr, words
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


def test_samples_of_scenarios_are_made_as_before(tmp_path: Path) -> None:
    run = rodlab("dataset", "deployment_dataset", "--set", "grasp_samples.points.count=4", "--out", tmp_path / "out")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "out" / "manifest.json").is_file()
