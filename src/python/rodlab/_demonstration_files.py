"""Files of demonstrations: arrays, tables, and LeRobot's format."""

import importlib
import json
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]

CHUNK = 1000
"""Episodes in a directory of LeRobot's format."""
STATE, IMAGE = "observation.state", "observation.images.scene"


@dataclass
class Episode:
    """An episode: t actions, and t + 1 observations and pictures."""

    seed: int
    rate: float
    parameters: dict[str, float]
    observations: list[NDArray[np.float32]] = field(default_factory=list)
    actions: list[NDArray[np.float32]] = field(default_factory=list)
    rewards: list[float] = field(default_factory=list)
    terminated: list[bool] = field(default_factory=list)
    truncated: list[bool] = field(default_factory=list)
    successes: list[bool] = field(default_factory=list)
    pictures: list[Picture] = field(default_factory=list)

    def begin(self, observation: NDArray[np.float32], picture: Picture | None) -> None:
        """Record the start."""
        self.observations.append(observation)
        if picture is not None:
            self.pictures.append(picture)

    def add(
        self,
        action: NDArray[np.float32],
        observation: NDArray[np.float32],
        reward: float,
        terminated: bool,
        truncated: bool,
        success: bool,
        picture: Picture | None,
    ) -> None:
        """Record a step."""
        self.actions.append(action)
        self.rewards.append(reward)
        self.terminated.append(terminated)
        self.truncated.append(truncated)
        self.successes.append(success)
        self.begin(observation, picture)

    def summary(self) -> dict[str, Any]:
        """Return the entry of the episode in lists."""
        return {
            "seed": self.seed,
            "parameters": self.parameters,
            "success": any(self.successes),
            "return": float(sum(self.rewards)),
            "steps": len(self.actions),
        }


class Writer(Protocol):
    """Writer of episodes into a directory."""

    def __init__(self, directory: Path, task: str, description: str) -> None: ...
    def write(self, episode: Episode) -> None:
        """Write an episode, or keep it until the end."""
    def close(self) -> None:
        """Write the list of all episodes."""


class NpzWriter:
    """A file of numpy arrays for each episode."""

    def __init__(self, directory: Path, task: str, description: str) -> None:
        directory.mkdir(parents=True, exist_ok=True)
        self._directory = directory
        self._task = task
        self._summaries: list[dict[str, Any]] = []

    def write(self, episode: Episode) -> None:
        """Write an episode."""
        arrays: dict[str, NDArray[Any]] = {
            "observations": np.array(episode.observations),
            "actions": np.array(episode.actions),
            "rewards": np.array(episode.rewards),
            "terminated": np.array(episode.terminated),
            "truncated": np.array(episode.truncated),
        }
        if episode.pictures:
            arrays["pictures"] = np.array(episode.pictures)
        np.savez_compressed(self._directory / f"episode_{len(self._summaries):06d}.npz", **arrays)  # type: ignore[arg-type]
        self._summaries.append(episode.summary())

    def close(self) -> None:
        """Write the list of episodes."""
        _write_list(self._directory, self._task, self._summaries)


class ParquetWriter:
    """One table with the rows of all episodes."""

    def __init__(self, directory: Path, task: str, description: str) -> None:
        self._arrow, self._parquet = _pyarrow()
        directory.mkdir(parents=True, exist_ok=True)
        self._directory = directory
        self._task = task
        self._summaries: list[dict[str, Any]] = []
        self._file: Any = None

    def write(self, episode: Episode) -> None:
        """Write the rows of an episode."""
        number = len(self._summaries)
        table = self._arrow.table(_columns(self._arrow, episode, number))
        if self._file is None:
            self._file = self._parquet.ParquetWriter(self._directory / "episodes.parquet", table.schema)
        self._file.write_table(table)
        self._summaries.append(episode.summary())

    def close(self) -> None:
        """End the table, and write the list of episodes."""
        if self._file is not None:
            self._file.close()
        _write_list(self._directory, self._task, self._summaries)


