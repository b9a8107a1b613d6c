//! Residual and Jacobian of joined rods against finite differences, and the plan of joints.

use super::*;
use crate::mechanics::contact::ContactModel;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{
    Body, Clamp, Joint, JointKind, RodDescription, RodNode, Scene, Spring, Strength,
    TurningStiffness,
};
use crate::mechanics::system::{Stage, copy_positions};
use crate::mechanics::test_support::{
    SOFT_MODELS, at, body, clamp, contact, curved, joint, line, obstacle, section, spring,
    sprung_hinge, weight,
};
use crate::mechanics::{JointError, Matrix3, SceneError};

fn rod(name: &str, from: Vector3, to: Vector3, edges: usize) -> RodDescription {
    let stiffness = section(30.0, [0.02, 0.05], 0.03);
    RodDescription {
        natural_shape: curved([1.0, -2.0], 0.5),
        twist: 0.3,
        rotational_inertia_per_length: 0.01,
        ..RodDescription::uniform(name, line(from, to, edges), stiffness, 0.01, 0.8)
    }
}

/// A star of five rods about the origin: the first two are welded, the third is at a hinge with a
/// body, the fourth passes through the origin with its middle welded too, and the fifth is in a
/// ball joint. A sixth hangs by a ball joint at the end of the first. Springs resist the hinge and
/// connect a clamped end, joined nodes and free ones; they are stretched, compressed, or without a
/// natural length. Other springs turn free ends, the sides of the hinge, and the hinge against the
/// clamp.
fn star() -> Scene {
    let origin = Vector3::zeros();
    let [a, b, c, d, e, f] = [
        [1.0, 0.1, 0.0],
        [-0.4, 0.9, 0.1],
        [-0.5, -0.8, 0.3],
        [0.1, 0.2, 0.9],
        [0.5, -0.6, -0.4],
        [1.5, 0.1, 0.4],
    ]
    .map(Vector3::from);
    Scene {
        rods: vec![
            rod("first", origin, a, 3),
            rod("second", b, origin, 3),
            rod("hinged", origin, c, 3),
            rod("through", -d, d, 4),
            rod("hanging", origin, e, 2),
            rod("last", a, f, 2),
        ],
        joints: vec![
            joint("weld", [at(0, 0), at(1, 3)], JointKind::Rigid),
            joint(
                "hinge",
                [at(2, 0), at(1, 3)],
                sprung_hinge(Vector3::new(0.6, 0.0, 0.8), 0.7, 0.2),
            ),
            joint("cross", [at(3, 2), at(0, 0)], JointKind::Rigid),
            joint("ball", [at(4, 0), at(0, 0)], JointKind::Ball),
            joint("end", [at(5, 0), at(0, 3)], JointKind::Ball),
        ],
        springs: vec![
            tie("bungee", [at(1, 0), at(5, 2)], Some(0.5)),
            tie("strut", [at(5, 0), at(2, 3)], Some(4.0)),
            tie("point", [at(4, 0), at(3, 4)], Some(0.0)),
            tie("placed", [at(4, 2), at(2, 2)], None),
            turning_spring("ends", [at(4, 1), at(5, 2)], Vector3::new(0.4, -0.3, 1.2)),
            turning_spring(
                "about the hinge",
                [at(2, 0), at(1, 3)],
                Vector3::new(0.1, 0.8, 0.2),
            ),
            turning_spring(
                "to the clamp",
                [at(1, 0), at(2, 0)],
                Vector3::new(-1.9, 0.5, 0.2),
            ),
        ],
        bodies: vec![
            carried("disk", at(2, 0), Some([0.02, 0.03, 0.04])),
            carried("hub", at(1, 3), Some([0.05, 0.03, 0.04])),
            carried("payload", at(5, 2), None),
            carried("flag", at(4, 2), Some([0.01, 0.02, 0.025])),
        ],
        clamps: vec![clamp(1, 0)],
        ..Scene::default()
    }
}

