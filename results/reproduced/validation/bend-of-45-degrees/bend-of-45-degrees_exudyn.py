"""A bend of 45° under a force across its plane, with geometrically exact beams of Exudyn."""

import exudyn
import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import (
    Force,
    GenericJoint,
    MarkerNodePosition,
    MarkerNodeRigid,
    NodePointGround,
    NodeRigidBodyEP,
    ObjectBeamGeometricallyExact,
    RotationMatrix2EulerParameters,
)


def tip(edges):
    mbs = rods.system()
    section = exudyn.BeamSection()
    bending = 1e7 / 12
    # Shear is a hundred times as stiff as of a square, so that its part is below 1e-5.
    section.stiffnessMatrix = np.diag([1e7, 5e8, 5e8, bending, bending, bending])
    section.massPerLength = 1.0
    section.inertia = np.eye(3)
    nodes = []
    for angle in np.linspace(0, np.pi / 4, edges + 1):
        sin, cos = np.sin(angle), np.cos(angle)
        axes = np.array([[sin, cos, 0], [cos, -sin, 0], [0, 0, -1]]).T
        place = [100 * (1 - cos), 100 * sin, 0, *RotationMatrix2EulerParameters(axes)]
        nodes.append(mbs.AddNode(NodeRigidBodyEP(referenceCoordinates=place)))
    for ends in zip(nodes, nodes[1:]):
        length = 25 * np.pi / edges
        mbs.AddObject(
            ObjectBeamGeometricallyExact(
                nodeNumbers=list(ends), length=length, sectionData=section
            )
        )
    ground = mbs.AddMarker(MarkerNodeRigid(nodeNumber=mbs.AddNode(NodePointGround())))
    start = mbs.AddMarker(MarkerNodeRigid(nodeNumber=nodes[0]))
    axes = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]).T
    mbs.AddObject(GenericJoint(markerNumbers=[ground, start], rotationMarker0=axes))
    marker = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    mbs.AddLoad(Force(markerNumber=marker, loadVector=[0, 0, 600]))
    mbs.Assemble()
    rods.solve(mbs, 6, 1e-8)
    return mbs.GetNodeOutput(nodes[-1], rods.POSITION)


peer.run("Exudyn", "exudyn", ["tip, x", "tip, y", "tip, z"], tip)
