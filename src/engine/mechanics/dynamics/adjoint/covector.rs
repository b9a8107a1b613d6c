//! Derivative of a result with respect to the state.

use super::SensitivityError;
use super::weights::{MOTIONS, Weights};
use crate::mechanics::dynamics::simulation::Simulation;
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
    /// With respect to the relaxing parts q of the strains.
    pub relaxing: OfStrains,
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
            relaxing: OfStrains::zero(rods),
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
        let moments = simulation.system.forces_of_moments(&self.strains[0]);
        let mut over = vec![0.0; moments.len()];
        for unknowns in &self.unknowns {
            add(&mut over, unknowns);
        }
        let at = simulation.state.unknowns.clone();
        let force = simulation.system.gather_over(&at, &over, moments);
        let motion = solve(simulation, &at, force)?;
        let strains = simulation.system.strains_along(&at, &motion);
        Ok(VirtualMotion { motion, strains })
    }
}

impl Covector {
    /// Begins the derivative with respect to the start of a step with that with respect to its
    /// end: the state at the start of the last step becomes the present state.
    pub(super) fn begin_start(&mut self) {
        for all in [&mut self.unknowns, &mut self.velocities] {
            all.rotate_left(1);
            all[MOTIONS - 1].fill(0.0);
        }
        self.strains.rotate_left(1);
        self.strains[STRAINS - 1].clear();
    }

    /// Converts the derivative with respect to a state at which a motion was started again, as
    /// after a joint broke, to one with respect to the state before: there are no earlier steps.
    pub(super) fn before_restart(&mut self) {
        for all in [&mut self.unknowns, &mut self.velocities] {
            let [now, earlier @ ..] = all;
            for earlier in earlier {
                add(now, earlier);
                earlier.fill(0.0);
            }
        }
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

/// Solves Jᵀ λ = q̄ at `unknowns` of the last evaluation.
pub(super) fn solve(
    simulation: &mut Simulation,
    unknowns: &[f64],
    mut force: Vec<f64>,
) -> Result<Vec<f64>, SensitivityError> {
    let solved = simulation.system.solve(&mut force);
    if solved.is_err() || !force.iter().all(|entry| entry.is_finite()) {
        return Err(SensitivityError::Singular {
            time: simulation.state.time,
        });
    }
    simulation.system.spread_virtual(unknowns, &mut force);
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
