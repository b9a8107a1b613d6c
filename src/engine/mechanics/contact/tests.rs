//! The facade as a whole, compared with brute force, with differences of the energy, and with
//! itself after a restart.

use super::closest_points::edge_distance;
use super::test_support::{Random, relative_error};
use super::*;
use crate::mechanics::Vector3;

const RADIUS: f64 = 1e-3;
const STATIC: f64 = f64::INFINITY;

fn parameters() -> ContactParameters {
    ContactParameters {
        friction: 0.3,
        ..ContactParameters::default()
    }
}

/// Zigzag rods in layers across each other, the layers `spacing` apart, the lowest on a plane.
fn woven(layers: usize, spacing: f64) -> (ContactSystem, Vec<Vector3>) {
    let mut random = Random::new(17);
    let mut surface = ContactSurface::new();
    let mut positions: Vec<Vector3> = Vec::new();
    for layer in 0..layers {
        for row in 0..4 {
            let across = 5.0 * RADIUS * row as f64;
            let height = RADIUS + spacing * layer as f64;
            let centreline: Vec<Vector3> = (0..8)
                .map(|k| {
                    let along = 4.3 * RADIUS * k as f64 - 6.0 * RADIUS;
                    let jitter = random.vector() * 0.1 * RADIUS;
                    let place = if layer % 2 == 0 {
                        [along, across]
                    } else {
                        [across, along]
                    };
                    Vector3::new(place[0], place[1], height)
                        + jitter.component_mul(&Vector3::new(1.0, 1.0, 0.02))
                })
                .collect();
            surface.add_rod(positions.len(), &centreline, false, RADIUS, false);
            positions.extend(centreline);
        }
    }
    let floor = ContactPlane {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        friction: Some(0.2),
        directed_friction: None,
    };
    (
        ContactSystem::new(parameters(), surface, vec![floor], 1e-3),
        positions,
    )
}

/// Contact forces on all nodes.
fn nodal_forces(contact: &ContactSystem, nodes: usize) -> Vec<Vector3> {
    let mut forces = vec![Vector3::zeros(); nodes];
    for pair in contact.contacts() {
        for (m, &node) in pair.nodes.iter().enumerate() {
            forces[node] += Vector3::from_column_slice(&pair.force[3 * m..3 * m + 3]);
        }
    }
    for support in contact.plane_contacts() {
        forces[support.node] += Vector3::from(support.force);
    }
    forces
}