fn tie(name: &str, nodes: [RodNode; 2], rest_length: Option<f64>) -> Spring {
    Spring {
        rest_length,
        ..spring(name, nodes, 0.4)
    }
}

/// A spring that only turns the frames that it connects.
fn turning_spring(name: &str, nodes: [RodNode; 2], rest_rotation: Vector3) -> Spring {
    let turning = TurningStiffness {
        stiffness: 0.3,
        rest_rotation,
    };
    Spring {
        stiffness: 0.0,
        turning: Some(turning),
        ..tie(name, nodes, None)
    }
}

fn carried(name: &str, at: RodNode, inertia: Option<[f64; 3]>) -> Body {
    body(name, at, 0.3, inertia)
}

/// The unknowns that Newton's method moves.
pub(super) fn own(system: &System) -> Vec<usize> {
    let dependent = system.assembly.joints.dependent();
    let held = &system.assembly.held;
    (0..held.len())
        .filter(|&k| !held[k] && !dependent.contains(&k))
        .collect()
}

pub(super) fn perturbed(system: &mut System, size: f64) -> Vec<f64> {
    let mut unknowns = system.assembly.unknowns.clone();
    for k in own(system) {
        unknowns[k] += size * ((1.7 * k as f64).sin() + (0.3 * (k * k) as f64).cos());
    }
    // Between nodes, because at nodes the third derivatives of the curve jump.
    for slide in &system.assembly.joints.slides {
        unknowns[slide.unknown] += 0.37;
    }
    system.complete(&mut unknowns);
    unknowns
}

fn moved(system: &mut System, unknowns: &[f64], unknown: usize, by: f64) -> Vec<f64> {
    let mut moved = unknowns.to_vec();
    moved[unknown] += by;
    system.complete(&mut moved);
    moved
}

/// Compares the residual, perturbed by a given amount, with differences of the energy.
pub(super) fn compare_residual(scene: &Scene, sizes: [f64; 3]) {
    let mut system = System::new(scene).unwrap();
    for size in sizes {
        let unknowns = perturbed(&mut system, size);
        system.evaluate(&unknowns, None);
        let residual = system.residual.clone();
        let scale = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        let step = 1e-5;
        for k in own(&system) {
            let mut energy_at = |by: f64| {
                let moved = moved(&mut system, &unknowns, k, by);
                system.update_geometry(&moved);
                system.elastic_energy().total()
            };
            let slope = (8.0 * (energy_at(step) - energy_at(-step)) - energy_at(2.0 * step)
                + energy_at(-2.0 * step))
                / (12.0 * step);
            assert!(
                (slope - residual[k]).abs() < 1e-8 * scale,
                "{size}, unknown {k}: {slope} against {}",
                residual[k]
            );
        }
    }
}

#[test]
fn the_residual_of_joined_rods_is_the_gradient_of_their_energy() {
    compare_residual(&star(), [0.0, 0.02, 0.2]);
}

pub(super) fn stage_at(system: &System) -> Stage {
    let start = system.assembly.unknowns.clone();
    let mut positions = vec![Vector3::zeros(); system.assembly.rods.nodes];
    copy_positions(&start, &mut positions);
    Stage {
        angles: start.iter().skip(3).step_by(4).copied().collect(),
        step: 0.05,
        acceleration_step: 0.06,
        keeps_spin: false,
        velocity: start.iter().map(|q| (3.0 * q).sin()).collect(),
        start,
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions,
    }
}

/// Compares the Jacobian, perturbed by a given amount, at rest or in a step, with differences of
/// the residual, whose error is at most `bound` times its largest entry.
pub(super) fn compare_jacobian(scene: &Scene, cases: &[(f64, bool)], bound: f64) {
    let system = System::new(scene).unwrap();
    let stage = stage_at(&system);
    compare_jacobian_of(system, &stage, cases, bound);
}

