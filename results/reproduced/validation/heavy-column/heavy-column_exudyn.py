"""A column that buckles under its weight, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import peer


def weight(edges):
    mbs = rods.system()
    nodes, elements = rods.straight(mbs, [0, 0], [0, 1], edges, 1e6)
    rods.hold(mbs, nodes[0], range(4))
    loads = rods.weight(mbs, elements)
    mbs.Assemble()
    return [rods.critical_load(mbs, loads, [0, -1, 0], 4, 6.0, 9.0)]


peer.run("Exudyn", "exudyn", ["critical weight w L³/EI"], weight)
