"""Rods in Exudyn: planar ANCF cables, geometrically exact beams, static solutions and critical loads."""

import exudyn
import numpy as np
from exudyn.utilities import (
    CoordinateConstraint,
    Gravity,
    MarkerBodyMass,
    MarkerNodeCoordinate,
    NodePoint2DSlope1,
    NodePointGround,
    ObjectANCFCable2D,
)
from scipy.optimize import brentq, minimize_scalar

POSITION = exudyn.OutputVariableType.Position


def system():
    """An empty system; the container lives as long as the system."""
    container = exudyn.SystemContainer()
    mbs = container.AddSystem()
    mbs.variables["container"] = container
    return mbs


def cable(mbs, points, tangents, length, stretching, curvature=0.0):
    """Adds elements of cubic shape and bending stiffness 1 along points; returns nodes and elements."""
    nodes = [
        mbs.AddNode(NodePoint2DSlope1(referenceCoordinates=[*point, *tangent]))
        for point, tangent in zip(points, tangents)
    ]
    elements = [
        mbs.AddObject(
            ObjectANCFCable2D(
                length=length,
                massPerLength=1.0,
                bendingStiffness=1.0,
                axialStiffness=stretching,
                referenceCurvature=curvature,
                nodeNumbers=[start, end],
                useReducedOrderIntegration=1,
            )
        )
        for start, end in zip(nodes, nodes[1:])
    ]
    return nodes, elements


def straight(mbs, start, direction, edges, stretching):
    """Adds a straight cable of length 1."""
    start, direction = np.array(start, float), np.array(direction, float)
    points = [start + s * direction for s in np.linspace(0, 1, edges + 1)]
    return cable(mbs, points, [direction] * (edges + 1), 1 / edges, stretching)


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


def critical_weight(mbs, loads, direction, held, low, high):
    """The weight per length at which the least eigenvalue of the stiffness matrix is zero.

    `held` is the number of coordinates of the clamped node, which come first.
    """

    def least_eigenvalue(size):
        for load in loads:
            mbs.SetLoadParameter(load, "loadVector", [size * x for x in direction])
        solve(mbs, 1)
        stiffness = mbs.ComputeLinearizedSystem()[1][held:, held:]
        return np.linalg.eigvalsh((stiffness + stiffness.T) / 2)[0]

    return brentq(least_eigenvalue, low, high, xtol=1e-8)


def limit_load(mbs, constraint, step):
    """The largest force of a constraint while the coordinate that it holds falls."""

    def load(fall, load_steps):
        mbs.SetObjectParameter(constraint, "offset", -fall)
        solve(mbs, load_steps)
        force = mbs.GetObjectOutput(constraint, exudyn.OutputVariableType.Force)
        return -float(np.ravel(force)[0])

    fall, forces, states = 0.0, [0.0], [mbs.systemData.GetSystemState()]
    while len(forces) < 3 or forces[-1] > forces[-2]:
        fall += step
        forces.append(load(fall, 1))
        states.append(mbs.systemData.GetSystemState())

    def negative(fall):
        mbs.systemData.SetSystemState(states[-3], configuration=exudyn.ConfigurationType.Initial)
        mbs.systemData.SetSystemState(states[-3])
        return -load(fall, 2)

    bounds = (fall - 2 * step, fall)
    return -minimize_scalar(negative, bounds=bounds, method="bounded", options={"xatol": 1e-5}).fun
