//! Joined rods and bodies in motion and at rest.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Joint, JointKind, Load, RodDescription, RodNode, Scene};
use crate::mechanics::test_support::{
    advance_to, at, at_rest, body, clamp, fixed_steps, hinge, joint, line, point_force, section,
    sprung_hinge,
};

fn rod(name: &str, from: Vector3, to: Vector3, edges: usize) -> RodDescription {
    let stiffness = section(1e3, [1e-3, 2e-3], 1e-3);
    RodDescription::uniform(name, line(from, to, edges), stiffness, 2e-3, 0.01)
}

fn weld(one: RodNode, other: RodNode) -> Joint {
    joint("weld", [one, other], JointKind::Rigid)
}

fn tip_load(rod: usize, node: usize) -> Load {
    point_force(rod, node, Vector3::new(0.0, 1e-4, 2e-4))
}

#[test]
fn a_rod_welded_of_two_pieces_bends_and_twists_as_one() {
    let [a, b, c] = [0.0, 0.2, 0.3].map(|x| Vector3::x() * x);
    let whole = Scene {
        rods: vec![rod("whole", a, c, 30)],
        clamps: vec![clamp(0, 0)],
        loads: vec![tip_load(0, 30)],
        ..Scene::default()
    };
    let pieces = Scene {
        // The second piece runs in the opposite direction.
        rods: vec![rod("first", a, b, 20), rod("second", c, b, 10)],
        clamps: vec![clamp(0, 0)],
        joints: vec![weld(at(0, 20), at(1, 10))],
        loads: vec![tip_load(1, 0)],
        ..Scene::default()
    };
    let directed = |mut scene: Scene| {
        for rod in &mut scene.rods {
            rod.first_director = Some(Vector3::y());
        }
        scene
    };
    let tip = |scene: Scene, node: usize| {
        let simulation = at_rest(&directed(scene));
        simulation.positions()[node] - c
    };
    let (one, two) = (tip(whole, 30), tip(pieces, 21));
    assert!(one.norm() > 1e-3);
    // Two half vertices in series bend by the sum of their angles, a vertex by a force law in the
    // tangent of its angle.
    assert!((one - two).norm() < 1e-4 * one.norm(), "{one} {two}");
}

#[test]
fn a_sprung_hinge_off_its_rest_angle_starts_with_every_scheme_for_it() {
    let scene = Scene {
        rods: vec![
            rod("upper", Vector3::zeros(), Vector3::x() * 0.2, 4),
            rod("lower", Vector3::x() * 0.2, Vector3::x() * 0.4, 4),
        ],
        clamps: vec![clamp(0, 0)],
        joints: vec![joint(
            "elbow",
            [at(0, 4), at(1, 0)],
            sprung_hinge(Vector3::z(), 0.02, 0.3),
        )],
        ..Scene::default()
    };
    let tip = |scheme, step| {
        let mut simulation = Simulation::new(&scene, &fixed_steps(scheme, step)).unwrap();
        // The frames of the hinge have no inertia: they turn at once.
        advance_to(&mut simulation, 0.02);
        simulation.positions()[9]
    };
    let fine = tip(Scheme::ImplicitEuler, 1e-5);
    let coarse = tip(Scheme::BackwardDifferences, 2e-4);
    let moved = (fine - Vector3::x() * 0.4).norm();
    assert!((fine - coarse).norm() < 0.02 * moved, "{fine} {coarse}");
}

/// Two rods that are welded at right angles with a body at the corner, free and rotating.
fn tumbling() -> Scene {
    let mut rods = vec![
        rod("one", Vector3::zeros(), Vector3::x() * 0.1, 5),
        rod("other", Vector3::y() * 0.1, Vector3::zeros(), 5),
    ];
    for rod in &mut rods {
        rod.angular_velocity = Vector3::new(2.0, 3.0, 8.0);
    }
    // The rods rotate about one point; each has the velocity of its centroid.
    rods[0].velocity = rods[0]
        .angular_velocity
        .cross(&Vector3::new(0.05, 0.0, 0.0));
    rods[1].velocity = rods[1]
        .angular_velocity
        .cross(&Vector3::new(0.0, 0.05, 0.0));
    Scene {
        rods,
        joints: vec![weld(at(0, 0), at(1, 5))],
        bodies: vec![body("hub", at(0, 0), 0.02, Some([4e-6, 5e-6, 6e-6]))],
        ..Scene::default()
    }
}

