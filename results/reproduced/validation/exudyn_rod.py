"""Rods in Exudyn: planar ANCF cables, geometrically exact beams, static solutions and critical loads."""

import exudyn
import numpy as np
from exudyn.utilities import (
    CoordinateConstraint,
    GenericJoint,
    Gravity,
    MarkerBodyMass,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    NodePoint2DSlope1,
    NodePointGround,
    NodeRigidBodyRxyz,
    ObjectANCFCable2D,
    ObjectBeamGeometricallyExact,
    RotationMatrixZ,
)
from scipy.optimize import brentq, minimize_scalar

POSITION = exudyn.OutputVariableType.Position


def system():
    """An empty system; the container lives as long as the system."""
    container = exudyn.SystemContainer()
    mbs = container.AddSystem()
    mbs.variables["container"] = container
    return mbs


def cable(mbs, points, tangents, length, stretching, curvature=0.0, bending=1.0):
    """Adds elements of cubic shape and unit mass per length along points; returns nodes and elements."""
    nodes = [
        mbs.AddNode(NodePoint2DSlope1(referenceCoordinates=[*point, *tangent]))
        for point, tangent in zip(points, tangents)
    ]
    elements = [
        mbs.AddObject(
            ObjectANCFCable2D(
                length=length,
                massPerLength=1.0,
                bendingStiffness=bending,
                axialStiffness=stretching,
                referenceCurvature=curvature,
                nodeNumbers=[start, end],
                useReducedOrderIntegration=1,
            )
        )
        for start, end in zip(nodes, nodes[1:])
    ]
    return nodes, elements


def straight(mbs, start, direction, edges, stretching, length=1.0, bending=1.0):
    """Adds a straight cable along a unit vector."""
    start, direction = np.array(start, float), np.array(direction, float)
    points = [start + s * direction for s in np.linspace(0, length, edges + 1)]
    tangents = [direction] * (edges + 1)
    return cable(mbs, points, tangents, length / edges, stretching, bending=bending)


def strip(mbs, edges):
    """Adds a strip on edge along x, clamped at its start, stiff in the plane of x and z."""
    section = exudyn.BeamSection()
    # Stretching, two of shear, twisting, bending about y and about z.
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
    hold(mbs, nodes[0], range(6))
    return nodes, elements


def hold(mbs, node, coordinates):
    """Holds coordinates of a node at their reference values; returns the constraints."""
    ground = mbs.AddNode(NodePointGround())
    fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    markers = [
        mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        for coordinate in coordinates
    ]
    return [mbs.AddObject(CoordinateConstraint(markerNumbers=[fixed, marker])) for marker in markers]


def solve(mbs, load_steps, tolerance=1e-9):
    """Solves the static equations by Newton's method, with loads that grow in steps."""
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.staticSolver.verboseMode = 0
    settings.staticSolver.numberOfLoadSteps = load_steps
    settings.staticSolver.newton.relativeTolerance = tolerance
    settings.staticSolver.newton.absoluteTolerance = 1e-6
    mbs.SolveStatic(settings, updateInitialValues=True)


def weight(mbs, elements):
    """Adds a weight to each element; returns the loads."""
    markers = [mbs.AddMarker(MarkerBodyMass(bodyNumber=element)) for element in elements]
    return [mbs.AddLoad(Gravity(markerNumber=marker, loadVector=[0, 0, 0])) for marker in markers]


def critical_load(mbs, loads, direction, held, low, high):
    """The size of loads at which the least eigenvalue of the stiffness matrix is zero.

    `held` is the number of coordinates of the clamped node, which come first.
    """

    def least_eigenvalue(size):
        for load in loads:
            mbs.SetLoadParameter(load, "loadVector", [size * x for x in direction])
        solve(mbs, 1)
        stiffness = mbs.ComputeLinearizedSystem()[1][held:, held:]
        return np.linalg.eigvalsh((stiffness + stiffness.T) / 2)[0]

    return brentq(least_eigenvalue, low, high, xtol=1e-8)


def join(mbs, before, length, after, angle):
    """Joins the end of an element of a length rigidly to the start of another one.

    `angle` is that from the direction of the second element to the direction of the first.
    """
    ends = [
        mbs.AddMarker(MarkerBodyRigid(bodyNumber=before, localPosition=[length, 0, 0])),
        mbs.AddMarker(MarkerBodyRigid(bodyNumber=after, localPosition=[0, 0, 0])),
    ]
    axes = [1, 1, 0, 0, 0, 1]
    turn = RotationMatrixZ(angle)
    mbs.AddObject(GenericJoint(markerNumbers=ends, constrainedAxes=axes, rotationMarker1=turn))


def limit_loads(mbs, constraint, step, count=1):
    """The first maximum, minimum, ... of the force of a constraint while its coordinate falls."""
    state = mbs.systemData.GetSystemState

    def load(fall, load_steps):
        mbs.SetObjectParameter(constraint, "offset", -fall)
        solve(mbs, load_steps)
        force = mbs.GetObjectOutput(constraint, exudyn.OutputVariableType.Force)
        return -float(np.ravel(force)[0])

    def begin_at(start):
        mbs.systemData.SetSystemState(start, configuration=exudyn.ConfigurationType.Initial)
        mbs.systemData.SetSystemState(start)

    fall, forces, states, found, sign = 0.0, [0.0], [state()], [], 1
    while len(found) < count:
        fall += step
        forces.append(load(fall, 1))
        states.append(state())
        if len(forces) > 2 and sign * forces[-1] < sign * forces[-2]:
            start = states[-3]

            def negative(fall):
                begin_at(start)
                return -sign * load(fall, 2)

            bounds = (fall - 2 * step, fall)
            least = minimize_scalar(negative, bounds=bounds, method="bounded", options={"xatol": 1e-5})
            found.append(-sign * least.fun)
            sign = -sign
            begin_at(states[-1])
    return found


def move(mbs, end, steps):
    """Advances by the generalized-α method, of second order, with little damping of fast vibration."""
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.endTime = end
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
    settings.timeIntegration.newton.relativeTolerance = 1e-6
    mbs.SolveDynamic(settings)
