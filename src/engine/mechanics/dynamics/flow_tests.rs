//! Rods in a viscous fluid that are joined or next to held rods.

use super::*;
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{
    JointKind, Load, RodDescription, Scene, Spring, Stiffness, Strength,
};
use crate::mechanics::test_support::{
    assert_close_in, at, at_rest, body, clamp, distributed, fixed_steps, hinge, joint, line,
    point_force, run, spring, sprung_hinge,
};
use crate::mechanics::{SceneError, Vector3};
use std::f64::consts::PI;

const RADIUS: f64 = 1e-4;
const STOKESLETS: FluidModel = FluidModel::RegularizedStokeslets {
    viscosity: 1.0,
    regularization: 1.02,
    far_field_error: 1e-4,
};

/// A stiff rod with a modulus of 1 GPa and little inertia.
fn rod(name: &str, from: Vector3, to: Vector3, edges: usize) -> RodDescription {
    let area = PI * RADIUS * RADIUS;
    let stiffness = Stiffness::circular(1e9, 0.5, RADIUS);
    RodDescription::uniform(
        name,
        line(from, to, edges),
        stiffness,
        RADIUS,
        1000.0 * area,
    )
}

fn pull(force_per_length: Vector3) -> Load {
    distributed(None, force_per_length)
}

/// The simulation after `steps` steps of implicit Euler.
fn after(scene: &Scene, step: f64, steps: usize) -> Simulation {
    run(scene, Scheme::ImplicitEuler, step, step * steps as f64)
}

/// A filament 10 mm long and 20 edges in all, in pieces with the given numbers of edges.
fn filament(pieces: &[usize], kind: JointKind, force: Vector3) -> Scene {
    let (mut rods, mut joints, mut done) = (Vec::new(), Vec::new(), 0);
    for (k, edges) in pieces.iter().enumerate() {
        let place = |node: usize| Vector3::x() * (0.01 * node as f64 / 20.0);
        rods.push(rod(
            &format!("piece {k}"),
            place(done),
            place(done + edges),
            *edges,
        ));
        if k > 0 {
            joints.push(joint("joint", [at(k - 1, pieces[k - 1]), at(k, 0)], kind));
        }
        done += edges;
    }
    Scene {
        rods,
        joints,
        loads: vec![pull(force)],
        fluid: Some(STOKESLETS),
        ..Scene::default()
    }
}

/// Mean velocity after forty steps of 1 ms.
fn glide(scene: &Scene) -> Vector3 {
    let simulation = after(scene, 1e-3, 40);
    let velocities = simulation.velocities();
    velocities.iter().sum::<Vector3>() / velocities.len() as f64
}

#[test]
fn joined_pieces_glide_as_one_filament() {
    let along = Vector3::x() * 1e-3;
    let whole = glide(&filament(&[20], JointKind::Rigid, along));
    assert!(whole.x > 0.0);
    let hinge = hinge(Vector3::z());
    let sprung = sprung_hinge(Vector3::y(), 1e-6, 0.0);
    for kind in [JointKind::Rigid, JointKind::Ball, hinge, sprung] {
        let pieces = glide(&filament(&[7, 9, 4], kind, along));
        assert!((pieces / whole.x - Vector3::x()).norm() < 1e-3, "{kind:?}");
    }
    let across = Vector3::y() * 1e-3;
    let whole = glide(&filament(&[20], JointKind::Rigid, across));
    let pieces = glide(&filament(&[7, 9, 4], JointKind::Rigid, across));
    assert!(
        (pieces - whole).norm() < 1e-2 * whole.norm(),
        "{pieces} {whole}"
    );
}

#[test]
fn pieces_tied_by_springs_or_a_body_glide_as_one_filament() {
    let along = Vector3::x() * 1e-3;
    let whole = glide(&filament(&[20], JointKind::Rigid, along));
    let mut tied = filament(&[10, 10], JointKind::Ball, along);
    tied.joints.clear();
    tied.springs.push(Spring {
        rest_length: Some(0.0),
        ..spring("tie", [at(0, 10), at(1, 0)], 100.0)
    });
    let speed = glide(&tied).x;
    assert!((speed / whole.x - 1.0).abs() < 1e-3, "{speed} {}", whole.x);
    let mut borne = filament(&[10, 10], JointKind::Rigid, along);
    borne
        .bodies
        .push(body("bead", at(0, 10), 1e-9, Some([1e-17; 3])));
    let speed = glide(&borne).x;
    assert!((speed / whole.x - 1.0).abs() < 1e-3, "{speed} {}", whole.x);
}

#[test]
fn density_hardly_matters_where_viscosity_rules() {
    let along = Vector3::x() * 1e-3;
    let mut scene = filament(&[7, 13], JointKind::Rigid, along);
    let speed = glide(&scene).x;
    for density in [1e-2, 10.0] {
        for rod in &mut scene.rods {
            rod.mass_per_length = density * 1000.0 * PI * RADIUS * RADIUS;
        }
        let other = glide(&scene).x;
        assert_close_in(density, other, speed, 2e-2);
    }
}

