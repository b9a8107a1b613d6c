"""A cantilever bent by a force at its tip, in PyElastica."""

import elastica_rod as rods
import numpy as np
import peer


def tip(edges, end=4.0):
    points = np.outer(rods.arclengths(edges), [1, 0, 0])
    normals = np.tile([0.0, 0.0, 1.0], (edges, 1))
    position = rods.relaxed_tip(points, normals, 1.0, 1.0, force=[0, 0, -10], end=end)
    return -position[2], 1 - position[0]


peer.run(
    "PyElastica", "pyelastica", ["deflection w/L", "shortening u/L"], tip, lambda: tip(5, 1e-4)
)
