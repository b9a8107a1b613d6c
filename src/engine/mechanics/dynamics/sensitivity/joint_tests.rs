//! Derivatives of motions of joined rods and bodies.

use super::tests::{AT_SWITCHES, Bounds, Change, Course, EXACT, OF_RODS, REST, WEAK, check_all};
use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactModel;
use crate::mechanics::dynamics::Scheme;
use crate::mechanics::scene::{
    HingeSpring, JointKind, NaturalShape, RodDescription, Scene, Strength,
};
use crate::mechanics::test_support::{
    at, body, clamp, curved, gravity, hinge, joint, line, point_force, pulled, section,
    sprung_hinge,
};

/// Schemes for scenes with frames that turn.
const FOR_FRAMES: [Scheme; 2] = [Scheme::ImplicitEuler, Scheme::BackwardDifferences];

fn rod(name: &str, from: Vector3, to: Vector3, edges: usize) -> RodDescription {
    let stiffness = section(200.0, [1e-3, 2.5e-3], 1.2e-3);
    RodDescription {
        natural_shape: curved([2.0, 1.0], 1.5),
        first_director: Some(Vector3::z()),
        ..RodDescription::uniform(name, line(from, to, edges), stiffness, 2e-3, 0.01)
    }
}

pub(in crate::mechanics::dynamics) fn sprung() -> JointKind {
    sprung_hinge(Vector3::z(), 5e-3, 0.3)
}

/// Two arms at an angle; the first is clamped, and a body is off the end of the second.
pub(in crate::mechanics::dynamics) fn arms(kind: JointKind) -> Scene {
    let elbow = Vector3::x() * 0.15;
    let mut hand = body("hand", at(1, 3), 2e-3, Some([2e-7, 3e-7, 4e-7]));
    hand.offset = Vector3::new(3e-3, -2e-3, 4e-3);
    Scene {
        rods: vec![
            rod("upper", Vector3::zeros(), elbow, 4),
            rod("lower", elbow, elbow + Vector3::y() * 0.1, 3),
        ],
        clamps: vec![clamp(0, 0)],
        joints: vec![joint("elbow", [at(0, 4), at(1, 0)], kind)],
        bodies: vec![hand, body("ring", at(0, 2), 1e-3, None)],
        loads: vec![gravity(2.0), point_force(1, 1, Vector3::z() * 2e-3)],
        ..Scene::default()
    }
}

/// A rod of two joined pieces with a body, which is pulled over the ground by one end, with contact
/// by complementarity.
pub(in crate::mechanics::dynamics) fn pulled_pieces(kind: JointKind) -> Scene {
    let mut scene = pulled(ContactModel::Complementarity);
    let mut second = scene.rods[0].clone();
    second.name = "second".into();
    second.centreline.drain(..5);
    scene.rods[0].centreline.truncate(6);
    scene.rods.push(second);
    scene.joints = vec![joint("middle", [at(0, 5), at(1, 0)], kind)];
    scene.bodies = vec![body("load", at(1, 2), 5e-3, Some([2e-7, 3e-7, 4e-7]))];
    scene.loads.truncate(1);
    scene
}

const OF_BODIES: [Change; 3] = [
    ("mass of a body", |scene, factor| {
        scene.bodies[0].mass *= factor;
        scene.bodies[1].mass *= factor;
    }),
    ("offset of a body", |scene, factor| {
        scene.bodies[0].offset *= factor;
    }),
    ("inertia of a body", |scene, factor| {
        scene.bodies[0].inertia = Some([2e-7 * factor, 3e-7, 4e-7]);
    }),
];

const OF_HINGE: [Change; 2] = [
    ("stiffness of a hinge", |scene, factor| {
        let spring = spring_of(scene);
        spring.stiffness *= factor;
    }),
    ("rest angle of a hinge", |scene, factor| {
        let spring = spring_of(scene);
        spring.rest_angle *= factor;
    }),
];

fn spring_of(scene: &mut Scene) -> &mut HingeSpring {
    match &mut scene.joints[0].kind {
        JointKind::Hinge {
            spring: Some(spring),
            ..
        } => spring,
        _ => panic!("the joint is no hinge with a spring"),
    }
}

/// Lengthens both arms and turns the second one.
const PLACED: Change = ("places of the rods", |scene, factor| {
    let turn = Vector3::new(0.3, -0.2, 0.4) * (factor - 1.0);
    for rod in &mut scene.rods {
        for node in &mut rod.centreline {
            *node = *node * factor + turn.cross(node);
        }
    }
});

/// For changes of positions, for which motions are far from linear.
const NEAR: Bounds = Bounds {
    step: 2e-6,
    difference: 5e-4,
    ..EXACT
};

#[test]
fn equilibria_of_joined_rods() {
    for kind in [JointKind::Rigid, sprung()] {
        check_all(&REST, &arms(kind), &OF_RODS[..5], &WEAK);
        check_all(&REST, &arms(kind), &OF_BODIES[..2], &WEAK);
        check_all(&REST, &arms(kind), &[PLACED], &WEAK);
    }
    check_all(&REST, &arms(sprung()), &OF_HINGE, &WEAK);
}

