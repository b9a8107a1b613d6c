//! A point at which a residual is differentiated: the solution of a step, or its prediction if the
//! forces there set the contact stiffness.

use super::covector::{Covector, VirtualMotion};
use super::weights::HistoryWeights;
use crate::mechanics::Vector3;
use crate::mechanics::contact::FromStart;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::topology::{add_to_node, position};
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
    /// Unknowns there.
    unknowns: Vec<f64>,
    /// Velocities relative to a fluid, m/s.
    velocities: Vec<Vector3>,
    /// The stage of the point.
    solved: Stage,
    /// The same for motions other than its own.
    stage: Stage,
    at_rest: Vec<f64>,
    /// Contacts that depend on the start of the step.
    contacts: Vec<FromStart>,
}

impl Point {
    /// The last evaluation of a simulation in a step (s), at these unknowns and with contacts that
    /// depend on the start of the step.
    pub(super) fn new(
        simulation: &Simulation,
        (step, unknowns): (f64, &[f64]),
        stage: &Stage,
        contacts: Vec<FromStart>,
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
            unknowns: unknowns.to_vec(),
            velocities: (simulation.integrator.fluid).velocities_in(stage, unknowns),
            solved: stage.clone(),
            stage: stage.without_drag(),
            at_rest: vec![0.0; unknowns.len()],
            contacts,
        }
    }

    /// Adds −(∂R/∂s)ᵀ λ to a derivative with respect to the start of the step, for a virtual
    /// motion λ with Jᵀ λ = `force`. `spins` are derivatives with respect to the spins of the
    /// frames at this point; those of λ are added to them, and the sum is transferred to the
    /// start.
    pub(super) fn pull_back(
        &mut self,
        covector: &mut Covector,
        simulation: &mut Simulation,
        [motion, force]: [&[f64]; 2],
        spins: &[f64],
    ) -> VirtualMotion {
        self.pull_back_drag(covector, simulation, motion);
        let system = &simulation.system;
        let strains = system.strains_along(&self.unknowns, motion);
        // Contribution of inertia, drag and friction, for which s is the start of the stage and
        // the velocity there.
        let mut over_start = self.motion_forces(simulation, motion, true);
        for contact in &self.contacts {
            contact.add_to_start(
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
        // The strains and relaxing parts from which these relax.
        if let Some(laws) = &self.laws.relaxation {
            let [of_change, of_start] = &laws.forces;
            covector.strains[0].add_products(1.0, of_change, &strains);
            covector.relaxing.add_products(-1.0, of_start, &strains);
        }
        let motion = motion.to_vec();
        VirtualMotion { motion, strains }
    }

    /// Adds −(∂R/∂s)ᵀ λ of the local resistance of a fluid, which is that of the places at the
    /// start or at the prediction.
    fn pull_back_drag(&self, covector: &mut Covector, simulation: &mut Simulation, motion: &[f64]) {
        let rules = simulation.rules();
        let fluid = &mut simulation.integrator.fluid;
        let Some(mut over) = fluid.over_places(&self.velocities, &self.stage.resistance, motion)
        else {
            return;
        };
        if !rules.predicts_drag() {
            let pairs = covector.unknowns[0].iter_mut().zip(&over);
            pairs.for_each(|(sum, over)| *sum -= over);
            return;
        }
        let prediction = &simulation.integrator.workspace.prediction;
        let system = &simulation.system;
        system.gather_places(prediction, &mut over);
        let entries = over.iter_mut().zip(&system.assembly.held);
        entries.for_each(|(entry, held)| *entry *= f64::from(!held));
        covector.add_history(-1.0, [&self.weights.prediction], [&over]);
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
        let changes = [&stage.start[..], &stage.velocity];
        system.add_start_forces(&self.unknowns, &self.solved, changes, &mut forces);
        forces
    }
}

/// Vector along an edge.
pub(super) fn along(vector: &[f64], edge: &Edge) -> Vector3 {
    position(vector, edge.end) - position(vector, edge.start)
}

/// Adds a derivative with respect to the vector of an edge to those with respect to its nodes.
pub(super) fn add_to_edge(vector: &mut [f64], edge: &Edge, force: &Vector3) {
    add_to_node(vector, edge.end, force);
    add_to_node(vector, edge.start, &-force);
}
