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

/// A naturally curved and twisted rod that hangs from a clamp and is twisted further.
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
    // No force acts on a node that is held where it was.
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

#[test]
fn a_clamp_that_is_carried_reaches_its_pose_and_keeps_it() {
    use crate::mechanics::{UnitQuaternion, rotation};
    let mut scene = heavy(vec![straight_rod(20, 0.5)]);
    scene.clamps.push(clamp(0, 0));
    let mut simulation = simulation_of(&scene);
    let before = simulation.clamp_pose(0).unwrap();
    let target = before.position + Vector3::new(0.01, 0.02, -0.03);
    let turn = rotation::from_vector(Vector3::new(0.3, -0.2, 0.4));
    let frame: UnitQuaternion = turn * before.frame;
    for until in [0.05, 0.1] {
        let carried = simulation.carry_clamp(0, target, Some(frame), until);
        carried.unwrap();
        advance_to(&mut simulation, until);
        let after = simulation.clamp_pose(0).unwrap();
        assert!((after.position - target).norm() < 1e-12);
        assert!(after.frame.angle_to(&frame) < 1e-9);
        let first = simulation.positions()[1] - simulation.positions()[0];
        let tangent = frame * Vector3::z();
        assert!(first.normalize().dot(&tangent) > 0.99);
    }
    assert!(simulation.carry_clamp(0, target, None, 0.09).is_err());
    let home = before.position;
    simulation.carry_clamp(0, home, None, 0.1).unwrap();
    simulation.find_equilibrium().unwrap();
    assert!((simulation.positions()[0] - home).norm() < 1e-12);
    assert!(simulation.carry_clamp(1, target, None, 1.0).is_err());
}

#[test]
fn given_curvature_is_that_of_a_uniform_actuation_and_part_of_the_state() {
    use crate::mechanics::scene::{ActuatedStrain, Actuation, Course};
    let actuated = |course| {
        let mut scene = heavy(vec![straight_rod(20, 0.5)]);
        scene.clamps.push(clamp(0, 0));
        scene.actuations.push(Actuation {
            rod: 0,
            strain: ActuatedStrain::SecondCurvature,
            part: [0.0, f64::INFINITY],
            course,
        });
        scene
    };
    let places = (0..21).map(|node| 0.5 * f64::from(node) / 20.0).collect();
    let given = actuated(Course::Given {
        places,
        values: vec![0.0; 21],
    });
    let mut uniform = simulation_of(&actuated(Course::Uniform(vec![(0.0, 3.0)])));
    let mut set = simulation_of(&given);
    set.set_actuation(0, &[3.0; 21]).unwrap();
    let mut restored = simulation_of(&given);
    restored.restore(set.state()).unwrap();
    for simulation in [&mut uniform, &mut set, &mut restored] {
        advance_to(simulation, 0.05);
    }
    assert_eq!(uniform.positions(), set.positions());
    assert_eq!(restored.positions(), set.positions());
    assert!(set.set_actuation(0, &[3.0; 20]).is_err());
    assert!(set.set_actuation(1, &[3.0; 21]).is_err());
}
