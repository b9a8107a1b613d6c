//! Scenes from scenario files, so that what a user writes is what is checked.

use super::GroupError;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_lab::experiment;
use rodlab_lab::run::PreparedRun;
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
