"""A cantilever rolled up by a moment at its end, with a flex of MuJoCo.

Points of a flex take no moments: a couple of forces turns the last edge.
"""

import mujoco_rod as rods
import numpy as np
import peer


def tip(edges):
    points = np.outer(rods.arclengths(edges), [1, 0, 0])
    rod = rods.Rod(points, 1.0, 1.0)

    def couple(nodes):
        edge = nodes[-1] - nodes[-2]
        force = 2 * np.pi * np.cross([0, 0, 1], edge) / (edge @ edge)
        forces = np.zeros_like(nodes)
        forces[-1], forces[-2] = force, -force
        return forces

    return rod.relax(couple)[:2]


peer.run("MuJoCo", "mujoco", ["tip along the beam, x/L", "tip across it, y/L"], tip)