class LeRobotWriter:
    """A data set of LeRobot's format, version 2.1, without videos."""

    def __init__(self, directory: Path, task: str, description: str) -> None:
        self._arrow, self._parquet = _pyarrow()
        (directory / "meta").mkdir(parents=True, exist_ok=True)
        self._directory = directory
        self._description = description
        self._lengths: list[int] = []
        self._stats: list[dict[str, Any]] = []
        self._features: dict[str, Any] = {}
        self._rate = 0.0

    def write(self, episode: Episode) -> None:
        """Write the table of an episode."""
        number, count = len(self._lengths), len(episode.actions)
        columns = _columns(self._arrow, episode, number)
        first = sum(self._lengths)
        columns["index"] = self._arrow.array(range(first, first + count), self._arrow.int64())
        columns["task_index"] = self._arrow.array([0] * count, self._arrow.int64())
        self._features = _features(episode)
        self._rate = episode.rate
        table = self._arrow.table(columns)
        info = json.dumps({"info": {"features": _huggingface(self._features)}})
        table = table.replace_schema_metadata({"huggingface": info})
        path = self._directory / f"data/chunk-{number // CHUNK:03d}/episode_{number:06d}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        self._parquet.write_table(table, path)
        self._stats.append({"episode_index": number, "stats": _stats(episode, number, first)})
        self._lengths.append(count)

    def close(self) -> None:
        """Write the descriptions of the data set."""
        episodes = [
            {"episode_index": number, "tasks": [self._description], "length": length}
            for number, length in enumerate(self._lengths)
        ]
        info = {
            "codebase_version": "v2.1",
            "robot_type": "rodlab",
            "total_episodes": len(self._lengths),
            "total_frames": sum(self._lengths),
            "total_tasks": 1,
            "total_videos": 0,
            "total_chunks": -(-len(self._lengths) // CHUNK),
            "chunks_size": CHUNK,
            "fps": round(self._rate),
            "splits": {"train": f"0:{len(self._lengths)}"},
            "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
            "video_path": None,
            "features": self._features,
        }
        meta = self._directory / "meta"
        (meta / "info.json").write_text(json.dumps(info, indent=4) + "\n")
        _write_lines(meta / "episodes.jsonl", episodes)
        _write_lines(meta / "tasks.jsonl", [{"task_index": 0, "task": self._description}])
        _write_lines(meta / "episodes_stats.jsonl", self._stats)


WRITERS: dict[str, type[Writer]] = {"npz": NpzWriter, "parquet": ParquetWriter, "lerobot": LeRobotWriter}


def encode_png(picture: Picture) -> bytes:
    """Return a picture, height × width × 3, as PNG."""
    height, width = picture.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 1:] = picture.reshape(height, 3 * width)

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    content = zlib.compress(rows.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", content) + chunk(b"IEND", b"")


def _pyarrow() -> tuple[Any, Any]:
    try:
        return importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            'this format needs pyarrow: pip install "rodlab[datasets]"', name=error.name
        ) from error


def _columns(arrow: Any, episode: Episode, number: int) -> dict[str, Any]:
    """Return the columns of an episode: a row for each action, with the preceding observation."""
    count = len(episode.actions)
    vectors = arrow.list_(arrow.float32())
    ended = [one or other for one, other in zip(episode.terminated, episode.truncated, strict=True)]
    columns = {
        STATE: arrow.array([row.tolist() for row in episode.observations[:count]], vectors),
        "action": arrow.array([row.tolist() for row in episode.actions], vectors),
        "next.reward": arrow.array(episode.rewards, arrow.float32()),
        "next.done": arrow.array(ended, arrow.bool_()),
        "next.success": arrow.array(episode.successes, arrow.bool_()),
        "timestamp": arrow.array([step / episode.rate for step in range(count)], arrow.float32()),
        "frame_index": arrow.array(range(count), arrow.int64()),
        "episode_index": arrow.array([number] * count, arrow.int64()),
    }
    if episode.pictures:
        pictures = [
            {"bytes": encode_png(picture), "path": f"frame_{step:06d}.png"}
            for step, picture in enumerate(episode.pictures[:count])
        ]
        kind = arrow.struct([("bytes", arrow.binary()), ("path", arrow.string())])
        columns[IMAGE] = arrow.array(pictures, kind)
    return columns


