//! Nodes that are grasped and released, compared with clamps of the scene and with untouched rods.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{LoadKind, RodDescription, Scene};
use crate::mechanics::test_support::{
    advance_to, at_rest, clamp, curved, farthest, gravity, pin, simulation_of, straight_rod,
};

const WHOLE: Grasp = Grasp {
    position: true,
    frame: true,
};

fn heavy(rods: Vec<RodDescription>) -> Scene {
    Scene {
        rods,
        loads: vec![gravity(9.81)],
        ..Scene::default()
    }
}

fn elastic(simulation: &Simulation) -> f64 {
    let energies = simulation.energies();
    energies.stretching + energies.bending + energies.twisting
}

fn apart(one: &Simulation, other: &Simulation) -> f64 {
    farthest(one.positions(), other.positions())
}

#[test]
fn a_straight_rod_grasped_anywhere_hangs_as_one_clamped_there() {
    for node in [0, 1, 7, 19, 20] {
        let mut clamped = heavy(vec![straight_rod(20, 0.5)]);
        let mut grasped = simulation_of(&clamped);
        grasped.grasp(node, WHOLE).unwrap();
        clamped.clamps.push(clamp(0, node));
        let clamped = at_rest(&clamped);
        grasped.find_equilibrium().unwrap();
        assert!(apart(&clamped, &grasped) < 1e-9, "{node}");
        assert!((elastic(&clamped) / elastic(&grasped) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_position_that_is_grasped_is_a_hinge() {
    let mut scene = heavy(vec![straight_rod(20, 0.5)]);
    scene.clamps.push(clamp(0, 0));
    let mut grasped = simulation_of(&scene);
    let hinge = Grasp {
        position: true,
        frame: false,
    };
    grasped.grasp(20, hinge).unwrap();
    scene.clamps.push(pin(0, 20));
    let clamped = at_rest(&scene);
    grasped.find_equilibrium().unwrap();
    assert!(apart(&clamped, &grasped) < 1e-9);
}

/// A rod that is naturally curved and twisted, hangs from a clamp, and is twisted further.
fn hanging() -> Scene {
    let mut scene = heavy(vec![RodDescription {
        natural_shape: curved([1.5, 0.4], 2.0),
        ..straight_rod(40, 0.5)
    }]);
    scene.clamps.push(clamp(0, 0));
    scene
}

#[test]
fn taking_hold_and_letting_go_leaves_the_rod_as_it_was() {
    let scene = hanging();
    let mut touched = at_rest(&scene);
    let before = elastic(&touched);
    let mut clamps = Vec::new();
    for node in [12, 25, 40] {
        clamps.push(touched.grasp(node, WHOLE).unwrap());
        let part = elastic(&touched) / before - 1.0;
        assert!(part.abs() < 1e-3, "{node}: {part}");
    }
    // Nothing pulls at a node that is held where it was.
    let untouched = at_rest(&scene);
    touched.find_equilibrium().unwrap();
    assert!(
        apart(&touched, &untouched) < 2e-5,
        "{}",
        apart(&touched, &untouched)
    );
    for clamp in [clamps[1], clamps[0], clamps[2]] {
        touched.release(clamp).unwrap();
    }
    touched.find_equilibrium().unwrap();
    assert!(apart(&touched, &untouched) < 1e-9);
    assert!((elastic(&touched) / before - 1.0).abs() < 1e-9);
}

#[test]
fn a_clamp_of_the_scene_can_let_go() {
    let mut falling = simulation_of(&heavy(vec![straight_rod(20, 0.5)]));
    let mut scene = heavy(vec![straight_rod(20, 0.5)]);
    scene.clamps.push(clamp(0, 7));
    let mut released = simulation_of(&scene);
    released.release(0).unwrap();
    for simulation in [&mut falling, &mut released] {
        advance_to(simulation, 0.05);
    }
    assert!(apart(&falling, &released) < 1e-9);
    assert!(falling.positions()[0].z < -0.01);
}

#[test]
fn what_cannot_be_grasped_or_released_is_refused_with_the_reason() {
    let mut scene = hanging();
    scene.rods.push(RodDescription {
        held: true,
        name: "post".into(),
        ..straight_rod(3, 0.1)
    });
    let mut simulation = simulation_of(&scene);
    let clamp = simulation.grasp(5, WHOLE).unwrap();
    let mut refusals = Vec::new();
    for node in [0, 5, 41, 1000] {
        refusals.push(simulation.grasp(node, WHOLE).unwrap_err().to_string());
    }
    simulation.release(clamp).unwrap();
    for clamp in [clamp, 99] {
        refusals.push(simulation.release(clamp).unwrap_err().to_string());
    }
    let reasons = [
        "node 0 of rod `rod` cannot be grasped: a clamp holds it",
        "node 5 of rod `rod` cannot be grasped: a clamp holds it",
        "node 0 of rod `post` cannot be grasped: its rod is a rigid obstacle",
        "node 1000 does not exist; the scene has 45 nodes",
        "clamp 1 is already released",
        "clamp 99 does not exist",
    ];
    assert_eq!(refusals, reasons);
}

#[test]
fn a_factor_scales_a_load_and_its_potential() {
    let mut whole = simulation_of(&hanging());
    let mut scene = hanging();
    scene.loads[0].kind = LoadKind::Gravity {
        acceleration: Vector3::z() * -9.81 * 4.0,
    };
    let mut scaled = simulation_of(&scene);
    scaled.set_load_factor(0, 0.25).unwrap();
    assert!(scaled.set_load_factor(1, 0.25).is_err());
    whole.find_equilibrium().unwrap();
    scaled.find_equilibrium().unwrap();
    assert!(apart(&whole, &scaled) < 1e-9);
    let ratio = scaled.energies().gravitational / whole.energies().gravitational;
    assert!((ratio - 1.0).abs() < 1e-9);
}
