//! Keys that made synthetic data are found again, within their error bars.

use super::observe::{Observation, Unpredicted};
use super::*;
use crate::experiment::{case_set_from_text, prepare};
use crate::scenario::CaseSet;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// A light cantilever that swings after it is let go horizontally: 1 s of motion with material damping.
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

/// The numbers that a scenario predicts for the rows of a file, whose numbers do not matter.
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

/// A file with a header and rows, whose numbers are those of the scenario with noise of the given deviation.
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

/// The scenario with keys that start elsewhere.
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

#[test]
fn stiffness_and_damping_of_a_swinging_beam_are_found_within_their_error_bars() {
    let found = swing(1);
    let off = deviations(&found, &[2e-4, 4000.0]);
    assert!(
        found.converged && off.iter().all(|off| off.abs() < 3.0),
        "{off:?} {}",
        brief(&found)
    );
    assert!(
        (found.groups[0].standard_deviation / 1e-3 - 1.0).abs() < 0.2,
        "{:?}",
        found.groups
    );
    let relative =
        |key: usize| found.parameters[key].standard_error.unwrap() / found.parameters[key].value;
    assert!(relative(0) < 0.01 && relative(1) < 0.2, "{}", brief(&found));
    assert!(
        found.undetermined.is_empty() && found.remarks.is_empty(),
        "{}",
        brief(&found)
    );
}

/// Fits of noisy data: errors are at most 1.2 times the bound, and 95 % of the intervals cover the truth.
#[track_caller]
fn check_error_bars(name: &str, truth: &[f64], fit: impl Fn(u64) -> Identified + Sync) {
    let trials: u64 = match std::env::var_os("RODLAB_TESTS_FULL") {
        Some(_) => 500,
        None => 12,
    };
    let found: Vec<Identified> = (0..trials)
        .into_par_iter()
        .map(|trial| fit(100 + trial))
        .collect();
    let mut covered = 0;
    let ratios = truth.iter().enumerate().map(|(key, truth)| {
        let (mut squares, mut bound) = (0.0, 0.0);
        for parameter in found.iter().map(|one| &one.parameters[key]) {
            squares += (parameter.value - truth).powi(2);
            bound += parameter.standard_error.unwrap().powi(2);
            let [low, high] = parameter.interval_95.unwrap();
            covered += usize::from((low..=high).contains(truth));
        }
        f64::sqrt(squares / bound)
    });
    let ratios: Vec<f64> = ratios.collect();
    let part = covered as f64 / (trials as usize * truth.len()) as f64;
    println!("{name}, {trials} trials: covered {part:.3}, errors over bounds {ratios:.3?}");
    let (most, least, covers) = match trials {
        500 => (1.2, 0.85, 0.92..=0.98),
        _ => (1.7, 0.4, 0.75..=1.0),
    };
    assert!(covers.contains(&part), "{name}: {part}");
    let is_near = |ratio: &f64| (least..most).contains(ratio);
    assert!(ratios.iter().all(is_near), "{name}: {ratios:?}");
}

#[test]
fn error_bars_of_bending_stiffness_and_damping_cover_the_truth() {
    check_error_bars("swing", &[2e-4, 4000.0], swing);
}

#[test]
fn error_bars_of_twisting_stiffness_cover_the_truth() {
    check_error_bars("twist", &[1e-3, 8e-4], twist);
}

#[test]
fn error_bars_of_friction_cover_the_truth() {
    check_error_bars("slide", &[0.3], slide);
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

/// A rod on the ground, whose end is pulled to its side.
const SLIDE: &str = r#"
experiment = "scene"
[parameters]
friction = 0.3
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "rod"
radius = "5 mm"
edges = 8
shape = { kind = "straight", start = [0, 0, "5 mm"], end = [0.2, 0, "5 mm"] }
[[clamps]]
rod = "rod"
at = "start"
move = [[0, [0, 0, 0]], [1, [0, 0.2, 0]]]
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[planes]]
point = [0, 0, 0]
normal = [0, 0, 1]
[contact]
friction = "friction"
[[probes]]
name = "grip"
kind = "reaction"
at = "start"
[time]
step = "5 ms"
end = "0.4 s"
"#;

/// A fit of its noisy path and of noisy forces.
fn slide(seed: u64) -> Identified {
    let truth = scenario(SLIDE);
    let mut path = "time_s,marker,node,x_m,y_m\n".to_owned();
    let mut force = "time_s,grip_force_y_n\n".to_owned();
    for step in 1..=16 {
        let time = 0.025 * f64::from(step);
        writeln!(path, "{time},tip,8,0,0").unwrap();
        writeln!(force, "{time},0").unwrap();
    }
    let path = measured(&truth, &path, |_| 1e-3, seed);
    let force = measured(&truth, &force, |_| 5e-3, seed + 10_000);
    let start = elsewhere(SLIDE, &[("friction", "0.2")]);
    let experiment = Experiment {
        scenario: start,
        files: vec![path, force],
    };
    fit(&task(vec![experiment], &["parameters.friction"]))
}

