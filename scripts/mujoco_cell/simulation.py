"""The simulation: steps, and what happens between them."""

import threading
import time

import mujoco

from .arm import Arm
from .hand_over import HandOver
from .model import compile_model

# Time between two updates of arms and cable, s.
INTERVAL = 2e-3


class Simulation:
    """Arms and a cable in MuJoCo. Hold `lock` to read or change them."""

    def __init__(self, cell):
        self.cell = cell
        self.model = compile_model(cell)
        self.data = mujoco.MjData(self.model)
        self.lock = threading.RLock()
        self.arms = [Arm(self.model, self.data, cell.chain, place) for place in cell.arms]
        self.hand_over = HandOver(self.model, self.data, cell.cable, cell.table[2])
        self.rest = threading.Event()
        self.steps = round(INTERVAL / cell.time_step)
        mujoco.mj_forward(self.model, self.data)

    def advance(self):
        """Advances by one interval."""
        with self.lock:
            for arm in self.arms:
                arm.advance()
            if not self.hand_over.advance(INTERVAL):
                self.rest.set()
            mujoco.mj_step(self.model, self.data, self.steps)
            if self.data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
                raise FloatingPointError(f"the simulation broke down at {self.data.time:.3f} s: take softer or shorter edges")

    def take(self, arm):
        """A gripper closes: the cable is handed to it. Returns the reason of a failure, or None."""
        with self.lock:
            if any(self.data.eq_active[other.hold] for other in self.arms):
                return "a gripper holds the cable already"
            refusal = self.hand_over.begin(arm.grip)
            if refusal:
                return refusal
            arm.holds(True)
            self.rest.clear()
        self.rest.wait()
        return None

    def release(self, arm):
        """A gripper opens."""
        with self.lock:
            arm.holds(False)

    def wait(self, seconds):
        """Waits until so much time has passed in the simulation."""
        until = self.data.time + seconds
        while self.data.time < until:
            time.sleep(0.002)

    def run(self, rate, each_interval):
        """Runs until stopped, at most `rate` times as fast as real time; reports the time of each interval."""
        behind = time.monotonic()
        while each_interval(self.data.time):
            self.advance()
            # A delay is not made up: the clock of the simulation waits.
            behind = max(behind + INTERVAL / rate, time.monotonic() - 0.05)
            wait = behind - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
