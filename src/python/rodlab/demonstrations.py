"""Demonstrations of the planners, for robots that learn by imitation.

Exact plans are carried out in the environments of `rodlab.envs`, and observations, actions, rewards and pictures are recorded:

============  ==========================================================================================
task          planner
============  ==========================================================================================
CableShape    `rodlab plan deployment`: a hanging cable is laid along the target, with `control="pose"`
Folding       `rodlab plan fold`: the edge of a strip is brought to its target without pushing
============  ==========================================================================================

On the command line::

    rodlab dataset CableShape --format lerobot --count 100 --out demonstrations

Formats
-------
npz
    `episode_000000.npz` and so on, with the arrays `observations` (t + 1 rows), `actions`, `rewards`, `terminated`,
    `truncated` (t rows) and `pictures` (t + 1 × 256 × 256 × 3), and `episodes.json`, which lists task, seed, parameters,
    success and return of each.
parquet
    `episodes.parquet`: a row for each action with the observation before it; pictures are PNG in a column of structures with
    `bytes` and `path`. And `episodes.json`.
lerobot
    A data set of LeRobot's format, version 2.1. Written are `meta/info.json`, `meta/episodes.jsonl`, `meta/tasks.jsonl`,
    `meta/episodes_stats.jsonl` and `data/chunk-000/episode_000000.parquet` and so on, with the columns `observation.state`,
    `observation.images.scene` (PNG), `action`, `next.reward`, `next.done`, `next.success`, `timestamp`, `frame_index`,
    `episode_index`, `index` and `task_index`. Not written are videos, and anything of version 3.
"""

import csv
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _rodlab
from ._demonstration_files import WRITERS, Episode
from .envs import CableShape, Folding
from .envs import cable_shape, folding
from .envs.gripper import Array, rotation_vector

Format = Literal["npz", "parquet", "lerobot"]

PACE = 0.04
"""Speed of laying and of folding, m/s."""
REST = 8
"""Control steps after the end of a plan."""


@dataclass(frozen=True)
class Plan:
    """A planned motion: times in s, poses n × 4 × 4."""

    times: Array
    poses: Array

    def at(self, time: float) -> Array:
        """Return the nearest planned pose, with a position between those of its neighbours."""
        pose = np.array(self.poses[int(np.abs(self.times - time).argmin())])
        for axis in range(3):
            pose[axis, 3] = np.interp(time, self.times, self.poses[:, axis, 3])
        return pose


def demonstrations(
    task: str,
    count: int,
    out: str | Path,
    format: Format = "npz",
    *,
    seed: int = 0,
    pictures: bool = True,
    progress: bool = False,
) -> list[dict[str, Any]]:
    """Write demonstrations of a planner.

    Parameters
    ----------
    task : {"CableShape", "Folding"}
        The environment.
    count : int
        Number of episodes.
    out : path
        Directory to write to. It must be empty or not exist.
    format : {"npz", "parquet", "lerobot"}
        Format of the files. "parquet" and "lerobot" need pyarrow.
    seed : int
        Seed of the first episode, from which the others count up. A seed whose target cannot be planned is left out.
    pictures : bool
        Record a picture of the scene at each step.
    progress : bool
        Print a line for each episode on standard error.

    Returns
    -------
    list of dict
        Of each episode: `seed`, `parameters`, `success`, `return`, `steps`.

    Raises
    ------
    ValueError
        If there is no such task or format, if the directory is not empty, or if too few targets can be planned.
    ModuleNotFoundError
        If the format needs a package that is not installed.
    """
    if task not in _TASKS:
        raise ValueError(f"no demonstrations of {task}; there are those of {', '.join(_TASKS)}")
    if format not in WRITERS:
        raise ValueError(f"no such format: {format}; there are {', '.join(WRITERS)}")
    if count < 1:
        raise ValueError(f"count is {count}; it must be at least 1")
    directory = Path(out)
    if directory.exists() and any(directory.iterdir()):
        raise ValueError(f"{directory} is not empty")
    record, description = _TASKS[task]
    writer = WRITERS[format](directory, task, description)
    summaries: list[dict[str, Any]] = []
    tried = 0
    while len(summaries) < count:
        if tried >= 10 * count + 10:
            raise ValueError(f"only {len(summaries)} of {tried} targets could be planned")
        episode = record(seed + tried, pictures)
        tried += 1
        if episode is None:
            continue
        writer.write(episode)
        summary = episode.summary()
        summaries.append(summary)
        if progress:
            outcome = "success" if summary["success"] else "no success"
            about = f"seed {summary['seed']}, {summary['steps']} steps, {outcome}"
            print(f"episode {len(summaries)} of {count}: {about}", file=sys.stderr)
    writer.close()
    return summaries


