"""A rod thrown by a force and a moment, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import peer
from exudyn.utilities import Force, MarkerBodyRigid, MarkerNodePosition, Torque

QUANTITIES = ["lower end, x", "lower end, z", "upper end, x", "upper end, z", "centre of mass, x"]


def part(time):
    return max(0.0, min(time, 5 - time) / 2.5)


def ends(edges):
    mbs = rods.system()
    nodes, elements = rods.straight(
        mbs, [6, 0], [-0.6, 0.8], edges, 1e8, length=10.0, bending=500.0
    )
    start = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[0]))
    mbs.AddLoad(
        Force(
            markerNumber=start,
            loadVector=[8, 0, 0],
            loadVectorUserFunction=lambda _, time, force: [part(time) * x for x in force],
        )
    )
    # A positive moment about y turns from z towards x, here clockwise.
    turned = mbs.AddMarker(MarkerBodyRigid(bodyNumber=elements[0], localPosition=[0, 0, 0]))
    mbs.AddLoad(
        Torque(
            markerNumber=turned,
            loadVector=[0, 0, -80],
            loadVectorUserFunction=lambda _, time, moment: [part(time) * x for x in moment],
        )
    )
    mbs.Assemble()
    # 5 ms with 20 edges, halved with each mesh, as of the scenario.
    rods.move(mbs, 6.0, 60 * edges)
    low, high = (mbs.GetNodeOutput(node, rods.POSITION) for node in (nodes[0], nodes[-1]))
    middles = [
        mbs.GetObjectOutputBody(element, rods.POSITION, [5 / edges, 0, 0])[0]
        for element in elements
    ]
    # Simpson's rule, exact for cubic elements.
    knots = [mbs.GetNodeOutput(node, rods.POSITION)[0] for node in nodes]
    centre = sum(a + 4 * b + c for a, b, c in zip(knots, middles, knots[1:])) / 6 / edges
    return [*low[:2], *high[:2], centre]


peer.run("Exudyn", "exudyn", QUANTITIES, ends)
