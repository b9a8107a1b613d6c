//! Rods that land on a floor, with the prediction alone.

use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{RodDescription, Scene, Stiffness};
use crate::mechanics::system::copy_positions;
use crate::mechanics::test_support::{SOFT_MODELS, ground};
use std::f64::consts::PI;

const RADIUS: f64 = 1e-3;
const GAP: f64 = 1e-5;
const STEP: f64 = 1e-3;
const FRICTION: f64 = 0.3;

/// Eighteen short rods side by side, a hundredth of a radius above a floor.
fn raft(model: ContactModel) -> Scene {
    let (modulus, density) = (1e7, 1000.0);
    let area = PI * RADIUS * RADIUS;
    let stiffness = Stiffness::circular(modulus, 0.5, RADIUS);
    let rods = (0..18).map(|rod| {
        let node = |k: usize| Vector3::new(0.01 * rod as f64, 5e-3 * k as f64, RADIUS + GAP);
        let nodes = (0..3).map(node).collect();
        let name = format!("rod {rod}");
        RodDescription::uniform(&name, nodes, stiffness, RADIUS, density * area)
    });
    Scene {
        rods: rods.collect(),
        planes: vec![ground()],
        contact: Some(ContactParameters {
            model,
            friction: FRICTION,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    }
}

/// Predicted displacements of the nodes of a scene in a step with the same initial velocity
/// everywhere, m.
fn moves(scene: &Scene, velocity: Vector3) -> Option<Vec<Vector3>> {
    let mut system = System::new(scene).unwrap();
    let start = system.assembly.unknowns.clone();
    let nodes = start.len() / STRIDE;
    let mut stage = Stage {
        step: STEP,
        keeps_spin: false,
        acceleration_step: STEP,
        start: start.clone(),
        velocity: vec![0.0; start.len()],
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions: vec![Vector3::zeros(); nodes],
        angles: vec![0.0; nodes],
    };
    copy_positions(&start, &mut stage.positions);
    for node in 0..nodes {
        for axis in 0..3 {
            stage.velocity[STRIDE * node + axis] = velocity[axis];
        }
    }
    let mut unknowns = start.clone();
    for (k, velocity) in stage.velocity.iter_mut().enumerate() {
        if system.assembly.held[k] {
            *velocity = 0.0;
        }
        unknowns[k] += STEP * *velocity;
    }
    system.update_candidates(&unknowns);
    system.begin_iterations(&stage);
    system.linearize(&unknowns, Some(&stage));
    let predicted = system.predict_contacts(&mut unknowns, &stage, RADIUS);
    let node = |node: usize| position(&unknowns, node) - position(&start, node);
    predicted.then(|| (0..nodes).map(node).collect())
}

#[test]
fn rods_that_land_keep_of_their_speed_what_friction_leaves() {
    for model in SOFT_MODELS {
        let scene = raft(model);
        // The floor stops the whole fall, and friction slows the slide as far as it can.
        let fall = 0.5;
        for slide in [0.0, 0.1, 0.5, 1.0] {
            let velocity = Vector3::new(0.6 * slide, 0.8 * slide, -fall);
            let left = (slide - FRICTION * (fall - GAP / STEP)).max(0.0);
            let along = Vector3::new(0.6, 0.8, 0.0) * (left * STEP);
            for moved in moves(&scene, velocity).unwrap() {
                let error = moved - along;
                assert!(error.xy().norm() < 0.02 * STEP * fall, "{slide}: {moved}");
                // The rods rest where the contact law carries the force that stopped them.
                assert!(error.z > -GAP && error.z < GAP, "{slide}: {moved}");
            }
        }
    }
}

#[test]
fn rods_that_would_pass_each_other_within_a_step_stay_on_their_side() {
    // Each rod is over the middle of a held rod that crosses it; without contact it would be 1.5
    // diameters away on the other side at the end of the step.
    let mut scene = raft(ContactModel::ImplicitContact);
    scene.planes.clear();
    let crossed = scene.rods.clone().into_iter().map(|mut rod| {
        let middle = rod.centreline[1] - Vector3::z() * (2.0 * RADIUS + GAP);
        rod.centreline = [-4e-3, 4e-3]
            .map(|along| middle + Vector3::x() * along)
            .into();
        rod.name.push_str(" below");
        rod.held = true;
        rod
    });
    scene.rods = scene.rods.clone().into_iter().chain(crossed).collect();
    let moved = moves(&scene, Vector3::z() * (-3.0 * RADIUS / STEP)).unwrap();
    for rod in 0..18 {
        let middle = moved[3 * rod + 1];
        assert!(middle.z.abs() < 2.0 * GAP, "{rod}: {middle}");
    }
}

#[test]
fn rods_without_contact_stay_where_they_are() {
    assert!(moves(&raft(ContactModel::ImplicitContact), Vector3::z()).is_none());
}