/// Compares the Jacobian in a step with a given stage.
fn compare_jacobian_of(mut system: System, stage: &Stage, cases: &[(f64, bool)], bound: f64) {
    for &(size, is_in_step) in cases {
        let stage = is_in_step.then_some(stage);
        let asymmetry = compare_to_differences(&mut system, stage, size, bound);
        assert!(asymmetry < 1e-12, "{size}");
    }
}

/// Compares the Jacobian at a configuration perturbed by `size`. Returns its largest asymmetry
/// over its largest entry.
pub(super) fn compare_to_differences(
    system: &mut System,
    stage: Option<&Stage>,
    size: f64,
    bound: f64,
) -> f64 {
    let unknowns = perturbed(system, size);
    system.linearize(&unknowns, stage);
    let jacobian = system.dense_matrix();
    let scale = jacobian.amax();
    let step = 1e-6;
    for column in own(system) {
        let mut difference = vec![0.0; unknowns.len()];
        // Fourth-order differences: contact laws fall by e within some hundred such steps.
        for (by, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
            let moved = moved(system, &unknowns, column, by * step);
            system.evaluate(&moved, stage);
            for (entry, residual) in difference.iter_mut().zip(&system.residual) {
                *entry += weight * residual / (12.0 * step);
            }
        }
        for row in own(system) {
            let error = (difference[row] - jacobian[(row, column)]).abs();
            assert!(error < bound * scale, "{size}, {row}, {column}: {error:e}");
        }
    }
    (&jacobian - jacobian.transpose()).amax() / scale
}

#[test]
fn the_jacobian_of_joined_rods_and_bodies_is_exact_and_symmetric() {
    let cases = [(0.0, false), (0.2, false), (0.0, true), (0.2, true)];
    compare_jacobian(&star(), &cases, 1e-8);
}

#[test]
fn the_jacobian_of_bodies_that_meet_drag_as_they_turn_is_exact_and_symmetric() {
    let system = System::new(&star()).unwrap();
    let places = system.assembly.all_places().len();
    let mut stage = stage_at(&system);
    stage.drag = vec![Vector3::zeros(); places];
    stage.drag_velocity = vec![Vector3::new(-0.3, 0.1, 0.2); places];
    stage.resistance = vec![Matrix3::zeros(); places];
    for frame in &system.assembly.joints.frames {
        if let Some((first, _)) = frame.body {
            let tips = first / STRIDE..first / STRIDE + 3;
            for tip in tips {
                stage.drag[tip] = Vector3::new(0.1, -0.2, 0.3);
                stage.resistance[tip] = Matrix3::from_diagonal_element(0.7);
            }
        }
    }
    compare_jacobian_of(system, &stage, &[(0.0, true), (0.2, true)], 1e-8);
}

/// The star with one more rod, attached to the end of its third rod by a breakable weld with
/// bodies on both sides.
fn star_with_breakable_weld() -> Scene {
    let mut scene = star();
    let end = scene.rods[2].centreline[3];
    let away = Vector3::new(-0.9, -0.2, 0.7);
    scene.rods.push(rod("welded", end, end + away, 3));
    scene.joints.push(Joint {
        strength: Strength::of_force(1.0),
        ..joint("breakable", [at(6, 0), at(2, 3)], JointKind::Rigid)
    });
    scene
        .bodies
        .push(carried("one", at(6, 0), Some([0.02, 0.03, 0.04])));
    scene
        .bodies
        .push(carried("other", at(2, 3), Some([0.01, 0.02, 0.015])));
    scene
}

#[test]
fn a_weld_that_may_break_is_as_exact_as_one_that_does_not() {
    let scene = star_with_breakable_weld();
    compare_residual(&scene, [0.0, 0.02, 0.2]);
    compare_jacobian(&scene, &[(0.2, false), (0.0, true), (0.2, true)], 1e-8);
}

#[test]
fn the_jacobian_of_bodies_whose_centre_is_off_their_node_is_exact_in_motion_and_under_their_weight()
{
    let mut scene = star_with_breakable_weld();
    for (k, body) in scene.bodies.iter_mut().enumerate() {
        if body.inertia.is_some() {
            body.offset = Vector3::new(0.2, -0.1 * k as f64, 0.15);
        }
    }
    scene.loads = vec![weight(Vector3::new(0.3, -0.2, -0.9))];
    let cases = [(0.0, false), (0.2, false), (0.0, true), (0.2, true)];
    compare_jacobian(&scene, &cases, 1e-8);
}

