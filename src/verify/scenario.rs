//! Scenes from scenario files, so that the checks include the file format.

use super::GroupError;
use super::rods::run_until;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_lab::experiment;
use rodlab_lab::run::PreparedRun;
use rodlab_lab::scenario::Loaded;
use std::path::Path;
use toml::Table;

/// A scene, with some keys set to other values.
pub(super) fn prepared(text: &str, overrides: &[String]) -> Result<PreparedRun, GroupError> {
    of_loaded(&experiment::from_text(
        "scene",
        text,
        Path::new(""),
        overrides,
    )?)
}

fn of_loaded(loaded: &Loaded) -> Result<PreparedRun, GroupError> {
    Ok(experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?)
}

/// The scene, ready to run.
pub(super) fn simulation(text: &str, overrides: &[String]) -> Result<Simulation, GroupError> {
    let prepared = prepared(text, overrides)?;
    Ok(Simulation::new(&prepared.scene, &prepared.integration)?)
}

/// A scene with computed keys, ready to run.
pub(super) fn built(scene: Table) -> Result<Simulation, GroupError> {
    let loaded = experiment::from_table("scene", scene, Path::new(""), &[])?;
    let prepared = of_loaded(&loaded)?;
    Ok(Simulation::new(&prepared.scene, &prepared.integration)?)
}

/// The scene at rest.
pub(super) fn at_rest(text: &str, overrides: &[String]) -> Result<Simulation, GroupError> {
    let mut simulation = simulation(text, overrides)?;
    simulation.find_equilibrium()?;
    Ok(simulation)
}

/// The scene after its motion up to a time, s.
pub(super) fn moved(text: &str, overrides: &[String], end: f64) -> Result<Simulation, GroupError> {
    let mut simulation = simulation(text, overrides)?;
    run_until(&mut simulation, end)?;
    Ok(simulation)
}
