//! A free helix of 67 edges with the flagellum's cross-section, during a time step of 1 ms.

use rodlab::mechanics::Vector3;
use rodlab::mechanics::scene::{Inertia, NaturalShape, RodDescription, Scene, Stiffness};
use rodlab::mechanics::system::{Stage, System};

/// System, unknowns and stage of the step.
pub fn free_rod() -> (System, Vec<f64>, Stage) {
    let system = System::new(&scene()).expect("a valid scene");
    let start = system.assembly.unknowns.clone();
    let shaken = start.iter().enumerate();
    let unknowns = shaken
        .map(|(k, q)| q + 1e-5 * libm::sin(k as f64))
        .collect();
    let stage = Stage {
        step: 1e-3,
        keeps_spin: false,
        acceleration_step: 1e-3,
        velocity: vec![0.0; start.len()],
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions: vec![Vector3::zeros(); start.len() / 4],
        angles: vec![0.0; start.len() / 4],
        start,
    };
    (system, unknowns, stage)
}

fn scene() -> Scene {
    let node = |k: usize| {
        let turn = 0.37 * k as f64;
        Vector3::new(
            0.01 * libm::cos(turn),
            0.01 * libm::sin(turn),
            0.003 * k as f64,
        )
    };
    let (young, radius, density) = (3e6, 1e-3, 1000.0);
    let area = std::f64::consts::PI * radius * radius;
    let second_moment = 0.25 * area * radius * radius;
    Scene {
        rods: vec![RodDescription {
            name: "rod".into(),
            centreline: (0..68).map(node).collect(),
            closed: false,
            end_tangents: [None, None],
            first_director: None,
            twist: 0.0,
            sections: Vec::new(),
            friction: None,
            natural_shape: NaturalShape::Straight,
            pretension: 0.0,
            stiffness: Stiffness {
                stretching: young * area,
                bending: [young * second_moment; 2],
                twisting: young / 3.0 * 2.0 * second_moment,
            },
            radius,
            mass_per_length: density * area,
            rotational_inertia_per_length: density * 2.0 * second_moment,
            inertia: Inertia::Lumped,
            retardation_time: 0.0,
            relaxation: None,
            yielding: None,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            held: false,
        }],
        ..Scene::default()
    }
}