#[test]
fn a_body_turns_about_each_of_its_axes_with_its_own_moment_of_inertia() {
    let moments = [4e-6, 5e-6, 6e-6];
    // The columns are the first and second directors and the tangent of the rod with the body.
    let axes = [Vector3::y(), Vector3::z(), Vector3::x()];
    for (axis, moment) in axes.into_iter().zip(moments) {
        let spin = axis * 3.0;
        let angular_momentum = |inertia: Option<[f64; 3]>| {
            let bar = RodDescription {
                first_director: Some(Vector3::y()),
                angular_velocity: spin,
                ..rod("bar", Vector3::zeros(), Vector3::x() * 0.1, 5)
            };
            let scene = Scene {
                rods: vec![bar],
                bodies: vec![body("hub", at(0, 2), 0.02, inertia)],
                ..Scene::default()
            };
            let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
            Simulation::new(&scene, &parameters).unwrap().momenta()[1]
        };
        let of_body = angular_momentum(Some(moments)) - angular_momentum(None);
        let missed = (of_body - spin * moment).norm() / (spin * moment).norm();
        assert!(missed < 1e-9, "{axis:?}: {of_body:?}");
    }
}

#[test]
fn a_body_that_tumbles_keeps_its_angular_momentum() {
    let lost = |scheme: Scheme, step: f64, offset: Vector3| {
        let mut scene = tumbling();
        scene.bodies[0].offset = offset;
        let mut simulation = Simulation::new(&scene, &fixed_steps(scheme, step)).unwrap();
        let [momentum, angular] = simulation.momenta();
        // The rotation exceeds a whole turn, so rotation vectors are reset several times.
        advance_to(&mut simulation, 1.0);
        let [momentum_after, angular_after] = simulation.momenta();
        assert!((momentum_after - momentum).norm() < 1e-9 * momentum.norm());
        (angular_after - angular).norm() / angular.norm()
    };
    let off_node = Vector3::new(0.02, -0.01, 0.03);
    for offset in [Vector3::zeros(), off_node] {
        let lost = |scheme, step| lost(scheme, step, offset);
        assert!(lost(Scheme::BackwardDifferences, 1e-3) < 1e-3);
        // The energy loss of implicit Euler is proportional to the step.
        let [whole, half] = [1e-3, 5e-4].map(|step| lost(Scheme::ImplicitEuler, step));
        assert!(whole < 0.1 && half < 0.6 * whole, "{whole} {half}");
    }
}

#[test]
fn tumbling_resumes_from_a_checkpoint_bit_for_bit() {
    let parameters = fixed_steps(Scheme::BackwardDifferences, 1e-3);
    let mut whole = Simulation::new(&tumbling(), &parameters).unwrap();
    let mut state = None;
    while whole.time() < 0.5 {
        whole.advance(0.5).unwrap();
        if state.is_none() && whole.time() > 0.3 {
            state = Some(whole.state());
        }
    }
    let mut resumed = Simulation::new(&tumbling(), &parameters).unwrap();
    resumed.restore(state.unwrap()).unwrap();
    advance_to(&mut resumed, 0.5);
    assert_eq!(whole.positions(), resumed.positions());
}

#[test]
fn joined_nodes_stay_one_point() {
    let mut scene = tumbling();
    scene.joints[0].kind = hinge(Vector3::z());
    let mut simulation =
        Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 1e-3)).unwrap();
    while simulation.time() < 0.1 {
        simulation.advance(0.1).unwrap();
        assert_eq!(simulation.positions()[0], simulation.positions()[11]);
    }
}
