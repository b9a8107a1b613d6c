"""Cantilevers that bend under their weight, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import peer

WEIGHTS = [1, 10, 100]
QUANTITIES = [f"height over width, Γ = {weight}" for weight in WEIGHTS]


def slope(edges, weight):
    mbs = rods.system()
    nodes, elements = rods.straight(mbs, [0, 0], [1, 0], edges, 1e7)
    rods.hold(mbs, nodes[0], range(4))
    for load in rods.weight(mbs, elements):
        mbs.SetLoadParameter(load, "loadVector", [0, -weight, 0])
    mbs.Assemble()
    rods.solve(mbs, 20)
    place = mbs.GetNodeOutput(nodes[-1], rods.POSITION)
    return -place[1] / place[0]


peer.run("Exudyn", "exudyn", QUANTITIES, lambda edges: [slope(edges, w) for w in WEIGHTS])
