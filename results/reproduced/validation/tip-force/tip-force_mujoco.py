"""A cantilever bent by a force at its tip, with a flex of MuJoCo."""

import mujoco_rod as rods
import numpy as np
import peer


def tip(edges):
    points = np.outer(rods.arclengths(edges), [1, 0, 0])
    rod = rods.Rod(points, 1.0, 1.0)
    forces = np.zeros((edges - 1, 3))
    forces[-1, 2] = -10
    position = rod.relax(lambda _: forces)
    return -position[2], 1 - position[0]


peer.run("MuJoCo", "mujoco", ["deflection w/L", "shortening u/L"], tip)
