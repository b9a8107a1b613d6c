//! Rods of viscous material.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{
    Clamp, Load, LoadKind, Motion, NaturalShape, RodDescription, Scene, Stiffness,
};
use crate::mechanics::system::System;

const LENGTH: f64 = 0.4;

fn rod(closed: bool) -> RodDescription {
    let nodes = if closed { 9 } else { 11 };
    let node = |k: usize| {
        let s = k as f64 / 10.0;
        let angle = std::f64::consts::TAU * k as f64 / 9.0;
        match closed {
            true => Vector3::new(angle.cos(), angle.sin(), 0.2 * (2.0 * angle).sin()) * 0.06,
            false => Vector3::new(s, 0.2 * (3.0 * s).sin(), 0.1 * s * s) * LENGTH,
        }
    };
    let stiffness = Stiffness {
        stretching: 30.0,
        bending: [0.02, 0.05],
        twisting: 0.03,
    };
    RodDescription {
        closed,
        retardation_time: 0.05,
        natural_shape: NaturalShape::Curved {
            curvature: [0.7, -0.4],
            twist: 0.5,
        },
        ..RodDescription::uniform("rod", (0..nodes).map(node).collect(), stiffness, 4e-3, 0.02)
    }
}

fn clamp(node: usize) -> Clamp {
    Clamp {
        rod: 0,
        node,
        holds_position: true,
        holds_frame: true,
        motion: Motion::default(),
    }
}

fn scene() -> Scene {
    Scene {
        rods: vec![rod(false)],
        clamps: vec![clamp(0)],
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: Vector3::new(0.0, 1.0, -9.81),
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    }
}

fn parameters(scheme: Scheme) -> IntegrationParameters {
    IntegrationParameters {
        scheme,
        step: StepSize::Fixed(2e-3),
        ..IntegrationParameters::default()
    }
}

/// Unknowns that are moved by some thousandths, differently with every `seed`.
fn moved(unknowns: &[f64], held: &[bool], seed: f64) -> Vec<f64> {
    let shift = |k: usize| match held[k] {
        true => 0.0,
        false => 4e-3 * (7.3 * k as f64 + seed).sin(),
    };
    unknowns
        .iter()
        .enumerate()
        .map(|(k, q)| q + shift(k))
        .collect()
}

/// Without inertia, only the forces of springs and dashpots count.
fn stage(system: &System, start: &[f64], step: f64) -> crate::mechanics::system::Stage {
    let mut positions = vec![Vector3::zeros(); system.assembly.rods.nodes];
    crate::mechanics::system::copy_positions(start, &mut positions);
    crate::mechanics::system::Stage {
        step,
        acceleration_step: f64::INFINITY,
        start: start.to_vec(),
        velocity: vec![0.0; start.len()],
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        positions,
    }
}

#[test]
fn forces_are_those_of_dashpots_and_the_jacobian_is_their_derivative() {
    for closed in [false, true] {
        let mut scene = scene();
        scene.rods = vec![rod(closed)];
        scene.loads.clear();
        if closed {
            scene.clamps.clear();
        }
        let mut system = System::new(&scene).unwrap();
        let placed = system.assembly.unknowns.clone();
        let held = system.assembly.held.clone();
        let [earliest, last, start, end] =
            [0.0, 1.0, 2.0, 3.0].map(|seed| moved(&placed, &held, seed));
        for unknowns in [&earliest, &last] {
            system.begin_damping(unknowns);
            system.damping.accept();
        }
        system.begin_damping(&start);
        let step = 0.02;
        system.damp(step, [-0.3, 0.1]);
        let stage = stage(&system, &start, step);
        // T/H: the dashpots hold ½ T/H K (ε − ε̂)², of which `viscous_loss` is twice where ε̂ = εₙ.
        let mut other = System::new(&scene).unwrap();
        other.begin_damping(&start);
        other.damp(step, [0.0; 2]);
        let energy = |system: &mut System, unknowns: &[f64]| {
            system.evaluate(unknowns, Some(&stage));
            system.elastic_energy().total() + 0.5 * system.viscous_loss()
        };
        other.evaluate(&end, Some(&stage));
        let forces = other.residual.clone();
        let shift = 1e-6;
        let largest = forces.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        for k in (0..end.len()).filter(|&k| !held[k]) {
            let mut ends = [end.clone(), end.clone()];
            ends[0][k] += shift;
            ends[1][k] -= shift;
            let [ahead, behind] = ends.map(|unknowns| energy(&mut other, &unknowns));
            let expected = (ahead - behind) / (2.0 * shift);
            assert!((forces[k] - expected).abs() < 1e-6 * largest, "{k}");
        }
        system.linearize(&end, Some(&stage));
        let matrix = system.dense_matrix();
        assert!((&matrix - matrix.transpose()).amax() < 1e-9 * matrix.amax());
        for column in (0..end.len()).filter(|&k| !held[k]) {
            let mut ends = [end.clone(), end.clone()];
            ends[0][column] += shift;
            ends[1][column] -= shift;
            let [ahead, behind] = ends.map(|unknowns| {
                system.evaluate(&unknowns, Some(&stage));
                system.residual.clone()
            });
            for row in (0..end.len()).filter(|&k| !held[k]) {
                let expected = (ahead[row] - behind[row]) / (2.0 * shift);
                let error = (matrix[(row, column)] - expected).abs();
                assert!(error < 1e-6 * matrix.amax(), "{row} {column}");
            }
        }
    }
}

