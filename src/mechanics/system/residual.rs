//! How large the residual is, how small it must become, and which term is to blame.

use super::{Stage, System, add_inertia};
use crate::mechanics::contact::ContactSystem;
use crate::mechanics::rod::STRIDE;

/// The terms of the residual, for the message that says which one diverged.
pub const TERMS: [&str; 4] = ["inertia and drag", "elastic", "external load", "contact"];

/// Last digits of the unknowns to which a residual must vanish.
const ROUNDINGS: f64 = 8.0;

impl System {
    /// Largest residual of a free unknown in N (moments divided by the shortest edge), and its unknown.
    pub fn worst_residual(&self) -> (f64, usize) {
        let mut worst = (0.0, 0);
        let per_length = 1.0 / self.assembly.shortest_edge;
        for (k, (&value, &held)) in self.residual.iter().zip(&self.assembly.held).enumerate() {
            if held {
                continue;
            }
            let size = if k % STRIDE == 3 {
                value.abs() * per_length
            } else {
                value.abs()
            };
            if size > worst.0 || size.is_nan() {
                worst = (size, k);
            }
        }
        worst
    }

    /// Sum of squares of the residual of the free unknowns, moments divided by the shortest edge, N².
    pub fn squared_residual(&self) -> f64 {
        self.square(&self.residual)
    }

    pub(super) fn square(&self, residual: &[f64]) -> f64 {
        let weights = [1.0, 1.0, 1.0, 1.0 / self.assembly.shortest_edge];
        let mut sums = [0.0; STRIDE];
        let held = self.assembly.held.chunks_exact(STRIDE);
        for (values, held) in residual.chunks_exact(STRIDE).zip(held) {
            for k in 0..STRIDE {
                let value = if held[k] { 0.0 } else { weights[k] * values[k] };
                sums[k] += value * value;
            }
        }
        sums.iter().sum()
    }

    /// Name of the term that is largest at one unknown.
    pub fn largest_term(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
        unknown: usize,
    ) -> &'static str {
        let total = self.residual[unknown];
        let mut elastic = vec![0.0; self.residual.len()];
        self.update_geometry(unknowns);
        self.assembly
            .rods
            .add_gradient(&self.geometry, &mut elastic);
        let mut inertia = vec![0.0; self.residual.len()];
        if let Some(stage) = stage {
            add_inertia(&self.assembly, &self.loads, stage, unknowns, &mut inertia);
        }
        let load = -self.dead_forces[unknown];
        let known = [inertia[unknown], elastic[unknown], load];
        // One term that is not a number leaves no other to blame.
        if let Some(term) = known.iter().position(|term| !term.is_finite()) {
            return TERMS[term];
        }
        let sizes = known.into_iter().chain(
            self.contact
                .is_some()
                .then(|| total - known.iter().sum::<f64>()),
        );
        let largest = sizes
            .enumerate()
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        TERMS[largest.map_or(0, |(term, _)| term)]
    }

    /// Tolerance for the residual: `relative` times the largest of EI/L², the loads and the contact forces
    /// of the last step, but no less than what rounding of the unknowns leaves in elastic forces and, in a time
    /// step, in inertia, N.
    pub fn force_tolerance(&self, relative: f64, unknowns: &[f64], stage: Option<&Stage>) -> f64 {
        let largest_load = self
            .dead_forces
            .iter()
            .fold(0.0_f64, |largest, f| largest.max(f.abs()));
        let largest_contact = self
            .contact
            .as_ref()
            .map_or(0.0, ContactSystem::largest_normal_force);
        let scale = self
            .assembly
            .force_scale
            .max(largest_load)
            .max(largest_contact);
        let positions = unknowns.iter().enumerate().filter(|(k, _)| k % STRIDE != 3);
        let farthest = positions.fold(0.0_f64, |farthest, (_, x)| farthest.max(x.abs()));
        let inertia = stage.map_or(0.0, |stage| self.inertia_rounding(unknowns, stage));
        (relative * scale)
            .max(ROUNDINGS * self.assembly.rounding_stiffness * farthest)
            .max(ROUNDINGS * inertia)
    }

    /// Change of the inertial force M q/(h hₐ) with the last digit of an unknown q, the largest of all that are free, N
    /// (moments divided by the shortest edge).
    fn inertia_rounding(&self, unknowns: &[f64], stage: &Stage) -> f64 {
        let per_length = 1.0 / self.assembly.shortest_edge;
        let weights = [1.0, 1.0, 1.0, per_length];
        let mut largest = 0.0_f64;
        for (k, (value, mass)) in unknowns.iter().zip(&self.assembly.masses).enumerate() {
            if !self.assembly.held[k] {
                largest = largest.max(weights[k % STRIDE] * mass * value.abs());
            }
        }
        largest * f64::EPSILON / (stage.step * stage.acceleration_step)
    }
}
