//! Pull-back through the end of a step of the implicit midpoint rule, which is extrapolated from
//! the solution m in its middle: q₁ = 2 m − q₀, v₁ = 2 (q₁ − q₀)/Δt − v₀. Prescribed unknowns have
//! the mean velocity (q₁ − q₀)/Δt.
//!
//! The frames of the state at the end are transported directly from those at the start, as if there
//! were no middle.

use super::covector::{Covector, add};
use super::point::{add_to_edge, along};
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;

/// The end of a step.
pub(super) struct Extrapolation {
    /// Δt, s.
    size: f64,
    /// Derivatives of the spin of each frame with respect to the vectors of its edge at the end and
    /// at the start of the step, 1/m; zero if a clamp prescribes the frame.
    spins: Vec<[Vector3; 2]>,
}

impl Extrapolation {
    /// Creates the pull-back for the step of a size (s) to `end` that a simulation has repeated.
    pub(super) fn new(simulation: &Simulation, size: f64, end: &[f64]) -> Self {
        let system = &simulation.system;
        let edges = system.assembly.rods.edges.iter();
        let spins = edges.map(|edge| {
            let edges = [end, &simulation.state.unknowns].map(|of| along(of, edge));
            let [end, start] = edges.map(|edge| edge.normalize());
            let normal = start.cross(&end) / -(1.0 + start.dot(&end));
            match system.assembly.held[STRIDE * edge.start + 3] {
                true => [Vector3::zeros(); 2],
                false => edges.map(|edge| normal / edge.norm()),
            }
        });
        Self {
            size,
            spins: spins.collect(),
        }
    }

    /// Derivatives with respect to the solution, without forces of moments on its strains and spins
    /// of its frames. The covector is then that at the start of the step, without the part of λ.
    pub(super) fn pull_back(
        &self,
        covector: &mut Covector,
        simulation: &Simulation,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let assembly = &simulation.system.assembly;
        let mut over_end = covector.unknowns[0].clone();
        let moved = covector.velocities[0].iter().zip(&assembly.held);
        let moved = moved.map(|(velocity, held)| match held {
            true => velocity / self.size,
            false => 2.0 * velocity / self.size,
        });
        let moved: Vec<f64> = moved.collect();
        add(&mut over_end, &moved);
        let edges = assembly.rods.edges.iter().zip(&self.spins);
        let spins = edges.clone().map(|(edge, _)| covector.spins[edge.start]);
        let spins: Vec<f64> = spins.collect();
        for ((edge, [at_end, _]), spin) in edges.clone().zip(&spins) {
            add_to_edge(&mut over_end, edge, &(at_end * *spin));
        }
        assembly.joints.gather_points(&mut over_end);
        let over_velocity = covector.velocities[0].clone();
        covector.begin_start();
        for k in 0..over_end.len() {
            covector.unknowns[0][k] -= over_end[k] + moved[k];
            if !assembly.held[k] {
                covector.velocities[0][k] -= over_velocity[k];
            }
        }
        for ((edge, [_, at_start]), spin) in edges.zip(&spins) {
            add_to_edge(&mut covector.unknowns[0], edge, &(at_start * *spin));
            if assembly.held[STRIDE * edge.start + 3] {
                covector.spins[edge.start] = 0.0;
            }
        }
        let over = over_end.iter().map(|over| 2.0 * over).collect();
        let nothing = vec![0.0; over_end.len()];
        (over, nothing, vec![0.0; covector.spins.len()])
    }
}
