"""Random calls with random arguments raise exceptions, and never crash.

``RODLAB_FUZZ_CASES`` is the number of calls.
"""

from __future__ import annotations

import os
import random
import types
from collections.abc import Callable
from typing import Any

import numpy as np
from conftest import cantilever

import rodlab

CASES = int(os.environ.get("RODLAB_FUZZ_CASES", "100000"))
CALLS_PER_SCENE = 200
NODES = 6


def argument(random: random.Random) -> Any:
    """Return a value of any kind; most are invalid for any argument."""
    finite = random.uniform(-0.01, 0.01)
    shape = tuple(random.choice([0, 1, 2, 3, 4, NODES]) for _ in range(random.randint(0, 3)))
    array = np.array(random.choices([finite, 0.0, 1.0, -1.0], k=int(np.prod(shape)))).reshape(shape)
    if random.random() < 0.1 and array.size:
        array.flat[random.randrange(array.size)] = random.choice([np.nan, np.inf, 1e300, -1e-300])
    pose = np.eye(4)
    pose[:3, 3] = [finite, -finite, finite]
    kinds: list[Any] = [
        None,
        True,
        finite,
        random.choice([0.0, -1.0, 1e-300, 1e9, float("nan"), float("inf"), -float("inf")]),
        random.choice([0, 1, 2, 5, 6, -1, 2**31, 2**63, -(2**70)]),
        random.choice(["", "beam", "beam.start", "start", "end", "5 mm", "1 s", "\x00", "é" * 50]),
        [finite] * random.randint(0, 5),
        (finite, "x", None),
        {},
        {"kind": random.choice(["straight", "points", "ring"]), "points": [[0, 0, 0]]},
        array,
        array.clip(-1e30, 1e30).astype(np.float32),
        array.astype(object),
        np.asfortranarray(array),
        array[::-1] if array.ndim else array,
        np.zeros((NODES, 3)),
        np.zeros((NODES, 2)),
        np.zeros(NODES),
        pose,
        pose[:3, 3],
        b"beam",
        object(),
        range(3),
    ]
    return random.choice(kinds)


class Caller:
    """Objects of one scene, on which random members are used."""

    def __init__(self, random: random.Random) -> None:
        self.random = random
        self.scene = cantilever(NODES - 1)
        self.scenario = self.scene.scenario
        self.simulation = self.scene.simulate(natural_curvature=True)
        self.batch = rodlab.Batch(self.scene, 2)
        self.start = self.simulation.save()
        self.state = self.start

    def targets(self) -> list[Any]:
        clamps = self.simulation.clamps
        number = self.random.randrange(len(clamps))
        return [
            self.scene,
            self.simulation,
            self.simulation._core,
            self.simulation.rods,
            self.simulation.rods["beam"],
            clamps,
            clamps[number],
            self.batch,
            self.batch._core,
            self.state,
            self.simulation.contacts,
            self.scenario,
        ]

    def call(self) -> None:
        target = self.random.choice(self.targets())
        names = [name for name in dir(type(target)) if is_tried(name)]
        name = self.random.choice(names)
        is_assigned = isinstance(getattr(type(target), name), (property, types.GetSetDescriptorType))
        if is_assigned and self.random.random() < 0.4:
            setattr(target, name, argument(self.random))
            return
        member = getattr(target, name)
        if isinstance(member, np.ndarray):
            member[self.random.choice([..., 0, -1, 99])] = argument(self.random)
        elif callable(member):
            self.use(name, member)

    def use(self, name: str, member: Callable[..., Any]) -> None:
        count = self.random.choices([0, 1, 2, 3], weights=[3, 4, 2, 1])[0]
        arguments = [argument(self.random) for _ in range(count)]
        if name in {"run", "step"} and arguments:
            arguments[0] = not_distant(arguments[0])
        if name == "step" and count > 1:
            arguments[1] = self.random.choice([-1, 0, 1, 3, "x"])
        if name == "restore" and self.random.random() < 0.5:
            arguments = [*arguments[:-1], self.state]
        result = member(*arguments)
        if isinstance(result, rodlab.State):
            self.state = result


def not_distant(time: Any) -> Any:
    """Limit a distant time: a long run is valid, but takes too much time."""
    is_number = isinstance(time, (int, float, np.number, np.ndarray)) and np.ndim(time) == 0
    is_distant = is_number and np.isfinite(float(time)) and time > 0.02
    return 0.02 if is_distant else time


def is_tried(name: str) -> bool:
    # `check` simulates a trial of up to a second.
    long = {"check", "file"}
    operators = {"__getitem__", "__setitem__", "__contains__", "__len__", "__copy__", "__repr__"}
    return name in operators or (not name.startswith("_") and name not in long)


def test_random_calls_raise_and_never_crash(tmp_path, monkeypatch) -> None:
    # `save` of a scene writes a file with a random name.
    monkeypatch.chdir(tmp_path)
    random_numbers = random.Random(20240607)
    raised = 0
    caller = Caller(random_numbers)
    for number in range(CASES):
        if number % CALLS_PER_SCENE == 0:
            caller = Caller(random_numbers)
        try:
            caller.call()
        except Exception:  # noqa: BLE001
            raised += 1
    assert 0.2 * CASES < raised < 0.95 * CASES
    caller = Caller(random_numbers)
    caller.simulation.step()
    assert np.isfinite(caller.simulation.positions).all()
