"""Frequency of a hanging chain, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import NodePoint2DSlope1, ObjectANCFCable2D, SensorNode
from scipy.special import j0, jn_zeros

END = 27.0


def frequency(edges):
    mbs = rods.system()
    nodes = [
        mbs.AddNode(
            NodePoint2DSlope1(
                referenceCoordinates=[0, -s, 0, -1], initialVelocities=[-1e-3 * s, 0, -1e-3, 0]
            )
        )
        for s in np.linspace(0, 1, edges + 1)
    ]
    elements = [
        mbs.AddObject(
            ObjectANCFCable2D(
                length=1 / edges,
                massPerLength=1.0,
                bendingStiffness=1e-8,
                axialStiffness=1e5,
                nodeNumbers=list(ends),
            )
        )
        for ends in zip(nodes, nodes[1:])
    ]
    rods.hold(mbs, nodes[0], range(2))
    for load in rods.weight(mbs, elements):
        mbs.SetLoadParameter(load, "loadVector", [0, -1, 0])
    sensors = [
        mbs.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=rods.POSITION))
        for node in nodes
    ]
    mbs.Assemble()
    # 10 ms with 25 edges, halved with each mesh, as of the scenario.
    rods.move(mbs, END, round(END * 100 * edges / 25))
    stored = np.array([mbs.GetSensorStoredData(sensor) for sensor in sensors])
    times, places = stored[0, :, 0], stored[:, :, 1]
    mode = j0(jn_zeros(0, 1)[0] * np.sqrt(1 - np.linspace(0, 1, edges + 1)))
    mode[-1] /= 2
    amplitudes = mode @ places
    before = np.nonzero(amplitudes[:-1] * amplitudes[1:] < 0)[0]
    part = amplitudes[before] / (amplitudes[before] - amplitudes[before + 1])
    crossings = times[before] + part * (times[before + 1] - times[before])
    return [np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])]


peer.run("Exudyn", "exudyn", ["frequency, √(g/L)"], frequency)
