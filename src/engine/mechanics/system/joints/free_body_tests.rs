//! Residual and Jacobian of free bodies in contact against finite differences.

use super::tests::{compare_to_differences, stage_at};
use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{
    Axle, BodyJoint, FreeBody, JointKind, RodDescription, RodNode, Scene,
};
use crate::mechanics::test_support::{
    SOFT_MODELS, contact, ground, line, obstacle, section, weight,
};

/// A box with an orientation given by a rotation vector, rad.
fn cuboid(name: &str, centre: Vector3, turned: Vector3) -> FreeBody {
    let axes = rotation::from_vector(turned);
    FreeBody {
        name: name.into(),
        shape: RigidBody::cuboid(centre, Vector3::new(0.6, 0.5, 0.4), &axes, 0.05),
        mass: 0.7,
        centre,
        inertia: [0.02, 0.03, 0.025],
        axes,
        velocity: Vector3::new(0.1, 0.2, -0.1),
        angular_velocity: Vector3::new(0.3, -0.2, 0.4),
        friction: None,
        axle: None,
        joints: Vec::new(),
    }
}

/// A box over a plane and beside an obstacle, another on it with a corner on its top face, a rod
/// that lies across both, and the end of a rod over the side of the first.
fn heap(model: ContactModel, friction: f64) -> Scene {
    let stiffness = section(3.0, [0.02, 0.05], 0.03);
    let rod = |name: &str, from: [f64; 3], to: [f64; 3]| {
        let nodes = line(Vector3::from(from), Vector3::from(to), 3);
        RodDescription::uniform(name, nodes, stiffness, 0.05, 0.8)
    };
    // The lowest corner of the second box is 0.26 below its centre.
    let tilt = Vector3::new(0.7, 0.6, 0.1);
    let corner = rotation::from_vector(tilt) * Vector3::new(0.25, -0.2, -0.15);
    let second = Vector3::new(0.03, 0.02, 0.4 + 0.06 + 0.05) - corner;
    Scene {
        rods: vec![
            rod("across", [-0.5, 0.205, 0.52], [0.5, 0.195, 0.48]),
            rod("beside", [0.36, 0.0, 0.2], [0.9, 0.1, 0.3]),
        ],
        free_bodies: vec![
            cuboid("lower", Vector3::new(0.0, 0.0, 0.21), Vector3::zeros()),
            cuboid("upper", second, tilt),
        ],
        planes: vec![ground()],
        obstacles: vec![obstacle(
            "ball",
            RigidBody::sphere(Vector3::new(0.0, -0.37, 0.1), 0.1),
        )],
        loads: vec![weight(Vector3::new(0.1, 0.2, -1.0))],
        contact: Some(ContactParameters {
            friction,
            slip_tolerance: 1.0,
            ..contact(model, 0.04)
        }),
        ..Scene::default()
    }
}

/// Kinds of contacts of the last evaluation: of edges, with faces of bodies, with obstacles, with
/// planes.
fn kinds(system: &System) -> [usize; 4] {
    let contact = system.contact().unwrap();
    let mut kinds = [0, 0, 0, contact.plane_contacts().len()];
    for one in contact.contacts() {
        let is_of_rod = contact.is_of_rod(one.nodes[3]);
        kinds[match (is_of_rod, one.first_body) {
            (true, 2) => 0,
            (true, _) => 1,
            _ => 2,
        }] += 1;
    }
    kinds
}

#[test]
fn the_jacobian_of_free_bodies_in_contact_is_exact() {
    for model in SOFT_MODELS {
        for friction in [0.0, 0.4] {
            let mut system = System::new(&heap(model, friction)).unwrap();
            let mut stage = stage_at(&system);
            // With friction, the Jacobian is not symmetric in any case.
            stage.keeps_spin = friction > 0.0;
            if let Some(contact) = &mut system.terms.contact.model {
                contact.set_stiffness(0.5);
            }
            for size in [0.0, 0.0005, 0.001] {
                let asymmetry = compare_to_differences(&mut system, Some(&stage), size, 1e-6);
                if friction == 0.0 {
                    assert!(asymmetry < 1e-12, "{model:?} {size}: {asymmetry:e}");
                }
                let kinds = kinds(&system);
                assert!(kinds.iter().all(|count| *count > 0), "{model:?} {kinds:?}");
            }
        }
    }
}

