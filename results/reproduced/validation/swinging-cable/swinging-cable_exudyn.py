"""A cable released from the horizontal, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import peer


def end(edges):
    mbs = rods.system()
    nodes, elements = rods.straight(mbs, [0, 0], [1, 0], edges, 1e6, bending=0.01)
    rods.hold(mbs, nodes[0], range(2))
    for load in rods.weight(mbs, elements):
        mbs.SetLoadParameter(load, "loadVector", [0, -1, 0])
    mbs.Assemble()
    # 5 ms with 20 edges, halved with each mesh, as of the scenario.
    rods.move(mbs, 2.5, 25 * edges)
    return mbs.GetNodeOutput(nodes[-1], rods.POSITION)[:2]


peer.run("Exudyn", "exudyn", ["end, x/L", "end, z/L"], end)
