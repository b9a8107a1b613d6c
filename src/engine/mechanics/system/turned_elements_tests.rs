use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters, FrictionAt};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::{Body, Motion, Obstacle, RodDescription, Scene};
use crate::mechanics::system::{Stage, System, angles_of};
use crate::mechanics::test_support::{
    SOFT_MODELS, at, body, contact, ground, line, obstacle, straight_rod,
};

const RADIUS: f64 = 5e-3;
const STEP: f64 = 1e-2;
/// Height of the lowest nodes, and the gap of other contacts, m.
const HEIGHT: f64 = RADIUS + 1e-5;
const GAP: f64 = 2e-5;

fn rubbing(model: ContactModel) -> ContactParameters {
    ContactParameters {
        friction: 0.4,
        friction_at: FrictionAt::Surface,
        ..contact(model, 5e-5)
    }
}

/// A slightly bent rod of five edges along x, with its middle nodes lowest.
fn bent() -> RodDescription {
    let node = |k: usize| {
        let x = 0.02 * k as f64 - 0.05;
        Vector3::new(x, 0.3 * x * x, HEIGHT + 0.1 * x * x)
    };
    RodDescription {
        centreline: (0..6).map(node).collect(),
        first_director: None,
        ..straight_rod(5, 0.1)
    }
}

/// A rod of four edges over the line x ≈ `x` at a given height, which ends at a small y > 0.
fn over(x: f64, z: f64) -> RodDescription {
    RodDescription {
        centreline: line(
            Vector3::new(x, -0.05, z),
            Vector3::new(x + 1e-3, 0.004, z + 1e-5),
            4,
        ),
        first_director: None,
        name: "over".into(),
        ..straight_rod(4, 0.1)
    }
}

fn turning(name: &str, body: RigidBody) -> Obstacle {
    Obstacle {
        motion: Motion {
            angular_velocity: 1.0,
            axis: Some(Vector3::x()),
            ..Motion::default()
        },
        ..obstacle(name, body)
    }
}

fn with_ball(rod: usize, node: usize, radius: f64) -> Body {
    Body {
        ball: Some(radius),
        ..body(&format!("ball {rod}"), at(rod, node), 0.01, None)
    }
}

/// Asserts that the Jacobian in a step with small slips is the derivative of the residual, and
/// that at least the given numbers of pairs and planes touch.
fn compare(scene: &Scene, touching: [usize; 2]) {
    let mut system = System::new(scene).unwrap();
    let mut unknowns = system.assembly.unknowns.clone();
    let noise = |k: usize| 1e-6 * libm::sin(7.0 * k as f64 + 1.0);
    let moved = |k: usize| noise(k) * if k % STRIDE == 3 { 300.0 } else { 1.0 };
    let start = unknowns.iter().enumerate();
    let start: Vec<f64> = start.map(|(k, own)| own + moved(k)).collect();
    system.drive(STEP, &mut unknowns);
    let nodes = 0..system.assembly.rods.nodes;
    let stage = Stage {
        step: STEP,
        keeps_spin: false,
        acceleration_step: STEP,
        velocity: vec![0.0; start.len()],
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions: nodes.map(|node| position(&start, node)).collect(),
        angles: angles_of(&start),
        start,
    };
    system.linearize(&unknowns, Some(&stage));
    let contact = system.contact().unwrap();
    let found = [contact.contacts().len(), contact.plane_contacts().len()];
    assert!((0..2).all(|k| found[k] >= touching[k]), "{found:?}");
    assert_eq!(contact.turned().len(), found[0] + found[1]);
    let jacobian = system.dense_matrix();
    let held = system.assembly.held.clone();
    let free = || (0..held.len()).filter(|k| !held[*k]);
    let scale = |k: usize| if k % STRIDE == 3 { 1.0 / RADIUS } else { 1.0 };
    let (mut error, mut total) = (0.0_f64, 0.0_f64);
    for column in free() {
        let step = 1e-10 * scale(column);
        let ends = [1.0, -1.0].map(|side| {
            let mut moved = unknowns.clone();
            moved[column] += side * step;
            system.evaluate(&moved, Some(&stage));
            system.residual.clone()
        });
        for row in free() {
            let unit = scale(row) * scale(column);
            let expected = (ends[0][row] - ends[1][row]) / (2.0 * step) * unit;
            error += (jacobian[(row, column)] * unit - expected).powi(2);
            total += expected.powi(2);
        }
    }
    let error = (error / total).sqrt();
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn rods_over_each_other_on_a_plane_beside_a_ball_that_turns() {
    for model in SOFT_MODELS {
        let beside = Vector3::new(-0.02, 1.5e-4 + 0.03 + RADIUS + GAP, HEIGHT);
        let scene = Scene {
            rods: vec![bent(), over(1e-3, HEIGHT + 2.0 * RADIUS + GAP)],
            planes: vec![ground()],
            obstacles: vec![turning("ball", RigidBody::sphere(beside, 0.03))],
            contact: Some(rubbing(model)),
            ..Scene::default()
        };
        compare(&scene, [2, 2]);
    }
}

#[test]
fn spheres_on_rods() {
    let radius = 8e-3;
    for model in SOFT_MODELS {
        let above = |lower: f64, upper: f64| Scene {
            rods: vec![bent(), over(-0.01, HEIGHT + lower + upper + GAP)],
            bodies: vec![with_ball(0, 2, radius)],
            contact: Some(rubbing(model)),
            ..Scene::default()
        };
        // With a rod and a ball at rest.
        let mut scene = above(radius, RADIUS);
        let beside = Vector3::new(-0.01, 0.05 + radius + 3e-5 + GAP, HEIGHT);
        scene.rods[1] = over(-0.011, HEIGHT + radius + RADIUS + GAP);
        scene.obstacles = vec![turning("ball", RigidBody::sphere(beside, 0.05))];
        compare(&scene, [2, 0]);
        // In contact with each other, one of them at the end of its rod.
        let mut scene = above(radius, 6e-3);
        scene.rods[1].centreline = line(
            Vector3::new(-0.01, 3e-5, HEIGHT + radius + 6e-3 + GAP),
            Vector3::new(-0.01, 0.05, HEIGHT + 0.03),
            4,
        );
        scene.bodies.push(with_ball(1, 0, 6e-3));
        compare(&scene, [1, 0]);
        scene.rods[1].centreline.reverse();
        scene.bodies[1] = with_ball(1, 4, 6e-3);
        compare(&scene, [1, 0]);
    }
}

#[test]
fn a_rod_on_a_sheet_and_in_a_tube() {
    for model in SOFT_MODELS {
        let corners = [[-0.2, -0.2, 0.0], [0.2, -0.2, 0.0], [0.0, 0.2, 0.0]];
        let sheet = RigidBody::of_mesh(corners.map(Vector3::from).to_vec(), vec![[0, 1, 2]], false);
        let axis = Vector3::new(0.0, 3e-5, HEIGHT + 0.3 - RADIUS - GAP);
        let tube = RigidBody::tube([axis - Vector3::x(), axis + Vector3::x()], 0.3);
        for body in [sheet.unwrap(), tube] {
            let scene = Scene {
                rods: vec![bent()],
                obstacles: vec![obstacle("body", body)],
                contact: Some(rubbing(model)),
                ..Scene::default()
            };
            compare(&scene, [2, 0]);
        }
    }
}
