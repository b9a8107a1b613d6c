//! Free bodies that are joined to rods, and bodies on axles.

use super::*;
use crate::mechanics::contact::ContactParameters;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{
    Axle, Body, BodyJoint, Clamp, FreeBody, JointKind, RodDescription, Scene,
};
use crate::mechanics::test_support::{
    SOFT_MODELS, advance_to, assert_close, assert_close_in, at, clamp, contact, drag, farthest,
    fixed_steps, hinge, line, resumed, run, run_with, section, weight,
};
use crate::mechanics::{UnitQuaternion, Vector3};

const GRAVITY: f64 = 9.81;
const MOMENTS: [f64; 3] = [3e-4, 5e-4, 7e-4];
const MASS: f64 = 0.4;

fn free_body(centre: Vector3, joints: Vec<BodyJoint>) -> FreeBody {
    FreeBody {
        name: "body".into(),
        shape: RigidBody::sphere(centre, 0.02),
        mass: MASS,
        centre,
        inertia: MOMENTS,
        axes: UnitQuaternion::identity(),
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        friction: None,
        axle: None,
        joints,
    }
}

fn on_axle(inertia: f64, brake: f64, torque: Vec<(f64, f64)>) -> Scene {
    let axle = Axle {
        direction: Vector3::new(0.0, 0.6, 0.8),
        inertia,
        brake,
        torque,
    };
    Scene {
        free_bodies: vec![FreeBody {
            axle: Some(axle),
            ..free_body(Vector3::new(0.1, 0.2, 0.3), Vec::new())
        }],
        loads: vec![weight(-GRAVITY * Vector3::z())],
        ..Scene::default()
    }
}

/// Rod along z that is clamped above; its second director is −x.
fn hanging(edges: usize) -> RodDescription {
    let stiffness = section(1e4, [2e-2; 2], 1e-2);
    let nodes = line(Vector3::zeros(), -0.3 * Vector3::z(), edges);
    RodDescription {
        first_director: Some(Vector3::y()),
        ..RodDescription::uniform("rod", nodes, stiffness, 2e-3, 0.02)
    }
}

#[test]
fn a_body_that_is_rigidly_joined_moves_like_one_that_the_rod_carries() {
    let edges = 12;
    let scene = |bodies, free_bodies| Scene {
        rods: vec![hanging(edges)],
        clamps: vec![clamp(0, 0)],
        bodies,
        free_bodies,
        loads: vec![weight(Vector3::new(3.0, 2.0, -GRAVITY))],
        ..Scene::default()
    };
    let offset = Vector3::new(0.03, -0.02, 0.05);
    // Along y, y × z and the tangent −z.
    let carried = Body {
        name: "body".into(),
        at: at(0, edges),
        mass: MASS,
        offset,
        inertia: Some([MOMENTS[1], MOMENTS[0], MOMENTS[2]]),
        ball: None,
    };
    let [first, second] = [Vector3::y(), -Vector3::z().cross(&Vector3::y())];
    let end = -0.3 * Vector3::z();
    let centre = end + first * offset.x + second * offset.y - Vector3::z() * offset.z;
    let joint = BodyJoint {
        at: at(0, edges),
        kind: JointKind::Rigid,
    };
    let free = free_body(centre, vec![joint]);
    // With implicit Euler free bodies keep their spin, which others do to first order.
    for (scheme, bound) in [
        (Scheme::ImplicitEuler, 1e-3),
        (Scheme::BackwardDifferences, 1e-7),
    ] {
        let one = run(&scene(vec![carried.clone()], Vec::new()), scheme, 1e-3, 0.4);
        let other = run(&scene(Vec::new(), vec![free.clone()]), scheme, 1e-3, 0.4);
        let rods = &other.positions()[..=edges];
        let moved = (rods[edges] - end).norm();
        assert!(moved > 0.05, "{moved}");
        let apart = farthest(one.positions(), rods);
        assert!(apart < bound * moved, "{scheme:?}: {apart:e}");
    }
}