#[test]
fn bending_and_twisting_stiffness_are_found_from_a_shape_and_a_moment() {
    let found = twist(7);
    let off = deviations(&found, &[1e-3, 8e-4]);
    assert!(
        found.converged && off.iter().all(|off| off.abs() < 3.0),
        "{off:?} {}",
        brief(&found)
    );
    let relative =
        |key: usize| found.parameters[key].standard_error.unwrap() / found.parameters[key].value;
    assert!(relative(0) < 0.1 && relative(1) < 0.1, "{}", brief(&found));
}

/// A rod along an incline that becomes steeper: the tangent of its angle is t/10.
const INCLINE: &str = r#"experiment = "scene"
[parameters]
mu = 0.3
[material]
youngs_modulus = "10 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "rod"
radius = "5 mm"
edges = 4
shape = { kind = "straight", start = [-0.05, 0, 0.00502], end = [0.05, 0, 0.00502] }
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
kind = "gravity"
acceleration = [9.81, 0, 0]
schedule = [[0, 0], [10, 1]]
[[planes]]
point = [0, 0, 0]
normal = [0, 0, 1]
[contact]
friction = "mu"
distance_tolerance = "50 µm"
slip_tolerance = "0.02 mm/s"
[time]
step = "20 ms"
end = 6.0
"#;

#[test]
fn friction_is_found_from_the_angle_at_which_a_rod_begins_to_slide() {
    // Measured angles: tan α = μ.
    let mut noise = Noise::new(21);
    let mut text = "sliding_onset_s,sliding_onset_s_sd\n".to_owned();
    for _ in 0..5 {
        writeln!(text, "{},0.05", 3.0 + 0.05 * noise.next()).unwrap();
    }
    let file = DataFile::from_text(Path::new("onset.csv"), &text, &BTreeMap::new()).unwrap();
    let late = predicted(&scenario(INCLINE), &file)[0] - 3.0;
    println!("onset {late} s late");
    assert!((0.0..0.02).contains(&late), "{late}");
    let start = elsewhere(INCLINE, &[("mu", "0.5")]);
    let experiment = Experiment {
        scenario: start,
        files: vec![file],
    };
    let found = fit(&task(vec![experiment], &["parameters.mu"]));
    let error = found.parameters[0].standard_error.unwrap();
    println!("{} ± {error}", found.parameters[0].value);
    assert!(
        found.converged && deviations(&found, &[0.3])[0].abs() < 3.0,
        "{}",
        brief(&found)
    );
    // The time is proportional to the friction: its error is that of the mean of five times.
    assert!(
        (error / (0.05 / 5f64.sqrt() / 10.0) - 1.0).abs() < 0.05,
        "{error}"
    );
    let never = elsewhere(INCLINE, &[("mu", "2.0")]);
    let prepared = prepare(&never.scenario_of(0).unwrap().scenario).unwrap();
    let files = [DataFile::from_text(
        Path::new("onset.csv"),
        "sliding_onset_s\n3\n",
        &BTreeMap::new(),
    )
    .unwrap()];
    let observation = Observation::new(&prepared, &files).unwrap();
    let Err(Unpredicted::NoValue(_, _, reason)) = observation.predict(&prepared, &|| true) else {
        panic!("it slides");
    };
    assert!(reason.contains("nothing begins to slide"), "{reason}");
}

#[test]
fn a_shape_that_does_not_depend_on_a_stiffness_says_so() {
    let flat = TWISTED.replace("twist = 4.0", "");
    let file = measured(&scenario(&flat), POINTS, |_| 1e-4, 3);
    let found = fit(&task(
        vec![Experiment {
            scenario: scenario(&flat),
            files: vec![file.clone()],
        }],
        &["parameters.gj"],
    ));
    assert_eq!(found.parameters[0].standard_error, None);
    assert!(
        found.undetermined[0]
            .words
            .contains("do not determine `parameters.gj`"),
        "{}",
        brief(&found)
    );
    assert!(
        found.undetermined[0].advice.contains("turn a clamp"),
        "{}",
        brief(&found)
    );
    // Without weight the shape depends on the ratio alone; an arc of a circle stays one.
    let arc = r#"kind = "arc", start = [0, 0, 0], tangent = [0, 0, 1], normal = [0, 1, 0], radius = 0.1, angle = "180 deg""#;
    let bent =
        r#"kind = "points", points = [[0, 0, 0], [0, 0, 0.1], [0.15, 0, 0.1], [0.15, 0, 0.05]]"#;
    let bent = scenario(&TWISTED.replace(arc, bent));
    let file = measured(&bent, POINTS, |_| 1e-4, 4);
    let experiment = Experiment {
        scenario: bent,
        files: vec![file],
    };
    let found = fit(&task(vec![experiment], &["parameters.ei", "parameters.gj"]));
    let [direction] = found.undetermined.as_slice() else {
        panic!("{}", brief(&found));
    };
    assert!(
        (direction.changes[0].1 - direction.changes[1].1).abs() < 1e-3,
        "{direction:?}"
    );
}

