//! The derivative of a result over the state, and how a step pulls it back from its end to its start.

use super::SensitivityError;
use super::weights::{HistoryWeights, MOTIONS};
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::sensitivity::Replayed;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{Edge, STRIDE};
use crate::mechanics::system::{OfStrains, Stage, StrainLaws};

/// Starts of steps whose strains count in the rates of dashpots.
const STRAINS: usize = 3;

/// Derivative of a result over the state.
#[derive(Clone, Debug)]
pub(super) struct Covector {
    /// Over the unknowns at present and at the starts of the last steps.
    pub unknowns: [Vec<f64>; MOTIONS],
    /// Over the velocities there.
    pub velocities: [Vec<f64>; MOTIONS],
    /// Over the spins ρ of the frames from which the next step transports, one for each node: the edge that starts there.
    pub spins: Vec<f64>,
    /// Over the strains at present and at the starts of the last steps, as the dashpots of later steps count them.
    strains: [OfStrains; STRAINS],
}

/// A virtual motion λ, with the strains along it.
pub(super) struct VirtualMotion {
    pub motion: Vec<f64>,
    pub strains: OfStrains,
}

impl Covector {
    pub(super) fn zero(simulation: &Simulation) -> Self {
        let of_unknowns = vec![0.0; simulation.state.unknowns.len()];
        let rods = &simulation.system.assembly.rods;
        Self {
            unknowns: std::array::from_fn(|_| of_unknowns.clone()),
            velocities: std::array::from_fn(|_| of_unknowns.clone()),
            spins: vec![0.0; rods.nodes],
            strains: std::array::from_fn(|_| OfStrains::zero(rods)),
        }
    }

    /// λ of the equilibrium at which a motion starts at rest, where a simulation is and has factored its Hessian. All motions of the
    /// last steps are the same there, and the angles count from the frames at hand.
    ///
    /// # Errors
    /// [`SensitivityError::Singular`].
    pub(super) fn settle(
        &self,
        simulation: &mut Simulation,
    ) -> Result<VirtualMotion, SensitivityError> {
        let mut force = simulation.system.forces_of_moments(&self.strains[0]);
        for unknowns in &self.unknowns {
            add(&mut force, unknowns);
        }
        let motion = solve(simulation, force)?;
        let strains = simulation.system.strains_along(&motion);
        Ok(VirtualMotion { motion, strains })
    }
}

/// A step that is repeated, to be pulled back through.
pub(super) struct StepBack {
    weights: HistoryWeights,
    /// Laws of the strains at its end.
    pub laws: StrainLaws,
    /// Moments ∂E/∂ψ on the edges, N m, one for each node.
    moments: Vec<f64>,
    /// Lengths of the edges at its start, m, one for each node.
    lengths: Vec<f64>,
    /// Its stage, for motions other than its own.
    stage: Stage,
    at_rest: Vec<f64>,
}

impl StepBack {
    /// For the step that a simulation has repeated.
    pub(super) fn new(simulation: &Simulation, replayed: &Replayed) -> Self {
        let system = &simulation.system;
        let stage = &simulation.integrator.workspace.stage;
        let mut motion = vec![0.0; replayed.solution.len()];
        system.add_motion_forces(&replayed.solution, stage, &mut motion);
        let nodes = system.assembly.rods.nodes;
        let angle = |node: usize| STRIDE * node + 3;
        let mut lengths = vec![1.0; nodes];
        for edge in &system.assembly.rods.edges {
            lengths[edge.start] = along(&simulation.state.unknowns, edge).norm();
        }
        Self {
            weights: HistoryWeights::of(simulation, replayed.step),
            laws: system.strain_laws(),
            moments: (0..nodes)
                .map(|node| system.residual[angle(node)] - motion[angle(node)])
                .collect(),
            lengths,
            stage: stage.clone(),
            at_rest: vec![0.0; replayed.solution.len()],
        }
    }

