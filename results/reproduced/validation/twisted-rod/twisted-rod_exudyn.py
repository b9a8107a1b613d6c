"""A straight rod that buckles under twist, with geometrically exact beams of Exudyn."""

import exudyn
import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import NodeRigidBodyRxyz, ObjectBeamGeometricallyExact
from scipy.optimize import brentq


def twist(edges):
    mbs = rods.system()
    section = exudyn.BeamSection()
    # Stretching, two of shear, twisting, bending about y and about z.
    section.stiffnessMatrix = np.diag([1e6, 1e6, 1e6, 1.0, 1.5, 1.5])
    section.massPerLength = 1.0
    section.inertia = 1e-3 * np.eye(3)
    nodes = [
        mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[x, 0, 0, 0, 0, 0]))
        for x in np.linspace(0, 1, edges + 1)
    ]
    for ends in zip(nodes, nodes[1:]):
        mbs.AddObject(
            ObjectBeamGeometricallyExact(
                nodeNumbers=list(ends), length=1 / edges, sectionData=section
            )
        )
    rods.hold(mbs, nodes[0], range(6))
    turned = rods.hold(mbs, nodes[-1], range(6))[3]
    mbs.Assemble()

    def least_eigenvalue(angle):
        mbs.SetObjectParameter(turned, "offset", angle)
        rods.solve(mbs, 1)
        # The nodes at both ends are held.
        stiffness = mbs.ComputeLinearizedSystem()[1][6:-6, 6:-6]
        return np.linalg.eigvalsh((stiffness + stiffness.T) / 2)[0]

    return [brentq(least_eigenvalue, 11.0, 15.0, xtol=1e-8)]


peer.run("Exudyn", "exudyn", ["critical twist Θ, rad"], twist)