/// A ball around the end of a rod that touches another rod, another ball and a sphere.
fn touching_ball(model: ContactModel) -> Scene {
    let tolerance = 1e-2;
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    // The surfaces are this far apart.
    let apart = |radii: f64| radii + 0.3 * tolerance;
    let (own, others) = (0.2, 0.3);
    let beside = -x * apart(own + 0.01);
    let above = z * apart(own + others);
    let ball = |name: &str, rod: usize, radius: f64| Body {
        ball: Some(radius),
        ..carried(name, at(rod, 0), Some([0.02, 0.03, 0.04]))
    };
    Scene {
        rods: vec![
            rod("bearer", Vector3::zeros(), Vector3::new(0.3, 0.2, -0.9), 3),
            // The middle of an edge, not a node, is next to the ball.
            rod("beside", beside - y * 0.7, beside + y * 0.4, 4),
            rod("above", above, above + Vector3::new(0.1, 0.3, 0.9), 3),
        ],
        bodies: vec![ball("ball", 0, own), ball("other", 2, others)],
        obstacles: vec![obstacle(
            "sphere",
            RigidBody::sphere(Vector3::new(0.6, -0.8, 0.0) * apart(own + 0.25), 0.25),
        )],
        contact: Some(contact(model, tolerance)),
        ..Scene::default()
    }
}

#[test]
fn the_jacobian_of_a_ball_that_touches_is_exact_and_symmetric() {
    for model in SOFT_MODELS {
        let scene = touching_ball(model);
        let mut system = System::new(&scene).unwrap();
        let unknowns = system.assembly.unknowns.clone();
        system.evaluate(&unknowns, None);
        let contacts = system.contact().unwrap().contacts();
        assert_eq!(contacts.len(), 3, "{model:?}");
        assert!(contacts.iter().all(|contact| contact.normal_force > 0.0));
        compare_jacobian(&scene, &[(0.0, false), (0.0, true)], 1e-6);
    }
}

#[test]
fn newton_solves_as_the_dense_matrix_does() {
    let mut system = System::new(&star()).unwrap();
    let stage = stage_at(&system);
    let unknowns = perturbed(&mut system, 0.05);
    system.linearize(&unknowns, Some(&stage));
    let jacobian = system.dense_matrix();
    let inertia = system.factor().unwrap().expect("symmetric");
    assert_eq!(inertia.negative, 0);
    let mut direction = vec![0.0; unknowns.len()];
    system.direction(&mut direction).unwrap();
    let product = &jacobian * nalgebra::DVector::from_row_slice(&direction);
    for k in own(&system) {
        assert!((product[k] + system.residual[k]).abs() < 1e-9 * jacobian.amax());
    }
    for [node, owner] in &system.assembly.joints.points {
        let moves = [node, owner].map(|node| &direction[STRIDE * node..STRIDE * node + 3]);
        assert_eq!(moves[0], moves[1]);
    }
}

