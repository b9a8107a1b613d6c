//! Contact by complementarity of rods with joints and bodies: exact sticking and sliding, balance of
//! forces, momentum, agreement with the implicit contact model, derivatives.

use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{CoulombFriction, Joint, JointKind, RodDescription, Scene};
use crate::mechanics::system::{Stage, angles_of};
use crate::mechanics::test_support::{
    at, body, contact, farthest, fixed, gravity, ground, hinge, joint, line, obstacle, run_with,
    straight_rod, weight,
};
use crate::mechanics::{UnitQuaternion, Vector3};

const RIGID: ContactModel = ContactModel::Complementarity;
const RADIUS: f64 = 5e-3;
const TOLERANCE: f64 = 5e-5;
const GRAVITY: f64 = 9.81;
const EDGES: usize = 4;
const LENGTH: f64 = 0.1;

/// A rod between two points.
fn rod(name: &str, from: Vector3, to: Vector3) -> RodDescription {
    RodDescription {
        name: name.into(),
        centreline: line(from, to, EDGES),
        first_director: None,
        ..straight_rod(EDGES, (to - from).norm())
    }
}

/// Rods along a path, each joined to the next one.
fn chain(name: &str, path: &[Vector3], kind: JointKind) -> (Vec<RodDescription>, Vec<Joint>) {
    let pieces = path.windows(2).enumerate();
    let rods: Vec<RodDescription> = pieces
        .map(|(k, ends)| rod(&format!("{name} {k}"), ends[0], ends[1]))
        .collect();
    let joints = (1..rods.len())
        .map(|k| joint(&format!("{name} {k}"), [at(k - 1, EDGES), at(k, 0)], kind))
        .collect();
    (rods, joints)
}

/// A zigzag of three rods that lies on the ground, with weight in a direction that makes the ground
/// an incline of `angle`.
fn lying(kind: JointKind, angle: f64, friction: f64) -> Scene {
    let at = |x: f64, y: f64| Vector3::new(x, y, RADIUS / LENGTH) * LENGTH;
    let path = [at(0.0, 0.0), at(1.0, 0.3), at(1.8, -0.3), at(2.8, 0.2)];
    let (rods, joints) = chain("rod", &path, kind);
    Scene {
        rods,
        joints,
        planes: vec![ground()],
        loads: vec![weight(
            Vector3::new(angle.sin(), 0.0, -angle.cos()) * GRAVITY,
        )],
        contact: Some(ContactParameters {
            friction,
            ..contact(RIGID, TOLERANCE)
        }),
        ..Scene::default()
    }
}