    /// Makes the derivative over the end of the step one over its start; returns λ.
    ///
    /// # Errors
    /// [`SensitivityError::Singular`].
    pub(super) fn pull_back(
        &mut self,
        covector: &mut Covector,
        simulation: &mut Simulation,
    ) -> Result<VirtualMotion, SensitivityError> {
        let step = simulation.integrator.workspace.stage.step;
        // What the end of the step has an effect on: itself, the velocity there, dashpots, and the transport of frames.
        let of_strains = simulation.system.forces_of_moments(&covector.strains[0]);
        let mut force = covector.unknowns[0].clone();
        add(&mut force, &of_strains);
        for (force, velocity) in force.iter_mut().zip(&covector.velocities[0]) {
            *force += velocity / step;
        }
        let system = &simulation.system;
        for edge in &system.assembly.rods.edges {
            let holonomy = system.geometry.edges[edge.start].holonomy;
            add_to_edge(&mut force, edge, &(holonomy * covector.spins[edge.start]));
        }
        let motion = solve(simulation, force.clone())?;
        let system = &simulation.system;
        let strains = system.strains_along(&motion);

        // −(∂R/∂s)ᵀ λ of inertia and drag, where s is the start of the stage and the velocity there.
        let over_start = self.motion_forces(simulation, &motion, true);
        let over_velocity = self.motion_forces(simulation, &motion, false);
        let mut start: Vec<f64> = over_start.iter().map(|entry| -entry).collect();
        for (start, velocity) in start.iter_mut().zip(&covector.velocities[0]) {
            *start -= velocity / step;
        }
        let velocity: Vec<f64> = over_velocity.iter().map(|entry| -entry).collect();
        covector.shift(&start, &velocity, &self.weights);

        // The frames.
        for edge in &system.assembly.rods.edges {
            let (node, angle) = (edge.start, STRIDE * edge.start + 3);
            let frame = &system.geometry.edges[node];
            let (source, tangent) = (&system.reference.tangent[node], &frame.tangent);
            let cosine = 1.0 + source.dot(tangent);
            let normal = source.cross(tangent) / cosine;
            // A clamp that holds the edge prescribes the spin of its material frame.
            let spin = match system.assembly.held[angle] {
                true => 0.0,
                // J λ = q̄ without inertia and drag.
                false => {
                    covector.spins[node] + of_strains[angle] - (force[angle] + over_start[angle])
                }
            };
            let moved = along(&motion, edge);
            let change = (tangent * moved.dot(&normal) - tangent.cross(&moved)) / cosine;
            let change = change * (self.moments[node] / frame.length);
            let change = change - source * source.dot(&change);
            let over_edge = (normal * spin + change) * (-1.0 / self.lengths[node]);
            add_to_edge(&mut covector.unknowns[0], edge, &over_edge);
            covector.spins[node] = spin;
        }

        // The strains from which dashpots count.
        covector.strains.rotate_left(1);
        covector.strains[STRAINS - 1] = OfStrains::zero(&system.assembly.rods);
        if let Some(dashpot) = &self.laws.dashpot {
            for (own, weight) in covector.strains.iter_mut().zip(self.laws.start_weights) {
                own.add_products(weight, dashpot, &strains);
            }
        }
        Ok(VirtualMotion { motion, strains })
    }

    /// Forces of inertia and drag that belong to λ as the start of the stage, or as the velocity there: −(∂R/∂s)ᵀ λ with the opposite sign.
    fn motion_forces(
        &mut self,
        simulation: &Simulation,
        motion: &[f64],
        as_start: bool,
    ) -> Vec<f64> {
        let stage = &mut self.stage;
        let (own, other) = match as_start {
            true => (&mut stage.start, &mut stage.velocity),
            false => (&mut stage.velocity, &mut stage.start),
        };
        own.copy_from_slice(motion);
        other.fill(0.0);
        let mut forces = vec![0.0; motion.len()];
        let system = &simulation.system;
        system.add_motion_forces(&self.at_rest, stage, &mut forces);
        forces
    }
}

impl Covector {
    /// The step is gone: what was at the start of the last step is at present. Adds the derivatives over the start of its stage and over
    /// the velocity there.
    fn shift(&mut self, start: &[f64], velocity: &[f64], weights: &HistoryWeights) {
        for all in [&mut self.unknowns, &mut self.velocities] {
            all.rotate_left(1);
            all[MOTIONS - 1].fill(0.0);
        }
        for index in 0..MOTIONS {
            for (of, given) in [(&weights.start, start), (&weights.velocity, velocity)] {
                add_scaled(&mut self.unknowns[index], of.unknowns[index], given);
                add_scaled(&mut self.velocities[index], of.velocities[index], given);
            }
        }
    }
}

/// Solves J λ = q̄.
fn solve(simulation: &mut Simulation, mut force: Vec<f64>) -> Result<Vec<f64>, SensitivityError> {
    let solved = simulation.system.solve(&mut force);
    if solved.is_err() || !force.iter().all(|entry| entry.is_finite()) {
        return Err(SensitivityError::Singular {
            time: simulation.state.time,
        });
    }
    Ok(force)
}

/// Vector along an edge.
fn along(vector: &[f64], edge: &Edge) -> Vector3 {
    position(vector, edge.end) - position(vector, edge.start)
}

/// Adds a derivative over the vector of an edge to those over its nodes.
fn add_to_edge(vector: &mut [f64], edge: &Edge, force: &Vector3) {
    for axis in 0..3 {
        vector[STRIDE * edge.end + axis] += force[axis];
        vector[STRIDE * edge.start + axis] -= force[axis];
    }
}

fn add(sum: &mut [f64], other: &[f64]) {
    add_scaled(sum, 1.0, other);
}

fn add_scaled(sum: &mut [f64], factor: f64, other: &[f64]) {
    if factor != 0.0 {
        let pairs = sum.iter_mut().zip(other);
        pairs.for_each(|(sum, other)| *sum += factor * other);
    }
}
