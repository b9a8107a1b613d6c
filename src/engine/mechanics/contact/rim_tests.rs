//! A rod that slides out of a tube around its rim: energies that count once, and derivatives.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::test_support::{SOFT_MODELS, contact};

const RADIUS: f64 = 1e-2;
const GAP: f64 = 1e-4;
const NODES: usize = 12;
/// Radius of the tube, and radius of the circle of the rod, m; slope of the rod at the rim.
const TUBE: f64 = 0.05;
const CIRCLE: f64 = 0.5;
const SLOPE: f64 = 0.3;

/// A circular rod that leaves a tube along x over the lowest point of its rim, at a gap in units
/// of the tolerance. The rim is a given number of edges before the middle of the rod. Edges turn
/// by `turn`.
fn over_rim(turn: f64, gap: f64, phase: f64) -> Vec<Vector3> {
    let direction = |angle: f64| Vector3::new(libm::sin(angle), 0.0, libm::cos(angle));
    // Sagitta between the circle of the nodes and the smooth curve through the middles of the
    // edges, which is inside.
    let sagitta = CIRCLE * turn * turn / 8.0;
    let touch = Vector3::new(0.0, 0.0, -TUBE) + direction(SLOPE) * (RADIUS + gap * GAP + sagitta);
    let centre = touch - direction(SLOPE) * CIRCLE;
    let middle = 0.5 * (NODES - 1) as f64;
    (0..NODES)
        .map(|k| centre + direction(SLOPE + (k as f64 - middle + phase) * turn) * CIRCLE)
        .collect()
}

fn system(model: ContactModel, friction: f64, positions: &[Vector3]) -> ContactSystem {
    let mut surface = ContactSurface::new();
    surface.add_rod(0, positions, false, RADIUS, false);
    let tube = RigidBody::tube([-Vector3::x(), Vector3::zeros()], TUBE);
    surface.add_obstacle(tube, Some(friction));
    let parameters = ContactParameters {
        slip_tolerance: 1e-3,
        ..contact(model, GAP)
    };
    ContactSystem::new(parameters, surface, Vec::new(), 1.0)
}

/// Force on the nodes, and its change by the Jacobian for a motion of all nodes.
fn force_and_change(contact: &ContactSystem, motion: &[Vector3]) -> [Vec<Vector3>; 2] {
    let mut found = [0, 1].map(|_| vec![Vector3::zeros(); NODES]);
    for (one, jacobian) in contact.contacts().iter().zip(contact.jacobians()) {
        let corners = one.nodes.iter().enumerate();
        let corners = corners.filter(|(_, node)| contact.is_of_rod(**node));
        for (m, &node) in corners.clone() {
            for axis in 0..3 {
                found[0][node][axis] += one.force[3 * m + axis];
                let row = &jacobian[3 * m + axis];
                for (n, &other) in corners.clone() {
                    for column in 0..3 {
                        found[1][node][axis] += row[3 * n + column] * motion[other][column];
                    }
                }
            }
        }
    }
    found
}

#[test]
fn a_rod_that_slides_around_the_rim_meets_the_same_force_everywhere() {
    for model in SOFT_MODELS {
        for turn in [0.01, 0.04] {
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for sample in 0..=200 {
                let phase = f64::from(sample) / 200.0;
                let positions = over_rim(turn, 0.2, phase);
                let mut contact = system(model, 0.0, &positions);
                contact.update_candidates(&positions);
                contact.evaluate(&positions, &positions, f64::INFINITY);
                let [forces, _] = force_and_change(&contact, &positions);
                let sum: Vector3 = forces.iter().sum();
                least = least.min(sum.norm());
                most = most.max(sum.norm());
                // Normal to the rod at the rim, not to the wall.
                let along = Vector3::new(libm::cos(SLOPE), 0.0, -libm::sin(SLOPE));
                assert!(
                    sum.dot(&along).abs() < 0.02 * sum.norm(),
                    "{model:?} {phase}: {sum:?}"
                );
            }
            assert!(most < 1.05 * least, "{model:?} {turn}: {least} to {most}");
        }
    }
}

