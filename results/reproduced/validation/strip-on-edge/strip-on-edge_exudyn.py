"""A strip on edge that buckles sideways under its weight, with geometrically exact beams of Exudyn."""

import exudyn_rod as rods
import peer


def weight(edges):
    mbs = rods.system()
    _, elements = rods.strip(mbs, edges)
    loads = rods.weight(mbs, elements)
    mbs.Assemble()
    return [rods.critical_load(mbs, loads, [0, 0, -1], 6, 11.0, 15.0)]


peer.run("Exudyn", "exudyn", ["critical weight w L³/√(EI GJ)"], weight)
