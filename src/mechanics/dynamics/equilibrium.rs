//! Equilibria of a simulation.

use super::Simulation;
use super::failure::no_equilibrium;
use super::integrator::{STIFFENING, report_contacts};
use super::report::{SimulationError, StepReport};
use super::simulation::ONLY_EULER;
use crate::mechanics::statics::{Descent, nearby_equilibrium};
use crate::mechanics::system::name_overlap;
use crate::mechanics::{Overlap, SceneError};
use tracing::debug;

/// Times that contact is made stiffer, where rods penetrate, before that is an error.
const STIFFENINGS: usize = 8;

const NO_ENERGY: SceneError =
    SceneError::Unsuitable("with friction an equilibrium has no energy whose least it could be");

impl Simulation {
    /// Finds the equilibrium at the present time where the scene would come to rest: Newton's method without
    /// inertia, and without friction.
    ///
    /// # Errors
    /// [`SimulationError::NoEquilibrium`], [`SimulationError::Unphysical`] where rods penetrate however stiff their
    /// contact, and [`SimulationError::BadScene`] with rigid contact, which gives forces to time steps only.
    pub fn find_equilibrium(&mut self) -> Result<StepReport, SimulationError> {
        let found = self.find_equilibrium_while(&|| true)?;
        Ok(found.expect("it is never stopped"))
    }

    /// The same, as long as `goes_on`, which is called at every iteration, returns true; `None` where it did not. The
    /// state is then as before.
    ///
    /// # Errors
    /// Those of [`Self::find_equilibrium`].
    pub fn find_equilibrium_while(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        if self.system.has_constraints() {
            return Err(ONLY_EULER.into());
        }
        let mut report = StepReport {
            time: self.state.time,
            ..StepReport::default()
        };
        let before = self.system.reference.clone();
        let mut descent = Descent::new(self.state.unknowns.len());
        let mut trial = self.state.unknowns.clone();
        for stiffening in 0..=STIFFENINGS {
            let tolerance = self.integrator.setting.parameters.force_tolerance;
            let run = descent.run(&mut self.system, &mut trial, tolerance, goes_on);
            match run {
                Err(divergence) => {
                    return Err(no_equilibrium(&mut self.system, &trial, &divergence));
                }
                Ok(None) => {
                    self.system.reference = before;
                    self.system.update_geometry(&self.state.unknowns);
                    return Ok(None);
                }
                Ok(Some(iterations)) => report.newton_iterations += iterations,
            }
            let Some(overlap) = self.penetration() else {
                break;
            };
            if stiffening == STIFFENINGS {
                return Err(SimulationError::Unphysical(overlap.to_string()));
            }
            report.retries += 1;
            self.system.adapt_contact_stiffness(&trial, None);
            self.system.stiffen_contact(STIFFENING, None);
        }
        self.rest_at(&trial);
        self.validity
            .check_strains(&self.system, &trial, self.state.time);
        report_contacts(&self.system, &mut report);
        debug!(
            time = report.time,
            iterations = report.newton_iterations,
            contacts = report.contacts,
            "equilibrium found"
        );
        Ok(Some(report))
    }

    /// Goes to the nearest equilibrium at the present time, which need not be stable; returns the number of
    /// directions in which its energy falls: 0 where it is stable.
    ///
    /// # Errors
    /// [`SimulationError::NoEquilibrium`], and [`SimulationError::BadScene`] with rigid contact or friction,
    /// where forces have no energy.
    pub fn find_nearby_equilibrium(&mut self) -> Result<usize, SimulationError> {
        if self.system.has_constraints() {
            return Err(ONLY_EULER.into());
        }
        let tolerance = self.integrator.setting.parameters.force_tolerance;
        let mut trial = self.state.unknowns.clone();
        let inertia = nearby_equilibrium(&mut self.system, &mut trial, tolerance)
            .map_err(|divergence| no_equilibrium(&mut self.system, &trial, &divergence))?
            .ok_or(NO_ENERGY)?;
        self.rest_at(&trial);
        Ok(inertia.negative)
    }

    /// Takes over an equilibrium.
    fn rest_at(&mut self, unknowns: &[f64]) {
        self.state.rest_at(unknowns);
        self.publish();
    }

    /// Rods that penetrate beyond what is allowed in the last evaluation.
    fn penetration(&self) -> Option<Overlap> {
        let contact = self.system.contact.as_ref()?;
        let overlap = contact.excessive_penetration()?;
        Some(name_overlap(&overlap, contact, &self.system.assembly))
    }
}
