//! The engine compared with closed forms; the full table of checks is in `verify`.

use super::test_log::Log;
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Clamp, Motion, RodDescription, Scene};
use crate::mechanics::system::System;
use crate::mechanics::test_support::{
    advance_to, assert_close_in, clamp, fixed, fixed_steps, free_rods, gravity, pin, resumed,
    run_with, simulation_of, straight_rod,
};
use std::f64::consts::TAU;

#[test]
fn a_rod_begins_with_the_velocities_of_a_rigid_body() {
    let rod = RodDescription {
        velocity: Vector3::new(0.1, 0.2, 0.3),
        angular_velocity: Vector3::new(0.0, 4.0, 3.0),
        ..straight_rod(8, 2.0)
    };
    let scene = free_rods(vec![rod]);
    let simulation = simulation_of(&scene);
    // One metre from the middle along x, rotating about y and z.
    let velocities = simulation.velocities();
    assert!((velocities[8] - Vector3::new(0.1, 3.2, -3.7)).norm() < 1e-14);
    assert!((velocities[0] - Vector3::new(0.1, -2.8, 4.3)).norm() < 1e-14);
}

pub(super) fn heavy_cantilever(edges: usize) -> Scene {
    Scene {
        rods: vec![straight_rod(edges, 1.0)],
        clamps: vec![clamp(0, 0)],
        loads: vec![gravity(9.81)],
        ..Scene::default()
    }
}

#[test]
fn heavy_cantilever_converges_to_the_elastica_with_second_order() {
    // γ = ρgAL³/EI = 15.696; tip of the inextensible elastica (x, drop)/L.
    let exact = Vector3::new(0.515_778_977_743_64, 0.0, -0.793_829_887_966_485);
    let mut errors = Vec::new();
    for edges in [25, 50, 100] {
        let mut simulation = simulation_of(&heavy_cantilever(edges));
        let report = simulation.find_equilibrium().unwrap();
        let error = (simulation.positions()[edges] - exact).norm();
        println!(
            "{edges} edges: {error:.3e} of L in {} iterations",
            report.newton_iterations
        );
        errors.push(error);
    }
    assert!(errors[1] < 3e-4, "{errors:?}");
    assert!(
        errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0,
        "{errors:?}"
    );
}

#[test]
fn a_free_rod_conserves_energy_and_momentum_with_the_midpoint_rule() {
    let mut rod = straight_rod(20, 1.0);
    rod.angular_velocity = Vector3::new(0.3, 1.0, 2.0);
    rod.velocity = Vector3::new(0.1, -0.2, 0.05);
    let scene = free_rods(vec![rod]);
    let parameters = IntegrationParameters {
        force_tolerance: 1e-9,
        ..fixed_steps(Scheme::ImplicitMidpoint, 2e-3)
    };
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let start = simulation.energies();
    let total = |e: &Energies| e.kinetic + e.elastic();
    advance_to(&mut simulation, 1.0);
    let end = simulation.energies();
    assert_eq!(simulation.time(), 1.0);
    let drift = (total(&end) / total(&start) - 1.0).abs();
    println!("energy drift {drift:.3e}");
    assert!(drift < 1e-4, "{drift}");
}

#[test]
fn a_restored_simulation_continues_bit_for_bit() {
    let parameters = fixed(1e-2);
    let scene = heavy_cantilever(20);
    let mut through = Simulation::new(&scene, &parameters).unwrap();
    let mut first = Simulation::new(&scene, &parameters).unwrap();
    for _ in 0..20 {
        through.advance(1.0).unwrap();
        first.advance(1.0).unwrap();
    }
    let mut second = resumed(&scene, &parameters, &first);
    for _ in 0..20 {
        through.advance(1.0).unwrap();
        second.advance(1.0).unwrap();
    }
    assert_eq!(through.positions(), second.positions());
    assert_eq!(through.velocities(), second.velocities());
}