def _features(episode: Episode) -> dict[str, Any]:
    """Return the description of the columns for `info.json`."""

    def feature(kind: str, *shape: int, names: list[str] | None = None) -> dict[str, Any]:
        return {"dtype": kind, "shape": list(shape), "names": names}

    features = {
        STATE: feature("float32", len(episode.observations[0])),
        "action": feature("float32", len(episode.actions[0])),
        "next.reward": feature("float32", 1),
        "next.done": feature("bool", 1),
        "next.success": feature("bool", 1),
        "timestamp": feature("float32", 1),
        "frame_index": feature("int64", 1),
        "episode_index": feature("int64", 1),
        "index": feature("int64", 1),
        "task_index": feature("int64", 1),
    }
    if episode.pictures:
        shape = episode.pictures[0].shape
        features[IMAGE] = feature("image", *shape, names=["height", "width", "channels"])
    return features


def _huggingface(features: dict[str, Any]) -> dict[str, Any]:
    """Return the description of the columns for the metadata of the tables."""
    result: dict[str, Any] = {}
    for name, feature in features.items():
        value = {"dtype": feature["dtype"], "_type": "Value"}
        if feature["dtype"] == "image":
            result[name] = {"_type": "Image"}
        elif feature["shape"] == [1]:
            result[name] = value
        else:
            result[name] = {"feature": value, "length": feature["shape"][0], "_type": "Sequence"}
    return result


def _stats(episode: Episode, number: int, first: int) -> dict[str, Any]:
    """Return the least, largest and mean values and the standard deviations of the columns."""
    count = len(episode.actions)
    ended = np.array(episode.terminated) | np.array(episode.truncated)
    columns: dict[str, NDArray[Any]] = {
        STATE: np.array(episode.observations[:count]),
        "action": np.array(episode.actions),
        "next.reward": np.array(episode.rewards)[:, np.newaxis],
        "next.done": ended[:, np.newaxis],
        "next.success": np.array(episode.successes)[:, np.newaxis],
        "timestamp": np.arange(count)[:, np.newaxis] / episode.rate,
        "frame_index": np.arange(count)[:, np.newaxis],
        "episode_index": np.full((count, 1), number),
        "index": np.arange(first, first + count)[:, np.newaxis],
        "task_index": np.zeros((count, 1), np.int64),
    }
    stats = {name: _moments(values, (0,)) | {"count": [count]} for name, values in columns.items()}
    if episode.pictures:
        pictures = np.array(episode.pictures[:count])
        moments = _moments(pictures, (0, 1, 2))
        scaled = {name: [[[value / 255.0]] for value in values] for name, values in moments.items()}
        stats[IMAGE] = scaled | {"count": [count]}
    return stats


def _moments(values: NDArray[Any], axes: tuple[int, ...]) -> dict[str, list[Any]]:
    return {
        "min": values.min(axis=axes).tolist(),
        "max": values.max(axis=axes).tolist(),
        "mean": values.mean(axis=axes, dtype=np.float64).tolist(),
        "std": values.std(axis=axes, dtype=np.float64).tolist(),
    }


def _write_list(directory: Path, task: str, summaries: list[dict[str, Any]]) -> None:
    content = {"task": f"rodlab/{task}-v0", "episodes": summaries}
    (directory / "episodes.json").write_text(json.dumps(content, indent=2) + "\n")


def _write_lines(path: Path, rows: list[dict[str, Any]]) -> None:
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
