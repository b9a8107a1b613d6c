//! Equilibria of a simulation.

use super::Simulation;
use super::failure::no_equilibrium;
use super::integrator::{STIFFENING, report_contacts};
use super::report::{SimulationError, StepReport};
use crate::mechanics::statics::{
    Descent, SmallMotions, nearby_equilibrium, nearest_eigenvalue, small_motions,
};
use crate::mechanics::system::{Demand, name_overlap};
use crate::mechanics::{Overlap, SceneError};
use tracing::{debug, warn};

/// Number of increases of the contact stiffness for rods that penetrate, before this is an error.
const STIFFENINGS: usize = 8;

const NOT_JUDGED: SceneError = SceneError::Unsuitable(
    "the stability of an equilibrium under moments and forces that turn with rods is computed for at most 1500 nodes",
);

const NO_ENERGY: SceneError =
    SceneError::Unsuitable("forces without an energy have no symmetric stiffness");

impl Simulation {
    /// Finds the equilibrium at the present time at which the scene would come to rest: Newton's method without
    /// inertia, and without friction.
    ///
    /// # Errors
    /// [`SimulationError::NoEquilibrium`], [`SimulationError::Unphysical`] if rods penetrate even with the stiffest
    /// contact, and [`SimulationError::BadScene`] with rigid contact, which is defined for time steps only.
    pub fn find_equilibrium(&mut self) -> Result<StepReport, SimulationError> {
        let found = self.find_equilibrium_while(&|| true)?;
        Ok(found.expect("it is never stopped"))
    }

    /// As [`Self::find_equilibrium`], but stops and returns `None` once `goes_on`, called at every
    /// iteration, returns false. The state is then as before.
    ///
    /// # Errors
    /// The errors of [`Self::find_equilibrium`].
    pub fn find_equilibrium_while(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        self.system.admit(Demand::Equilibrium)?;
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
        self.validity.check_slides(&self.system, self.state.time);
        self.judge_stability();
        report_contacts(&self.system, &mut report);
        debug!(
            time = report.time,
            iterations = report.newton_iterations,
            contacts = report.contacts,
            "equilibrium found"
        );
        Ok(Some(report))
    }

    /// Small motions about the present equilibrium of forces without a potential; `None` if the
    /// forces have one, with friction, or if there are too many unknowns.
    pub fn small_motions(&mut self) -> Option<SmallMotions> {
        if self.system.is_symmetric() || self.system.rubs() {
            return None;
        }
        small_motions(&mut self.system, &self.state.unknowns)
    }

    /// Determines the stability of the equilibrium from its small motions, if the forces have no
    /// potential.
    fn judge_stability(&mut self) {
        if self.system.is_symmetric() || self.system.rubs() {
            return;
        }
        let message = match self.small_motions() {
            None => Some("the stability of the equilibrium could not be determined".to_owned()),
            Some(motions) => {
                let how = motions.in_words();
                how.map(|how| format!("the equilibrium is unstable: {how}"))
            }
        };
        if let Some(message) = message {
            warn!("{message}");
            self.validity.note_instability(message);
        }
        // Restores the residual of the equilibrium.
        self.system.evaluate(&self.state.unknowns, None);
    }

    /// Finds the nearest equilibrium at the present time, which need not be stable. Returns the
    /// number of unstable directions: those in which the energy decreases, or small motions that
    /// grow; 0 if it is stable.
    ///
    /// # Errors
    /// [`SimulationError::NoEquilibrium`], and [`SimulationError::BadScene`] with rigid contact or
    /// friction, whose forces have no energy.
    pub fn find_nearby_equilibrium(&mut self) -> Result<usize, SimulationError> {
        self.system.admit(Demand::NearbyEquilibrium)?;
        let tolerance = self.integrator.setting.parameters.force_tolerance;
        let mut trial = self.state.unknowns.clone();
        let inertia = nearby_equilibrium(&mut self.system, &mut trial, tolerance)
            .map_err(|divergence| no_equilibrium(&mut self.system, &trial, &divergence))?;
        self.rest_at(&trial);
        match inertia {
            Some(inertia) => Ok(inertia.negative),
            None => {
                let motions = self.small_motions().ok_or(NOT_JUDGED)?;
                self.system.evaluate(&self.state.unknowns, None);
                Ok(motions.unstable.total())
            }
        }
    }

    /// Finds the equilibrium of [`Self::find_nearby_equilibrium`] and returns its stiffness (N/m):
    /// the size of the eigenvalue of the Hessian nearest to zero, with angles in units of the
    /// shortest edge, positive for a stable equilibrium and negative for an unstable one. It is
    /// continuous where stability is lost.
    ///
    /// # Errors
    /// Those of [`Self::find_nearby_equilibrium`], and [`SimulationError::BadScene`] for forces
    /// without an energy.
    pub fn find_nearby_stiffness(&mut self) -> Result<f64, SimulationError> {
        if !self.system.is_symmetric() {
            return Err(NO_ENERGY.into());
        }
        let unstable = self.find_nearby_equilibrium()?;
        // The Hessian at the equilibrium is still factored.
        let size = nearest_eigenvalue(&mut self.system).abs();
        Ok(if unstable > 0 { -size } else { size })
    }

    /// Stores an equilibrium as the present state.
    fn rest_at(&mut self, unknowns: &[f64]) {
        self.state.rest_at(unknowns);
        self.publish();
    }

    /// Finds rods that penetrate by more than is allowed in the last evaluation.
    fn penetration(&self) -> Option<Overlap> {
        let contact = self.system.contact()?;
        let overlap = contact.excessive_penetration()?;
        Some(name_overlap(&overlap, contact, &self.system.assembly))
    }
}
