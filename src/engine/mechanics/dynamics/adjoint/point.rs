//! A point at which a residual is differentiated: the solution of a step, or its prediction if the
//! forces there set the contact stiffness.

use super::covector::{Covector, VirtualMotion};
use super::weights::HistoryWeights;
use crate::mechanics::Vector3;
use crate::mechanics::contact::Damper;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{Edge, STRIDE};
use crate::mechanics::system::{Stage, StrainLaws};

/// A point at which a simulation has evaluated its forces.
pub(super) struct Point {
    pub weights: HistoryWeights,
    /// Laws of the strains at the point.
    pub laws: StrainLaws,
    /// Moments ∂E/∂ψ on the edges, N m, one for each node.
    moments: Vec<f64>,
    /// Lengths of the edges at the start of the step, m, one for each node.
    lengths: Vec<f64>,
    /// The stage of the point, for motions other than its own.
    stage: Stage,
    at_rest: Vec<f64>,
    /// Contacts that rub.
    dampers: Vec<Damper>,
}

impl Point {
    /// The last evaluation of a simulation in a step (s), at these unknowns and with contacts that
    /// have friction.
    pub(super) fn new(
        simulation: &Simulation,
        (step, unknowns): (f64, &[f64]),
        stage: &Stage,
        dampers: Vec<Damper>,
    ) -> Self {
        let system = &simulation.system;
        let mut motion = vec![0.0; unknowns.len()];
        system.add_motion_forces(unknowns, stage, &mut motion);
        let nodes = system.assembly.rods.nodes;
        let angle = |node: usize| STRIDE * node + 3;
        let mut lengths = vec![1.0; nodes];
        for edge in &system.assembly.rods.edges {
            lengths[edge.start] = along(&simulation.state.unknowns, edge).norm();
        }
        Self {
            weights: HistoryWeights::of(simulation, step),
            laws: system.strain_laws(),
            moments: (0..nodes)
                .map(|node| system.residual[angle(node)] - motion[angle(node)])
                .collect(),
            lengths,
            stage: stage.clone(),
            at_rest: vec![0.0; unknowns.len()],
            dampers,
        }
    }

    /// Adds −(∂R/∂s)ᵀ λ to a derivative with respect to the start of the step, for a virtual
    /// motion λ with Jᵀ λ = `force`. `spins` are derivatives with respect to the spins of the
    /// frames at this point; those of λ are added to them, and the sum is transferred to the
    /// start.
    pub(super) fn pull_back(
        &mut self,
        covector: &mut Covector,
        simulation: &Simulation,
        [motion, force]: [&[f64]; 2],
        spins: &[f64],
    ) -> VirtualMotion {
        let system = &simulation.system;
        let strains = system.strains_along(motion);
        // Contribution of inertia, drag and friction, for which s is the start of the stage and
        // the velocity there.
        let mut over_start = self.motion_forces(simulation, motion, true);
        for damper in &self.dampers {
            damper.add_to_start(
                |node| position(motion, node),
                |node, force| add_to_node(&mut over_start, node, &force),
            );
        }
        let over_velocity = self.motion_forces(simulation, motion, false);
        covector.add_history(
            -1.0,
            [&self.weights.start, &self.weights.velocity],
            [&over_start, &over_velocity],
        );

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
                // Jᵀ λ without inertia and drag.
                false => spins[node] - (force[angle] + over_start[angle]),
            };
            let moved = along(motion, edge);
            let change = (tangent * moved.dot(&normal) - tangent.cross(&moved)) / cosine;
            let change = change * (self.moments[node] / frame.length);
            let change = change - source * source.dot(&change);
            let over_edge = (normal * spin + change) * (-1.0 / self.lengths[node]);
            add_to_edge(&mut covector.unknowns[0], edge, &over_edge);
            covector.spins[node] += spin;
        }

        // The strains from which the dashpots compute their rates.
        if let Some(dashpot) = &self.laws.dashpot {
            for (own, weight) in covector.strains.iter_mut().zip(self.laws.start_weights) {
                own.add_products(weight, dashpot, &strains);
            }
        }
        let motion = motion.to_vec();
        VirtualMotion { motion, strains }
    }

    /// Forces of inertia and drag if λ is the start of the stage, or the velocity there: −(∂R/∂s)ᵀ
    /// λ with the opposite sign.
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

/// Vector along an edge.
pub(super) fn along(vector: &[f64], edge: &Edge) -> Vector3 {
    position(vector, edge.end) - position(vector, edge.start)
}

/// Adds a derivative with respect to the position of a node.
fn add_to_node(vector: &mut [f64], node: usize, force: &Vector3) {
    for axis in 0..3 {
        vector[STRIDE * node + axis] += force[axis];
    }
}

/// Adds a derivative with respect to the vector of an edge to those with respect to its nodes.
pub(super) fn add_to_edge(vector: &mut [f64], edge: &Edge, force: &Vector3) {
    add_to_node(vector, edge.end, force);
    add_to_node(vector, edge.start, &-force);
}
