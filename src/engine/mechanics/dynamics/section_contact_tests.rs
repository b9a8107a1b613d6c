//! Rods whose radius varies, in contact with rods and planes, and in fluids.

use super::{IntegrationParameters, Simulation};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters, Geometry};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{
    NaturalShape, RodDescription, Scene, Section, Stiffness, edge_sections,
};
use crate::mechanics::test_support::{
    MODELS, SOFT_MODELS, assert_close_in, clamp, contact, drag, fixed, gravity, ground, line,
    obstacle, run_with, simulation_of,
};

const THICK: f64 = 8e-3;
const THIN: f64 = 3e-3;
const STEP: f64 = 0.1;
const TOLERANCE: f64 = 5e-5;
const EDGES: usize = 10;
/// Largest gap, m, of rods that touch; with the radius of the other part it is off by 5 mm.
const TOUCHING: f64 = 2.0 * TOLERANCE;

/// A soft rod along x, 20 cm long and thinner beyond its middle.
fn stepped(height: f64) -> RodDescription {
    let centreline = line(Vector3::z() * height, Vector3::new(0.2, 0.0, height), EDGES);
    let nodes: Vec<f64> = centreline.iter().map(|node| node.x).collect();
    let section = |place: f64| {
        let radius = if place < STEP { THICK } else { THIN };
        let mass_per_length = 1000.0 * std::f64::consts::PI * radius * radius;
        Section {
            stiffness: Stiffness::circular(1e6, 0.5, radius),
            radius,
            mass_per_length,
            rotational_inertia_per_length: 0.5 * mass_per_length * radius * radius,
            friction: None,
        }
    };
    let thick = section(0.0);
    let sections = edge_sections(&nodes, &[STEP], &section);
    RodDescription {
        first_director: Some(Vector3::z()),
        natural_shape: NaturalShape::Straight,
        ..RodDescription::uniform(
            "stepped",
            centreline,
            thick.stiffness,
            THICK,
            thick.mass_per_length,
        )
    }
    .with_sections(sections, &[0.2 / EDGES as f64; EDGES])
}

/// A rod of the thin radius across the held stepped rod at a place along it, clamped at one end
/// 0.2 mm above contact, and pulled down.
fn pressed_on(place: f64, radius: f64, parameters: ContactParameters) -> Scene {
    let height = radius + THIN + 2e-4;
    let from = Vector3::new(place, -0.093, height);
    let bar = RodDescription {
        first_director: Some(Vector3::z()),
        ..RodDescription::uniform(
            "bar",
            line(from, from + Vector3::y() * 0.1, 5),
            Stiffness::circular(1e7, 0.5, THIN),
            THIN,
            0.03,
        )
    };
    Scene {
        rods: vec![
            RodDescription {
                held: true,
                ..stepped(0.0)
            },
            bar,
        ],
        clamps: vec![clamp(1, 0)],
        loads: vec![gravity(5.0), drag(Some(1), 1.0, 1e-4)],
        contact: Some(parameters),
        ..Scene::default()
    }
}

#[test]
fn rods_touch_each_part_of_a_stepped_rod_at_its_radius() {
    for model in MODELS {
        for (place, radius) in [(0.053, THICK), (0.151, THIN)] {
            let scene = pressed_on(place, radius, contact(model, TOLERANCE));
            let simulation = run_with(&scene, &fixed(2e-3), 1.0);
            let gap = simulation.minimum_distance() - radius - THIN;
            println!("{model:?} at {place}: gap {gap:.2e} m");
            assert!(gap.abs() < TOUCHING, "{model:?}, {place}: {gap:e}");
            assert!(simulation.mean_gap().is_some(), "it touches");
        }
    }
}

#[test]
fn smooth_contact_has_the_local_radius() {
    for model in SOFT_MODELS {
        for (place, radius) in [(0.053, THICK), (0.151, THIN)] {
            let smooth = ContactParameters {
                geometry: Geometry::Smooth,
                ..contact(model, TOLERANCE)
            };
            let scene = pressed_on(place, radius, smooth);
            let simulation = run_with(&scene, &fixed(2e-3), 1.0);
            // The stiff bar is nearly straight between its nodes on both sides of the held rod.
            let [before, after] = [4, 5].map(|node| simulation.positions()[EDGES + 1 + node]);
            let share = before.y / (before.y - after.y);
            let gap = before.z + share * (after.z - before.z) - radius - THIN;
            assert!(gap.abs() < TOUCHING, "{model:?}, {place}: {gap:e}");
        }
    }
}

