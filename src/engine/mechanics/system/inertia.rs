//! Inertia as a term, M/hₐ ((q − qₙ)/h − vₙ), including the masses that neighbours share
//! ([`super::mass`]), those of bodies with a centre away from their node ([`super::eccentric`]), and
//! the spin of free bodies ([`super::spin`]).

use super::build::Assembly;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::linalg::in_chunks;
use crate::mechanics::SceneError;
use crate::mechanics::scene::Scene;

/// Forces of inertia.
pub(crate) struct Inertia {
    /// Whether there are free bodies whose spin counts.
    spins: bool,
}

impl Term for Inertia {
    fn new(scene: &Scene, _: &mut Assembly) -> Result<Self, SceneError> {
        let mut bodies = scene.free_bodies.iter();
        Ok(Self {
            spins: bodies.any(|body| body.axle.is_none()),
        })
    }

    fn kind(&self) -> Kind {
        Kind::Motion
    }

    fn has_copies(&self) -> bool {
        true
    }

    /// The moments of spin have none.
    fn has_potential(&self) -> bool {
        !self.spins
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        let (Some(stage), assembly) = (at.stage, at.assembly) else {
            return;
        };
        let per_step = 1.0 / stage.step;
        let per_acceleration_step = 1.0 / stage.acceleration_step;
        in_chunks(residual, &|first, residual| {
            let [masses, now, start, velocity] =
                [&assembly.masses, at.unknowns, &stage.start, &stage.velocity]
                    .map(|all| &all[first..first + residual.len()]);
            let motion = now.iter().zip(start).zip(velocity);
            let entries = residual.iter_mut().zip(masses).zip(motion);
            for ((entry, mass), ((now, start), velocity)) in entries {
                let change = (now - start) * per_step - velocity;
                *entry += mass * per_acceleration_step * change;
            }
        });
        assembly.add_shared_inertia(stage, at.unknowns, residual);
        assembly.add_eccentric_inertia(stage, at.unknowns, residual);
        assembly.add_moments_of_spin(stage, at.unknowns, residual);
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        if let Some(stage) = at.stage {
            entries.matrix().add_masses(at.assembly, stage);
        }
    }
}
