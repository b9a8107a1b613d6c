//! Derivatives with respect to fields in motions with frictional contact, compared with
//! differences of whole runs and with the forward mode.

use super::comparison::{Course, SCHEMES, check_at, course, results};
use super::{LARGEST_TRACE, Recording};
use crate::mechanics::contact::{ContactModel, DirectedFriction, FrictionAt, Geometry};
use crate::mechanics::dynamics::sensitivity::{Sensitivity, Variation};
use crate::mechanics::dynamics::{IntegrationParameters, Scheme};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{Motion, Obstacle, Plane, RodNode, Scene};
use crate::mechanics::test_support::{
    SOFT_MODELS, at, cantilever, crossed, ground, moved, obstacle, point_force, pulled, rubbing,
};
use crate::mechanics::{UnitQuaternion, Vector3};

/// A rod that a box pushes aside and drags along.
fn pushed(model: ContactModel) -> Scene {
    let mut scene = cantilever();
    scene.rods[0] = moved(scene.rods[0].clone(), Vector3::zeros());
    let centre = Vector3::new(0.18, 0.005, -0.02515);
    let sides = Vector3::new(0.05, 0.06, 0.04);
    let body = RigidBody::cuboid(centre, sides, &UnitQuaternion::identity(), 2e-3);
    let way = Vector3::new(0.1, 0.4, 0.1);
    scene.obstacles = vec![Obstacle {
        motion: Motion {
            translation: vec![(0.0, Vector3::zeros()), (1.0, way)],
            ..Motion::default()
        },
        ..obstacle("box", body)
    }];
    scene.contact = Some(rubbing(model));
    scene
}

/// A rod that a roller pushes up and drags along with its surface.
fn rolled(model: ContactModel) -> Scene {
    let mut scene = pushed(model);
    let centre = Vector3::new(0.18, 0.0, -0.02515);
    let body = RigidBody::cylinder(centre, Vector3::y(), 0.02, 1.0);
    scene.obstacles = vec![Obstacle {
        motion: Motion {
            translation: vec![(0.0, Vector3::zeros()), (1.0, Vector3::z() * 0.1)],
            axis: Some(Vector3::new(0.0, 1.0, 0.3)),
            angular_velocity: 30.0,
            pivot: Some(centre),
            ..Motion::default()
        },
        ..obstacle("roller", body)
    }];
    scene
}

/// A rod that falls on the ground.
fn falling(model: ContactModel) -> Scene {
    let mut scene = cantilever();
    scene.rods[0] = moved(scene.rods[0].clone(), Vector3::z() * 6.5e-3);
    scene.planes = vec![ground()];
    scene.contact = Some(rubbing(model));
    scene
}

/// Derivatives of the results with respect to a force on a node by the forward mode, as differences
/// over `step` (N).
fn by_forward_mode(course: &Course, scene: &Scene, at: RodNode, step: f64) -> Vec<f64> {
    let with = |force: f64| {
        let mut scene = scene.clone();
        scene.loads.push(point_force(
            at.rod,
            at.node,
            Vector3::new(0.3, 0.5, 1.0) * force,
        ));
        scene
    };
    let variation = Variation {
        scenes: [with(step), with(-step)],
        step,
    };
    let mut forward = Sensitivity::new(&with(0.0), &course.parameters(), &[variation]).unwrap();
    if course.settles {
        forward.find_equilibrium().unwrap();
    }
    while forward.base().time() < course.end() {
        forward.advance(course.end()).unwrap();
    }
    let [plus, minus] = forward.neighbours(0).map(results);
    let differences = plus.iter().zip(minus);
    differences
        .map(|(plus, minus)| (plus - minus) / (2.0 * step))
        .collect()
}

/// Largest difference between the derivatives with respect to a force on a node and those of the
/// forward mode, extrapolated from steps (N) of two sizes, relative to the largest derivative.
pub(super) fn against_forward(course: &Course, scene: &Scene, at: RodNode, step: f64) -> f64 {
    let gradients = course.gradients(scene, LARGEST_TRACE);
    let before = scene.rods[..at.rod].iter();
    let node = at.node + before.map(|rod| rod.centreline.len()).sum::<usize>();
    let [near, far] = [1.0, 2.0].map(|part| by_forward_mode(course, scene, at, part * step));
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for (of, gradient) in gradients.iter().enumerate() {
        let expected = (4.0 * near[of] - far[of]) / 3.0;
        let own = gradient.force[node].dot(&Vector3::new(0.3, 0.5, 1.0));
        worst = worst.max((own - expected).abs());
        largest = largest.max(expected.abs());
    }
    worst / largest
}

