//! Derivative of a result with respect to the state.

use super::SensitivityError;
use super::weights::{HistoryWeights, MOTIONS, Weights};
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::OfStrains;

/// Number of starts of steps whose strains enter the rates of dashpots.
const STRAINS: usize = 3;

/// Derivative of a result with respect to the state.
#[derive(Clone, Debug)]
pub(super) struct Covector {
    /// With respect to the unknowns at present and at the starts of the last steps.
    pub unknowns: [Vec<f64>; MOTIONS],
    /// With respect to the velocities at these times.
    pub velocities: [Vec<f64>; MOTIONS],
    /// With respect to the spins ρ of the frames from which the next step transports, one for each
    /// node: that of the edge that starts there.
    pub spins: Vec<f64>,
    /// With respect to the strains at present and at the starts of the last steps, as used by the
    /// dashpots of later steps.
    pub strains: [OfStrains; STRAINS],
    /// With respect to the contact stiffness k.
    pub stiffness: f64,
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
            stiffness: 0.0,
        }
    }

    /// λ of the equilibrium at which a motion starts at rest. The simulation must be at this
    /// equilibrium and have factored its Hessian. The states of all previous steps are the same
    /// there, and the angles are measured from the present frames.
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

impl Covector {
    /// Starts the derivative with respect to the start of a step (s) from that with respect to its
    /// end: the state at the start of the last step becomes the present state. Returns the
    /// derivatives with respect to the spins of the frames at the end of the step.
    pub(super) fn begin_start(
        &mut self,
        of_strains: &[f64],
        step: f64,
        weights: &HistoryWeights,
    ) -> Vec<f64> {
        let over_start = self.velocities[0].iter().map(|velocity| -velocity / step);
        let over_start: Vec<f64> = over_start.collect();
        for all in [&mut self.unknowns, &mut self.velocities] {
            all.rotate_left(1);
            all[MOTIONS - 1].fill(0.0);
        }
        self.add_history(1.0, [&weights.start], [&over_start]);
        self.strains.rotate_left(1);
        self.strains[STRAINS - 1].clear();
        let spins = self.spins.iter_mut().enumerate();
        spins
            .map(|(node, spin)| std::mem::take(spin) + of_strains[STRIDE * node + 3])
            .collect()
    }

    /// Adds a factor times derivatives with respect to the quantities that a scheme computes from
    /// the last steps.
    pub(super) fn add_history<const N: usize>(
        &mut self,
        factor: f64,
        weights: [&Weights; N],
        given: [&[f64]; N],
    ) {
        for index in 0..MOTIONS {
            for (of, given) in weights.iter().zip(given) {
                add_scaled(
                    &mut self.unknowns[index],
                    factor * of.unknowns[index],
                    given,
                );
                add_scaled(
                    &mut self.velocities[index],
                    factor * of.velocities[index],
                    given,
                );
            }
        }
    }
}

/// Solves Jᵀ λ = q̄.
pub(super) fn solve(
    simulation: &mut Simulation,
    mut force: Vec<f64>,
) -> Result<Vec<f64>, SensitivityError> {
    let solved = simulation.system.solve(&mut force);
    if solved.is_err() || !force.iter().all(|entry| entry.is_finite()) {
        return Err(SensitivityError::Singular {
            time: simulation.state.time,
        });
    }
    Ok(force)
}

pub(super) fn add(sum: &mut [f64], other: &[f64]) {
    add_scaled(sum, 1.0, other);
}

fn add_scaled(sum: &mut [f64], factor: f64, other: &[f64]) {
    if factor != 0.0 {
        let pairs = sum.iter_mut().zip(other);
        pairs.for_each(|(sum, other)| *sum += factor * other);
    }
}
