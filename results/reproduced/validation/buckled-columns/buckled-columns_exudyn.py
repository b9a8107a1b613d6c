"""Columns bent far beyond buckling, with ANCF cables of Exudyn.

A small force across the top, which vanishes at the end, begins the bending.
"""

import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import Force, MarkerNodePosition
from scipy.special import ellipk

ANGLES = [60, 120, 160]
NAMES = ["height of the top over L", "distance of the top over L"]
QUANTITIES = [f"α = {angle}°: {name}" for angle in ANGLES for name in NAMES]


def top(edges, angle):
    mbs = rods.system()
    nodes, _ = rods.straight(mbs, [0, 0], [0, 1], edges, 1e6)
    rods.hold(mbs, nodes[0], range(4))
    end = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    load = mbs.AddLoad(Force(markerNumber=end, loadVector=[0, 0, 0]))
    mbs.Assemble()
    size = ellipk(np.sin(np.deg2rad(angle / 2)) ** 2) ** 2
    for part in np.linspace(0, 1, 21)[1:]:
        across = 0.3 if part < 1 else 0.0
        mbs.SetLoadParameter(load, "loadVector", [across, -part * size, 0])
        rods.solve(mbs, 1)
    place = mbs.GetNodeOutput(nodes[-1], rods.POSITION)
    return [place[1], abs(place[0])]


peer.run("Exudyn", "exudyn", QUANTITIES, lambda edges: sum((top(edges, a) for a in ANGLES), []))
