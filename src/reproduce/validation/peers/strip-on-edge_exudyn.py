"""A strip on edge that buckles sideways under its weight, with geometrically exact beams of Exudyn."""

import exudyn
import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import NodeRigidBodyRxyz, ObjectBeamGeometricallyExact


def weight(edges):
    mbs = rods.system()
    section = exudyn.BeamSection()
    # Stretching, two of shear, twisting, bending about y (in the vertical plane) and about z.
    section.stiffnessMatrix = np.diag([1e6, 1e6, 1e6, 1.0, 1e5, 1.0])
    section.massPerLength = 1.0
    section.inertia = 1e-3 * np.eye(3)
    nodes = [
        mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[x, 0, 0, 0, 0, 0]))
        for x in np.linspace(0, 1, edges + 1)
    ]
    elements = [
        mbs.AddObject(
            ObjectBeamGeometricallyExact(
                nodeNumbers=list(ends), length=1 / edges, sectionData=section
            )
        )
        for ends in zip(nodes, nodes[1:])
    ]
    rods.hold(mbs, nodes[0], range(6))
    loads = rods.weight(mbs, elements)
    mbs.Assemble()
    return [rods.critical_weight(mbs, loads, [0, 0, -1], 6, 11.0, 15.0)]


peer.run("Exudyn", "exudyn", ["critical weight w L³/√(EI GJ)"], weight)
