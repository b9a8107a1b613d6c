"""The limit load of a deep arch, with ANCF cables of Exudyn and a crown that falls in steps."""

import exudyn_rod as rods
import numpy as np
import peer


def load(edges):
    mbs = rods.system()
    half = np.deg2rad(107.5)
    angles = np.linspace(-half, half, edges + 1)
    sin, cos = np.sin(angles), np.cos(angles)
    points, tangents = zip(sin, cos), zip(cos, -sin)
    nodes, _ = rods.cable(mbs, points, tangents, 2 * half / edges, 1e6, curvature=-1.0)
    rods.hold(mbs, nodes[0], range(4))
    rods.hold(mbs, nodes[-1], range(2))
    crown = rods.hold(mbs, nodes[edges // 2], [1])[0]
    mbs.Assemble()
    return rods.limit_loads(mbs, crown, 0.05)


peer.run("Exudyn", "exudyn", ["limit load P R²/EI"], load)
