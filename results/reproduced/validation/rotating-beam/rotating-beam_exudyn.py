"""Extension of a beam that turns steadily, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import NodePoint2DSlope1, ObjectANCFCable2D, SensorNode

SPIN, END = 6.0, 6.0


def extension(edges):
    mbs = rods.system()
    nodes = [
        mbs.AddNode(
            NodePoint2DSlope1(
                referenceCoordinates=[x, 0, 1, 0], initialVelocities=[0, SPIN * x, 0, SPIN]
            )
        )
        for x in np.linspace(0, 10, edges + 1)
    ]
    for ends in zip(nodes, nodes[1:]):
        mbs.AddObject(
            ObjectANCFCable2D(
                length=10 / edges,
                massPerLength=1.2,
                bendingStiffness=1.4e4,
                axialStiffness=2.8e7,
                # The viscosity of the scenario, 0.1 of the elastic modulus.
                bendingDamping=1.4e3,
                axialDamping=2.8e6,
                nodeNumbers=list(ends),
            )
        )
    rods.hold(mbs, nodes[0], range(2))
    sensor = SensorNode(nodeNumber=nodes[-1], storeInternal=True, outputVariableType=rods.POSITION)
    sensor = mbs.AddSensor(sensor)
    mbs.Assemble()
    # 5 ms with 10 edges, halved with each mesh, as of the scenario.
    rods.move(mbs, END, round(END * 200 * edges / 10))
    stored = mbs.GetSensorStoredData(sensor)
    late = stored[stored[:, 0] > 5.0]
    return [1e4 * (np.hypot(late[:, 1], late[:, 2]).mean() - 10)]


peer.run("Exudyn", "exudyn", ["extension, 10⁻⁴"], extension)