#[test]
fn a_loaded_y_comes_to_rest_where_statics_has_it() {
    let end = |x: f64, z: f64| Vector3::new(x, 0.0, z) * 5e-3;
    let arms = [end(0.0, -1.0), end(0.7, 0.7), end(-0.7, 0.7)];
    let rods = arms.iter().enumerate();
    let scene = Scene {
        rods: rods
            .map(|(k, arm)| rod(&format!("arm {k}"), Vector3::zeros(), *arm, 5))
            .collect(),
        joints: vec![
            joint("joint", [at(0, 0), at(1, 0)], JointKind::Rigid),
            joint("joint", [at(0, 0), at(2, 0)], JointKind::Rigid),
        ],
        clamps: vec![clamp(0, 5)],
        loads: vec![point_force(1, 5, Vector3::new(1e-4, 5e-5, 0.0))],
        fluid: Some(STOKESLETS),
        ..Scene::default()
    };
    let tip = |simulation: &Simulation| simulation.positions()[11] - arms[1];
    let equilibrium = at_rest(&Scene {
        fluid: None,
        ..scene.clone()
    });
    let expected = tip(&equilibrium);
    let rests = tip(&after(&scene, 5e-2, 60));
    assert!(expected.norm() > RADIUS);
    assert!(
        (rests - expected).norm() < 1e-3 * expected.norm(),
        "{rests} {expected}"
    );
}

/// A filament that is pulled along next to another one.
fn beside(fix: impl Fn(&mut Scene)) -> Scene {
    let mut scene = filament(&[20], JointKind::Rigid, Vector3::zeros());
    let side = Vector3::y() * (5.0 * RADIUS);
    scene
        .rods
        .push(rod("wall", side, side + Vector3::x() * 0.01, 20));
    scene.loads = vec![distributed(Some(0), Vector3::x() * 1e-3)];
    fix(&mut scene);
    scene
}

#[test]
fn a_held_rod_obstructs_the_flow_as_a_clamped_one_does() {
    let speed = |scene: &Scene| after(scene, 1e-3, 40).velocities()[10].x;
    let alone = speed(&filament(&[20], JointKind::Rigid, Vector3::x() * 1e-3));
    let clamped = speed(&beside(|scene| {
        scene.clamps = (0..=20).map(|node| clamp(1, node)).collect();
    }));
    let held = speed(&beside(|scene| scene.rods[1].held = true));
    assert!(clamped < 0.75 * alone, "{clamped} {alone}");
    assert!((held / clamped - 1.0).abs() < 1e-6, "{held} {clamped}");
}

/// A tail whose first node slides along a held wire, with a force on this node.
fn bead(pulled: f64) -> Scene {
    let mut wire = rod("wire", Vector3::zeros(), Vector3::x() * 0.01, 20);
    wire.held = true;
    let foot = Vector3::x() * 4e-3;
    Scene {
        rods: vec![wire, rod("tail", foot, foot + Vector3::z() * 2e-3, 4)],
        joints: vec![joint("joint", [at(1, 0), at(0, 8)], JointKind::FREE_SLIDE)],
        loads: vec![point_force(1, 0, Vector3::x() * pulled)],
        fluid: Some(STOKESLETS),
        ..Scene::default()
    }
}

#[test]
fn a_tail_slides_along_a_wire_at_a_steady_pace() {
    // It passes three nodes of the wire, 0.5 mm apart.
    let scene = bead(1e-5);
    let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-2);
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let mut paces = Vec::new();
    while simulation.positions()[21].x < 6e-3 {
        let before = simulation.positions()[21].x;
        simulation.advance(f64::INFINITY).unwrap();
        paces.push((simulation.positions()[21].x - before) / 1e-2);
        assert!(paces.len() < 1000);
    }
    for pair in paces[20..].windows(2) {
        assert!((pair[1] / pair[0] - 1.0).abs() < 0.05, "{pair:?}");
    }
}

#[test]
fn pieces_part_in_the_fluid_where_their_weld_breaks() {
    let mut scene = filament(&[10, 10], JointKind::Ball, Vector3::x() * 1e-3);
    scene.joints[0].strength = Strength::of_force(1e-6);
    scene.loads = vec![point_force(1, 5, Vector3::x() * 1e-5)];
    let simulation = after(&scene, 1e-2, 100);
    let [behind, before] = [10, 11].map(|node| simulation.positions()[node].x);
    // The distance is greater than the range of the tie in the flow.
    assert!(before - behind > 2.0 * RADIUS, "{behind} {before}");
    let velocities = simulation.velocities();
    assert!(
        velocities[11].x > 0.0 && velocities[11].x < 2e-3,
        "{}",
        velocities[11].x
    );
    assert!(velocities[10].x < velocities[11].x);
}

#[test]
fn untied_nodes_at_one_place_are_refused() {
    let mut scene = filament(&[10, 10], JointKind::Ball, Vector3::x() * 1e-3);
    scene.joints.clear();
    let attempt = |scene: &Scene| Simulation::new(scene, &IntegrationParameters::default());
    let error = attempt(&scene).err().unwrap();
    assert!(matches!(
        error,
        SimulationError::BadScene(SceneError::Fluid(_))
    ));
    let message = error.to_string();
    for part in [
        "node 10 of rod `piece 0`",
        "node 0 of rod `piece 1`",
        "[[joints]]",
    ] {
        assert!(message.contains(part), "{message}");
    }
    // Both are clamped at one root, so they cannot separate.
    scene.clamps = vec![clamp(0, 10), clamp(1, 0)];
    assert!(attempt(&scene).is_ok());
    scene.clamps.pop();
    assert!(attempt(&scene).is_err());
}
