"""A bend of 45° under a force across its plane, in PyElastica."""

import elastica_rod as rods
import numpy as np
import peer


def tip(edges, end=4.0):
    angles = np.pi / 4 * rods.arclengths(edges)
    points = 100 * np.stack([1 - np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    normals = np.tile([0.0, 0.0, 1.0], (edges, 1))
    return rods.relaxed_tip(points, normals, 25 * np.pi, 1e7 / 12, force=[0, 0, 600], end=end)


peer.run("PyElastica", "pyelastica", ["tip, x", "tip, y", "tip, z"], tip, lambda: tip(5, 1e-4))
