"""A strip on edge that buckles sideways under a force at its end, by geometrically exact beams of Exudyn."""

import exudyn_rod as rods
import peer
from exudyn.utilities import Force, MarkerNodePosition


def force(edges):
    mbs = rods.system()
    nodes, _ = rods.strip(mbs, edges)
    end = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    loads = [mbs.AddLoad(Force(markerNumber=end, loadVector=[0, 0, 0]))]
    mbs.Assemble()
    return [rods.critical_load(mbs, loads, [0, 0, -1], 6, 3.0, 5.0)]


peer.run("Exudyn", "exudyn", ["critical force P L²/√(EI GJ)"], force)