/// Kinds of joints of which contact alone determines the motion of the rods in a plane.
fn kinds() -> [(&'static str, JointKind); 3] {
    [
        ("ball", JointKind::Ball),
        ("hinge", hinge(Vector3::z())),
        ("rigid", JointKind::Rigid),
    ]
}

#[test]
fn joined_rods_on_an_incline_stick_and_slide_exactly_by_coulomb() {
    let (friction, time) = (0.5_f64, 0.05);
    let limit = friction.atan();
    let cases = kinds().map(|case| [(case, false), (case, true)]);
    for ((name, kind), on_table) in cases.into_iter().flatten() {
        let velocities = |angle: f64| {
            let mut scene = lying(kind, angle, friction);
            if on_table {
                // The vertices of obstacles are numbered after all nodes, as frames are.
                let sides = Vector3::new(1.0, 1.0, 0.1);
                let (centre, axes) = (Vector3::z() * -0.05, UnitQuaternion::identity());
                let table = RigidBody::cuboid(centre, sides, &axes, RADIUS);
                scene.obstacles = vec![obstacle("table", table)];
                scene.planes.clear();
            }
            let simulation = run_with(&scene, &fixed(1e-3), time);
            let lowest = simulation.positions().iter().map(|x| x.z);
            assert!(lowest.fold(f64::INFINITY, f64::min) > RADIUS - 1e-3 * TOLERANCE);
            simulation.velocities().to_vec()
        };
        let sticking = velocities(limit - 1e-3);
        let fastest = sticking.iter().map(|v| v.norm()).fold(0.0, f64::max);
        println!("{name}, sticking: {fastest:.1e} m/s");
        assert!(fastest < 1e-12, "{name}: {fastest:e}");
        let angle = limit + 0.2;
        let expected = GRAVITY * (angle.sin() - friction * angle.cos());
        for velocity in velocities(angle) {
            let error = (velocity / time - Vector3::x() * expected).norm();
            assert!(error < 1e-6 * GRAVITY, "{name}: {velocity}, {error:e}");
        }
    }
}

#[test]
fn a_pendulum_of_joined_rods_falls_on_the_ground_as_with_the_implicit_model() {
    for (name, kind) in kinds() {
        let scene = |model: ContactModel| {
            let mut scene = lying(kind, 0.1, 0.3);
            for rod in &mut scene.rods {
                for node in &mut rod.centreline {
                    node.z += 0.2 * node.x;
                }
            }
            scene.bodies = vec![body("load", at(1, 2), 0.02, Some([3e-6, 4e-6, 5e-6]))];
            scene.contact = Some(ContactParameters {
                friction: 0.3,
                slip_tolerance: 1e-5,
                stiffness_factor: 1e5,
                ..contact(model, TOLERANCE)
            });
            scene
        };
        let run = |model| run_with(&scene(model), &fixed(5e-4), 0.2);
        let [one, other] = [RIGID, ContactModel::ImplicitContact].map(run);
        let apart = farthest(one.positions(), other.positions());
        println!("{name}: {apart:.1e} m");
        assert!(one.positions().iter().any(|node| node.z < 1.01 * RADIUS));
        assert!(apart < TOLERANCE, "{name}: {apart:e}");
    }
}

#[test]
fn a_carried_body_rests_on_the_ground() {
    let mass = 0.05;
    for inertia in [None, Some([3e-6, 4e-6, 5e-6])] {
        for ball in [None, Some(2.0 * RADIUS)] {
            let mut scene = lying(JointKind::Ball, 0.1, 0.5);
            let mut load = body("load", at(0, EDGES), mass, inertia);
            load.ball = ball;
            scene.bodies = vec![load];
            if ball.is_some() {
                // The ball lies on the ground, and the rods lean on it.
                for node in scene.rods.iter_mut().flat_map(|rod| &mut rod.centreline) {
                    node.z += RADIUS;
                }
            }
            let simulation = run_with(&scene, &fixed(1e-3), 0.5);
            let of_rods: f64 = (scene.rods.iter())
                .map(|rod| rod.mass_per_length * (rod.centreline[0] - rod.centreline[EDGES]).norm())
                .sum();
            let weight = (of_rods + mass) * GRAVITY * 0.1_f64.cos();
            let contacts = simulation.plane_contacts();
            let pressed: f64 = contacts.iter().map(|one| one.normal_force).sum();
            println!("{inertia:?}, {ball:?}: {pressed:.6} of {weight:.6} N");
            assert!((pressed / weight - 1.0).abs() < 1e-6);
            let speeds = simulation.velocities().iter().map(|v| v.norm());
            assert!(speeds.fold(0.0, f64::max) < 1e-9);
        }
    }
}

#[test]
fn jointed_chains_that_collide_keep_their_momentum() {
    for (name, kind) in kinds() {
        let at = |x: f64, y: f64, z: f64| Vector3::new(x, y, z) * LENGTH;
        let lower = [at(-1.1, 0.0, 0.0), at(-0.1, 0.1, 0.0), at(0.9, 0.0, 0.0)];
        let upper = [at(0.1, -1.0, 0.13), at(0.2, 0.05, 0.13), at(0.1, 1.0, 0.13)];
        let (mut rods, mut joints) = chain("lower", &lower, kind);
        let (mut others, more) = chain("upper", &upper, kind);
        for rod in &mut others {
            rod.velocity = Vector3::new(0.3, 0.1, -1.0);
        }
        rods.append(&mut others);
        joints.extend(more.into_iter().map(|mut joint| {
            joint.nodes.iter_mut().for_each(|node| node.rod += 2);
            joint
        }));
        let scene = Scene {
            rods,
            joints,
            contact: Some(ContactParameters {
                friction: 0.3,
                ..contact(RIGID, TOLERANCE)
            }),
            ..Scene::default()
        };
        let mut simulation = Simulation::new(&scene, &fixed(5e-4)).unwrap();
        let energy = |simulation: &Simulation| {
            let energies = simulation.energies();
            energies.kinetic + energies.elastic()
        };
        let (before, mut last) = (simulation.momenta()[0], energy(&simulation));
        let mut touched = 0;
        for _ in 0..60 {
            touched += simulation.advance(1.0).unwrap().contacts;
            let forces: Vector3 = simulation.contact_forces().iter().sum();
            assert!(forces.norm() < 1e-10);
            let now = energy(&simulation);
            assert!(now <= last * (1.0 + 1e-9), "{name}: {now:e} after {last:e}");
            last = now;
            assert!(simulation.minimum_distance() > (1.0 - 1e-4) * 2.0 * RADIUS);
        }
        assert!(touched > 0);
        let change = (simulation.momenta()[0] - before).norm() / before.norm();
        println!("{name}: momentum changed by {change:.1e}, {touched} contacts");
        assert!(change < 1e-6);
    }
}

/// A rod along y whose middle slides down a stiff wire until it lies on the ground; with friction
/// of the slide and of the ground.
fn bead(model: ContactModel, friction: Option<f64>) -> Scene {
    let down = Vector3::new(0.8, 0.0, -0.6);
    let start = Vector3::z() * 0.1;
    let middle = start + down * 0.08;
    let wire = RodDescription {
        centreline: line(start, start + down * 0.16, 20),
        held: true,
        radius: 0.1 * RADIUS,
        ..rod("wire", start, middle)
    };
    let bead = rod(
        "bead",
        middle - Vector3::y() * 0.03,
        middle + Vector3::y() * 0.03,
    );
    let law = friction.map(|coefficient| CoulombFriction {
        coefficient,
        presliding: Some(1e-5),
    });
    Scene {
        rods: vec![wire, bead],
        joints: vec![joint(
            "slide",
            [at(1, EDGES / 2), at(0, 10)],
            JointKind::Slide { friction: law },
        )],
        planes: vec![ground()],
        loads: vec![gravity(GRAVITY)],
        contact: Some(ContactParameters {
            friction: friction.unwrap_or(0.0),
            slip_tolerance: 1e-5,
            stiffness_factor: 1e5,
            ..contact(model, TOLERANCE)
        }),
        ..Scene::default()
    }
}

#[test]
fn a_bead_slides_down_a_wire_and_comes_to_rest_on_the_ground() {
    for friction in [None, Some(0.2)] {
        let scene = bead(RIGID, friction);
        let run = |model| run_with(&bead(model, friction), &fixed(1e-3), 0.4);
        let rigid = run(RIGID);
        let apart = farthest(
            rigid.positions(),
            run(ContactModel::ImplicitContact).positions(),
        );
        println!("{friction:?}: {apart:.1e} m from the implicit model");
        assert!(apart < TOLERANCE, "{friction:?}: {apart:e}");
        let lying = &rigid.positions()[21..];
        let lowest = lying.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
        assert!((lowest - RADIUS).abs() < 1e-3 * TOLERANCE, "{lowest:e}");
        if friction.is_none() {
            // The wire carries nothing once the ground carries the weight.
            let contacts = rigid.plane_contacts();
            let pressed: f64 = contacts.iter().map(|one| one.normal_force).sum();
            let weight = scene.rods[1].mass_per_length * 0.06 * GRAVITY;
            assert!((pressed / weight - 1.0).abs() < 1e-6, "{pressed} {weight}");
        }
    }
}

#[test]
fn the_jacobian_with_the_laws_of_pressing_contacts_is_that_of_the_forces() {
    for (name, kind) in kinds() {
        let mut scene = lying(kind, 0.4, 0.3);
        scene.bodies = vec![body("load", at(1, 0), 0.02, Some([3e-6, 4e-6, 5e-6]))];
        let step = 1e-3;
        let mut simulation = run_with(&scene, &fixed(step), 0.01);
        let start = simulation.state.unknowns.clone();
        let (velocity, positions) = (
            simulation.state.velocity.clone(),
            simulation.positions().to_vec(),
        );
        simulation.advance(1.0).unwrap();
        let end = simulation.state.unknowns.clone();
        let stage = Stage {
            step,
            acceleration_step: step,
            keeps_spin: true,
            angles: angles_of(&start),
            start,
            velocity,
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            flow_torque: Vec::new(),
            positions,
        };
        let free = simulation.free_unknowns();
        let system = &mut simulation.system;
        let laws = system.pressing();
        assert!(laws.len() >= 3 * (EDGES + 1));
        system.set_active_laws(laws, &end, &stage).unwrap();
        system.linearize(&end, Some(&stage));
        let jacobian = system.dense_matrix();
        let (scale, by) = (jacobian.amax(), 1e-7);
        for &column in &free {
            let mut residual_at = |by: f64| {
                let mut unknowns = end.clone();
                unknowns[column] += by;
                system.complete(&mut unknowns);
                system.evaluate(&unknowns, Some(&stage));
                system.residual.clone()
            };
            let [above, below] = [by, -by].map(&mut residual_at);
            for &row in &free {
                let difference = (above[row] - below[row]) / (2.0 * by);
                let error = (difference - jacobian[(row, column)]).abs();
                assert!(error < 1e-8 * scale, "{name}, {row}, {column}: {error:e}");
            }
        }
    }
}