/// Compares every model and scheme with the forward mode, with a force of `step` (N). Some are
/// also compared with differences for changes by `shares` of the amounts of fields.
#[track_caller]
fn check_contact(
    name: &str,
    models: &[ContactModel],
    scene: fn(ContactModel) -> Scene,
    steps: usize,
    step: f64,
    shares: &[f64],
) {
    for &model in models {
        for scheme in SCHEMES {
            let course = Course {
                steps,
                ..course(scheme)
            };
            let error = against_forward(&course, &scene(model), at(0, 7), step);
            println!("{name} {model:?} {scheme:?} against the forward mode: {error:.1e}");
            assert!(error < 4e-7, "{name} {model:?} {scheme:?}: {error:e}");
        }
    }
    for (k, share) in shares.iter().enumerate() {
        let course = Course {
            steps,
            ..course(SCHEMES[k])
        };
        check_at(
            [7],
            1e-6,
            name,
            &course,
            &scene(models[k % models.len()]),
            *share,
        );
    }
}

#[test]
fn friction_on_the_ground() {
    check_contact("pulled", &SOFT_MODELS, pulled, 30, 1e-7, &[0.02; 2]);
}

#[test]
fn rods_that_rub_against_each_other() {
    check_contact("crossed", &SOFT_MODELS, crossed, 30, 1e-7, &[0.02; 2]);
}

#[test]
fn an_obstacle_that_moves() {
    check_contact("pushed", &SOFT_MODELS[..1], pushed, 30, 1e-7, &[0.02]);
}

#[test]
fn an_obstacle_that_turns_about_its_axis() {
    check_contact("rolled", &SOFT_MODELS[..1], rolled, 30, 1e-7, &[0.02]);
}

#[test]
fn contact_that_begins() {
    check_contact("falling", &SOFT_MODELS, falling, 60, 5e-8, &[0.02]);
}

/// Contacts that stick and slide; the active set of a step is that of the run.
#[test]
fn complementarity_by_its_active_set() {
    for (name, scene) in [
        ("pulled", pulled as fn(ContactModel) -> Scene),
        ("crossed", crossed),
    ] {
        let scene = scene(ContactModel::Complementarity);
        let course = course(Scheme::ImplicitEuler);
        let error = against_forward(&course, &scene, at(0, 7), 1e-7);
        println!("{name} against the forward mode: {error:.1e}");
        assert!(error < 1e-5, "{name}: {error:e}");
        check_at([7], 1e-5, name, &course, &scene, 0.02);
        // Repeated parts of the motion find the same contacts.
        let whole = course.gradients(&scene, LARGEST_TRACE);
        assert_eq!(whole, course.gradients(&scene, 100_000));
    }
}

#[test]
fn an_equilibrium_in_contact() {
    for model in SOFT_MODELS {
        let mut scene = falling(model);
        scene.planes[0].point.z = -0.02;
        let course = Course {
            settles: true,
            steps: 2,
            ..course(SCHEMES[0])
        };
        let error = against_forward(&course, &scene, at(0, 7), 1e-9);
        println!("equilibrium {model:?} against the forward mode: {error:.1e}");
        assert!(error < 4e-7, "{error:e}");
    }
}

#[test]
fn smooth_curves_are_refused() {
    let mut scene = pulled(ContactModel::ImplicitContact);
    scene.contact.as_mut().unwrap().geometry = Geometry::Smooth;
    let refused = Recording::new(&scene, &IntegrationParameters::default()).err();
    let refused = refused.unwrap().to_string();
    assert!(refused.contains("geometry"), "{refused}");
}

#[test]
fn friction_at_surfaces_is_refused() {
    let mut scene = falling(ContactModel::ImplicitContact);
    scene.contact.as_mut().unwrap().friction_at = FrictionAt::Surface;
    let refused = Recording::new(&scene, &IntegrationParameters::default()).err();
    let refused = refused.unwrap().to_string();
    assert!(refused.contains("friction_at"), "{refused}");
}

#[test]
fn friction_by_direction_is_refused() {
    let mut scene = falling(ContactModel::ImplicitContact);
    let own = DirectedFriction {
        forwards: 0.1,
        backwards: 0.2,
        sideways: 0.3,
    };
    let directed = Plane {
        directed_friction: Some(own),
        ..ground()
    };
    scene.planes.push(directed);
    let refused = Recording::new(&scene, &IntegrationParameters::default()).err();
    let refused = refused.unwrap().to_string();
    assert!(refused.contains("directed_friction"), "{refused}");
}
