//! Equilibria of a simulation.

use super::Simulation;
use super::report::{SimulationError, StepReport};
use super::simulation::ONLY_EULER;
use crate::mechanics::statics::{Descent, nearby_equilibrium};
use crate::mechanics::system::describe_overlap;

/// Times that contact is made stiffer, where rods penetrate, before that is an error.
const STIFFENINGS: usize = 8;

const NO_ENERGY: &str = "with friction an equilibrium has no energy whose least it could be";

impl Simulation {
    /// Finds the equilibrium at the present time where the scene would come to rest: Newton's method without
    /// inertia, and without friction.
    ///
    /// # Errors
    /// [`SimulationError::NoEquilibrium`], [`SimulationError::Unphysical`] where rods penetrate however stiff their
    /// contact, and [`SimulationError::BadScene`] with rigid contact, which gives forces to time steps only.
    pub fn find_equilibrium(&mut self) -> Result<StepReport, SimulationError> {
        let found = self.find_equilibrium_while(&|| true)?;
        Ok(found.expect("nobody stops it"))
    }

    /// The same, as long as `goes_on`, which is asked at every iteration; `None` where it said no. The state is
    /// then as before.
    ///
    /// # Errors
    /// Those of [`Self::find_equilibrium`].
    pub fn find_equilibrium_while(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        if self.system.has_constraints() {
            return Err(SimulationError::BadScene(ONLY_EULER.into()));
        }
        let mut report = StepReport {
            time: self.time,
            ..StepReport::default()
        };
        let before = self.system.reference.clone();
        let mut descent = Descent::new(self.unknowns.len());
        self.trial.copy_from_slice(&self.unknowns);
        for stiffening in 0..=STIFFENINGS {
            let tolerance = self.parameters.force_tolerance;
            let force = self.system.force_tolerance(tolerance, &self.trial, None);
            let run = descent.run(&mut self.system, &mut self.trial, force, goes_on);
            match run {
                Err(divergence) => return Err(self.no_equilibrium(&divergence)),
                Ok(None) => {
                    self.system.reference = before;
                    self.system.update_geometry(&self.unknowns);
                    return Ok(None);
                }
                Ok(Some(iterations)) => report.newton_iterations += iterations,
            }
            let Some(what) = self.penetration() else {
                break;
            };
            if stiffening == STIFFENINGS {
                return Err(SimulationError::Unphysical(what));
            }
            report.retries += 1;
            self.system.adapt_contact_stiffness(&self.trial, None);
            self.stiffen_contact();
        }
        self.rest();
        self.report_contacts(&mut report);
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
            return Err(SimulationError::BadScene(ONLY_EULER.into()));
        }
        let force =
            self.system
                .force_tolerance(self.parameters.force_tolerance, &self.unknowns, None);
        self.trial.copy_from_slice(&self.unknowns);
        let inertia = nearby_equilibrium(&mut self.system, &mut self.trial, force)
            .map_err(|divergence| self.no_equilibrium(&divergence))?
            .ok_or_else(|| SimulationError::BadScene(NO_ENERGY.into()))?;
        self.rest();
        Ok(inertia.negative)
    }

    /// Takes over the trial, at rest.
    fn rest(&mut self) {
        self.unknowns.copy_from_slice(&self.trial);
        self.velocity.fill(0.0);
        self.history.forget();
        self.publish();
    }

    /// Names the rods that penetrate beyond what is allowed in the last evaluation.
    fn penetration(&self) -> Option<String> {
        let contact = self.system.contact.as_ref()?;
        let overlap = contact.excessive_penetration()?;
        Some(describe_overlap(&overlap, contact, &self.system.assembly))
    }
}
