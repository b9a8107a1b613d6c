//! Whole scenario files: what is accepted, what is refused and how.

mod expansion;
mod faults;
mod merging;
mod round_trip;

use super::keys::ExperimentKeys;
use super::{Experiments, Scenario, ScenarioError};
use crate::experiment::kind_named;
use std::path::Path;
use std::sync::LazyLock;

/// The experiments of the thesis: messages and lists name all that there are.
pub static EXPERIMENTS: LazyLock<Experiments> = LazyLock::new(|| {
    let names = [
        "scene",
        "flagella",
        "knot-tightening",
        "knot-inversion",
        "helix-stability",
    ];
    let keys = names.map(|name| kind_named(name).expect("a kind") as &dyn ExperimentKeys);
    Experiments::new(keys.to_vec().leak())
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
    super::from_text(*EXPERIMENTS, "beam", text, Path::new(""), &[]).map(|loaded| loaded.scenario)
}
