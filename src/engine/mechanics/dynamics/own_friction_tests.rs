//! Friction coefficients of rods and of their parts, against the acceleration of Coulomb's law.

use super::Simulation;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters, DirectedFriction, Geometry};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{EdgeSection, Obstacle, Plane, RodDescription, Scene};
use crate::mechanics::test_support::{
    MODELS, SOFT_MODELS, advance_to, assert_close_in, contact, fixed, ground, line, moved,
    straight_rod, weight,
};
use nalgebra::UnitQuaternion;

const GRAVITY: f64 = 9.81;
const INCLINE: f64 = 0.6;
const EDGES: usize = 8;
const LENGTH: f64 = 0.2;
const TOLERANCE: f64 = 5e-5;

/// A rod along x, 20 cm long, whose halves have these coefficients.
fn coated(halves: [Option<f64>; 2]) -> RodDescription {
    let rod = straight_rod(EDGES, LENGTH);
    let section = |edge: usize| EdgeSection {
        friction: halves[2 * edge / EDGES],
        ..rod.section(edge)
    };
    let sections = (0..EDGES).map(section).collect();
    rod.with_sections(sections, &[LENGTH / EDGES as f64; EDGES])
}

/// A rod that is released on surfaces along x that descend towards +x.
fn released(rod: RodDescription, parameters: ContactParameters) -> Scene {
    let height = rod.radius + 0.5 * TOLERANCE;
    let down = Vector3::new(libm::sin(INCLINE), 0.0, -libm::cos(INCLINE));
    Scene {
        rods: vec![moved(rod, Vector3::z() * height)],
        loads: vec![weight(down * GRAVITY)],
        contact: Some(parameters),
        ..Scene::default()
    }
}

/// Mean acceleration over the second half of a time, s.
fn acceleration(scene: &Scene, time: f64) -> f64 {
    let mut simulation = Simulation::new(scene, &fixed(1e-3)).unwrap();
    let mut speed_at = |time: f64| {
        advance_to(&mut simulation, time);
        simulation.velocities()[0].x
    };
    let before = speed_at(0.5 * time);
    (speed_at(time) - before) / (0.5 * time)
}

fn expected(friction: f64) -> f64 {
    GRAVITY * (libm::sin(INCLINE) - friction * libm::cos(INCLINE))
}

fn with_friction(model: ContactModel, friction: f64) -> ContactParameters {
    ContactParameters {
        friction,
        ..contact(model, TOLERANCE)
    }
}

#[test]
fn parts_of_a_rod_have_their_own_friction_on_planes_and_obstacles() {
    let block = RigidBody::cuboid(
        Vector3::new(0.3, 0.0, -0.05),
        Vector3::new(0.8, 0.2, 0.1),
        &UnitQuaternion::identity(),
        0.0,
    );
    for model in MODELS {
        for (halves, own, mean) in [
            ([Some(0.1), Some(0.5)], None, 0.3),
            ([Some(0.1), None], None, 0.5 * (0.1 + 0.2)),
            // With a coefficient of the other body: the geometric mean.
            ([Some(0.1), Some(0.4)], Some(0.1), 0.5 * (0.1 + 0.2)),
            ([Some(0.4), None], Some(0.1), 0.5 * (0.2 + 0.1)),
        ] {
            let mut on_plane = released(coated(halves), with_friction(model, 0.2));
            let mut on_block = on_plane.clone();
            on_plane.planes.push(Plane {
                friction: own,
                ..ground()
            });
            on_block.obstacles.push(Obstacle {
                friction: own,
                body: block.clone(),
                ..Obstacle::default()
            });
            for (scene, name) in [(on_plane, "plane"), (on_block, "block")] {
                let case = format!("{model:?}, {name}, {halves:?}, {own:?}");
                assert_close_in(case, acceleration(&scene, 0.1), expected(mean), 2e-3);
            }
        }
    }
}

#[test]
fn rods_with_their_own_friction_rub_with_the_geometric_mean() {
    for model in MODELS {
        for geometry in [Geometry::Polyline, Geometry::Smooth] {
            if geometry == Geometry::Smooth && !SOFT_MODELS.contains(&model) {
                continue;
            }
            let mut scene = released(
                RodDescription {
                    friction: Some(0.4),
                    ..straight_rod(EDGES, LENGTH)
                },
                ContactParameters {
                    geometry,
                    ..with_friction(model, 0.3)
                },
            );
            // Rails at a quarter and at three quarters, which bear the same load.
            for (place, own) in [(0.25, Some(0.1)), (0.75, None)] {
                let radius = scene.rods[0].radius;
                let centre = Vector3::new(place * LENGTH + 0.01, 0.0, -radius);
                let across = Vector3::y() * 0.1;
                scene.rods.push(RodDescription {
                    centreline: line(centre - across, centre + across, 3),
                    held: true,
                    friction: own,
                    ..straight_rod(3, 0.2)
                });
            }
            scene.rods[0]
                .centreline
                .iter_mut()
                .for_each(|node| node.x += 0.01);
            // Before the rod has moved much, which would load one rail more.
            let found = acceleration(&scene, 0.03);
            let case = format!("{model:?}, {geometry:?}");
            assert_close_in(case, found, expected(0.5 * (0.2 + 0.4)), 2e-2);
        }
    }
}

#[test]
fn scales_and_rims_refuse_friction_of_rods() {
    let mut scene = released(coated([Some(0.1), None]), with_friction(MODELS[0], 0.2));
    let refused = |scene: &Scene| {
        Simulation::new(scene, &fixed(1e-3))
            .err()
            .unwrap()
            .to_string()
    };
    scene.planes.push(Plane {
        directed_friction: Some(DirectedFriction {
            forwards: 0.1,
            backwards: 0.2,
            sideways: 0.3,
        }),
        ..ground()
    });
    assert!(refused(&scene).contains("`friction` of their own"));
    scene.planes.clear();
    let ends = [Vector3::x() * -0.1, Vector3::x() * 0.4];
    scene.obstacles.push(Obstacle {
        body: RigidBody::tube(ends, 0.05),
        ..Obstacle::default()
    });
    assert!(refused(&scene).contains("radius and friction"));
    scene.rods[0] = RodDescription {
        friction: Some(0.1),
        ..straight_rod(EDGES, LENGTH)
    };
    assert!(Simulation::new(&scene, &fixed(1e-3)).is_ok());
}
