//! Events: steps end exactly at corners of schedules and motions and resolve what begins there;
//! error control.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Clamp, Load, LoadKind, Motion, Scene};
use crate::mechanics::test_support::{SCHEMES, assert_close_in, clamp, run_with, straight_rod};
use std::f64::consts::TAU;

const EDGES: usize = 20;
fn cantilever() -> Scene {
    Scene {
        rods: vec![straight_rod(EDGES, 1.0)],
        clamps: vec![clamp(0, 0)],
        ..Scene::default()
    }
}

/// A cantilever at rest. After 0.2 s a force acts on its tip for 10 ms.
fn struck() -> Scene {
    let kind = LoadKind::Force {
        rod: 0,
        node: EDGES,
        force: -4.0 * Vector3::z(),
    };
    let schedule = vec![(0.2, 0.0), (0.201, 1.0), (0.209, 1.0), (0.21, 0.0)];
    Scene {
        loads: vec![Load { kind, schedule }],
        ..cantilever()
    }
}

/// A cantilever. After 0.2 s its clamp jerks up and down within 20 ms.
fn jerked() -> Scene {
    let at = |height: f64| height * Vector3::z();
    let translation = vec![(0.2, at(0.0)), (0.21, at(0.05)), (0.22, at(0.0))];
    let motion = Motion {
        translation,
        ..Motion::default()
    };
    Scene {
        clamps: vec![Clamp {
            motion,
            ..clamp(0, 0)
        }],
        ..cantilever()
    }
}

fn parameters(scheme: Scheme, step: StepSize) -> IntegrationParameters {
    IntegrationParameters {
        scheme,
        step,
        ..IntegrationParameters::default()
    }
}

fn automatic(tolerance: f64, maximum: f64) -> StepSize {
    StepSize::Auto { tolerance, maximum }
}

/// All steps to `end` (s), and the nodes there.
fn run(
    scene: &Scene,
    parameters: &IntegrationParameters,
    end: f64,
) -> (Vec<StepReport>, Vec<Vector3>) {
    let mut simulation = Simulation::new(scene, parameters).unwrap();
    let mut steps = Vec::new();
    while simulation.time() < end {
        steps.push(simulation.advance(end).unwrap());
    }
    (steps, simulation.positions().to_vec())
}

fn apart(a: &[Vector3], b: &[Vector3]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f64::max)
}

#[test]
fn automatic_steps_do_not_miss_a_blow_or_a_jerk() {
    for scene in [struck(), jerked()] {
        let fine = parameters(Scheme::ImplicitMidpoint, StepSize::Fixed(2e-4));
        let (_, exact) = run(&scene, &fine, 0.3);
        let (_, placed) = run(&scene, &fine, 1e-3);
        let way = apart(&exact, &placed);
        assert!(way > 0.03, "{way} m");
        for scheme in SCHEMES {
            let (steps, found) = run(&scene, &parameters(scheme, automatic(1e-2, 0.1)), 0.3);
            let error = apart(&found, &exact) / way;
            println!(
                "{scheme:?}: {error:.1e} of {way} m in {} steps",
                steps.len()
            );
            // If the event is missed, the error is 1. The schemes damp only the waves that a jerk
            // sends along the rod.
            let allowed = if scheme == Scheme::ImplicitEuler {
                0.5
            } else {
                0.2
            };
            assert!(error < allowed, "{scheme:?}: {error}");
        }
    }
}