def _cable_shape(seed: int, pictures: bool) -> Episode | None:
    """Lay a cable along the target of a seed; return None if no plan exists."""
    env = CableShape(control="pose")
    env.reset(seed=seed)
    values = env.parameters
    # The pattern is slightly shorter than the cable, so that the gripper can hold an end.
    pattern = 0.985 * (env.target - env.target[0]) + env.target[0]
    end = pattern[-1] - pattern[-2]
    rest = values["length"] * 0.015 * end / np.linalg.norm(end)
    target = np.vstack([pattern, pattern[-1] + rest])
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        rod = {
            "gravito_bending_length": values["bending_length"],
            "radius": values["radius"],
            "length": values["length"],
            "density": values["density"],
        }
        (directory / "rod.toml").write_text(_table("deployment.rod", rod))
        _write_points(directory / "pattern.csv", pattern)
        arguments = ["plan", "deployment", "--pattern", f"{directory}/pattern.csv", "--rod", f"{directory}/rod.toml"]
        arguments += ["--lead-in", "none", "--speed", str(PACE), "--friction", str(values["friction"])]
        try:
            _rodlab.command([*arguments, "--out", f"{directory}/plan"])
            landing = _rodlab.Scenario.load(
                f"{directory}/plan/landing.toml", [f"deployment.rod.edges={cable_shape.EDGES}"]
            )
            points = np.array(_rodlab.Simulation(landing).positions)
        except _rodlab.RodlabError:
            return None
        plan = _read_plan(directory / "plan" / "trajectory.csv")
    env.horizon = int(np.ceil(plan.times[-1] / env.period)) + REST
    options = {"parameters": values, "points": points, "target": target}
    start = plan.poses[0, :3, :3]

    def action(frame: Array, time: float) -> Array:
        gripper = env.gripper
        wanted = plan.at(time)
        shift = (wanted[:3, 3] - gripper.pose[:3, 3]) / (cable_shape.SPEED * env.period)
        turn = rotation_vector(wanted[:3, :3] @ start.T @ frame @ gripper.pose[:3, :3].T)
        return np.concatenate([shift, turn / (cable_shape.RATE * env.period)])

    return _record(env, seed, options, action, pictures)


def _folding(seed: int, pictures: bool) -> Episode | None:
    """Fold the strip of a seed; return None if no plan exists."""
    env = Folding()
    env.reset(seed=seed)
    values = env.parameters
    length = values["length"]
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        paper = {
            "length": length,
            "width": values["width"],
            "gravito_bending_length": values["bending_length"],
            "thickness": values["thickness"],
            "density": values["density"],
        }
        (directory / "paper.toml").write_text(_table("folding.paper", paper))
        arguments = ["plan", "fold", "--paper", f"{directory}/paper.toml", "--objective", "friction"]
        arguments += ["--crease", str((1.0 - values["target"]) * length), "--speed", str(PACE)]
        try:
            _rodlab.command([*arguments, "--friction", str(values["friction"]), "--out", f"{directory}/plan"])
        except _rodlab.RodlabError:
            return None
        plan = _read_plan(directory / "plan" / "trajectory.csv")
    env.horizon = int(np.ceil(plan.times[-1] / env.period)) + REST

    def action(frame: Array, time: float) -> Array:
        gripper = env.gripper
        wanted = plan.at(time)
        # The plan folds from x = 0 towards +x; the environment folds its strip from the end towards -x.
        place = np.array([length - wanted[0, 3], wanted[2, 3] + 0.5 * values["thickness"]])
        height = max(place[1], env.target[1] if time > 0.5 * plan.times[-1] else 0.0)
        shift = (np.array([place[0], height]) - gripper.pose[[0, 2], 3]) / (folding.SPEED * env.period)
        present = np.arctan2(gripper.pose[2, 2], gripper.pose[0, 2])
        angle = np.arctan2(wanted[2, 0], -wanted[0, 0])
        turn = (angle - present + np.pi) % (2.0 * np.pi) - np.pi
        return np.append(shift, turn / (folding.RATE * env.period))

    return _record(env, seed, {"parameters": values}, action, pictures)


def _record(
    env: CableShape | Folding,
    seed: int,
    options: dict[str, Any],
    action: Callable[[Array, float], Array],
    pictures: bool,
) -> Episode:
    """Carry out a plan in an environment."""
    observation, _ = env.reset(seed=seed, options=options)
    frame = np.array(env.gripper.pose[:3, :3])
    episode = Episode(seed, 1.0 / env.period, dict(env.parameters))
    episode.begin(observation, env.picture() if pictures else None)
    ended = False
    while not ended:
        wanted = action(frame, (env.steps + 1) * env.period)
        chosen = np.clip(wanted, -1.0, 1.0).astype(np.float32)
        observation, reward, terminated, truncated, info = env.step(chosen)
        ended = terminated or truncated
        picture = env.picture() if pictures else None
        episode.add(chosen, observation, reward, terminated, truncated, bool(info["success"]), picture)
    env.close()
    return episode


_TASKS: dict[str, tuple[Callable[[int, bool], Episode | None], str]] = {
    "CableShape": (_cable_shape, "Lay the cable along the curve."),
    "Folding": (_folding, "Fold the strip without sliding it."),
}


def _table(name: str, values: dict[str, float]) -> str:
    """Return a TOML table of numbers."""
    return "\n".join([f"[{name}]", *(f"{key} = {value!r}" for key, value in values.items())]) + "\n"


def _write_points(path: Path, points: Array) -> None:
    np.savetxt(path, points, delimiter=",", header="x_m,y_m", comments="")


def _read_plan(path: Path) -> Plan:
    """Read a trajectory of a gripper: times, positions and quaternions."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    poses = np.zeros((len(rows), 4, 4))
    for pose, row in zip(poses, rows, strict=True):
        w, x, y, z = (float(row[name]) for name in ("qw", "qx", "qy", "qz"))
        pose[:3, :3] = _frame(w, x, y, z)
        pose[:3, 3] = [float(row[name]) for name in ("x_m", "y_m", "z_m")]
        pose[3, 3] = 1.0
    return Plan(np.array([float(row["time_s"]) for row in rows]), poses)


def _frame(w: float, x: float, y: float, z: float) -> NDArray[np.float64]:
    """Return the rotation matrix of a unit quaternion."""
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
