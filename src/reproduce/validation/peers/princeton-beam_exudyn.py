"""The Princeton beam, with geometrically exact beams of Exudyn."""

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
)

LENGTH, HEIGHT, THICKNESS = 0.508, 0.0123777, 0.0032024
YOUNG, SHEAR = 71.7e9, 71.7e9 / 2.62
ANGLES = [30, 45, 60]
NAMES = [
    "stiff deflection, mm",
    "soft deflection, mm",
    "twist, degrees",
]
QUANTITIES = [f"{angle}°: {name}" for angle in ANGLES for name in NAMES]


def beam(edges, angle):
    mbs = rods.system()
    area, ratio = HEIGHT * THICKNESS, THICKNESS / HEIGHT
    torsion = HEIGHT * THICKNESS**3 / 3 * (1 - 0.63 * ratio * (1 - ratio**4 / 12))
    section = exudyn.BeamSection()
    # The height is along local z. Shear is as of the section.
    section.stiffnessMatrix = np.diag(
        [
            YOUNG * area,
            SHEAR * area,
            SHEAR * area,
            SHEAR * torsion,
            YOUNG * area * HEIGHT**2 / 12,
            YOUNG * area * THICKNESS**2 / 12,
        ]
    )
    section.massPerLength = 1.0
    section.inertia = 1e-4 * np.eye(3)
    nodes = [
        mbs.AddNode(NodeRigidBodyEP(referenceCoordinates=[x, 0, 0, 1, 0, 0, 0]))
        for x in np.linspace(0, LENGTH, edges + 1)
    ]
    for ends in zip(nodes, nodes[1:]):
        mbs.AddObject(
            ObjectBeamGeometricallyExact(
                nodeNumbers=list(ends), length=LENGTH / edges, sectionData=section
            )
        )
    ground = mbs.AddMarker(MarkerNodeRigid(nodeNumber=mbs.AddNode(NodePointGround())))
    start = mbs.AddMarker(MarkerNodeRigid(nodeNumber=nodes[0]))
    mbs.AddObject(GenericJoint(markerNumbers=[ground, start]))
    end = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    direction = np.deg2rad(angle)
    force = 13.345 * np.array([0, np.sin(direction), -np.cos(direction)])
    mbs.AddLoad(Force(markerNumber=end, loadVector=force))
    mbs.Assemble()
    rods.solve(mbs, 5, 1e-8)
    place = mbs.GetNodeOutput(nodes[-1], rods.POSITION)
    axes = mbs.GetNodeOutput(nodes[-1], exudyn.OutputVariableType.RotationMatrix).reshape(3, 3)
    twist = np.rad2deg(np.arctan2(axes[1, 2], axes[2, 2]))
    return -1e3 * place[2], 1e3 * place[1], twist


peer.run("Exudyn", "exudyn", QUANTITIES, lambda edges: sum((beam(edges, a) for a in ANGLES), ()))