#[test]
fn corners_are_hit_exactly_and_the_step_after_them_is_small() {
    for (scene, corners) in [
        (struck(), vec![0.2, 0.201, 0.209, 0.21]),
        (jerked(), vec![0.2, 0.21, 0.22]),
    ] {
        for scheme in SCHEMES {
            for size in [automatic(1e-2, 0.1), StepSize::Fixed(0.03)] {
                let (steps, _) = run(&scene, &parameters(scheme, size), 0.3);
                for corner in &corners {
                    assert!(
                        steps.iter().any(|step| step.time == *corner),
                        "{corner} s, {scheme:?}, {size:?}"
                    );
                }
            }
            let (steps, _) = run(&scene, &parameters(scheme, automatic(1e-2, 0.1)), 0.3);
            let after = steps
                .iter()
                .position(|step| step.time == corners[0])
                .unwrap()
                + 1;
            assert!(
                steps[after].step < 1e-3,
                "{scheme:?}: {} s",
                steps[after].step
            );
        }
    }
}

#[test]
fn the_corners_of_a_smooth_motion_cost_little() {
    // A clamp that oscillates by 5 mm within a second, given by 100 points.
    let mut scene = cantilever();
    scene.clamps[0].motion.translation = (0..=100)
        .map(|k| 0.01 * f64::from(k))
        .map(|time| (time, 5e-3 * (1.0 - (TAU * time).cos()) * Vector3::z()))
        .collect();
    let (steps, _) = run(
        &scene,
        &parameters(Scheme::ImplicitEuler, automatic(0.1, 0.1)),
        1.0,
    );
    println!("{} steps", steps.len());
    // Three steps are taken from corner to corner; restarting with small steps would take twelve.
    assert!(steps.len() < 400, "{} steps", steps.len());
}

#[test]
fn a_force_that_nothing_announces_makes_steps_repeat() {
    // Forces of another solver are not events: only the error reveals them.
    for scheme in SCHEMES {
        let push = |simulation: &mut Simulation| {
            let mut forces = vec![Vector3::zeros(); EDGES + 1];
            forces[EDGES] = -0.5 * Vector3::z();
            simulation.set_external_forces(&forces, &[0.0; EDGES + 1]);
        };
        let end = |size: StepSize| {
            let mut simulation = run_with(&cantilever(), &parameters(scheme, size), 1.0);
            push(&mut simulation);
            let (mut retries, mut smallest) = (0, f64::INFINITY);
            while simulation.time() < 1.3 {
                let report = simulation.advance(1.3).unwrap();
                retries += report.retries;
                smallest = f64::min(smallest, report.step);
            }
            (simulation.positions()[EDGES].z, retries, smallest)
        };
        let (coarse, retries, smallest) = end(automatic(1e-2, 0.1));
        let (fine, ..) = end(StepSize::Fixed(1e-4));
        println!("{scheme:?}: {coarse} of {fine} m, {retries} retries, {smallest} s");
        assert!(fine < -0.05, "{fine}");
        assert!((1..20).contains(&retries), "{scheme:?}: {retries}");
        assert_close_in(scheme, coarse, fine, 0.1);
    }
}

#[test]
fn automatic_steps_err_less_with_a_smaller_tolerance() {
    // The cantilever is released from the horizontal.
    let kind = LoadKind::Gravity {
        acceleration: -9.81 * Vector3::z(),
    };
    let schedule = Vec::new();
    let scene = Scene {
        loads: vec![Load { kind, schedule }],
        ..cantilever()
    };
    for scheme in SCHEMES {
        let fine = parameters(scheme, StepSize::Fixed(1e-4));
        let (_, exact) = run(&scene, &fine, 0.3);
        let errors = [1.0, 0.1, 0.01].map(|tolerance| {
            let (steps, found) = run(&scene, &parameters(scheme, automatic(tolerance, 0.1)), 0.3);
            println!("{scheme:?}, {tolerance}: {} steps", steps.len());
            apart(&found, &exact)
        });
        println!("{errors:?}");
        // With implicit Euler the error falls by √10 a decade, because its local error is
        // proportional to the square of the step. Backward differences take the same steps with
        // the two larger tolerances, since their slow growth limits them.
        assert!(
            errors[1] <= errors[0] && errors[2] < 0.4 * errors[0],
            "{errors:?}"
        );
        assert!(errors[2] < 5e-3, "{errors:?}");
    }
}
