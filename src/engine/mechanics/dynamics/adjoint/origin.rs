//! The scene of a motion, from which a simulation is set up again: joints that broke are whole
//! before they break.

use super::SensitivityError;
use crate::mechanics::SceneError;
use crate::mechanics::dynamics::parameters::IntegrationParameters;
use crate::mechanics::dynamics::report::{SimulationError, SimulationState};
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::scene::Scene;

/// A scene and the parameters of its motion.
pub(super) struct Origin {
    pub scene: Scene,
    pub parameters: IntegrationParameters,
}

impl Origin {
    /// A simulation at time zero.
    ///
    /// # Errors
    /// [`SensitivityError::Simulation`] for an invalid scene.
    pub(super) fn simulation(&self) -> Result<Simulation, SensitivityError> {
        Ok(Simulation::new(&self.scene, &self.parameters)?)
    }

    /// Restores a state of the motion, from which a simulation then takes steps.
    ///
    /// # Errors
    /// [`SensitivityError::Simulation`] if the state belongs to another scene.
    pub(super) fn restore(
        &self,
        simulation: &mut Simulation,
        at: &SimulationState,
    ) -> Result<(), SensitivityError> {
        if simulation.breaks().iter().any(Option::is_some) {
            *simulation = self.simulation()?;
        }
        simulation.system.clear_active_laws();
        Ok(simulation.restore(at.clone())?)
    }

    /// Moves a simulation to the state at which a step began or ended.
    ///
    /// # Errors
    /// [`SensitivityError::Simulation`] if the state belongs to another scene.
    pub(super) fn take_up(
        &self,
        simulation: &mut Simulation,
        at: &SimulationState,
    ) -> Result<(), SensitivityError> {
        if simulation.breaks() != at.breaks {
            *simulation = self.simulation()?;
            let restored = simulation.system.restore_breaks(&at.breaks);
            restored.map_err(|what| foreign(what.to_owned()))?;
        }
        let Simulation { system, state, .. } = simulation;
        system.undamp();
        let restored = system.restore(at.strains.clone());
        restored.map_err(|what| foreign(what.to_owned()))?;
        let restored = system.restore_frame_bases(&at.frames);
        restored.map_err(|what| foreign(what.to_owned()))?;
        system.terms.contact.place_obstacles(at.time);
        let restored = system.restore_contact(at.contact.as_ref());
        restored.map_err(|what| foreign(what.to_string()))?;
        state.time = at.time;
        state.unknowns.clone_from(&at.unknowns);
        state.velocity.clone_from(&at.velocity);
        state.history.clone_from(&at.history);
        system.resume(at.time, &at.unknowns, &at.reference);
        system.drive(at.time, &mut state.unknowns);
        system.update_geometry(&state.unknowns);
        simulation.publish();
        Ok(())
    }
}

fn foreign(what: String) -> SimulationError {
    SimulationError::BadScene(SceneError::Checkpoint(what))
}
