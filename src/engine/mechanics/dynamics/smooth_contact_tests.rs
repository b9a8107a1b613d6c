//! Contact of smooth curves: derivatives, motions, restarts, equilibria, and what is refused.

use crate::mechanics::contact::{ContactModel, ContactParameters, FrictionAt, Geometry};
use crate::mechanics::dynamics::{IntegrationParameters, Scheme, Simulation};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{NaturalShape, RodDescription, Scene};
use crate::mechanics::system::System;
use crate::mechanics::test_support::{
    SOFT_MODELS, cantilever, contact, fixed_steps, free_rods, gravity, ground, line, obstacle,
    section,
};
use crate::mechanics::{UnitQuaternion, Vector3};
use std::f64::consts::TAU;

const RADIUS: f64 = 5e-3;

/// Two bends of radius 3 h that hook into each other, with this distance of their surfaces.
fn clasp(parameters: ContactParameters, gap: f64) -> Scene {
    let stiffness = section(200.0, [1e-3, 1e-3], 1e-3);
    let rod = |name: &str, place: &dyn Fn(f64, f64) -> Vector3| {
        let nodes = (-3..=3).map(|k| {
            let angle = f64::from(k) * 2.08 / 3.0;
            place(3.0 * RADIUS * angle.cos(), 3.0 * RADIUS * angle.sin())
        });
        RodDescription::uniform(name, nodes.collect(), stiffness, RADIUS, 1e-2)
    };
    let centre = 4.0 * RADIUS - gap;
    Scene {
        contact: Some(parameters),
        ..free_rods(vec![
            rod("first", &|along, across| Vector3::new(along, across, 0.0)),
            rod("second", &|along, across| {
                Vector3::new(centre - along, 0.0, across)
            }),
        ])
    }
}

fn smooth(model: ContactModel, distance_tolerance: f64) -> ContactParameters {
    ContactParameters {
        geometry: Geometry::Smooth,
        ..contact(model, distance_tolerance)
    }
}

/// The part of contact in the residual and in the Jacobian.
fn of_contact(scene: &Scene, unknowns: &[f64]) -> (Vec<f64>, nalgebra::DMatrix<f64>) {
    let alone = Scene {
        contact: None,
        planes: Vec::new(),
        ..scene.clone()
    };
    let parts = [scene, &alone].map(|scene| {
        let mut system = System::new(scene).unwrap();
        system.update_candidates(unknowns);
        system.linearize(unknowns, None);
        (system.residual.clone(), system.dense_matrix())
    });
    let [(residual, matrix), (other, without)] = parts;
    let difference = residual.iter().zip(&other).map(|(a, b)| a - b);
    (difference.collect(), matrix - without)
}

/// Compares the Jacobian of the contacts with differences of their forces.
#[track_caller]
fn check_jacobian(scene: &Scene, what: &str) {
    let system = System::new(scene).unwrap();
    let unknowns = system.assembly.unknowns.clone();
    let (forces, jacobian) = of_contact(scene, &unknowns);
    let scale = jacobian.amax();
    assert!(
        scale > 0.0 && forces.iter().any(|force| *force != 0.0),
        "{what} touches"
    );
    let difference = 1e-7 * RADIUS;
    for column in (0..unknowns.len()).filter(|k| k % STRIDE < 3) {
        let moved = |by: f64| {
            let mut unknowns = unknowns.clone();
            unknowns[column] += by;
            of_contact(scene, &unknowns).0
        };
        let (plus, minus) = (moved(difference), moved(-difference));
        for row in 0..unknowns.len() {
            let rate = (plus[row] - minus[row]) / (2.0 * difference);
            let error = (rate - jacobian[(row, column)]).abs() / scale;
            assert!(error < 1e-5, "{what} {row} {column}: {error:e}");
        }
    }
}

