//! All observers and controllers of a run together.

use super::observer::{Finding, Sample};
use super::{Controller, Observer, PreparedRun};
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_files::results::{CaseOutcome, NamedValues, ResultsError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The saved states of observers and controllers, with their names.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct SavedStates {
    observers: Vec<(String, Vec<u8>)>,
    controllers: Vec<(String, Vec<u8>)>,
}

/// The observers and controllers of a run.
#[derive(Clone)]
pub(super) struct Participants {
    pub observers: Vec<Box<dyn Observer>>,
    pub controllers: Vec<Box<dyn Controller>>,
}

impl Participants {
    /// The participants of a run, in their state at the start.
    pub fn of(prepared: &PreparedRun) -> Self {
        Self {
            observers: prepared.observers.clone(),
            controllers: prepared.controllers.clone(),
        }
    }

    /// Lets controllers act before a step; returns when the next of them must act again, s.
    pub fn control(&mut self, simulation: &mut Simulation) -> Result<f64, SimulationError> {
        let now = simulation.time();
        let mut until = f64::INFINITY;
        for controller in &mut self.controllers {
            controller.act(simulation)?;
            let next = controller.next_time();
            if next > now {
                until = until.min(next);
            }
        }
        Ok(until)
    }

    /// Calls the observers that are due at `time`, independently of the times of outputs.
    pub fn sample_if_due(&mut self, sample: &Sample<'_>, time: f64) -> Vec<Finding> {
        let observers = self.observers.iter_mut();
        let due = observers.filter(|observer| observer.is_due(time));
        due.map(|observer| observer.sample(sample)).collect()
    }

    /// Current states of the participants.
    pub fn save(&self) -> SavedStates {
        let observers = self.observers.iter();
        let controllers = self.controllers.iter();
        SavedStates {
            observers: observers
                .map(|one| (one.name().to_owned(), (**one).save()))
                .collect(),
            controllers: controllers
                .map(|one| (one.name().to_owned(), (**one).save()))
                .collect(),
        }
    }

    /// Takes over saved states.
    ///
    /// # Errors
    /// [`ResultsError::Damaged`] if they belong to other observers or controllers.
    pub fn restore(&mut self, states: &SavedStates, directory: &Path) -> Result<(), ResultsError> {
        let damaged = |reason: String| ResultsError::Damaged {
            path: directory.to_owned(),
            reason: format!("the checkpoint does not fit: {reason}"),
        };
        let observers = self.observers.iter().map(|one| one.name());
        let controllers = self.controllers.iter().map(|one| one.name());
        let saved = states.observers.iter().chain(&states.controllers);
        if !observers
            .chain(controllers)
            .eq(saved.map(|(name, _)| name.as_str()))
        {
            return Err(damaged("other observers or controllers".into()));
        }
        for (one, (name, state)) in self.observers.iter_mut().zip(&states.observers) {
            let restored = (**one).restore(state);
            restored.map_err(|error| damaged(format!("{name}: {error}")))?;
        }
        for (one, (name, state)) in self.controllers.iter_mut().zip(&states.controllers) {
            let restored = (**one).restore(state);
            restored.map_err(|error| damaged(format!("{name}: {error}")))?;
        }
        Ok(())
    }
}

/// Names of the columns that observers add to the series.
pub(super) fn columns(observers: &[Box<dyn Observer>]) -> Vec<String> {
    observers.iter().flat_map(|one| one.columns()).collect()
}

/// Outcomes and remarks of all observers.
pub(super) fn outcomes(observers: &[Box<dyn Observer>]) -> NamedValues {
    let values = observers.iter().flat_map(|one| one.outcomes().0);
    NamedValues(values.collect())
}

/// Main results of an outcome for the user.
pub(super) fn highlights(
    observers: &[Box<dyn Observer>],
    outcome: &CaseOutcome,
) -> Vec<(String, String)> {
    let lines = observers.iter().flat_map(|one| one.highlights(outcome));
    lines.collect()
}
