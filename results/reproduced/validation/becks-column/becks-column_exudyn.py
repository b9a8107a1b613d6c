"""Beck's column, which flutters, with ANCF cables of Exudyn."""

import exudyn_rod as rods
import numpy as np
import peer
from exudyn.utilities import ObjectGenericODE2
from scipy.linalg import eig
from scipy.optimize import brentq


def critical(edges):
    mbs = rods.system()
    nodes, _ = rods.straight(mbs, [0, 0], [1, 0], edges, 1e6)
    force = [0.0]

    def push(mbs, time, item, displacements, velocities):
        """A force against the tangent; unlike a load, it is part of the linearised system."""
        tangent = np.array([1, 0]) + displacements[2:]
        return [*(-force[0] * tangent / np.linalg.norm(tangent)), 0, 0]

    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[nodes[-1]], forceUserFunction=push))
    # The stretching of the tangent of the clamp is free.
    rods.hold(mbs, nodes[0], [0, 1, 3])
    mbs.Assemble()
    free = [2, *range(4, 4 * len(nodes))]

    def discriminant(size):
        """The square of the difference of the two lowest eigenvalues of M⁻¹K, which flutter makes complex."""
        force[0] = size
        rods.solve(mbs, 1)
        mass, stiffness, _ = mbs.ComputeLinearizedSystem()
        values = eig(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], right=False)
        first, second = sorted(values, key=abs)[:2]
        return ((first - second) ** 2).real

    return [brentq(discriminant, 19.0, 21.0, xtol=1e-8)]


peer.run("Exudyn", "exudyn", ["critical force P L²/EI"], critical)