#[test]
fn the_jacobian_is_the_derivative_of_the_forces() {
    for model in SOFT_MODELS {
        let mut scene = clasp(smooth(model, 0.1 * RADIUS), 0.06 * RADIUS);
        scene.planes = vec![ground()];
        let heights = scene.rods[1].centreline.iter().map(|node| node.z);
        let lowest = heights.fold(f64::INFINITY, f64::min);
        scene.planes[0].point.z = lowest - 1.06 * RADIUS;
        check_jacobian(&scene, &format!("{model:?}"));

        // The bend around a post, and with its apex at a ball and at the face of a block.
        let outside = |half: f64| Vector3::x() * (4.06 * RADIUS + half);
        let ends = [-1.0, 1.0].map(|z| Vector3::z() * (4.0 * RADIUS * z));
        let sides = Vector3::new(1.0, 4.0, 4.0) * RADIUS;
        for body in [
            RigidBody::capsule(ends, 1.88 * RADIUS),
            RigidBody::sphere(outside(RADIUS), RADIUS),
            RigidBody::cuboid(
                outside(0.5 * RADIUS),
                sides,
                &UnitQuaternion::identity(),
                0.0,
            ),
        ] {
            scene.planes.clear();
            scene.rods.truncate(1);
            scene.obstacles = vec![obstacle("post", body)];
            check_jacobian(&scene, &format!("{model:?} {:?}", scene.obstacles[0].body));
        }
    }
}

#[test]
fn rods_that_collide_keep_momentum_and_their_distance() {
    for model in SOFT_MODELS {
        let parameters = ContactParameters {
            friction: 0.3,
            ..smooth(model, 0.02 * RADIUS)
        };
        let mut scene = clasp(parameters, 0.2 * RADIUS);
        scene.rods[1].velocity = Vector3::new(0.3, 0.02, -0.05);
        let mut simulation =
            Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 2e-4)).unwrap();
        let energy = |simulation: &Simulation| {
            let energies = simulation.energies();
            energies.kinetic + energies.elastic() + energies.contact
        };
        let (before, start) = (simulation.momenta()[0], energy(&simulation));
        let mut touched = 0;
        while simulation.time() < 0.03 {
            touched += simulation.advance(0.03).unwrap().contacts;
            let least = match model {
                ContactModel::ImplicitContact => 1.9 * RADIUS,
                _ => 2.0 * RADIUS,
            };
            assert!(simulation.minimum_distance() > least, "{model:?}");
            assert!(energy(&simulation) < start * (1.0 + 1e-6), "{model:?}");
            let forces = simulation.contact_forces();
            let largest = forces.iter().map(Vector3::norm).fold(0.0, f64::max);
            assert!(forces.iter().sum::<Vector3>().norm() <= 1e-12 * largest);
        }
        assert!(touched > 0, "{model:?}");
        let change = (simulation.momenta()[0] - before).norm();
        assert!(change < 1e-6 * before.norm(), "{model:?}: {change:e}");
    }
}

#[test]
fn a_restart_continues_with_the_same_bits() {
    let parameters = ContactParameters {
        friction: 0.3,
        ..smooth(ContactModel::ImplicitContact, 0.02 * RADIUS)
    };
    let mut scene = clasp(parameters, 0.1 * RADIUS);
    scene.rods[1].velocity = Vector3::new(0.3, 0.02, -0.05);
    let run = |simulation: &mut Simulation, steps: usize| {
        for _ in 0..steps {
            simulation.advance(1.0).unwrap();
        }
    };
    let mut whole = Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 2e-4)).unwrap();
    run(&mut whole, 20);
    let state = whole.state();
    run(&mut whole, 20);
    let mut resumed = Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 2e-4)).unwrap();
    resumed.restore(state).unwrap();
    run(&mut resumed, 20);
    assert_eq!(whole.positions(), resumed.positions());
}

#[test]
fn a_rod_rests_on_a_plane() {
    let stiffness = section(2e3, [1e-2, 1e-2], 1e-2);
    let nodes = line(
        Vector3::new(0.0, 0.0, 1.001 * RADIUS),
        Vector3::new(0.1, 0.0, 1.001 * RADIUS),
        10,
    );
    let mut scene = Scene {
        contact: Some(smooth(ContactModel::ImplicitContact, 0.01 * RADIUS)),
        planes: vec![ground()],
        loads: vec![gravity(10.0)],
        ..free_rods(vec![RodDescription::uniform(
            "rod", nodes, stiffness, RADIUS, 1e-2,
        )])
    };
    scene.contact.as_mut().unwrap().friction = 0.3;
    let mut simulation =
        Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 1e-3)).unwrap();
    for _ in 0..200 {
        simulation.advance(1.0).unwrap();
    }
    let height = simulation.positions()[5].z;
    assert!((height / RADIUS - 1.004).abs() < 3e-3, "{height}");
    let forces = simulation.contact_forces();
    let weight = forces.iter().map(|force| force.z).sum::<f64>();
    assert!(
        (weight / (10.0 * 1e-2 * 0.1) - 1.0).abs() < 1e-3,
        "{weight}"
    );

    // A cantilever bends under its weight until it touches the ground.
    let mut scene = cantilever();
    scene.planes = vec![ground()];
    scene.planes[0].point.z = -0.02;
    scene.contact = Some(smooth(ContactModel::ImplicitContact, 1e-4));
    let mut simulation = Simulation::new(&scene, &IntegrationParameters::default()).unwrap();
    simulation.find_equilibrium().unwrap();
    assert!(!simulation.plane_contacts().is_empty());
}