#[test]
fn outliers_are_outweighed_by_the_loss_of_huber() {
    let mut file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, 11);
    for datum in file.data.iter_mut().step_by(9) {
        datum.value += 0.05;
    }
    let mut task = task(
        vec![Experiment {
            scenario: scenario(SWING),
            files: vec![file],
        }],
        &SWING_KEYS,
    );
    let squares = fit(&task);
    task.loss = Loss::Huber;
    let huber = fit(&task);
    let off = |found: &Identified| (found.parameters[0].value / 2e-4 - 1.0).abs();
    assert!(
        off(&huber) < 0.4 * off(&squares) && off(&huber) < 0.01,
        "{} {}",
        off(&huber),
        off(&squares)
    );
}

#[test]
fn priors_and_bounds_hold() {
    let file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, 5);
    let mut task = task(
        vec![Experiment {
            scenario: scenario(SWING),
            files: vec![file],
        }],
        &SWING_KEYS,
    );
    task.keys[1].prior = Some([5000.0, 1.0]);
    let found = fit(&task);
    assert!(
        (found.parameters[1].value - 5000.0).abs() < 5.0,
        "{}",
        brief(&found)
    );
    task.keys[1].prior = None;
    task.keys[0].bounds = Some([1e-4, 1.9e-4]);
    let outside = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {});
    assert!(
        outside
            .unwrap_err()
            .to_string()
            .contains("outside of the bounds")
    );
    task.experiments[0].scenario = elsewhere(SWING, &[("stiffness", "1.5e-4")]);
    let found = fit(&task);
    assert!(
        found.parameters[0].at_bound && (found.parameters[0].value - 1.9e-4).abs() < 1e-12,
        "{}",
        brief(&found)
    );
    assert!(
        found
            .remarks
            .iter()
            .any(|remark| remark.contains("at its bound"))
    );
}

#[test]
fn a_mirrored_frame_is_refused_with_its_row() {
    let mut file = measured(&scenario(TWISTED), POINTS, |_| 0.0, 1);
    for datum in &mut file.data {
        if matches!(datum.measured, Measured::Coordinate { axis: 0, .. }) {
            datum.value = -datum.value;
        }
    }
    let task = task(
        vec![Experiment {
            scenario: scenario(TWISTED),
            files: vec![file],
        }],
        &["parameters.gj"],
    );
    let error = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {})
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("data.csv, line") && error.contains("the axis x is mirrored"),
        "{error}"
    );
}

#[test]
fn requests_that_cannot_be_met_state_what_is_allowed() {
    let file = measured(&scenario(SWING), &swing_rows(), |_| 0.0, 1);
    let experiment = Experiment {
        scenario: scenario(SWING),
        files: vec![file],
    };
    for (keys, expected) in [
        (&["parameters.ei"] as &[&str], "states no number"),
        (&["material.youngs_moduls"], "states no number"),
        (&[], "--fit KEY"),
        (&["material.density", "material.density"], "fitted twice"),
        (
            &["material.relaxing_modulus"],
            "--set material.relaxing_modulus=VALUE",
        ),
    ] {
        let error = identify(
            &task(vec![experiment.clone()], keys),
            &CentralDifferences::default(),
            &|| true,
            &mut |_| {},
        );
        let error = error.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let mut task = task(vec![experiment], &["material.density"]);
    task.noise.insert("force".into(), 1.0);
    let error = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("there are: position"), "{error}");
}

#[test]
fn the_files_are_written_and_the_rod_and_the_scenario_can_be_used() {
    let found = swing(2);
    let file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, 2);
    let experiments = [Experiment {
        scenario: scenario(SWING),
        files: vec![file],
    }];
    let directory = tempfile::tempdir().unwrap();
    let paths = write(directory.path(), &found, &experiments).unwrap();
    assert_eq!(paths.len(), 6);
    let table = std::fs::read_to_string(directory.path().join(PARAMETERS)).unwrap();
    assert!(
        table.starts_with(
            "key,value,unit,standard_error,low_95,high_95,start\nparameters.stiffness,"
        ),
        "{table}"
    );
    let residuals = std::fs::read_to_string(directory.path().join(RESIDUALS)).unwrap();
    assert_eq!(residuals.lines().count(), 201);
    let rod = crate::experiment::RodFile::read(&directory.path().join(ROD)).unwrap();
    let weight = 1000.0 * std::f64::consts::PI * 4e-6 * 9.81;
    let expected = (found.parameters[0].value / (2.0 * weight)).cbrt();
    assert!((rod.rod.gravito_bending_length / expected - 1.0).abs() < 1e-9);
    crate::experiment::load(&directory.path().join(FITTED), &[]).unwrap();
}