#[test]
fn rotations_that_begin_anew_are_the_same() {
    let mut system = System::new(&star()).unwrap();
    let mut unknowns = perturbed(&mut system, 0.0);
    let frame = system.assembly.joints.frames[0].clone();
    for (axis, turn) in [0.9, -0.7, 0.5].into_iter().enumerate() {
        unknowns[frame.first_unknown + axis] = turn * frame.length;
    }
    let mut velocity = vec![0.0; unknowns.len()];
    velocity[frame.first_unknown] = 0.3 * frame.length;
    let turned = |system: &mut System, unknowns: &[f64]| {
        system.update_geometry(unknowns);
        system
            .ghosts
            .iter()
            .map(|ghost| ghost.tangent)
            .collect::<Vec<_>>()
    };
    let later = |unknowns: &[f64], velocity: &[f64]| {
        let moved = unknowns.iter().zip(velocity).map(|(q, v)| q + 1e-6 * v);
        moved.collect::<Vec<_>>()
    };
    let before = turned(&mut system, &unknowns);
    let soon = turned(&mut system, &later(&unknowns, &velocity));
    let long = system.long_rotations(&unknowns);
    system.begin_rotations_anew(&long, &mut [[&mut unknowns, &mut velocity]]);
    assert!(unknowns[frame.first_unknown].abs() < 1e-15);
    let after = turned(&mut system, &unknowns);
    let soon_after = turned(&mut system, &later(&unknowns, &velocity));
    for (one, other) in before
        .iter()
        .zip(&after)
        .chain(soon.iter().zip(&soon_after))
    {
        assert!((one - other).norm() < 1e-12);
    }
}

#[test]
fn joints_that_cannot_be_are_named() {
    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = star();
        change(&mut scene);
        match System::new(&scene).err() {
            Some(SceneError::Joint { name, reason }) => (name, reason),
            other => panic!("{other:?}"),
        }
    };
    let (name, reason) = refused(&|scene| scene.joints[3].nodes[0] = at(4, 1));
    assert_eq!(name, "ball");
    assert!(matches!(reason, JointError::Apart { distance } if (distance - 0.4387).abs() < 1e-3));
    // A thousandth of an edge is more than rounding.
    let (name, reason) = refused(&|scene| {
        let nodes = scene.rods[4].centreline.iter_mut();
        nodes.for_each(|node| *node += Vector3::y() * 4e-4);
    });
    assert_eq!(name, "ball");
    assert!(matches!(reason, JointError::Apart { distance } if (distance - 4e-4).abs() < 1e-12));
    let again = joint("again", [at(0, 0), at(3, 2)], JointKind::Rigid);
    let (name, reason) = refused(&|scene| scene.joints.push(again.clone()));
    assert_eq!((name.as_str(), reason), ("again", JointError::Twice));
    for number in [0, 1, 3] {
        let (_, reason) = refused(&|scene| scene.joints[number].strength = Strength::of_force(1.0));
        assert_eq!(reason, JointError::Unbreakable);
    }
    let (name, reason) = refused(&|scene| scene.springs[1].nodes = [at(4, 0), at(2, 0)]);
    assert_eq!((name.as_str(), reason), ("strut", JointError::OnePoint));
    let (name, reason) = refused(&|scene| {
        scene.joints.truncate(3);
        scene.springs[0].nodes = [at(4, 0), at(2, 0)];
    });
    let rest_length = 0.5;
    assert_eq!(name, "bungee");
    assert_eq!(reason, JointError::NoDirection { rest_length });
    let (_, reason) = refused(&|scene| scene.springs[2].nodes = [at(4, 9), at(2, 0)]);
    assert_eq!(reason, JointError::NoSuchNode { node: 9, nodes: 3 });
    let (_, reason) = refused(&|scene| scene.springs[2].nodes = [at(4, 1), at(4, 1)]);
    assert_eq!(reason, JointError::SameNode);
    let (_, reason) = refused(&|scene| scene.joints[4].nodes = [at(5, 0), at(0, 9)]);
    assert_eq!(reason, JointError::NoSuchNode { node: 9, nodes: 4 });
    let (_, reason) = refused(&|scene| {
        scene.clamps.push(Clamp {
            rod: 0,
            node: 0,
            ..scene.clamps[0].clone()
        });
    });
    assert_eq!(
        reason,
        JointError::ClampedFrame {
            rod: "first".into()
        }
    );
    let (_, reason) = refused(&|scene| {
        for rod in [0, 4] {
            scene.clamps.push(Clamp {
                rod,
                node: 0,
                holds_frame: false,
                ..scene.clamps[0].clone()
            });
        }
    });
    let (first, second) = ("first".into(), "hanging".into());
    assert_eq!(reason, JointError::TwoClamps { first, second });
}
