"""Tests of the learning environments and the demonstrations."""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

from rodlab import _rodlab, envs  # noqa: E402
from rodlab._demonstration_files import WRITERS, Episode, encode_png  # noqa: E402
from rodlab.demonstrations import demonstrations  # noqa: E402
from rodlab.envs import cable  # noqa: E402
from rodlab.envs.gripper import Gripper, rotation, rotation_vector  # noqa: E402

SINGLES: list[type[envs.RodEnv]] = [
    envs.CantileverReach,
    envs.CableShape,
    envs.PegPlacement,
    envs.KnotState,
    envs.Folding,
    envs.FlagellumSpeed,
]
BATCHED = [single for single in SINGLES if single.batched]


def actions(env: envs.RodEnv, count: int, seed: int = 0) -> Any:
    """Return random actions, count × actions."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, *(env.action_space.shape or ()))).astype(np.float32)


def roll(env: envs.RodEnv, seed: int, count: int) -> list[bytes]:
    """Return the bytes of all results of an environment in some steps."""
    observation, info = env.reset(seed=seed)
    result = [observation.tobytes(), json.dumps(info).encode()]
    for action in actions(env, count):
        observation, reward, terminated, truncated, info = env.step(action)
        result += [observation.tobytes(), np.float64(reward).tobytes(), bytes([terminated, truncated])]
    return result


@pytest.mark.parametrize("single", SINGLES)
def test_environments_follow_the_interface(single: type[envs.RodEnv]) -> None:
    env = gymnasium.make(f"rodlab/{single.__name__}-v0", render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*different render modes.*")
        check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("single", SINGLES)
def test_same_seed_and_actions_give_the_same_bytes(single: type[envs.RodEnv]) -> None:
    assert roll(single(), 3, 4) == roll(single(), 3, 4)
    assert roll(single(), 3, 1) != roll(single(), 4, 1)


@pytest.mark.parametrize("single", SINGLES)
def test_parameters_are_within_their_ranges_and_can_be_fixed(single: type[envs.RodEnv]) -> None:
    env = single()
    _, drawn = env.reset(seed=5)
    for name, limits in single.ranges.items():
        assert limits.low <= drawn["parameters"][name] <= limits.high
    first = next(iter(single.ranges))
    middle = 0.5 * (single.ranges[first].low + single.ranges[first].high)
    _, fixed = env.reset(seed=5, options={"parameters": {first: middle}})
    assert fixed["parameters"] == drawn["parameters"] | {first: middle}
    with pytest.raises(ValueError, match="no such parameter: colour"):
        env.reset(options={"parameters": {"colour": 1.0}})
    with pytest.raises(ValueError, match="no such option: speed"):
        env.reset(options={"speed": 1.0})


@pytest.mark.parametrize("single", SINGLES)
def test_pictures_show_the_scene(single: type[envs.RodEnv]) -> None:
    env = single(render_mode="rgb_array")
    env.reset(seed=1)
    picture = env.render()
    assert picture is not None
    assert picture.shape == (256, 256, 3) and picture.dtype == np.uint8
    assert 200 < int((picture < 250).any(axis=2).sum()) < 30000
    assert single().render() is None


def test_horizon_truncates_and_bad_input_raises() -> None:
    env = envs.CantileverReach(horizon=2)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(6, np.float32))
    env.reset(seed=0)
    assert not env.step(np.zeros(6, np.float32))[3]
    assert env.step(np.zeros(6, np.float32))[3]
    with pytest.raises(ValueError, match="shape"):
        env.step(np.zeros(5, np.float32))
    with pytest.raises(ValueError, match="not finite"):
        env.step(np.full(6, np.nan, np.float32))
    with pytest.raises(ValueError, match="horizon"):
        envs.CantileverReach(horizon=0)
    with pytest.raises(ValueError, match="render_mode"):
        envs.CantileverReach(render_mode="human")


def test_an_error_of_the_engine_ends_the_episode(monkeypatch: pytest.MonkeyPatch) -> None:
    class Failing:
        """A simulation whose steps fail."""

        def __init__(self, simulation: Any) -> None:
            self._simulation = simulation

        def __getattr__(self, name: str) -> Any:
            return getattr(self._simulation, name)

        def step(self, duration: float) -> None:
            raise _rodlab.ConvergenceError("no convergence")

    env = envs.CantileverReach()
    env.reset(seed=0)
    monkeypatch.setattr(env, "_simulation", Failing(env._simulation))
    observation, reward, terminated, _, info = env.step(np.zeros(6, np.float32))
    assert terminated and reward == -env.failure_penalty and observation in env.observation_space
    assert info == {"success": False, "failure": "no convergence"}


def test_too_strong_a_pull_ends_the_episode() -> None:
    env = envs.KnotState()
    env.reset(seed=0, options={"parameters": {"force": 0.01}})
    _, reward, terminated, _, info = env.step(np.ones(2, np.float32))
    assert terminated and reward == -env.failure_penalty
    assert info["failure"] == "the task can no longer be solved" and not info["success"]


@pytest.mark.parametrize("single", BATCHED)
def test_vectors_give_the_bytes_of_single_environments(single: type[envs.RodEnv]) -> None:
    count, horizon = 3, 2
    vector = envs.make_vec(single.__name__, count, horizon=horizon)
    singles = [single(horizon=horizon) for _ in range(count)]
    observations, _ = vector.reset(seed=7)
    for case, env in enumerate(singles):
        assert observations[case].tobytes() == env.reset(seed=7 + case)[0].tobytes()
    chosen = np.stack([actions(env, 2 * horizon + 1, case) for case, env in enumerate(singles)], axis=1)
    for step, row in enumerate(chosen):
        observations, rewards, terminations, truncations, _ = vector.step(row)
        for case, env in enumerate(singles):
            if step % (horizon + 1) == horizon:
                expected = env.reset()[0], 0.0, False, False
            else:
                expected = env.step(row[case])[:4]
            assert observations[case].tobytes() == expected[0].tobytes()
            assert (rewards[case], terminations[case], truncations[case]) == expected[1:]
    vector.close()


def test_vectors_reset_in_the_same_step_or_by_a_mask() -> None:
    vector = envs.make_vec("CantileverReach", 2, horizon=1, autoreset_mode=AutoresetMode.SAME_STEP)
    vector.reset(seed=1)
    observations, _, _, truncations, infos = vector.step(np.zeros((2, 6), np.float32))
    assert truncations.all() and infos["_final_obs"].all()
    assert infos["final_obs"][0].tobytes() != observations[0].tobytes()
    assert "distance" in infos["final_info"]

    vector = envs.make_vec("CantileverReach", 2, horizon=1, autoreset_mode="Disabled")
    vector.reset(seed=1)
    kept = vector.step(np.zeros((2, 6), np.float32))[0]
    with pytest.raises(gymnasium.error.ResetNeeded):
        vector.step(np.zeros((2, 6), np.float32))
    observations, _ = vector.reset(options={"reset_mask": np.array([True, False])})
    assert observations[1].tobytes() == kept[1].tobytes()
    assert observations[0].tobytes() != kept[0].tobytes()
    with pytest.raises(ValueError, match="no such environment"):
        envs.make_vec("Juggling", 2)


def test_environments_with_reactions_are_vectorised_one_by_one() -> None:
    vector = envs.make_vec("rodlab/FlagellumSpeed-v0", 2, fluid="resistive")
    vector.reset(seed=0)
    observations, *_ = vector.step(np.zeros((2, 3), np.float32))
    assert observations.shape == (2, *(envs.FlagellumSpeed().observation_space.shape or ()))
    registered = gymnasium.make_vec("rodlab/CantileverReach-v0", num_envs=2)
    assert isinstance(registered, envs.RodVectorEnv)


def test_a_flagellum_swims_by_its_curvature() -> None:
    env = envs.FlagellumSpeed(fluid="resistive", control="curvature")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env, skip_render_check=True)
    assert roll(env, 3, 4) == roll(envs.FlagellumSpeed(fluid="resistive", control="curvature"), 3, 4)
    middle = {"target_polar": 0.0, "helix_radius": 0.008, "youngs_modulus": 5e6}

    # A wave of curvature travels along the filament, while the head does not rotate.
    env.reset(seed=1, options={"parameters": middle})
    start = env.positions.mean(axis=0)
    for step in range(40):
        phases = 2.0 * np.pi * step / 20.0 + 0.5 * np.pi * np.arange(4)
        bends = 0.9 * np.stack([np.cos(phases), np.sin(phases)], axis=1)
        observation, *_ = env.step(np.append(np.zeros(3), bends).astype(np.float32))
    assert np.array_equal(observation[-8:], (env.curvatures / 20.0).ravel().astype(np.float32))
    assert np.linalg.norm(env.positions.mean(axis=0) - start) > 1e-3
    env.reset(seed=1)
    env.step(np.ones(11, np.float32))
    assert np.allclose(env.curvatures, 5.0)
    env.reset(seed=1)
    assert not env.curvatures.any()
    with pytest.raises(ValueError, match="control"):
        envs.FlagellumSpeed(control="tail")  # type: ignore[arg-type]


def test_a_flagellum_whose_curvature_rests_moves_as_one_without() -> None:
    ends = []
    for control in ("head", "curvature"):
        env = envs.FlagellumSpeed(fluid="resistive", control=control)  # type: ignore[arg-type]
        env.reset(seed=2)
        for action in actions(envs.FlagellumSpeed(fluid="resistive"), 4):
            env.step(np.pad(action, (0, env.action_space.shape[0] - 3)))
        ends.append(env.positions)
    assert np.allclose(*ends, rtol=0.0, atol=1e-12)


def test_rotations_and_grippers() -> None:
    vector = np.array([0.3, -0.5, 0.8])
    assert np.allclose(rotation_vector(rotation(vector)), vector)
    assert np.allclose(rotation_vector(np.eye(3)), 0.0)
    gripper = Gripper(0, np.eye(4), np.full(3, -0.1), np.full(3, 0.1))
    pose = gripper.move(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, np.pi]), 0.5)
    assert np.allclose(pose[:3, 3], [0.1, 0.0, 0.0])
    assert np.allclose(pose[:3, 0], [0.0, 1.0, 0.0])


def test_curves_on_the_table() -> None:
    curve = cable.smooth_curve(0.5, [0.1, 0.2], 0.3, [1.0, -0.5], 50)
    lengths = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    assert np.allclose(lengths, 0.01) and np.allclose(curve[0], [0.1, 0.2])
    assert np.isclose(np.arctan2(*(curve[-1] - curve[-2])[::-1]), 1.3, atol=0.01)
    assert np.allclose(cable.resample(np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]]), 4)[:, 0], [0.0, 1.0, 2.0, 3.0])
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert cable.winding_number(square, np.array([0.5, 0.5])) == 1
    assert cable.winding_number(square, np.array([1.5, 0.5])) == 0


def test_cables_are_laid_as_planned(tmp_path: Path) -> None:
    (summary,) = demonstrations("CableShape", 1, tmp_path, seed=1, pictures=False)
    assert summary["success"]
    arrays = np.load(tmp_path / "episode_000000.npz")
    assert len(arrays["observations"]) == len(arrays["actions"]) + 1 == summary["steps"] + 1
    assert "pictures" not in arrays
    assert json.loads((tmp_path / "episodes.json").read_text())["episodes"] == [summary]
    with pytest.raises(ValueError, match="not empty"):
        demonstrations("CableShape", 1, tmp_path)


def test_strips_are_folded_as_planned_and_can_be_replayed(tmp_path: Path) -> None:
    (summary,) = demonstrations("Folding", 1, tmp_path, seed=1)
    assert summary["success"]
    arrays = np.load(tmp_path / "episode_000000.npz")
    env = envs.Folding(render_mode="rgb_array", horizon=1000)
    observation, _ = env.reset(seed=summary["seed"], options={"parameters": summary["parameters"]})
    for step, action in enumerate(arrays["actions"]):
        assert observation.tobytes() == arrays["observations"][step].tobytes()
        assert step % 10 or (env.render() == arrays["pictures"][step]).all()
        observation = env.step(action)[0]


def recorded(seed: int, count: int) -> Episode:
    """Return an episode of random actions."""
    env = envs.CantileverReach(horizon=count)
    observation, info = env.reset(seed=seed)
    episode = Episode(seed, 1.0 / env.period, info["parameters"])
    episode.begin(observation, env.picture())
    for action in actions(env, count):
        observation, reward, terminated, truncated, info = env.step(action)
        episode.add(action, observation, reward, terminated, truncated, info["success"], env.picture())
    return episode


def test_episodes_as_one_table(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    episodes = [recorded(0, 2), recorded(1, 3)]
    writer = WRITERS["parquet"](tmp_path, "CantileverReach", "Reach.")
    for episode in episodes:
        writer.write(episode)
    writer.close()
    table = parquet.read_table(tmp_path / "episodes.parquet")
    assert table["episode_index"].to_pylist() == [0, 0, 1, 1, 1]
    assert table["frame_index"].to_pylist() == [0, 1, 0, 1, 2]
    assert table["action"][2].as_py() == episodes[1].actions[0].tolist()
    assert len(json.loads((tmp_path / "episodes.json").read_text())["episodes"]) == 2


def test_episodes_in_the_format_of_lerobot(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    episodes = [recorded(0, 2), recorded(1, 3)]
    writer = WRITERS["lerobot"](tmp_path, "CantileverReach", "Reach the point.")
    for episode in episodes:
        writer.write(episode)
    writer.close()
    info = json.loads((tmp_path / "meta" / "info.json").read_text())
    assert (info["total_episodes"], info["total_frames"], info["fps"]) == (2, 5, 20)
    table = parquet.read_table(tmp_path / info["data_path"].format(episode_chunk=0, episode_index=1))
    assert set(table.column_names) == set(info["features"])
    assert table["index"].to_pylist() == [2, 3, 4] and table["task_index"].to_pylist() == [0, 0, 0]
    for name in ("action", "observation.state"):
        assert info["features"][name]["shape"] == [len(table[name][0])]
    assert table["action"][0].as_py() == episodes[1].actions[0].tolist()
    assert table["next.done"].to_pylist() == [False, False, True]
    assert table["observation.images.scene"][0]["bytes"].as_py() == encode_png(episodes[1].pictures[0])
    assert set(json.loads(table.schema.metadata[b"huggingface"])["info"]["features"]) == set(info["features"])
    lines = (tmp_path / "meta" / "episodes_stats.jsonl").read_text().splitlines()
    stats = json.loads(lines[1])["stats"]
    assert set(stats) == set(info["features"]) and stats["index"]["mean"] == [3.0]
    assert np.shape(stats["observation.images.scene"]["mean"]) == (3, 1, 1)
    tasks = [json.loads(line) for line in (tmp_path / "meta" / "tasks.jsonl").read_text().splitlines()]
    assert tasks == [{"task_index": 0, "task": "Reach the point."}]
    lengths = [json.loads(line)["length"] for line in (tmp_path / "meta" / "episodes.jsonl").read_text().splitlines()]
    assert lengths == [2, 3]


def test_formats_without_their_package_name_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import importlib

    def missing(name: str) -> Any:
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ModuleNotFoundError, match=r"rodlab\[datasets\]"):
        demonstrations("Folding", 1, tmp_path, "lerobot")
    with pytest.raises(ValueError, match="no such format"):
        demonstrations("Folding", 1, tmp_path, "csv")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no demonstrations of KnotState"):
        demonstrations("KnotState", 1, tmp_path)
    with pytest.raises(ValueError, match="count is 0"):
        demonstrations("Folding", 0, tmp_path)


def test_pictures_are_encoded_as_png() -> None:
    image = pytest.importorskip("PIL.Image")
    import io

    picture = np.random.default_rng(0).integers(0, 256, (5, 7, 3), dtype=np.uint8)
    assert (np.asarray(image.open(io.BytesIO(encode_png(picture)))) == picture).all()
