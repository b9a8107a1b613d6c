"""A cantilever rolled up by a moment at its end, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import MarkerBodyRigid, Torque


def tip(edges):
    mbs = rods.system()
    nodes, elements = rods.straight(mbs, [0, 0], [1, 0], edges, 1e6)
    rods.hold(mbs, nodes[0], range(4))
    end = MarkerBodyRigid(bodyNumber=elements[-1], localPosition=[1 / edges, 0, 0])
    mbs.AddLoad(Torque(markerNumber=mbs.AddMarker(end), loadVector=[0, 0, 2 * np.pi]))
    mbs.Assemble()
    rods.solve(mbs, 20)
    return mbs.GetNodeOutput(nodes[-1], rods.POSITION)[:2]


peer.run("Exudyn", "exudyn", ["tip along the beam, x/L", "tip across it, y/L"], tip)
