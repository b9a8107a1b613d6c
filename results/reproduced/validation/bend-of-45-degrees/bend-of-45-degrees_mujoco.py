"""A bend of 45° under a force across its plane, with a flex of MuJoCo."""

import mujoco_rod as rods
import numpy as np
import peer


def tip(edges):
    angles = np.pi / 4 * rods.arclengths(edges)
    points = 100 * np.stack([1 - np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    rod = rods.Rod(points, 25 * np.pi, 1e7 / 12)
    forces = np.zeros((edges - 1, 3))
    forces[-1, 2] = 600
    return rod.relax(lambda _: forces)


peer.run("MuJoCo", "mujoco", ["tip, x", "tip, y", "tip, z"], tip)
