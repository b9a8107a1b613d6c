//! Tests that the keys of synthetic data are recovered within their error bars.

mod error_bars;
mod friction;
mod requests;
mod shooting;

use super::observe::{Observation, Unpredicted};
use super::*;
use crate::experiment::{case_set_from_text, prepare};
use crate::scenario::CaseSet;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// A light cantilever that swings after it is released horizontally: 1 s of motion with material
/// damping.
pub(super) const SWING: &str = r#"
experiment = "scene"
[parameters]
stiffness = 2e-4
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000.0
viscosity = 4000.0
[[rods]]
name = "beam"
radius = "2 mm"
edges = 10
shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }
stiffness = { bending_1 = "stiffness", bending_2 = "stiffness" }
[[clamps]]
rod = "beam"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[time]
step = "5 ms"
end = 1.0
"#;

/// A bent and twisted rod between clamps: its shape depends on EI/GJ, its moments on both.
pub(super) const TWISTED: &str = r#"
experiment = "scene"
[parameters]
ei = 1e-3
gj = 8e-4
[material]
youngs_modulus = "100 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "wire"
radius = "2 mm"
edges = 24
shape = { kind = "arc", start = [0, 0, 0], tangent = [0, 0, 1], normal = [0, 1, 0], radius = 0.1, angle = "180 deg" }
natural_shape = "straight"
twist = 4.0
stiffness = { bending_1 = "ei", bending_2 = "ei", twisting = "gj" }
[[clamps]]
rod = "wire"
at = "start"
[[clamps]]
rod = "wire"
at = "end"
[[probes]]
name = "grip"
kind = "reaction"
at = "end"
[time]
mode = "static"
"#;

pub(super) fn scenario(text: &str) -> CaseSet {
    case_set_from_text("scenario", text, Path::new("")).unwrap()
}

/// Normal noise from a seed.
struct Noise(Pcg64);

impl Noise {
    fn new(seed: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed))
    }

    fn next(&mut self) -> f64 {
        let mut uniform = || (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let (one, other) = (1.0 - uniform(), uniform());
        f64::sqrt(-2.0 * f64::ln(one)) * (std::f64::consts::TAU * other).cos()
    }
}

/// Predictions of a scenario for the rows of a file; the numbers in the file are ignored.
fn predicted(scenario: &CaseSet, file: &DataFile) -> Vec<f64> {
    let prepared = prepare(&scenario.scenario_of(0).unwrap().scenario).unwrap();
    let files = [file.clone()];
    let observation = Observation::new(&prepared, &files).unwrap();
    match observation.predict(&prepared, &|| true) {
        Ok(prediction) => prediction.values,
        Err(Unpredicted::Failed(error)) => panic!("{error}"),
        Err(Unpredicted::NoValue(_, _, reason)) => panic!("{reason}"),
        Err(Unpredicted::Stopped) => panic!("stopped"),
    }
}

/// A file with a header and rows; its numbers are predictions of the scenario plus noise of the
/// given deviation.
fn measured(
    scenario: &CaseSet,
    text: &str,
    deviation: impl Fn(&Datum) -> f64,
    seed: u64,
) -> DataFile {
    let mut file = DataFile::from_text(Path::new("data.csv"), text, &BTreeMap::new()).unwrap();
    let mut noise = Noise::new(seed);
    let values = predicted(scenario, &file);
    for (datum, value) in file.data.iter_mut().zip(values) {
        datum.value = value + deviation(datum) * noise.next();
    }
    file
}

pub(super) fn swing_rows() -> String {
    let mut text = "time_s,marker,node,x_m,z_m\n".to_owned();
    for step in 0..50 {
        for (marker, node) in [("middle", 5), ("tip", 10)] {
            writeln!(text, "{},{marker},{node},0,0", 0.02 * f64::from(step)).unwrap();
        }
    }
    text
}

fn task(experiments: Vec<Experiment>, keys: &[&str]) -> Task {
    let request = |key: &&str| Request {
        key: (*key).to_owned(),
        ..Request::default()
    };
    Task {
        experiments,
        keys: keys.iter().map(request).collect(),
        loss: Loss::Squares,
        noise: BTreeMap::new(),
        shared: None,
        windows: 1,
    }
}

fn fit(task: &Task) -> Identified {
    identify(task, &CentralDifferences::default(), &|| true, &mut |_| {}).unwrap()
}

/// The result without its residuals.
fn brief(found: &Identified) -> String {
    serde_json::to_string_pretty(found).unwrap()
}

/// Errors of all keys in standard errors.
fn deviations(identified: &Identified, truth: &[f64]) -> Vec<f64> {
    let keys = identified.parameters.iter().zip(truth);
    keys.map(|(key, truth)| (key.value - truth) / key.standard_error.unwrap())
        .collect()
}

/// The scenario with other start values of its keys.
fn elsewhere(text: &str, keys: &[(&str, &str)]) -> CaseSet {
    let mut text = text.to_owned();
    for (key, value) in keys {
        let line = text
            .lines()
            .find(|line| line.starts_with(&format!("{key} =")))
            .unwrap()
            .to_owned();
        text = text.replace(&line, &format!("{key} = {value}"));
    }
    scenario(&text)
}

pub(super) const SWING_KEYS: [&str; 2] = ["parameters.stiffness", "material.viscosity"];

/// A fit of noisy positions of the swinging beam.
fn swing(seed: u64) -> Identified {
    let file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, seed);
    let start = elsewhere(SWING, &[("stiffness", "3e-4"), ("viscosity", "2000.0")]);
    fit(&task(
        vec![Experiment {
            scenario: start,
            files: vec![file],
        }],
        &SWING_KEYS,
    ))
}

const POINTS: &str =
    "arc_length_m,x_m,y_m,z_m\n0.06,0,0,0\n0.12,0,0,0\n0.16,0,0,0\n0.2,0,0,0\n0.26,0,0,0\n";

/// A fit of a noisy shape and of noisy moments of the twisted rod.
fn twist(seed: u64) -> Identified {
    let truth = scenario(TWISTED);
    let shape = measured(&truth, POINTS, |_| 2e-4, seed);
    let moment = "grip_moment_x_n_m,grip_moment_y_n_m,grip_moment_z_n_m\n0,0,0\n";
    let moment = measured(&truth, moment, |_| 1e-4, seed + 10_000);
    let start = elsewhere(TWISTED, &[("ei", "2e-3"), ("gj", "1e-3")]);
    let experiment = Experiment {
        scenario: start,
        files: vec![shape, moment],
    };
    let mut task = task(vec![experiment], &["parameters.ei", "parameters.gj"]);
    for column in [
        "grip_moment_x_n_m",
        "grip_moment_y_n_m",
        "grip_moment_z_n_m",
    ] {
        task.noise.insert(column.to_owned(), 1e-4);
    }
    fit(&task)
}