#[test]
fn a_clamp_that_holds_a_whole_edge_turns_its_frame() {
    // The twisted part extends from the middle of the first edge to the last node: the energy is ½
    // GJ φ²/(L − l/2), for either node of the held edge.
    let (edges, turned) = (10, 4.0);
    for [head, neighbour, tail] in [[0, 1, edges], [edges, edges - 1, 0]] {
        let motion = Motion {
            angle: vec![(0.0, 0.0), (1.0, turned)],
            ..Motion::default()
        };
        let scene = Scene {
            rods: vec![straight_rod(edges, 1.0)],
            clamps: vec![
                Clamp {
                    motion,
                    ..clamp(0, head)
                },
                pin(0, neighbour),
                clamp(0, tail),
            ],
            ..Scene::default()
        };
        let parameters = fixed(0.1);
        let mut simulation = run_with(&scene, &parameters, 1.0);
        simulation.find_equilibrium().unwrap();
        let twisting = scene.rods[0].stiffness.twisting;
        let expected = 0.5 * twisting * turned * turned / (1.0 - 0.5 / edges as f64);
        let got = simulation.energies().twisting;
        assert!((got / expected - 1.0).abs() < 1e-12, "{got} {expected}");
        let rate = turned / (1.0 - 0.5 / edges as f64);
        let rates = simulation.twist_rates();
        for got in &rates[1..edges - 1] {
            assert!((got.abs() / rate - 1.0).abs() < 1e-9, "{got} {rate}");
        }
    }
}

/// A rod held at both ends, or from its first whole edge on. Its head makes a number of turns
/// within a second.
fn turned(turns: f64, holds_whole_edge: bool) -> Scene {
    let motion = Motion {
        angle: vec![(0.0, 0.0), (1.0, turns * TAU)],
        ..Motion::default()
    };
    let mut clamps = vec![
        Clamp {
            motion,
            ..clamp(0, 0)
        },
        clamp(0, 10),
    ];
    if holds_whole_edge {
        clamps.push(pin(0, 1));
    }
    Scene {
        rods: vec![straight_rod(10, 1.0)],
        clamps,
        ..Scene::default()
    }
}

#[test]
fn turns_of_a_clamp_count_however_long_the_steps_are() {
    for holds_whole_edge in [false, true] {
        for step in [0.25, 0.1, 1e-2] {
            let scene = turned(100.0, holds_whole_edge);
            let parameters = fixed(step);
            let simulation = run_with(&scene, &parameters, 2.0);
            let length = if holds_whole_edge { 0.95 } else { 1.0 };
            let angle = 100.0 * TAU;
            let expected = 0.5 * scene.rods[0].stiffness.twisting * angle * angle / length;
            let got = simulation.energies().twisting;
            assert_close_in(step, got, expected, 1e-6);
        }
    }
}

#[test]
fn turns_about_an_axis_across_the_rod_count_as_in_small_steps() {
    // The head rotates about an axis oblique to its tangent, three turns in a second.
    let twist = |step: f64| {
        let mut scene = turned(3.0, false);
        scene.clamps[0].motion.axis = Some(Vector3::new(2.0, 0.5, 0.3).normalize());
        let parameters = fixed(step);
        let mut system = System::new(&scene).unwrap();
        let mut unknowns = system.assembly.unknowns.clone();
        let mut time = 0.0;
        // The rod itself stays straight: only the clamp rotates.
        while time < 1.0 {
            time = (time + parameters.step.largest()).min(1.0);
            system.drive(time, &mut unknowns);
            system.update_geometry(&unknowns);
            system.commit_frames();
        }
        system.geometry.twist(0)
    };
    let fine = twist(1e-3);
    assert!(fine.abs() > 2.5 * TAU, "{fine}");
    for step in [1.0 / 3.0, 0.5, 1.0] {
        assert!(
            (twist(step) - fine).abs() < 1e-9,
            "{step} s: {} {fine}",
            twist(step)
        );
    }
}

#[test]
fn external_forces_act_like_loads() {
    let heavy = heavy_cantilever(10);
    let light = Scene {
        loads: Vec::new(),
        ..heavy.clone()
    };
    let parameters = IntegrationParameters::default();
    let mut loaded = Simulation::new(&heavy, &parameters).unwrap();
    let mut pushed = Simulation::new(&light, &parameters).unwrap();
    let weight = heavy.rods[0].mass_per_length * 0.1 * -9.81;
    let mut forces = vec![Vector3::new(0.0, 0.0, weight); 11];
    forces[0] *= 0.5;
    forces[10] *= 0.5;
    pushed.set_external_forces(&forces, &[0.0; 11]);
    for _ in 0..20 {
        loaded.advance(1.0).unwrap();
        pushed.advance(1.0).unwrap();
    }
    let tip = loaded.positions()[10];
    assert!(tip.z < -1e-3);
    assert!((pushed.positions()[10] - tip).norm() < 1e-9);
}

