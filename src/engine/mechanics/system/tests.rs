//! The whole residual against its energy, and the whole Jacobian against the residual, by finite
//! differences: rings, ghost edges on either side, moments, drag, contact with and without friction.

use super::*;
use crate::mechanics::contact::{ContactParameters, FrictionAt};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{
    Clamp, Inertia, Load, LoadKind, Motion, NaturalShape, Plane, RodDescription, Scene,
};
use crate::mechanics::test_support::{curved, drag, section};
use crate::mechanics::{Matrix3, Vector3};
use std::f64::consts::TAU;

fn rod(name: &str, centreline: Vec<Vector3>, closed: bool) -> RodDescription {
    let stiffness = section(30.0, [0.02, 0.05], 0.03);
    RodDescription {
        closed,
        twist: 0.7,
        natural_shape: curved([1.0, -2.0], 0.5),
        rotational_inertia_per_length: 0.01,
        ..RodDescription::uniform(name, centreline, stiffness, 0.05, 0.8)
    }
}

fn arc(nodes: usize, height: f64) -> Vec<Vector3> {
    (0..nodes)
        .map(|k| {
            let s = k as f64 / (nodes - 1) as f64;
            Vector3::new(s, 0.3 * (3.0 * s).sin(), height + 0.2 * s * s)
        })
        .collect()
}

fn ring(nodes: usize) -> Vec<Vector3> {
    (0..nodes)
        .map(|k| {
            let turn = std::f64::consts::TAU * k as f64 / nodes as f64;
            Vector3::new(
                0.4 * turn.cos(),
                0.4 * turn.sin(),
                2.0 + 0.1 * (2.0 * turn).sin(),
            )
        })
        .collect()
}

fn held(rod: usize, node: usize, holds_position: bool) -> Clamp {
    Clamp {
        rod,
        node,
        holds_position,
        holds_frame: true,
        motion: Motion::default(),
    }
}

/// A rod clamped at the start, with a frame held in the middle and another frame at the end;
/// beside it a ring with a clamp.
fn elastic_scene() -> Scene {
    Scene {
        rods: vec![rod("arc", arc(8, 0.0), false), rod("ring", ring(7), true)],
        clamps: vec![
            held(0, 0, true),
            held(0, 4, false),
            held(0, 7, false),
            held(1, 3, true),
        ],
        ..Scene::default()
    }
}

fn perturbed(system: &System, size: f64) -> Vec<f64> {
    let unknowns = system.assembly.unknowns.iter().enumerate();
    let shake = |k: usize| size * ((1.7 * k as f64).sin() + (0.3 * (k * k) as f64).cos());
    unknowns
        .map(|(k, q)| {
            if system.assembly.held[k] {
                *q
            } else {
                q + shake(k)
            }
        })
        .collect()
}

fn free(system: &System) -> Vec<usize> {
    (0..system.assembly.held.len())
        .filter(|&k| !system.assembly.held[k])
        .collect()
}

fn stage_at(system: &System, start: Vec<f64>) -> Stage {
    let nodes = system.assembly.rods.nodes;
    let mut positions = vec![Vector3::zeros(); nodes];
    copy_positions(&start, &mut positions);
    Stage {
        angles: angles_of(&start),
        step: 0.05,
        acceleration_step: 0.06,
        keeps_spin: false,
        velocity: start.iter().map(|q| (3.0 * q).sin()).collect(),
        start,
        drag: vec![Vector3::new(0.1, -0.2, 0.3); nodes],
        drag_velocity: vec![Vector3::new(-0.3, 0.1, 0.2); nodes],
        resistance: vec![Matrix3::new(2.0, 0.1, 0.2, 0.1, 3.0, 0.3, 0.2, 0.3, 4.0); nodes],
        flow_torque: vec![0.4; nodes],
        positions,
    }
}

/// Largest error of the Jacobian's columns against central differences, relative to its largest entry.
fn jacobian_error(system: &mut System, unknowns: &[f64], stage: Option<&Stage>, step: f64) -> f64 {
    system.linearize(unknowns, stage);
    let jacobian = system.dense_matrix();
    let mut worst = 0.0_f64;
    for column in free(system) {
        let mut difference = vec![0.0; unknowns.len()];
        for sign in [1.0, -1.0] {
            let mut moved = unknowns.to_vec();
            moved[column] += sign * step;
            system.evaluate(&moved, stage);
            for (entry, residual) in difference.iter_mut().zip(&system.residual) {
                *entry += sign * residual / (2.0 * step);
            }
        }
        for row in free(system) {
            worst = worst.max((difference[row] - jacobian[(row, column)]).abs());
        }
    }
    worst / jacobian.amax()
}