#[test]
fn energy_force_and_jacobian_agree_all_the_way_through_the_mouth() {
    for model in SOFT_MODELS {
        for turn in [0.01, 0.04] {
            for sample in 0..200 {
                let phase = (f64::from(sample) + 0.3) / 200.0;
                let positions = over_rim(turn, 0.2, phase);
                // A slide combined with another motion.
                let step = 1e-4 * GAP;
                let further = over_rim(turn, 0.2, phase + 1e-6);
                let slide = (further[3] - positions[3]).norm();
                let motion: Vec<Vector3> = (positions.iter().zip(&further).enumerate())
                    .map(|(k, (x, y))| {
                        let wave = libm::sin(k as f64);
                        (y - x) / slide + Vector3::new(0.0, 0.3, 0.2) * wave
                    })
                    .collect();
                for time_step in [f64::INFINITY, 1e-2] {
                    let friction = if time_step.is_finite() { 0.4 } else { 0.0 };
                    let mut contact = system(model, friction, &positions);
                    contact.update_candidates(&positions);
                    let at = |contact: &mut ContactSystem, by: f64| {
                        let moved: Vec<Vector3> = (positions.iter().zip(&motion))
                            .map(|(x, m)| x + m * by)
                            .collect();
                        contact.evaluate(&moved, &positions, time_step);
                        let [forces, change] = force_and_change(contact, &motion);
                        (contact.energy(), forces, change)
                    };
                    let (before, after) = (at(&mut contact, -step), at(&mut contact, step));
                    let (energy, forces, change) = at(&mut contact, 0.0);
                    let size: f64 = forces.iter().map(|force| force.norm()).sum();
                    assert!(energy > 0.0 && size > 0.0);
                    if time_step.is_infinite() {
                        let work: f64 = forces.iter().zip(&motion).map(|(f, m)| f.dot(m)).sum();
                        let fall = (before.0 - after.0) / (2.0 * step);
                        assert!(
                            (work - fall).abs() < 1e-4 * size,
                            "{model:?} {phase}: {work} {fall}"
                        );
                    }
                    let largest: f64 = change.iter().map(|change| change.norm()).sum();
                    for node in 0..NODES {
                        let expected = (after.1[node] - before.1[node]) / (2.0 * step);
                        let error = (change[node] - expected).norm();
                        assert!(
                            error < 1e-3 * largest,
                            "{model:?} {phase} {node}: {error:e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_barrier_keeps_rods_off_the_rim_and_passages_are_noticed() {
    let positions = over_rim(0.04, 0.2, 0.3);
    let fall = vec![Vector3::new(0.01, 0.0, -0.3); NODES];
    let mut contact = system(ContactModel::IncrementalPotential, 0.0, &positions);
    contact.update_candidates(&positions);
    let step = contact.largest_step(&positions, &fall);
    assert!(
        step.fraction > 0.0 && step.fraction < 1e-3,
        "{}",
        step.fraction
    );
    // The part outside swings down through the rim.
    let mut contact = system(ContactModel::ImplicitContact, 0.0, &positions);
    contact.update_candidates(&positions);
    let through: Vec<Vector3> = (positions.iter())
        .map(|x| {
            if x.x > 0.0 {
                x - Vector3::z() * 0.2
            } else {
                *x
            }
        })
        .collect();
    assert!(contact.passage(&positions, &through).is_some());
    let out: Vec<Vector3> = positions
        .iter()
        .map(|x| x + Vector3::x() * 0.3 + Vector3::z() * 0.12)
        .collect();
    assert!(contact.passage(&positions, &out).is_none());
}

#[test]
fn a_rod_beside_a_tube_passes_its_end() {
    // Outside along the wall, nearer to the rim than its radius.
    let beside: Vec<Vector3> = (0..NODES)
        .map(|k| Vector3::new(0.02 * (k as f64 - 5.5), 0.0, -TUBE - 0.5 * RADIUS))
        .collect();
    let mut contact = system(ContactModel::ImplicitContact, 0.0, &beside);
    assert!(contact.initial_overlaps(&beside).is_empty());
    contact.update_candidates(&beside);
    contact.evaluate(&beside, &beside, f64::INFINITY);
    assert!(contact.contacts().is_empty());
    assert_eq!(contact.excessive_penetration_at(&beside), None);
}

#[test]
fn a_rod_on_the_axis_of_a_tube_meets_wall_and_rim_on_its_way() {
    // The rod is a hundredth thinner than the tube, so the margin of the candidates is wider than
    // the clearance.
    let on_axis: Vec<Vector3> = (0..NODES)
        .map(|k| Vector3::new(0.02 * (k as f64 - 5.5), 0.0, 0.0))
        .collect();
    let mut surface = ContactSurface::new();
    surface.add_rod(0, &on_axis, false, 0.99 * TUBE, false);
    let tube = RigidBody::tube([-Vector3::x(), Vector3::zeros()], TUBE);
    surface.add_obstacle(tube, None);
    let parameters = contact(ContactModel::IncrementalPotential, GAP);
    let mut contact = ContactSystem::new(parameters, surface, Vec::new(), 1.0);
    contact.update_candidates(&on_axis);
    let nearest = contact.nearest(&on_axis).unwrap();
    assert!((nearest.distance - TUBE).abs() < 1e-15);
    let only = |moves: &dyn Fn(f64) -> bool| -> Vec<Vector3> {
        let fall = |x: &Vector3| if moves(x.x) { -TUBE } else { 0.0 };
        on_axis.iter().map(|x| Vector3::z() * fall(x)).collect()
    };
    // A tenth of the clearance remains: at the wall, and at the rim for the middle of an edge
    // whose outer node moves.
    let inside = contact.largest_step(&on_axis, &only(&|x| x < -0.02));
    assert!(
        (inside.fraction - 0.009).abs() < 1e-3,
        "{}",
        inside.fraction
    );
    let outside = contact.largest_step(&on_axis, &only(&|x| x > 0.0));
    assert!(outside.fraction < 0.05, "{}", outside.fraction);
}