#[test]
fn joined_bodies_in_flight_keep_their_momenta() {
    let mut rod = hanging(10);
    rod.velocity = Vector3::new(0.1, 0.0, 0.2);
    rod.angular_velocity = Vector3::new(1.0, 3.0, 2.0);
    let middle = -0.15 * Vector3::z();
    let joint = |node: usize, kind: JointKind| BodyJoint {
        at: at(0, node),
        kind,
    };
    let thrown = |place: Vector3, joint: BodyJoint| FreeBody {
        velocity: rod.velocity + rod.angular_velocity.cross(&(place - middle)),
        angular_velocity: rod.angular_velocity,
        ..free_body(place, vec![joint])
    };
    let bodies = vec![
        thrown(Vector3::new(0.03, 0.01, 0.02), joint(0, JointKind::Ball)),
        thrown(
            Vector3::new(0.0, 0.04, -0.16),
            joint(5, hinge(Vector3::x())),
        ),
        thrown(Vector3::new(-0.04, 0.0, -0.3), joint(10, JointKind::Rigid)),
    ];
    let scene = Scene {
        rods: vec![rod],
        free_bodies: bodies,
        ..Scene::default()
    };
    let mut simulation = run(&scene, Scheme::BackwardDifferences, 5e-4, 0.0);
    let [momentum, angular] = simulation.momenta();
    let total = |simulation: &Simulation| {
        let energies = simulation.energies();
        energies.kinetic + energies.stretching + energies.bending + energies.twisting
    };
    let energy = total(&simulation);
    advance_to(&mut simulation, 0.4);
    let [momentum_after, angular_after] = simulation.momenta();
    let lost = (momentum_after - momentum).norm() / momentum.norm();
    assert!(lost < 1e-8, "{lost:e}");
    let lost = (angular_after - angular).norm() / angular.norm();
    assert!(lost < 1e-5, "{lost:e}");
    assert_close(total(&simulation), energy, 1e-3);
    // The ball has turned against the rod, and its point stays that of the rod.
    let (positions, bodies) = (simulation.positions(), simulation.rod_ranges());
    for (range, body) in bodies[1..].iter().zip(&scene.free_bodies) {
        let joined = body.joints[0].at.node;
        let placed = scene.rods[0].centreline[joined] - body.centre;
        let now = positions[joined] - positions[range.first_node];
        assert!((now.norm() - placed.norm()).abs() < 1e-15, "{now}");
    }
}

#[test]
fn a_body_hangs_from_two_rods() {
    let edges = 8;
    let rods = [-0.05, 0.05].map(|x| {
        let nodes = line(Vector3::x() * x, Vector3::new(x, 0.0, -0.2), edges);
        RodDescription::uniform("rod", nodes, section(1e4, [1e-5; 2], 1e-5), 1e-3, 1e-3)
    });
    let joint = |rod| BodyJoint {
        at: at(rod, edges),
        kind: JointKind::Ball,
    };
    // Its centre of mass divides the weight between the rods in the ratio 1 to 3.
    let centre = Vector3::new(0.025, 0.0, -0.22);
    let hold = |rod| Clamp {
        holds_frame: false,
        ..clamp(rod, 0)
    };
    let scene = Scene {
        rods: rods.to_vec(),
        clamps: vec![hold(0), hold(1)],
        free_bodies: vec![free_body(centre, vec![joint(0), joint(1)])],
        loads: vec![weight(-GRAVITY * Vector3::z()), drag(None, 30.0, 0.0)],
        ..Scene::default()
    };
    let parameters = fixed_steps(Scheme::ImplicitEuler, 2e-3);
    let mut simulation = run_with(&scene, &parameters, 1.0);
    let mut copy = resumed(&scene, &parameters, &simulation);
    for simulation in [&mut simulation, &mut copy] {
        advance_to(simulation, 4.0);
    }
    assert_eq!(simulation.positions(), copy.positions());
    let carried = [0, edges + 1].map(|node| simulation.reaction(node).z);
    let own = 1e-3 * 0.2 * GRAVITY;
    for (force, share) in carried.into_iter().zip([0.25, 0.75]) {
        assert_close(force, own + share * MASS * GRAVITY, 2e-3);
    }
}

#[test]
fn a_torque_and_a_brake_turn_a_body_on_an_axle_by_its_inertia() {
    let (inertia, step, end) = (2e-3, 1e-3, 0.5);
    for (torque, brake) in [(0.04, 0.0), (0.04, 0.015), (0.01, 0.015)] {
        let scene = on_axle(inertia, brake, vec![(0.0, torque)]);
        let simulation = run(&scene, Scheme::ImplicitEuler, step, end);
        let motion = simulation.body_motion(0);
        let angle = motion.turn.dot(&Vector3::new(0.0, 0.6, 0.8));
        if brake > torque {
            assert!(angle.abs() < 1e-4, "{angle}");
            continue;
        }
        // Implicit Euler sums up velocities at the ends of steps.
        let rate = (torque - brake) / inertia;
        let bound = if brake == 0.0 { 1e-9 } else { 1e-4 };
        let expected = (0.5 * rate * end * (end + step)).rem_euclid(std::f64::consts::TAU);
        assert_close(angle, expected, bound);
        let turning = 0.5 * inertia * (rate * end).powi(2);
        assert_close(motion.kinetic_energy, turning, 10.0 * bound);
    }
}