#[test]
fn what_it_does_not_support_is_refused() {
    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = clasp(smooth(ContactModel::ImplicitContact, 1e-5), 0.1 * RADIUS);
        change(&mut scene);
        Simulation::new(&scene, &IntegrationParameters::default())
            .err()
            .expect("the scene is refused")
            .to_string()
    };
    let model = |change: fn(&mut ContactParameters)| {
        refused(&|scene| change(scene.contact.as_mut().unwrap()))
    };
    let message = model(|own| own.model = ContactModel::Complementarity);
    assert!(message.contains("polyline"), "{message}");
    let message = model(|own| own.friction_at = FrictionAt::Surface);
    assert!(message.contains("polyline"), "{message}");
    let message = refused(&|scene| {
        let ends = [1.0, 2.0].map(|x| Vector3::new(x, 1.0, 1.0));
        scene.obstacles = vec![obstacle("tube", RigidBody::tube(ends, 0.1))];
    });
    assert!(message.contains("tubes"), "{message}");
}

/// A closed ring that is stretched over a held straight rod presses on it with p = T/R, so with
/// 2π T in all, at the radius R = h₁ + h₂ + g of its centreline and the tension T = EA (R/R₀ − 1).
/// Returns the relative error of the total force.
fn pressure_error(edges: usize, geometry: Geometry) -> f64 {
    const STRETCHING: f64 = 200.0;
    const STRETCH: f64 = 0.3;
    let stiffness = section(STRETCHING, [1e-3, 1e-3], 1e-3);
    let step = TAU / edges as f64;
    // Nodes of a polyline that touches the inner circle.
    let placed = 3.02 * RADIUS / (0.5 * step).cos();
    let ring = (0..edges).map(|k| {
        let angle = step * k as f64;
        Vector3::new(angle.cos(), angle.sin(), 0.0) * placed
    });
    let mut ring = RodDescription::uniform("ring", ring.collect(), stiffness, RADIUS, 1e-2);
    ring.closed = true;
    ring.natural_shape = NaturalShape::AsPlaced;
    ring.pretension = STRETCHING * STRETCH;
    let ends = [-1.0, 1.0].map(|z| Vector3::z() * (10.0 * RADIUS * z));
    let core = line(ends[0], ends[1], 2);
    let mut post = RodDescription::uniform("post", core, stiffness, 2.0 * RADIUS, 1e-2);
    post.held = true;
    let scene = Scene {
        contact: Some(ContactParameters {
            geometry,
            ..contact(ContactModel::ImplicitContact, 0.01 * RADIUS)
        }),
        ..free_rods(vec![ring, post])
    };
    let mut simulation =
        Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 1e-2)).unwrap();
    for _ in 0..100 {
        simulation.advance(10.0).unwrap();
    }
    let radius = 3.0 * RADIUS + simulation.mean_gap().unwrap();
    let tension = STRETCHING * (radius * (1.0 + STRETCH) / placed - 1.0);
    let contacts = simulation.contacts();
    let pressed: f64 = contacts.iter().map(|contact| contact.normal_force).sum();
    pressed / (TAU * tension) - 1.0
}

#[test]
fn a_stretched_ring_presses_with_its_tension() {
    for (edges, smooth, polyline) in [(9, 0.05, 0.2), (18, 0.01, 0.05)] {
        let error = pressure_error(edges, Geometry::Smooth).abs();
        assert!(error < smooth, "{edges} edges: {error}");
        let error = pressure_error(edges, Geometry::Polyline).abs();
        assert!(error > polyline, "{edges} edges, polyline: {error}");
    }
}