/// The scene with lumped masses, and with consistent inertia of rods that are naturally curved or
/// straight.
fn elastic_scenes() -> [Scene; 3] {
    [0, 1, 2].map(|case| {
        let mut scene = elastic_scene();
        for rod in &mut scene.rods {
            if case > 0 {
                rod.inertia = Inertia::Consistent;
            }
            if case == 2 {
                rod.natural_shape = NaturalShape::Straight;
            }
        }
        scene
    })
}

#[test]
fn the_residual_is_the_gradient_of_the_energy() {
    for scene in elastic_scenes() {
        let mut system = System::new(&scene).unwrap();
        let unknowns = perturbed(&system, 0.02);
        system.evaluate(&unknowns, None);
        let residual = system.residual.clone();
        let scale = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        let step = 1e-5;
        for k in free(&system) {
            let mut energy_at = |change: f64| {
                let mut moved = unknowns.clone();
                moved[k] += change;
                system.update_geometry(&moved);
                system.elastic_energy().total()
            };
            let slope = (8.0 * (energy_at(step) - energy_at(-step)) - energy_at(2.0 * step)
                + energy_at(-2.0 * step))
                / (12.0 * step);
            assert!(
                (slope - residual[k]).abs() < 1e-8 * scale,
                "unknown {k}: {slope} against {}",
                residual[k]
            );
        }
    }
}

#[test]
fn the_jacobian_of_elasticity_inertia_and_drag_is_exact() {
    for mut scene in elastic_scenes() {
        scene.loads.push(drag(None, 0.3, 0.2));
        let mut system = System::new(&scene).unwrap();
        let unknowns = perturbed(&system, 0.02);
        let stage = stage_at(&system, system.assembly.unknowns.clone());
        assert!(jacobian_error(&mut system, &unknowns, Some(&stage), 1e-6) < 1e-8);
        assert!(jacobian_error(&mut system, &unknowns, None, 1e-6) < 1e-8);
        let dense = system.dense_matrix();
        assert!((&dense - dense.transpose()).amax() < 1e-12 * dense.amax());
    }
}

#[test]
fn drag_follows_its_schedule() {
    let mut scene = elastic_scene();
    scene.loads.push(Load {
        schedule: vec![(0.0, 1.0), (2.0, 0.5)],
        ..drag(None, 0.3, 0.2)
    });
    let mut system = System::new(&scene).unwrap();
    let at_start = system.terms.drag.coefficients.clone();
    assert!(at_start.iter().any(|coefficient| *coefficient > 0.0));
    let mut unknowns = system.assembly.unknowns.clone();
    for (time, factor) in [(1.0, 0.75), (3.0, 0.5), (0.0, 1.0)] {
        system.drive(time, &mut unknowns);
        for (now, start) in system.terms.drag.coefficients.iter().zip(&at_start) {
            assert!((now - factor * start).abs() < 1e-15);
        }
    }
}

#[test]
fn the_jacobian_of_a_moment_is_exact() {
    let mut scene = elastic_scene();
    scene.loads.push(Load {
        kind: LoadKind::Moment {
            rod: 0,
            edge: 5,
            moment: Vector3::new(0.4, -0.3, 0.6),
        },
        schedule: vec![(0.0, 2.0)],
    });
    let mut system = System::new(&scene).unwrap();
    let unknowns = perturbed(&system, 0.02);
    assert!(jacobian_error(&mut system, &unknowns, None, 1e-6) < 1e-8);
}