#[test]
fn swings_of_joined_rods_with_a_body() {
    for scheme in FOR_FRAMES {
        let course = Course::moves(scheme, 2e-3, 30);
        for kind in [JointKind::Ball, JointKind::Rigid, sprung()] {
            check_all(&course, &arms(kind), &OF_RODS[..5], &EXACT);
            check_all(&course, &arms(kind), &OF_BODIES, &EXACT);
            check_all(&course, &arms(kind), &[PLACED], &NEAR);
        }
        check_all(&course, &arms(sprung()), &OF_HINGE, &EXACT);
    }
}

/// Without a clamp that holds the first node.
const FREE: Bounds = Bounds {
    reactions: f64::INFINITY,
    ..EXACT
};

const FREE_AND_NEAR: Bounds = Bounds {
    reactions: f64::INFINITY,
    ..NEAR
};

/// Two rods welded at right angles with a body at the corner, which turn by more than a radian.
pub(in crate::mechanics::dynamics) fn tumbling() -> Scene {
    let mut scene = arms(JointKind::Rigid);
    scene.clamps.clear();
    scene.loads.clear();
    let spin = Vector3::new(2.0, 30.0, 20.0);
    for rod in &mut scene.rods {
        rod.natural_shape = NaturalShape::Straight;
        rod.angular_velocity = spin;
        let middle = (rod.centreline[0] + rod.centreline[rod.centreline.len() - 1]) * 0.5;
        rod.velocity = spin.cross(&middle);
    }
    scene
}

#[test]
fn a_body_that_tumbles_and_resets_its_rotation() {
    let scene = tumbling();
    let spinning: Change = ("spin", |scene, factor| {
        for rod in &mut scene.rods {
            rod.angular_velocity *= factor;
            rod.velocity *= factor;
        }
    });
    for scheme in FOR_FRAMES {
        let course = Course::moves(scheme, 2e-3, 40);
        check_all(&course, &scene, &[spinning], &FREE);
        check_all(&course, &scene, &OF_BODIES, &FREE);
        check_all(&course, &scene, &[PLACED], &FREE_AND_NEAR);
    }
}

/// Joints that may break.
pub(in crate::mechanics::dynamics) fn breakable() -> [JointKind; 3] {
    [JointKind::Ball, JointKind::Rigid, hinge(Vector3::z())]
}

/// Arms that are pulled apart.
pub(in crate::mechanics::dynamics) fn breaking(kind: JointKind) -> Scene {
    let mut scene = arms(kind);
    scene.joints[0].strength = Strength::of_force(0.07);
    let mut pull = point_force(1, 1, Vector3::new(0.2, 1.0, 0.3));
    pull.schedule = vec![(0.0, 0.0), (0.02, 0.0), (0.021, 1.0), (0.025, 0.0)];
    scene.loads.push(pull);
    scene
}

#[test]
fn motions_in_which_a_joint_breaks() {
    for kind in breakable() {
        let scene = breaking(kind);
        for scheme in FOR_FRAMES {
            let course = Course::moves(scheme, 1e-3, 40);
            let broken = course.run(&scene).breaks();
            assert!(broken[0].is_some(), "{kind:?}");

            check_all(&course, &scene, &OF_RODS[..2], &AT_SWITCHES);
            check_all(&course, &scene, &OF_BODIES[..1], &AT_SWITCHES);
        }
    }
}

/// A bead that slides along a rod with both ends clamped.
pub(in crate::mechanics::dynamics) fn sliding() -> Scene {
    let mut wire = rod("wire", Vector3::zeros(), Vector3::new(0.3, 0.0, -0.1), 8);
    wire.natural_shape = NaturalShape::Straight;
    let start = wire.centreline[2];
    let bead = rod("bead", start, start + Vector3::y() * 0.02, 2);
    let slide = joint("slide", [at(1, 0), at(0, 2)], JointKind::FREE_SLIDE);
    Scene {
        rods: vec![wire, bead],
        clamps: vec![clamp(0, 0), clamp(0, 8)],
        joints: vec![slide],
        loads: vec![gravity(2.0)],
        ..Scene::default()
    }
}

#[test]
fn a_bead_that_slides_along_a_rod() {
    let scene = sliding();
    // The velocity of a bead on a straight wire hardly depends on its stiffness.
    let bounds = Bounds {
        motion: 1e-6,
        reactions: 1e-6,
        ..WEAK
    };
    for (scheme, steps) in [
        (Scheme::ImplicitEuler, 30),
        (Scheme::BackwardDifferences, 30),
        (Scheme::ImplicitMidpoint, 5),
    ] {
        let course = Course::moves(scheme, 2e-3, steps);
        check_all(&course, &scene, &OF_RODS[..2], &bounds);
    }
}

#[test]
fn joined_rods_that_stick_and_slide_by_complementarity() {
    let changes: [Change; 3] = [
        ("friction", |scene, factor| {
            scene.contact.as_mut().unwrap().friction *= factor;
        }),
        ("EI", |scene, factor| {
            scene.rods[0].stiffness.bending = [1e-3 * factor, 2.5e-3 * factor];
        }),
        ("mass of a body", |scene, factor| {
            scene.bodies[0].mass *= factor;
        }),
    ];
    let rigid = Bounds {
        motion: 1e-5,
        reactions: 1e-5,
        ..AT_SWITCHES
    };
    let course = Course::moves(Scheme::ImplicitEuler, 2e-3, 30);
    for kind in [JointKind::Ball, hinge(Vector3::z()), JointKind::Rigid] {
        check_all(&course, &pulled_pieces(kind), &changes, &rigid);
    }
}
