//! Tests that error bars cover the truth, and that errors meet the bound of Cramér and Rao.

use super::*;
use rayon::prelude::*;

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

/// A rod on the ground with one end pulled sideways.
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