/// A rod across another one over a plane, with friction; and, in a step, positions at which the
/// upper rod is pressed on the lower one and slides, and the lower one is on the plane.
fn pressed_rods(friction: f64, friction_at: FrictionAt) -> (System, Vec<f64>, Stage) {
    let across = (0..5).map(|k| Vector3::new(0.51, 0.3 + 0.23 * (k as f64 - 1.7), 0.22));
    let scene = Scene {
        rods: vec![
            rod("lower", arc(6, 0.06), false),
            rod("upper", across.collect(), false),
        ],
        planes: vec![Plane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: Some(friction),
            directed_friction: None,
        }],
        contact: Some(ContactParameters {
            distance_tolerance: 0.02,
            friction,
            friction_at,
            slip_tolerance: 1.0,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    };
    let mut system = System::new(&scene).unwrap();
    let contact = system.terms.contact.model.as_mut().unwrap();
    contact.set_stiffness(2.0);
    let start = perturbed(&system, 0.004);
    let mut unknowns = start.clone();
    for node in 0..system.assembly.rods.nodes {
        unknowns[STRIDE * node] += 0.01;
        unknowns[STRIDE * node + 2] -= if node < 6 { 0.012 } else { 0.024 };
    }
    let stage = stage_at(&system, start);
    system.update_candidates(&unknowns);
    (system, unknowns, stage)
}

#[test]
fn a_linearisation_after_an_evaluation_is_the_same_as_one_alone() {
    for friction_at in [FrictionAt::Centreline, FrictionAt::Surface] {
        let results = [false, true].map(|is_evaluated| {
            let (mut system, unknowns, stage) = pressed_rods(0.4, friction_at);
            let nodes = system.assembly.rods.nodes;
            // One node of the lower rod touches the plane and is held.
            system.assembly.held[..3].fill(true);
            let contact = system.terms.contact.model.as_mut().unwrap();
            contact.set_prescribed((0..nodes).map(|node| node == 0));
            // The contact forces of the first iteration are known in the second, in which the
            // upper rod is lifted.
            system.begin_iterations(&stage);
            system.linearize(&unknowns, Some(&stage));
            let mut lifted = unknowns;
            for node in 6..nodes {
                lifted[STRIDE * node + 2] += 0.1;
            }
            if is_evaluated {
                system.evaluate(&lifted, Some(&stage));
                system.linearize_evaluated(&lifted, Some(&stage));
            } else {
                system.linearize(&lifted, Some(&stage));
            }
            let contact = system.contact().unwrap();
            assert!(contact.contacts().len() * contact.plane_contacts().len() > 0);
            let near: Vec<_> = contact.touching().collect();
            assert!(near.len() > contact.contacts().len() + contact.plane_contacts().len());
            let (energy, count) = (contact.energy(), contact.contact_count());
            (system.dense_matrix(), system.residual, near, energy, count)
        });
        assert_eq!(results[0], results[1]);
    }
}

#[test]
fn the_jacobian_of_contact_and_friction_is_exact() {
    for friction in [0.0, 0.4] {
        let (mut system, unknowns, stage) = pressed_rods(friction, FrictionAt::Centreline);
        let error = jacobian_error(&mut system, &unknowns, Some(&stage), 1e-7);
        let contact = system.contact().unwrap();
        assert!(!contact.contacts().is_empty() && !contact.plane_contacts().is_empty());
        assert!(error < 1e-6, "friction {friction}: {error:e}");
        let mut direction = vec![0.0; unknowns.len()];
        system.linearize(&unknowns, Some(&stage));
        system.factor().unwrap();
        system.direction(&mut direction).unwrap();
        let product = system.dense_matrix() * nalgebra::DVector::from_row_slice(&direction);
        for k in free(&system) {
            assert!((product[k] + system.residual[k]).abs() < 1e-8 * product.amax());
        }
    }
}

#[test]
fn candidates_without_contact_are_in_the_pattern() {
    let across = |height: f64| {
        (0..5)
            .map(|k| Vector3::new(0.4, 0.2 * (f64::from(k) - 2.0), 2.0 + height))
            .collect::<Vec<_>>()
    };
    // A ring couples its ends, with or without contact.
    let scene = Scene {
        rods: vec![rod("ring", ring(7), true), rod("rod", across(1.0), false)],
        contact: Some(ContactParameters {
            distance_tolerance: 0.02,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    };
    let mut system = System::new(&scene).unwrap();
    let far = system.assembly.unknowns.clone();
    let at_height = |height: f64| {
        let mut unknowns = far.clone();
        for node in 7..12 {
            unknowns[STRIDE * node + 2] = 2.0 + height;
        }
        unknowns
    };
    let stage = stage_at(&system, far.clone());
    // Lowered so slowly that the last candidates were built before the first contact.
    let mut height = 1.0;
    let contacts = loop {
        let unknowns = at_height(height);
        system.update_candidates(&unknowns);
        system.linearize(&unknowns, Some(&stage));
        system.factor().unwrap();
        let contacts = system.contact().unwrap().contacts().len();
        if contacts > 0 {
            break contacts;
        }
        height -= 0.01;
    };
    assert!(contacts > 0 && height > 0.0);
}

/// A free, naturally straight ring of unit length and 120 edges, with frames that turn around four
/// times.
fn twisted_ring(contact: Option<ContactParameters>) -> Scene {
    let (edges, radius) = (120, 0.01);
    let corner = |k: usize| {
        let angle = TAU * k as f64 / edges as f64;
        Vector3::new(angle.cos(), angle.sin(), 0.0) / TAU
    };
    Scene {
        rods: vec![RodDescription {
            twist: 4.0 * TAU,
            natural_shape: NaturalShape::Straight,
            stiffness: section(4.0 / (radius * radius), [1.0, 1.0], 2.0 / 3.0),
            radius,
            ..rod("ring", (0..edges).map(corner).collect(), true)
        }],
        contact,
        ..Scene::default()
    }
}

#[test]
fn the_inertia_of_a_twisted_ring_is_that_of_its_eigenvalues() {
    // Without contact, with candidates that do not touch, and with contacts that push.
    let contact_at = |distance_tolerance| {
        Some(ContactParameters {
            distance_tolerance,
            ..ContactParameters::default()
        })
    };
    for (contact, touches) in [
        (None, false),
        (contact_at(0.001), false),
        (contact_at(0.05), true),
    ] {
        let mut system = System::new(&twisted_ring(contact)).unwrap();
        let unknowns = perturbed(&system, 1e-6);
        system.update_candidates(&unknowns);
        if let Some(contact) = system.contact() {
            assert!(!contact.candidates().is_empty());
        }
        let spin = system.assembly.shortest_edge.powi(2);
        for shift in [1.0, 100.0, 1e4, 1e6] {
            system.linearize(&unknowns, None);
            system.shift(shift, shift * spin);
            let contacts = system.contact().map_or(0, |c| c.contacts().len());
            assert_eq!(contacts > 0, touches);
            let dense = system.dense_matrix();
            let eigenvalues = dense.clone().symmetric_eigenvalues();
            let rounding = 1e-13 * eigenvalues.amax();
            assert!(eigenvalues.iter().all(|value| value.abs() > rounding));
            let negative = eigenvalues.iter().filter(|&&value| value < 0.0).count();
            let inertia = system.factor().unwrap().expect("a symmetric matrix");
            assert_eq!(inertia.negative, negative, "shift {shift}");

            let expected =
                nalgebra::DVector::from_fn(unknowns.len(), |k, _| (0.3 * k as f64).cos());
            let mut solution = &dense * &expected;
            system.solve(solution.as_mut_slice()).unwrap();
            let error = (solution - expected).amax();
            assert!(error < 1e-8, "shift {shift}: {error:e}");
            // The symmetric factors solved it: no others have replaced them.
            assert!(system.factor().unwrap().is_some(), "shift {shift}");
        }
    }
}

#[test]
fn a_stiff_post_does_not_stiffen_the_contacts_of_soft_rods() {
    let stiffness = |rods: &[RodDescription]| {
        let scene = Scene {
            rods: rods.to_vec(),
            contact: Some(ContactParameters::default()),
            ..Scene::default()
        };
        System::new(&scene)
            .unwrap()
            .terms
            .contact
            .model
            .unwrap()
            .stiffness()
    };
    let soft = rod("soft", arc(8, 0.0), false);
    let mut post = rod("post", arc(8, 1.0), false);
    post.stiffness.stretching *= 1e4;
    post.stiffness.bending = post.stiffness.bending.map(|stiffness| 1e4 * stiffness);
    let alone = stiffness(std::slice::from_ref(&soft));
    assert_eq!(stiffness(&[soft.clone(), post.clone()]), alone);
    assert!(stiffness(&[post.clone()]) > 1e3 * alone);
    // An obstacle does not bend at all.
    post.held = true;
    assert_eq!(stiffness(&[soft, post]), alone);
}
