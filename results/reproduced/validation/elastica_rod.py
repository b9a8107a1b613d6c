"""Rods in PyElastica: explicit steps with damping until they rest.

The stiffnesses of stretching and shear are the same, S, so that the rod bends as one without both; their
part of the displacement of the tip under a force F is F L/S, which is subtracted. Node and director of
the first element are held, as by `OneEndFixedBC`; its middle is the clamp.
"""

import elastica
import numpy as np


class Simulator(
    elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping
):
    """A rod with a clamp, loads and damping."""


class EndMoment(elastica.NoForces):
    """A moment at the last element that grows to its size within a time; in a fixed direction."""

    def __init__(self, moment, ramp):
        super().__init__()
        self.moment, self.ramp = moment, ramp

    def apply_torques(self, system, time=0.0):
        moment = self.moment * min(1.0, time / self.ramp)
        system.external_torques[:, -1] += system.director_collection[:, :, -1] @ moment


def arclengths(edges):
    """Arclengths of the nodes of a rod of length 1 that is clamped in the middle of its first edge."""
    return (np.arange(edges + 1) - 0.5) / (edges - 0.5)


def relaxed_tip(points, normals, length, bending, force=None, moment=None, stiffness=1e5, end=4.0):
    """The tip of a rod of mass 1 at rest; `normals` are the first directors of the elements.

    `stiffness` is that of stretching in units of EI/L², `end` the time in units of √(m L³/EI).
    """
    points, unit = np.asarray(points, float).T, np.sqrt(length**3 / bending)
    edges = np.diff(points)
    lengths = np.linalg.norm(edges, axis=0)
    tangents, normals = edges / lengths, np.asarray(normals, float).T
    directors = np.stack([normals, np.cross(tangents.T, normals.T).T, tangents])
    stiffness *= bending / length**2
    radius = np.sqrt(4 * bending / stiffness)
    area = np.pi * radius**2
    young = bending * 4 / (np.pi * radius**4)
    rod = elastica.CosseratRod.straight_rod(
        edges.shape[1],
        points[:, 0],
        tangents[:, 0],
        normals[:, 0],
        lengths.sum(),
        radius,
        1 / (area * lengths.sum()),
        youngs_modulus=young,
        shear_modulus=young / 2,
        position=points,
        directors=directors,
    )
    for axis in range(3):
        rod.shear_matrix[axis, axis, :] = stiffness
        rod.bend_matrix[axis, axis, :] = bending
    # The rod is at rest in its first shape.
    rod.compute_internal_forces_and_torques(0.0)
    rod.rest_kappa[:] = rod.kappa
    rod.rest_sigma[:] = rod.sigma
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    # Half of the time that a wave needs for an element or for the radius.
    step = 0.5 * min(lengths.min(), radius) / np.sqrt(stiffness * lengths.sum())
    if force is not None:
        simulator.add_forcing_to(rod).using(
            elastica.EndpointForces, np.zeros(3), np.array(force, float), ramp_up_time=unit
        )
    if moment is not None:
        simulator.add_forcing_to(rod).using(EndMoment, np.array(moment, float), unit)
    simulator.dampen(rod).using(
        elastica.AnalyticalLinearDamper, uniform_damping_constant=12 / unit, time_step=step
    )
    simulator.finalize()
    stepper, time = elastica.PositionVerlet(), 0.0
    while time < end * unit:
        time = stepper.step(simulator, time, step)
    tip = rod.position_collection[:, -1]
    return tip if force is None else tip - np.array(force) * length / stiffness