#[test]
fn a_rigid_turn_meets_no_resistance() {
    let mut scene = scene();
    scene.clamps.clear();
    let node = |k: usize| Vector3::new(k as f64, 0.1 * (k * k) as f64, 0.0) * 0.04;
    scene.rods[0].centreline = (0..=10).map(node).collect();
    let mut system = System::new(&scene).unwrap();
    let start = system.assembly.unknowns.clone();
    system.begin_damping(&start);
    system.damp(1e-3, [0.0; 2]);
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 1.0);
    let mut end = start.clone();
    for place in end.chunks_exact_mut(STRIDE) {
        let x = turn * Vector3::from_column_slice(&place[..3]);
        place[..3].copy_from_slice(x.as_slice());
    }
    system.update_geometry(&end);
    let turned = system.viscous_loss();
    system.update_geometry(&moved(&start, &system.assembly.held.clone(), 0.0));
    assert!(turned < 1e-20 * system.viscous_loss(), "{turned}");
}

#[test]
fn energy_falls_by_what_dashpots_take_and_the_scheme_damps() {
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let fine = IntegrationParameters {
            step: StepSize::Fixed(2e-4),
            ..parameters(scheme)
        };
        let mut simulation = Simulation::new(&scene(), &fine).unwrap();
        let start = simulation.energies().total();
        let (mut before, mut lost) = (start, 0.0);
        while simulation.time() < 0.4 {
            let loss = simulation.advance(0.4).unwrap().exchange.drag_loss;
            let now = simulation.energies().total();
            lost += loss;
            if scheme == Scheme::ImplicitEuler {
                assert!(loss >= 0.0 && now <= before, "{loss} {now} {before}");
            }
            before = now;
        }
        let fallen = start - before;
        println!("{scheme:?}: {fallen:e} {lost:e}");
        assert!(
            (lost / fallen - 1.0).abs() < 1e-2,
            "{scheme:?}: {lost} of {fallen}"
        );
    }
}

#[test]
fn a_checkpoint_of_a_damped_motion_is_exact() {
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let scene = scene();
        let run = |simulation: &mut Simulation, until: f64| {
            while simulation.time() < until {
                simulation.advance(until).unwrap();
            }
        };
        let mut whole = Simulation::new(&scene, &parameters(scheme)).unwrap();
        run(&mut whole, 0.1);
        let state = whole.state();
        run(&mut whole, 0.2);
        let mut again = Simulation::new(&scene, &parameters(scheme)).unwrap();
        again.restore(state).unwrap();
        run(&mut again, 0.2);
        assert_eq!(again.positions(), whole.positions());
        assert_eq!(again.resultants(), whole.resultants());
    }
}

#[test]
fn at_rest_there_is_no_damping() {
    let at_rest = |retardation_time: f64, moves: bool| {
        let mut scene = scene();
        scene.rods[0].retardation_time = retardation_time;
        let mut simulation = Simulation::new(&scene, &parameters(Scheme::ImplicitEuler)).unwrap();
        while moves && simulation.time() < 0.02 {
            simulation.advance(0.02).unwrap();
        }
        simulation.find_equilibrium().unwrap();
        (simulation.positions()[10], simulation.reaction_moment(0))
    };
    let (place, moment) = at_rest(0.0, false);
    for moves in [false, true] {
        let damped = at_rest(0.05, moves);
        assert!((damped.0 - place).norm() < 1e-7 && (damped.1 - moment).norm() < 1e-7);
    }
}

#[test]
fn the_midpoint_rule_refuses_viscous_rods() {
    let refused = Simulation::new(&scene(), &parameters(Scheme::ImplicitMidpoint));
    let message = refused.err().unwrap().to_string();
    assert!(message.contains("backward differences"), "{message}");
}