#[test]
fn a_brake_stops_a_spinning_body_after_its_angular_momentum_is_spent() {
    let mut scene = on_axle(2e-3, 0.02, Vec::new());
    scene.free_bodies[0].angular_velocity = Vector3::new(0.0, 0.6, 0.8) * 4.0;
    let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
    // It stops at 0.4 s.
    let mut simulation = run_with(&scene, &parameters, 0.2);
    let mut copy = resumed(&scene, &parameters, &simulation);
    let turned = |simulation: &Simulation| simulation.body_motion(0).turn.norm();
    for simulation in [&mut simulation, &mut copy] {
        advance_to(simulation, 0.41);
    }
    let angle = turned(&simulation);
    assert_close(angle, 0.5 * 4.0 * 0.4, 5e-3);
    advance_to(&mut simulation, 0.6);
    assert!((turned(&simulation) - angle).abs() < 1e-4);
    advance_to(&mut copy, 0.6);
    assert_eq!(turned(&simulation), turned(&copy));
}

#[test]
fn a_rope_over_a_braked_drum_carries_what_the_brake_allows() {
    let (radius, thickness) = (0.05, 1e-3);
    let count = 24;
    let hang = 10;
    // The middles of edges touch.
    let half = 0.5 * std::f64::consts::PI / f64::from(count);
    let around = (radius + thickness + 2e-5) / half.cos();
    let edge = std::f64::consts::PI * around / f64::from(count);
    let nodes: Vec<Vector3> = (-hang..=count + hang)
        .map(|k| {
            let beyond = |steps: i32| -edge * f64::from(steps);
            let angle = std::f64::consts::PI * f64::from(k) / f64::from(count);
            match k {
                k if k < 0 => Vector3::new(around, 0.0, beyond(-k)),
                k if k > count => Vector3::new(-around, 0.0, beyond(k - count)),
                _ => Vector3::new(around * angle.cos(), 0.0, around * angle.sin()),
            }
        })
        .collect();
    let last = nodes.len() - 1;
    let rope = RodDescription::uniform(
        "rope",
        nodes,
        section(5e3, [1e-6; 2], 1e-6),
        thickness,
        1e-3,
    );
    let axle = Axle {
        direction: Vector3::y(),
        inertia: 1e-4,
        brake: 0.02,
        torque: Vec::new(),
    };
    let ends = 0.03 * Vector3::y();
    let weight_at = |node: usize, mass: f64| Body {
        name: "weight".into(),
        at: at(0, node),
        mass,
        offset: Vector3::zeros(),
        inertia: None,
        ball: None,
    };
    for model in SOFT_MODELS {
        // The brake holds a difference of 0.4 N, which is 41 g.
        for (heavier, turns) in [(0.13, false), (0.16, true)] {
            let scene = Scene {
                rods: vec![rope.clone()],
                bodies: vec![weight_at(0, 0.1), weight_at(last, heavier)],
                free_bodies: vec![FreeBody {
                    shape: RigidBody::capsule([-ends, ends], radius),
                    axle: Some(axle.clone()),
                    ..free_body(Vector3::zeros(), Vec::new())
                }],
                loads: vec![weight(-GRAVITY * Vector3::z())],
                contact: Some(ContactParameters {
                    friction: 0.5,
                    slip_tolerance: 1e-4,
                    ..contact(model, 1e-5)
                }),
                ..Scene::default()
            };
            let mut simulation = run(&scene, Scheme::ImplicitEuler, 1e-3, 0.1);
            let spin = |simulation: &Simulation| {
                let energy = simulation.body_motion(0).kinetic_energy;
                (2.0 * energy / axle.inertia).sqrt()
            };
            let before = spin(&simulation);
            advance_to(&mut simulation, 0.25);
            if turns {
                // The rope moves with the surface of the drum, at its centreline.
                let moment = (heavier - 0.1) * GRAVITY * around - axle.brake;
                let mass = heavier + 0.1 + 1e-3 * edge * last as f64;
                let rate = moment / (axle.inertia + mass * around * around);
                assert_close_in(model, (spin(&simulation) - before) / 0.15, rate, 0.01);
            } else {
                assert!(spin(&simulation) < 1e-6, "{model:?}");
            }
        }
    }
}
