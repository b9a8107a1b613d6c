//! Whole scenario files: accepted ones, and rejected ones with their messages.

mod expansion;
mod faults;
mod merging;
mod round_trip;
mod sections;
mod tables;

use super::keys::ExperimentKeys;
use super::{Experiments, Issue, Scenario, ScenarioError};
use crate::experiment::kind_named;
use std::path::Path;
use std::sync::LazyLock;

/// The experiments of the thesis. Messages and lists name all existing experiments.
pub static EXPERIMENTS: LazyLock<Experiments> = LazyLock::new(|| {
    let names = [
        "scene",
        "flagella",
        "knot-tightening",
        "knot-inversion",
        "helix-stability",
    ];
    let keys = names.map(|name| kind_named(name).expect("a kind") as &dyn ExperimentKeys);
    Experiments::new(keys.to_vec().leak(), crate::experiment::PARTS)
});

const BEAM: &str = r#"experiment = "scene"
title = "Heavy cantilever"

[material]
youngs_modulus = "100 MPa"
poissons_ratio = 0.5
density = 1000.0

[[rods]]
name = "beam"
radius = "5 mm"
edges = 50
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }

[[clamps]]
rod = "beam"
at = "start"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[time]
mode = "static"

[output]
nodes = true
"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    read_with("beam", text, &[])
}

/// Reads the scenario of a text with overrides. A table with the same values must give the same
/// scenario or the same faults.
fn read_with(name: &str, text: &str, set: &[String]) -> Result<Scenario, ScenarioError> {
    let of_text = super::from_text(*EXPERIMENTS, name, text, Path::new(""), set);
    // Text that is not TOML, and numbers that only text can express, cannot become a table.
    if let Ok(table) = text.parse() {
        let of_table = super::from_table(*EXPERIMENTS, name, table, Path::new(""), set);
        match (&of_text, &of_table) {
            (Ok(of_text), Ok(of_table)) => {
                assert_eq!(of_text.scenario.to_toml(), of_table.scenario.to_toml());
            }
            (Err(of_text), Err(of_table)) => {
                let issues = |error: &ScenarioError| -> Vec<Issue> {
                    error
                        .0
                        .iter()
                        .map(|located| located.issue.clone())
                        .collect()
                };
                assert_eq!(issues(of_text), issues(of_table));
            }
            _ => panic!("{text}: {of_text:?} {of_table:?}"),
        }
    }
    of_text.map(|loaded| loaded.scenario)
}
