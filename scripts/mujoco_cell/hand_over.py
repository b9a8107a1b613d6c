"""A person who hands the end of the cable to a gripper, so that it hangs by itself."""

import math

import mujoco
import numpy as np

# How long the person holds the free end, s, and how fast swinging dies down in that time, 1/s.
HOLDING = 3.0
CALMING = 8.0
# Least height of the hand above the table over the length of the cable.
LOWEST = 0.4
UP = np.array([0.0, 0.0, 1.0])


class HandOver:
    """Hangs the cable from a gripper, a finger under its free end above the table until it is still. The end may turn and slide,
    so that nothing bends it and nothing pulls at it."""

    def __init__(self, model, data, cable, table_height):
        self.model, self.data, self.cable = model, data, cable
        self.height = table_height + cable.radius
        root = model.body("cable_B_first").jntadr[0]
        self.position = slice(model.jnt_qposadr[root], model.jnt_qposadr[root] + 3)
        self.turns = slice(self.position.stop, model.nq)
        self.velocities = slice(model.jnt_dofadr[root], model.nv)
        self.end = model.site("cable_S_last").id
        self.hand = [model.joint(name).qposadr[0] for name in ("hand_x", "hand_y")]
        self.hold = model.equality("person_holds").id
        self.is_stored = True
        self.until = None

    def begin(self, grip):
        """Hangs the cable from a site; returns the reason why it cannot hang there, or None."""
        end = self.data.site_xpos[grip].copy()
        y_axis = self.data.site_xmat[grip].reshape(3, 3)[:, 1]
        fall = end[2] - self.height
        if fall < LOWEST * self.cable.length:
            return f"the hand is {fall:.3f} m above the table: too low for a cable of {self.cable.length} m to hang from it"
        # On the table the cable comes from behind, as the hand holds it.
        ahead = np.cross(UP, y_axis)
        if np.linalg.norm(ahead) < 0.5:
            return "the y axis of the hand is not level: a cable that it held would hang in no direction"
        ahead /= np.linalg.norm(ahead)
        slack = self.cable.length - fall
        self.data.qpos[self.position] = end
        self.data.qpos[self.turns] = self.hanging(ahead, max(slack, 0.0)).ravel()
        self.data.qvel[self.velocities] = 0.0
        self.is_stored = False
        mujoco.mj_kinematics(self.model, self.data)
        self.until = self.data.time + HOLDING
        # One that does not come down to the table needs no second hand.
        if slack > 0.0:
            self.data.qpos[self.hand] = self.data.site_xpos[self.end][:2]
            self.data.eq_active[self.hold] = 1
        return None

    def hanging(self, ahead, slack):
        """Quaternions of the edges, each in the frame of the one before: straight down, then a quarter of a circle."""
        turns = np.zeros((self.cable.nodes - 1, 4))
        down = np.column_stack([-UP, np.cross(ahead, UP), -ahead])
        mujoco.mju_mat2Quat(turns[0], down.ravel())
        arc = math.pi / 2 * slack / (math.pi / 2 - 1)
        middles = (np.arange(self.cable.nodes - 1) + 0.5) * self.cable.edge
        begin = self.cable.length - arc
        angles = math.pi / 2 * np.clip((middles - begin) / max(arc, 1e-9), 0.0, 1.0)
        halves = np.diff(angles) / 2
        turns[1:, 0], turns[1:, 2] = np.cos(halves), -np.sin(halves)
        return turns

    def advance(self, interval):
        """Between two steps: whether the person still has the cable in hand."""
        if self.is_stored:
            self.data.qpos[self.position.start :] = self.model.qpos0[self.position.start :]
            self.data.qvel[self.velocities] = 0.0
        if self.until is None:
            return False
        if self.data.time < self.until:
            self.data.qvel[self.velocities] *= math.exp(-CALMING * interval)
            return True
        self.data.eq_active[self.hold] = 0
        self.until = None
        return False