#[test]
fn a_clamp_that_cannot_be_is_named() {
    let mut scene = heavy_cantilever(5);
    scene.clamps[0].node = 9;
    let error = Simulation::new(&scene, &IntegrationParameters::default())
        .err()
        .unwrap();
    assert_eq!(
        error.to_string(),
        "rod `rod`: a clamp names node 9, but the rod has 6 nodes"
    );
}

#[test]
fn a_short_step_to_an_output_time_converges() {
    // At 0.1 µs the last digit of a position is an inertial force of 4e-5 N, a thousand times the
    // tolerance without inertia.
    for remainder in [6e-5, 1e-6, 1e-7] {
        let mut simulation = simulation_of(&heavy_cantilever(50));
        for until in [10e-3 + remainder, 20e-3 + remainder] {
            while simulation.time() < until {
                let report = simulation.advance(until).unwrap();
                assert_eq!(report.retries, 0, "{remainder} s: {report:?}");
            }
        }
        let drop = -simulation.positions()[50].z;
        let free_fall = 0.5 * 9.81 * simulation.time().powi(2);
        assert_close_in(remainder, drop, free_fall, 0.1);
    }
}

#[test]
fn a_time_that_differs_by_rounding_takes_no_step() {
    for step in [
        StepSize::Fixed(1e-3),
        StepSize::Auto {
            tolerance: 1e-3,
            maximum: 1e-3,
        },
    ] {
        let parameters = IntegrationParameters {
            step,
            ..IntegrationParameters::default()
        };
        let mut simulation = run_with(&heavy_cantilever(50), &parameters, 0.3);
        let (positions, velocities) = (
            simulation.positions().to_vec(),
            simulation.velocities().to_vec(),
        );
        let later = 0.3_f64.next_up();
        assert_eq!(simulation.advance(later).unwrap().time, later);
        assert_eq!(simulation.time(), later);
        assert_eq!(simulation.positions(), positions);
        assert_eq!(simulation.velocities(), velocities);
        assert_eq!(simulation.advance(0.31).unwrap().retries, 0);
    }
}

/// Runs `scene` and returns the logged warnings and the error that ended it early.
fn warnings(scene: &Scene, parameters: &IntegrationParameters, end: f64) -> Vec<String> {
    let log = Log::default();
    let ended = tracing::subscriber::with_default(log.clone(), || {
        let mut simulation = Simulation::new(scene, parameters).unwrap();
        while simulation.time() < end {
            simulation.advance(end)?;
        }
        Ok::<_, SimulationError>(())
    });
    let mut lines = log.lines();
    lines.extend(ended.err().map(|error| error.to_string()));
    lines
}

#[test]
fn a_sixfold_stretch_draws_a_warning() {
    let mut scene = Scene {
        rods: vec![straight_rod(10, 0.2)],
        clamps: vec![clamp(0, 0), clamp(0, 10)],
        ..Scene::default()
    };
    let fixed = fixed(0.01);
    assert!(warnings(&scene, &fixed, 1.0).is_empty());
    let way = vec![(0.0, Vector3::zeros()), (0.5, Vector3::x())];
    scene.clamps[1].motion.translation = way;
    let said = warnings(&scene, &fixed, 1.0);
    assert!(
        said.len() == 1 && said[0].contains("`rod` is stretched"),
        "{said:?}"
    );
}

#[test]
fn the_midpoint_rule_remarks_energy_created_by_large_steps() {
    let scene = heavy_cantilever(20);
    let with = |step: f64| fixed_steps(Scheme::ImplicitMidpoint, step);
    assert!(warnings(&scene, &with(1e-3), 1.0).is_empty());
    let said = warnings(&scene, &with(10.0), 1000.0);
    assert!(said.iter().any(|line| line.contains("gained")), "{said:?}");
}