#[test]
fn both_parts_of_a_soft_stepped_rod_lie_on_the_ground() {
    for model in MODELS {
        let scene = Scene {
            rods: vec![stepped(THICK + 1e-4)],
            planes: vec![ground()],
            loads: vec![gravity(60.0), drag(None, 0.3, 1e-4)],
            contact: Some(contact(model, TOLERANCE)),
            ..Scene::default()
        };
        let simulation = run_with(&scene, &fixed(1e-3), 0.5);
        let heights: Vec<f64> = simulation.positions().iter().map(|node| node.z).collect();
        println!("{model:?}: {heights:?}");
        // The rod rests on the edge of the thick part and on the end of the thin one.
        for (node, radius) in [(0, THICK), (EDGES / 2, THICK), (EDGES, THIN)] {
            assert!(
                (heights[node] - radius).abs() < TOLERANCE,
                "{model:?}, node {node}"
            );
        }
    }
}

#[test]
fn resistive_drag_has_the_local_radius() {
    // Both halves fall side by side with the force 4πη/(ln(2L/h) − ½) per length and velocity.
    let viscosity = 2.0;
    let mut rod = stepped(0.0);
    rod.velocity = Vector3::z();
    let scene = Scene {
        rods: vec![rod],
        fluid: Some(FluidModel::Resistive { viscosity }),
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, &fixed(1e-9)).unwrap();
    simulation.advance(1e-9).unwrap();
    let forces = simulation.fluid_forces();
    let [start, end] = [0, EDGES].map(|node| forces[node].z);
    let half_edge = 0.1 / EDGES as f64;
    for (force, radius) in [(start, THICK), (end, THIN)] {
        let across = 4.0 * std::f64::consts::PI * viscosity / ((0.4 / radius).ln() - 0.5);
        assert_close_in(radius, force / -half_edge, across, 1e-3);
    }
}

#[test]
fn quadratic_drag_has_the_local_radius() {
    // A node that moves across at 1 m/s bears ½ ρ 2h Cₙ per length of the half edge.
    let (density, normal) = (1000.0, 1.2);
    let mut rod = stepped(0.0);
    rod.velocity = Vector3::z();
    let scene = Scene {
        rods: vec![rod],
        fluid: Some(FluidModel::Quadratic {
            density,
            normal,
            tangential: 0.0,
            added_mass: 0.0,
        }),
        ..Scene::default()
    };
    let simulation = simulation_of(&scene);
    let forces = simulation.fluid_forces();
    for (node, radius) in [(0, THICK), (EDGES, THIN)] {
        let expected = density * radius * normal * 0.1 / EDGES as f64;
        assert_close_in(radius, -forces[node].z, expected, 1e-12);
    }
}

#[test]
fn what_needs_one_radius_refuses_others() {
    let stokeslets = Scene {
        rods: vec![stepped(0.0)],
        fluid: Some(FluidModel::RegularizedStokeslets {
            viscosity: 1.0,
            regularization: 1.02,
            far_field_error: 0.0,
        }),
        ..Scene::default()
    };
    let tube = RigidBody::tube([Vector3::zeros(), Vector3::x()], 0.02);
    let in_tube = Scene {
        rods: vec![stepped(0.0)],
        obstacles: vec![obstacle("tube", tube)],
        contact: Some(contact(ContactModel::ImplicitContact, TOLERANCE)),
        ..Scene::default()
    };
    for (scene, word) in [(stokeslets, "resistive"), (in_tube, "hollow tubes")] {
        let refused = Simulation::new(&scene, &IntegrationParameters::default());
        let message = refused.err().expect("refused").to_string();
        assert!(message.contains(word), "{message}");
    }
    // A rod with sections of one radius is not refused.
    let mut alike = stepped(0.0);
    for edge in &mut alike.sections {
        (edge.radius, edge.end_radii) = (THICK, [THICK; 2]);
    }
    simulation_of(&Scene {
        rods: vec![alike],
        ..Scene::default()
    });
}
