//! Scenes from scenario files, so that what a user writes is what is checked.

use super::GroupError;
use crate::experiment;
use crate::mechanics::dynamics::Simulation;
use crate::run::PreparedRun;
use std::path::Path;

/// A scene, with some keys set to other values.
pub(super) fn prepared(text: &str, overrides: &[String]) -> Result<PreparedRun, GroupError> {
    let loaded = experiment::from_text("scene", text, Path::new(""), overrides)?;
    Ok(experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?)
}

/// The same, ready to run.
pub(super) fn simulation(text: &str, overrides: &[String]) -> Result<Simulation, GroupError> {
    let prepared = prepared(text, overrides)?;
    Ok(Simulation::new(&prepared.scene, &prepared.integration)?)
}
