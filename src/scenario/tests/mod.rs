//! Whole scenario files: what is accepted, what is refused and how.

mod faults;
mod merging;
mod round_trip;

use super::{Scenario, ScenarioError, from_text};
use std::path::Path;

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
    from_text("beam", text, Path::new("")).map(|loaded| loaded.scenario)
}
