//! Helpers for tests of the laboratory: scenarios from texts, their resolved form and simulations,
//! quiet runs, tables of cases.

use crate::experiment::{from_text, prepare};
use crate::run::{Mode, OutputPlan, PreparedRun, RunError, RunOptions, RunOutcome, run_until};
use crate::scenario::{Loaded, Scenario};
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation};
use rodlab_engine::mechanics::scene::Scene;
use std::path::Path;
use tempfile::TempDir;

/// The cases of a table, one per line: a text, whose lines are separated by `; `, then ` => ` and
/// the expected result.
pub fn cases(table: &str) -> impl Iterator<Item = (String, &str)> {
    let lines = table.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.map(|line| {
        let (text, expected) = line.split_once(" => ").expect("a case has two sides");
        (text.replace("; ", "\n"), expected)
    })
}

/// A scenario from its text, or its faults.
pub fn loaded(name: &str, text: &str) -> Result<Loaded, String> {
    from_text(name, text, Path::new(""), &[]).map_err(|error| error.to_string())
}

/// The run of a scenario, or its faults.
pub fn prepared(name: &str, text: &str) -> Result<PreparedRun, String> {
    let loaded = loaded(name, text)?;
    prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues).to_string())
}

/// The simulation of a scenario at its start, or its faults.
pub fn simulation(name: &str, text: &str) -> Result<Simulation, String> {
    let run = prepared(name, text)?;
    Simulation::new(&run.scene, &run.integration).map_err(|error| error.to_string())
}

/// The resolved scenario reads back to itself.
#[track_caller]
pub fn assert_reads_back(name: &str, scenario: &Scenario) {
    let text = scenario.to_toml();
    let again = loaded(name, &text).unwrap();
    assert_eq!(again.scenario, *scenario, "{text}");
}

/// Advances a simulation to a time, s.
pub fn advance_to(simulation: &mut Simulation, end: f64) {
    while simulation.time() < end {
        simulation.advance(end).unwrap();
    }
}

/// Options of a run into a directory without a progress bar.
pub fn quiet(directory: &Path) -> RunOptions {
    RunOptions {
        progress: false,
        ..RunOptions::new(directory)
    }
}

/// A whole run into a new directory.
pub fn ran(prepared: &PreparedRun) -> Result<(RunOutcome, TempDir), RunError> {
    let directory = tempfile::tempdir().unwrap();
    let outcome = run_until(prepared, &quiet(directory.path()), &|| None)?;
    Ok((outcome, directory))
}

/// A run of a scene without a scenario: without observers and controllers, with nodes as its only
/// output.
pub fn run_of_scene(name: &str, scene: Scene, mode: Mode, interval: f64) -> PreparedRun {
    PreparedRun {
        name: name.into(),
        experiment: "scene".into(),
        title: name.into(),
        scenario_toml: "experiment = \"scene\"\n".into(),
        scene,
        mode,
        integration: IntegrationParameters::default(),
        output: OutputPlan {
            interval,
            nodes: true,
            forces: false,
            contacts: false,
            vtk: false,
        },
        observers: Vec::new(),
        warnings: Vec::new(),
        controllers: Vec::new(),
        own_files: Vec::new(),
        table: None,
        start: None,
    }
}
