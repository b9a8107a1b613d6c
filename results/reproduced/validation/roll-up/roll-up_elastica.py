"""A cantilever rolled up by a moment at its end, in PyElastica."""

import elastica_rod as rods
import numpy as np
import peer


def tip(edges, end=8.0):
    points = np.outer(rods.arclengths(edges), [1, 0, 0])
    normals = np.tile([0.0, 0.0, 1.0], (edges, 1))
    moment = [0, 0, 2 * np.pi]
    # Without a force, the rod is not stretched at rest for any stiffness.
    position = rods.relaxed_tip(points, normals, 1.0, 1.0, moment=moment, stiffness=1e4, end=end)
    return position[:2]


quantities = ["tip along the beam, x/L", "tip across it, y/L"]
peer.run("PyElastica", "pyelastica", quantities, tip, lambda: tip(5, 1e-3))