fn flat(vectors: &[Vector3]) -> Vec<f64> {
    vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

fn moved(positions: &[Vector3], seed: u64, size: f64) -> Vec<Vector3> {
    let mut random = Random::new(seed);
    positions
        .iter()
        .map(|x| x + random.vector() * size)
        .collect()
}

#[test]
fn active_contacts_are_all_pairs_within_reach() {
    let (mut contact, start) = woven(4, 2.0 * RADIUS);
    contact.update_candidates(&start);
    let mut most = 0;
    for seed in 0..20 {
        let positions = moved(&start, seed, 0.2 * RADIUS);
        assert!(!contact.update_candidates(&positions));
        contact.evaluate(&positions, &positions, STATIC);
        let found: Vec<[usize; 2]> = contact
            .contacts()
            .iter()
            .map(|active| contact.candidates()[active.candidate].edges)
            .collect();

        let surface = contact.surface();
        let edges = surface.edges();
        let mut expected = Vec::new();
        for i in 0..edges.len() {
            for j in i + 1..edges.len() {
                let [a, b] = edges[i].nodes.map(|node| positions[node]);
                let [c, d] = edges[j].nodes.map(|node| positions[node]);
                let reach = 1.5 * contact.parameters().distance_tolerance;
                if surface.may_touch(i, j) && edge_distance(&[a, b, c, d]) < 2.0 * RADIUS + reach {
                    expected.push([i, j]);
                }
            }
        }
        assert_eq!(found, expected);
        most = most.max(expected.len());
    }
    assert!(most > 20, "{most}");
}

#[test]
fn static_forces_are_the_slope_of_the_energy() {
    let (mut contact, start) = woven(3, 2.0 * RADIUS);
    let positions = moved(&start, 3, 1e-6);
    contact.update_candidates(&positions);
    contact.evaluate(&positions, &positions, STATIC);
    assert!(contact.contacts().len() > 20 && contact.plane_contacts().len() > 5);
    let forces = flat(&nodal_forces(&contact, positions.len()));
    let step = 1e-10;
    let slopes: Vec<f64> = (0..forces.len())
        .map(|index| {
            let mut energy = |sign: f64| {
                let mut positions = positions.clone();
                positions[index / 3][index % 3] += sign * step;
                contact.evaluate_forces(&positions, &positions, STATIC);
                contact.energy()
            };
            (energy(-1.0) - energy(1.0)) / (2.0 * step)
        })
        .collect();
    let error = relative_error(&forces, &slopes);
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn jacobians_are_the_slopes_of_the_forces_with_friction() {
    let (mut contact, start) = woven(3, 2.0 * RADIUS);
    let previous = moved(&start, 3, 1e-6);
    let positions = moved(&previous, 4, 1e-8);
    let time_step = 1e-3;
    contact.update_candidates(&positions);
    contact.evaluate(&positions, &previous, time_step);
    let mut found = vec![vec![0.0; 3 * positions.len()]; 3 * positions.len()];
    for (active, jacobian) in contact.contacts().iter().zip(contact.jacobians()) {
        for row in 0..12 {
            for column in 0..12 {
                let (m, n) = (active.nodes[row / 3], active.nodes[column / 3]);
                found[3 * n + column % 3][3 * m + row % 3] += jacobian[row][column];
            }
        }
    }
    for (support, jacobian) in contact
        .plane_contacts()
        .iter()
        .zip(contact.plane_jacobians())
    {
        for row in 0..3 {
            for column in 0..3 {
                found[3 * support.node + column][3 * support.node + row] += jacobian[row][column];
            }
        }
    }
    let step = 1e-11;
    let largest = found.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (index, column) in found.iter().enumerate() {
        let mut forces = |sign: f64| {
            let mut positions = positions.clone();
            positions[index / 3][index % 3] += sign * step;
            contact.evaluate_forces(&positions, &previous, time_step);
            flat(&nodal_forces(&contact, positions.len()))
        };
        let (after, before) = (forces(1.0), forces(-1.0));
        for row in 0..column.len() {
            let slope = (after[row] - before[row]) / (2.0 * step);
            assert!(
                (slope - column[row]).abs() < 1e-5 * largest,
                "{row} {index}"
            );
        }
    }
}

#[test]
fn forces_alone_are_the_same_bytes_as_with_jacobians() {
    let (mut contact, start) = woven(3, 2.0 * RADIUS);
    let positions = moved(&start, 5, 0.02 * RADIUS);
    contact.update_candidates(&start);
    contact.evaluate(&positions, &start, 1e-3);
    let (contacts, planes) = (
        contact.contacts().to_vec(),
        contact.plane_contacts().to_vec(),
    );
    assert_eq!(contact.jacobians().len(), contacts.len());
    contact.evaluate_forces(&positions, &start, 1e-3);
    assert_eq!(contact.contacts(), contacts);
    assert_eq!(contact.plane_contacts(), planes);
    assert!(contact.jacobians().is_empty() && contact.plane_jacobians().is_empty());
}

#[test]
fn candidates_live_until_a_quarter_of_the_margin_is_used_up() {
    let (mut contact, start) = woven(2, 3.0 * RADIUS);
    assert!(contact.update_candidates(&start));
    let lifted = |height: f64| -> Vec<Vector3> {
        let lift = Vector3::new(0.0, 0.0, height);
        let half = start.len() / 2;
        let upper = start[half..].iter().map(|x| x + lift);
        start[..half].iter().copied().chain(upper).collect()
    };
    // The margin is 2 radii.
    assert!(!contact.update_candidates(&lifted(0.49 * RADIUS)));
    assert!(contact.candidates_are_complete(&lifted(0.99 * RADIUS)));
    assert!(!contact.candidates_are_complete(&lifted(1.01 * RADIUS)));
    let before = contact.candidates().len();
    assert!(before > 0);
    assert!(
        contact.update_candidates(&lifted(1.5 * RADIUS)),
        "the layers part"
    );
    assert!(contact.candidates().len() < before);
    // All rods move up together: the set is rebuilt but unchanged.
    let together: Vec<Vector3> = lifted(1.5 * RADIUS)
        .iter()
        .map(|x| x + Vector3::z())
        .collect();
    assert!(!contact.update_candidates(&together));
    assert!(contact.candidates_are_complete(&together));
}

#[test]
fn a_restart_continues_with_the_same_bytes() {
    let (mut contact, start) = woven(4, 2.0 * RADIUS);
    contact.update_candidates(&start);
    contact.set_stiffness(0.37);
    let positions = moved(&start, 6, 0.2 * RADIUS);
    let stored = postcard::to_stdvec(&contact.memory()).unwrap();

    let (mut restored, _) = woven(4, 2.0 * RADIUS);
    restored
        .restore(&postcard::from_bytes(&stored).unwrap())
        .unwrap();
    assert!(restored.memory() == contact.memory());
    for contact in [&mut contact, &mut restored] {
        assert!(!contact.update_candidates(&positions));
        contact.evaluate(&positions, &start, 1e-3);
    }
    assert_eq!(restored.candidates(), contact.candidates());
    assert_eq!(restored.contacts(), contact.contacts());
    assert!(restored.jacobians() == contact.jacobians());

    let (mut other, _) = woven(2, 2.0 * RADIUS);
    let expected = memory::MismatchedMemory {
        expected: 64,
        found: 128,
    };
    assert_eq!(other.restore(&contact.memory()), Err(expected));
}

#[test]
fn node_order_does_not_matter() {
    let (mut contact, positions) = woven(3, 2.0 * RADIUS);
    contact.update_candidates(&positions);
    contact.evaluate(&positions, &moved(&positions, 8, 1e-8), 1e-3);
    let forces = nodal_forces(&contact, positions.len());

    let reversed: Vec<Vector3> = positions.iter().rev().copied().collect();
    let mut surface = ContactSurface::new();
    for rod in reversed.chunks(8).enumerate() {
        surface.add_rod(8 * rod.0, rod.1, false, RADIUS, false);
    }
    let planes = contact.planes().to_vec();
    let mut backward = ContactSystem::new(parameters(), surface, planes, contact.stiffness());
    let mut previous = moved(&positions, 8, 1e-8);
    previous.reverse();
    backward.update_candidates(&reversed);
    backward.evaluate(&reversed, &previous, 1e-3);
    let mut backward = nodal_forces(&backward, positions.len());
    backward.reverse();
    assert!(relative_error(&flat(&backward), &flat(&forces)) < 1e-9);
}

#[test]
fn overlaps_and_penetration_are_named() {
    let (mut contact, apart) = woven(2, 2.1 * RADIUS);
    let overlaps = contact.initial_overlaps(&apart);
    assert!(
        overlaps
            .iter()
            .all(|found| matches!(found.pair, ContactPair::NodeAndPlane { .. }))
    );

    let mut positions = apart.clone();
    for x in &mut positions {
        x.z += 0.1 * RADIUS;
    }
    assert!(contact.initial_overlaps(&positions).is_empty());
    contact.update_candidates(&positions);
    let minimum = contact.minimum_distance(&positions);
    assert!((2.0 * RADIUS..2.1 * RADIUS).contains(&minimum), "{minimum}");

    // Press the upper layer 7 % of the diameter into the lower one.
    let half = positions.len() / 2;
    for x in &mut positions[half..] {
        x.z -= 0.24 * RADIUS;
    }
    contact.evaluate(&positions, &positions, STATIC);
    let deepest = contact
        .excessive_penetration()
        .expect("more than 5 % are not allowed");
    assert!((0.06..0.08).contains(&deepest.penetration()), "{deepest:?}");
    assert!((deepest.distance - contact.minimum_distance(&positions)).abs() < 1e-15);
    let ContactPair::Edges([lower, upper]) = deepest.pair else {
        panic!("{deepest:?}");
    };
    assert!(lower < 28 && upper >= 28);
    assert!(contact.initial_overlaps(&positions).contains(&deepest));
}

#[test]
fn statics_refuse_friction() {
    let (mut contact, start) = woven(2, 2.0 * RADIUS);
    contact.update_candidates(&start);
    contact.evaluate(&start, &moved(&start, 9, 1e-4), STATIC);
    assert!(
        contact
            .plane_contacts()
            .iter()
            .all(|c| c.force[0] == 0.0 && c.force[1] == 0.0)
    );
    contact.evaluate(&start, &moved(&start, 9, 1e-4), 1e-3);
    assert!(contact.plane_contacts().iter().any(|c| c.force[0] != 0.0));
}

#[test]
fn a_margin_can_be_chosen() {
    let (mut contact, start) = woven(3, 2.0 * RADIUS);
    contact.update_candidates(&start);
    let before = contact.candidates().len();
    contact.set_candidate_margin(0.5 * RADIUS);
    assert!(contact.candidates().is_empty());
    assert!(contact.update_candidates(&start));
    assert!((1..before).contains(&contact.candidates().len()));
    let lifted: Vec<Vector3> = start
        .iter()
        .map(|x| x + Vector3::z() * 0.26 * RADIUS)
        .collect();
    assert!(!contact.candidates_are_complete(&lifted));
}

/// Acceleration along the slope of two free masses on an incline of 30° after implicit Euler steps
/// of 1 ms, m/s², and their final speed, m/s.
fn slide_down(friction: f64) -> (f64, f64) {
    const MASS: f64 = 2e-3;
    const TIME_STEP: f64 = 1e-3;
    let angle = 30f64.to_radians();
    let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
    let down = Vector3::new(angle.cos(), 0.0, -angle.sin());
    let weight = Vector3::z() * (-9.81 * MASS);
    let mut positions = [0.0, 1.0]
        .map(|y| normal * (RADIUS + 5e-6) + Vector3::y() * y)
        .to_vec();
    let mut surface = ContactSurface::new();
    surface.add_rod(0, &positions, false, RADIUS, false);
    let plane = ContactPlane {
        point: Vector3::zeros(),
        normal,
        friction: Some(friction),
        directed_friction: None,
    };
    let mut contact = ContactSystem::new(parameters(), surface, vec![plane], 1.0);
    let mut velocities = [Vector3::zeros(); 2];
    let mut speeds = Vec::new();
    for _ in 0..400 {
        let previous = positions.clone();
        contact.adapt_stiffness(&positions, &[weight; 2]);
        for _ in 0..30 {
            contact.evaluate(&positions, &previous, TIME_STEP);
            for node in 0..2 {
                let moved = positions[node] - previous[node];
                let inertia = (moved / TIME_STEP - velocities[node]) * (MASS / TIME_STEP);
                let mut residual = inertia - weight;
                let mut matrix = nalgebra::Matrix3::identity() * (MASS / TIME_STEP.powi(2));
                for (found, jacobian) in contact
                    .plane_contacts()
                    .iter()
                    .zip(contact.plane_jacobians())
                {
                    if found.node == node {
                        residual -= Vector3::from(found.force);
                        matrix -= nalgebra::Matrix3::from_fn(|r, c| jacobian[r][c]);
                    }
                }
                positions[node] -= matrix.lu().solve(&residual).unwrap();
            }
        }
        for node in 0..2 {
            velocities[node] = (positions[node] - previous[node]) / TIME_STEP;
        }
        speeds.push(velocities[0].dot(&down));
    }
    assert!((velocities[0] - velocities[1]).norm() < 1e-12);
    let last = speeds.len() - 1;
    (((speeds[last] - speeds[last - 100]) / 0.1), speeds[last])
}

#[test]
fn a_mass_slides_down_an_incline_by_coulombs_law() {
    let angle = 30f64.to_radians();
    for friction in [0.1, 0.3, 0.5] {
        let (acceleration, _) = slide_down(friction);
        let expected = 9.81 * (angle.sin() - friction * angle.cos());
        assert!(
            (acceleration - expected).abs() < 1e-3 * expected,
            "{friction}: {acceleration}"
        );
    }
}

#[test]
fn a_mass_sticks_to_an_incline_except_for_the_creep_of_the_smoothing() {
    for friction in [0.6, 0.8] {
        let (acceleration, speed) = slide_down(friction);
        // tan(30°)/μ of the Coulomb limit, see the friction law.
        let fraction = 30f64.to_radians().tan() / friction;
        let creep = ((1.0 + fraction) / (1.0 - fraction)).ln() * parameters().slip_tolerance / 15.0;
        assert!(
            (speed - creep).abs() < 1e-3 * creep,
            "{friction}: {speed} {creep}"
        );
        assert!(acceleration.abs() < 1e-6);
    }
}

#[test]
fn the_stiffness_follows_the_largest_force_near_contact() {
    let (mut contact, start) = woven(2, 2.0 * RADIUS);
    contact.update_candidates(&start);
    let mut forces = vec![Vector3::zeros(); start.len()];
    assert!(!contact.adapt_stiffness(&start, &forces));
    forces[9] = Vector3::new(0.0, 3.0, 4.0);
    assert!(contact.adapt_stiffness(&start, &forces));
    assert_eq!(contact.stiffness(), 5e5);

    // Far from contact no force counts.
    let far: Vec<Vector3> = (0..start.len())
        .map(|k| Vector3::z() * (1.0 + k as f64))
        .collect();
    forces[9] *= 100.0;
    contact.update_candidates(&far);
    assert!(!contact.adapt_stiffness(&far, &forces));
}

#[test]
fn the_softer_of_two_bodies_sets_the_least_stiffness_of_their_contact() {
    // Two crossing edges with contact forces at the stiffness of each pair of bodies.
    let nodes = [
        Vector3::new(-5.0, 0.0, 0.0),
        Vector3::new(5.0, 0.0, 0.0),
        Vector3::new(0.0, -5.0, 2.0),
        Vector3::new(0.0, 5.0, 2.0),
    ]
    .map(|x| x * RADIUS);
    let force_between = |present: f64, least: [f64; 2]| {
        let mut surface = ContactSurface::new();
        for edge in 0..2 {
            surface.add_rod(
                2 * edge,
                &nodes[2 * edge..2 * edge + 2],
                false,
                RADIUS,
                false,
            );
        }
        let mut contact = ContactSystem::new(parameters(), surface, Vec::new(), present);
        let [first, second] = least;
        contact.set_least_stiffness_of_nodes(vec![first, first, second, second]);
        contact.update_candidates(&nodes);
        contact.evaluate(&nodes, &nodes, STATIC);
        contact.contacts()[0].normal_force
    };
    let (soft, stiff, obstacle) = (1e-3, 1e2, f64::INFINITY);
    let of = |stiffness: f64| force_between(stiffness, [0.0; 2]);
    assert!(of(soft) > 0.0 && (of(stiff) / of(soft) - stiff / soft).abs() < 1e-9 * stiff / soft);
    for (present, least, expected) in [
        (1e-6, [soft, soft], soft),
        (1e-6, [soft, stiff], soft),
        (1e-6, [stiff, soft], soft),
        (1e-6, [soft, obstacle], soft),
        (1e-6, [stiff, obstacle], stiff),
        (1e-6, [stiff, stiff], stiff),
        // The stiffness that forces near contact require applies to all contacts.
        (1.0, [soft, stiff], 1.0),
    ] {
        assert_eq!(
            force_between(present, least),
            of(expected),
            "{present} {least:?}"
        );
    }
}
