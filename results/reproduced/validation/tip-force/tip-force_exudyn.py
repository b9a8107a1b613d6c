"""A cantilever bent by a force at its tip, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import peer
from exudyn.utilities import Force, MarkerNodePosition


def tip(edges):
    mbs = rods.system()
    nodes, _ = rods.straight(mbs, [0, 0], [1, 0], edges, 1e5)
    rods.hold(mbs, nodes[0], range(4))
    marker = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    mbs.AddLoad(Force(markerNumber=marker, loadVector=[0, -10, 0]))
    mbs.Assemble()
    rods.solve(mbs, 10)
    position = mbs.GetNodeOutput(nodes[-1], rods.POSITION)
    return -position[1], 1 - position[0]


peer.run("Exudyn", "exudyn", ["deflection w/L", "shortening u/L"], tip)
