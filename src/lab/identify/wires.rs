//! Tests with real wires: stiffness from photographs, and shapes that were not fitted.

use super::observe::Observation;
use super::*;
use crate::experiment::{case_set, prepare};
use crate::scenario::CaseSet;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Mean distance of the points of a shape, over the length of the wire: the measure of the authors of the photographs.
fn shape_error(scenario: &CaseSet, found: &Identified, shape: &DataFile) -> f64 {
    let values: Vec<(&str, f64)> = found
        .parameters
        .iter()
        .map(|one| (one.key.as_str(), one.value))
        .collect();
    let loaded = scenario.scenario_with(&values).unwrap();
    let prepared = prepare(&loaded.scenario).unwrap();
    let files = [shape.clone()];
    let observation = Observation::new(&prepared, &files).unwrap();
    let predicted = observation.predict(&prepared, &|| true);
    let predicted = predicted.map_or_else(|_| Vec::new(), |prediction| prediction.values);
    let mut sum = 0.0;
    for (points, at) in shape.data.chunks(2).zip(predicted.chunks(2)) {
        sum += (points[0].value - at[0]).hypot(points[1].value - at[1]);
    }
    sum / (predicted.len() / 2) as f64 / 1.5
}

fn scenarios(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(name)
}

fn read(name: &str) -> DataFile {
    DataFile::read(&scenarios("wires").join(name), &BTreeMap::new()).unwrap()
}

struct Wire {
    name: &'static str,
    mass_per_length: f64,
    start: f64,
    /// EI and shape error of the authors' fit.
    authors: [f64; 2],
}

const WIRES: [Wire; 3] = [
    Wire {
        name: "white",
        mass_per_length: 0.087 / 5.0,
        start: 1e-4,
        authors: [5.64e-5, 0.0078],
    },
    Wire {
        name: "black",
        mass_per_length: 0.081 / 2.98,
        start: 1e-3,
        authors: [1.00e-3, 0.0158],
    },
    Wire {
        name: "red",
        mass_per_length: 0.043 / 2.0,
        start: 1e-3,
        authors: [6.37e-4, 0.0138],
    },
];

/// Fits shapes 0 to 2 of a wire, with its critical twists if requested, and returns the result
/// with the error of shape 3.
fn fit(wire: &Wire, with_twist: bool) -> (Identified, f64) {
    let overrides = [
        format!("parameters.mass_per_length={}", wire.mass_per_length),
        format!("parameters.ei={}", wire.start),
        format!("parameters.gj={}", 1.3 * wire.start),
    ];
    let scenario = |name: &str| case_set(&scenarios(name), &overrides, &[]).unwrap();
    let shapes = (0..3).map(|number| read(&format!("{}_{number}.csv", wire.name)));
    let mut experiments = vec![Experiment {
        scenario: scenario("wire_loop.toml"),
        files: shapes.collect(),
    }];
    let mut keys = vec![
        "parameters.ei",
        "parameters.right",
        "parameters.left",
        "parameters.tilt",
    ];
    if with_twist {
        keys.push("parameters.gj");
        experiments.push(Experiment {
            scenario: scenario("wire_twist.toml"),
            files: vec![read(&format!("{}_twist.csv", wire.name))],
        });
    }
    let request = |key: &str| Request {
        key: key.to_owned(),
        bounds: None,
        // The tangents at the holders are uncertain by some degrees.
        prior: ["parameters.right", "parameters.left"]
            .contains(&key)
            .then_some([0.0, 0.1]),
    };
    let task = Task {
        experiments,
        keys: keys.into_iter().map(request).collect(),
        loss: Loss::Squares,
        noise: BTreeMap::new(),
        shared: None,
        windows: 1,
    };
    let found = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {}).unwrap();
    let unseen = read(&format!("{}_3.csv", wire.name));
    let error = shape_error(&task.experiments[0].scenario, &found, &unseen);
    (found, error)
}

#[test]
fn a_shape_that_was_not_fitted_is_closer_than_that_of_the_authors() {
    let is_full = std::env::var_os("RODLAB_TESTS_FULL").is_some();
    for wire in WIRES.iter().filter(|wire| is_full || wire.name == "black") {
        let (found, error) = fit(wire, is_full);
        println!(
            "{}: error {error:.4} (authors {}) {}",
            wire.name,
            wire.authors[1],
            serde_json::to_string(&found).unwrap()
        );
        assert!(found.converged && error < wire.authors[1], "{error}");
        let [low, high] = found.parameters[0].interval_95.unwrap();
        println!(
            "EI {:.3e}, {low:.3e} to {high:.3e}; authors {:.3e}",
            found.parameters[0].value, wire.authors[0]
        );
        assert!((0.5..2.0).contains(&(found.parameters[0].value / wire.authors[0])));
    }
}