/// A body that hangs from a rod by a ball joint, from another by a rigid joint and from a third by
/// a hinge, and a drum on an axle, to which a rod is welded and over which another one lies.
fn joined(model: ContactModel) -> Scene {
    let stiffness = section(3.0, [0.02, 0.05], 0.03);
    let rod = |name: &str, from: [f64; 3], to: [f64; 3]| {
        let nodes = line(Vector3::from(from), Vector3::from(to), 3);
        RodDescription::uniform(name, nodes, stiffness, 0.05, 0.8)
    };
    let joint = |rod: usize, node: usize, kind: JointKind| BodyJoint {
        at: RodNode { rod, node },
        kind,
    };
    let hinge = JointKind::Hinge {
        axis: Vector3::new(0.6, 0.0, 0.8),
        spring: None,
    };
    let axle = Axle {
        direction: Vector3::new(0.0, 0.8, 0.6),
        inertia: 0.04,
        brake: 0.3,
        torque: vec![(0.0, 0.2)],
    };
    let along = axle.direction * 0.5;
    let drum = Vector3::new(3.0, 0.0, 0.0);
    Scene {
        rods: vec![
            rod("ball", [0.3, 0.2, 1.0], [0.2, 0.1, 0.2]),
            rod("rigid", [-0.2, 0.1, 0.1], [-1.0, 0.2, 0.4]),
            rod("hinge", [0.1, -0.8, 0.2], [0.1, -0.3, 0.1]),
            rod("spoke", [2.9, 0.1, 0.0], [2.0, 0.1, 0.2]),
            rod("rope", [2.5, 0.1, 0.38], [3.5, -0.1, 0.42]),
        ],
        free_bodies: vec![
            FreeBody {
                joints: vec![
                    joint(0, 3, JointKind::Ball),
                    joint(1, 0, JointKind::Rigid),
                    joint(2, 3, hinge),
                ],
                ..cuboid("box", Vector3::zeros(), Vector3::new(0.2, -0.1, 0.3))
            },
            FreeBody {
                shape: RigidBody::capsule([drum - along, drum + along], 0.25),
                angular_velocity: axle.direction * 0.4,
                velocity: Vector3::zeros(),
                axle: Some(axle),
                joints: vec![joint(3, 0, JointKind::Rigid)],
                ..cuboid("drum", drum, Vector3::zeros())
            },
        ],
        loads: vec![weight(Vector3::new(0.1, 0.2, -1.0))],
        contact: Some(ContactParameters {
            friction: 0.4,
            slip_tolerance: 1.0,
            ..contact(model, 0.04)
        }),
        ..Scene::default()
    }
}

#[test]
fn the_jacobian_of_joined_bodies_and_axles_is_exact() {
    for model in SOFT_MODELS {
        let scene = joined(model);
        let mut system = System::new(&scene).unwrap();
        let joints = &system.assembly.joints;
        assert_eq!([joints.pins.len(), joints.bodies.len()], [4, 2]);
        let stage = stage_at(&system);
        if let Some(contact) = &mut system.terms.contact.model {
            contact.set_stiffness(0.5);
        }
        for size in [0.0, 0.0004, 0.0007] {
            compare_to_differences(&mut system, Some(&stage), size, 1e-6);
            assert!(
                !system.contact().unwrap().contacts().is_empty(),
                "{model:?}"
            );
        }
    }
}

#[test]
fn a_whole_turn_within_a_step_is_not_taken_for_none() {
    let mut system = System::new(&joined(ContactModel::ImplicitContact)).unwrap();
    assert!(system.excessive_turn().is_none());
    let joints = &system.assembly.joints;
    // The box turns freely, the drum about its axle.
    let [cuboid, drum] = [0, 1].map(|body| &joints.frames[joints.bodies[body]]);
    let full = std::f64::consts::TAU;
    let turned = [
        (cuboid.first_unknown + 1, full * cuboid.length),
        (drum.first_unknown + 3, full),
    ];
    for (unknown, value) in turned {
        let mut unknowns = system.assembly.unknowns.clone();
        unknowns[unknown] += value;
        system.update_geometry(&unknowns);
        let turn = system.excessive_turn().unwrap();
        assert!((turn.angle - full).abs() < 1e-9, "{turn:?}");
    }
}
