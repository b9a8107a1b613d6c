//! Compares probes with exact results of simple scenes, from the scenario file to the tables.

mod contact;
mod forces;
mod geometry;
mod keys;
mod run;

use crate::run::{PreparedRun, RunOutcome};
use crate::test_support;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::results::{SERIES, SUMMARY, Table};

fn prepared(text: &str) -> Result<PreparedRun, String> {
    test_support::prepared("probes", text)
}

/// The tables of a run.
struct Ran {
    directory: tempfile::TempDir,
    outcome: RunOutcome,
    series: Table,
    summary: Table,
}

fn ran(text: &str) -> Ran {
    let prepared = prepared(text).unwrap_or_else(|error| panic!("{error}"));
    let (outcome, directory) = test_support::ran(&prepared).unwrap();
    Ran {
        series: Table::read(&directory.path().join(SERIES)).unwrap(),
        summary: Table::read(&directory.path().join(SUMMARY)).unwrap(),
        directory,
        outcome,
    }
}

impl Ran {
    /// The value of a column in the last row of the series.
    fn last(&self, column: &str) -> Option<f64> {
        let column = self.series.numbers(column);
        column.expect("such a column").pop().expect("a row")
    }

    fn vector(&self, name: &str, unit: &str) -> Vector3 {
        let component = |axis: &str| self.last(&format!("{name}_{axis}_{unit}")).unwrap();
        Vector3::new(component("x"), component("y"), component("z"))
    }
}

fn near(got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance * expected.abs(),
        "{got} instead of {expected}"
    );
}

const CANTILEVER: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }
output = { nodes = true }
[[rods]]
name = "beam"
radius = 0.004
edges = 40
shape = { kind = "straight", start = [0, 0, 0], end = [0.3, 0.1, 0] }
[[clamps]]
rod = "beam"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

fn cantilever(probes: &str) -> Ran {
    ran(&format!("{CANTILEVER}{probes}"))
}

fn weight_of(length: f64) -> f64 {
    1000.0 * std::f64::consts::PI * 0.004_f64.powi(2) * length * 9.81
}

const RESTING: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
time = { step = 2e-3, end = 0.4 }
output = { interval = 0.05 }
[[rods]]
name = "rod"
radius = 0.004
edges = 20
shape = { kind = "straight", start = [0, 0, 0.00402], end = [0.2, 0, 0.00402] }
[[planes]]
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
kind = "drag"
translation = 1.0
[contact]
model = "imc"
friction = 0.3
distance_tolerance = 1e-4
"#;
