//! Rods at obstacles of every kind: derivatives, candidates, bounds of steps, the certificate.

use super::test_support::{Random, relative_error};
use super::*;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::rotation::{self, Pose};
use crate::mechanics::test_support::{SOFT_MODELS, contact};
use crate::mechanics::{UnitQuaternion, Vector3};

const RADIUS: f64 = 1e-2;
const GAP: f64 = 1e-4;
const NODES: usize = 6;

/// A ball, a capsule, a rounded box, a sharp tetrahedron, a sheet, a ball and a wavy sheet as smooth
/// meshes, and a tube around them all; every surface passes near the origin.
fn body(kind: usize) -> RigidBody {
    let down = |depth: f64| Vector3::new(0.003, -0.002, -depth);
    match kind {
        0 => RigidBody::sphere(down(0.2), 0.2),
        1 => RigidBody::capsule([down(0.1), down(0.1) + Vector3::new(0.02, 0.05, 0.0)], 0.1),
        2 => {
            let turned = rotation::from_vector(Vector3::new(0.3, 0.5, 0.1));
            RigidBody::cuboid(down(0.06), Vector3::new(0.1, 0.08, 0.12), &turned, 0.004)
        }
        3 => {
            let corners = [
                [0.0, 0.0, 0.0],
                [0.3, 0.0, -0.3],
                [-0.2, 0.3, -0.3],
                [-0.2, -0.3, -0.3],
            ];
            let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
            RigidBody::of_mesh(corners.map(Vector3::from).to_vec(), faces, true).unwrap()
        }
        4 => {
            let corners = [
                [-0.2, -0.2, 0.0],
                [0.2, -0.2, 0.01],
                [0.2, 0.2, 0.0],
                [-0.2, 0.2, 0.01],
            ];
            let faces = vec![[0, 1, 2], [0, 2, 3]];
            RigidBody::of_mesh(corners.map(Vector3::from).to_vec(), faces, false).unwrap()
        }
        5 => {
            let (corners, faces) = ball_mesh(2);
            let corners = corners.iter().map(|x| down(0.2) + x * 0.2);
            let ball = RigidBody::of_mesh(corners.collect(), faces, true).unwrap();
            ball.smoothed(1.0)
        }
        6 => {
            let corner = |k: usize| {
                let [x, y] = [k % 9, k / 9].map(|k| 0.06 * k as f64 - 0.24);
                Vector3::new(x, y, 0.02 * (5.0 * x).sin() * (7.0 * y).cos())
            };
            let cells = (0..8).flat_map(|row| (0..8).map(move |column| 9 * row + column));
            let faces = cells.flat_map(|k| [[k, k + 1, k + 10], [k, k + 10, k + 9]]);
            let sheet = RigidBody::of_mesh((0..81).map(corner).collect(), faces.collect(), false);
            sheet.unwrap().smoothed(1.0)
        }
        _ => {
            let axis = Vector3::new(0.02, 0.01, 0.1);
            RigidBody::tube([axis - Vector3::x(), axis + Vector3::x()], 0.1)
        }
    }
}

const KINDS: usize = 8;
const CLOSED: [usize; 5] = [0, 1, 2, 3, 5];

/// The octahedron with its faces divided into four `times` times, on the unit sphere.
fn ball_mesh(times: usize) -> (Vec<Vector3>, Vec<[usize; 3]>) {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let mut corners: Vec<Vector3> = axes.into_iter().flat_map(|axis| [axis, -axis]).collect();
    let mut faces = Vec::new();
    for k in 0..8 {
        let [a, b, c] = [k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2 & 1)];
        let is_even = (k & 1) ^ (k >> 1 & 1) ^ (k >> 2 & 1) == 0;
        faces.push(if is_even { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..times {
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
                let middle = (corners[from] + corners[to]).normalize();
                let known = corners.iter().position(|x| (x - middle).norm() < 1e-9);
                known.unwrap_or_else(|| {
                    corners.push(middle);
                    corners.len() - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    (corners, faces)
}

/// A rod with nodes at random positions, at an obstacle with friction.
fn system(kind: usize, model: ContactModel, positions: &[Vector3]) -> ContactSystem {
    let mut surface = ContactSurface::new();
    surface.add_rod(0, positions, false, RADIUS, false);
    surface.add_obstacle(body(kind), Some(0.4));
    let parameters = ContactParameters {
        slip_tolerance: 1e-3,
        ..contact(model, GAP)
    };
    ContactSystem::new(parameters, surface, Vec::new(), 1.0)
}

/// A wavy rod over the origin, about as high as its radius.
fn wavy(random: &mut Random) -> Vec<Vector3> {
    (0..NODES)
        .map(|k| Vector3::new(0.04 * k as f64 - 0.1, 0.0, 0.0) + random.vector() * 0.02)
        .collect()
}

/// Moves the rod along z until its least gap is a given part of the reach of the forces; `None` if
/// this is impossible.
fn at_reach(kind: usize, model: ContactModel, random: &mut Random) -> Option<Vec<Vector3>> {
    let placed = wavy(random);
    let part = GAP * 0.4 * (1.0 + 0.5 * random.symmetric());
    let lifted = |height: f64| -> Vec<Vector3> {
        placed.iter().map(|x| x + Vector3::z() * height).collect()
    };
    let gap = |height: f64| {
        let positions = lifted(height);
        let mut contact = system(kind, model, &positions);
        contact.update_candidates(&positions);
        let nearest = contact.nearest(&positions);
        nearest.map_or(f64::INFINITY, |near| near.distance - near.threshold)
    };
    // Approaches from afar, then bisects.
    let mut height = 0.08;
    while gap(height) > 2.0 * part {
        height -= 2e-3;
        if height < -0.2 {
            return None;
        }
    }
    let (mut low, mut high) = (height, height + 2e-3);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if gap(middle) > part {
            high = middle;
        } else {
            low = middle;
        }
    }
    let found = gap(high);
    (found > 0.0 && found < GAP).then(|| lifted(high))
}

fn flat(contact: &ContactSystem) -> Vec<f64> {
    let mut forces = vec![0.0; 3 * NODES];
    for one in contact.contacts() {
        for (corner, &node) in one.nodes.iter().enumerate() {
            if contact.is_of_rod(node) {
                for axis in 0..3 {
                    forces[3 * node + axis] += one.force[3 * corner + axis];
                }
            }
        }
    }
    forces
}

fn dense(contact: &ContactSystem) -> Vec<f64> {
    let size = 3 * NODES;
    let mut matrix = vec![0.0; size * size];
    for (one, jacobian) in contact.contacts().iter().zip(contact.jacobians()) {
        for (m, &p) in one
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| contact.is_of_rod(**node))
        {
            for (n, &q) in one
                .nodes
                .iter()
                .enumerate()
                .filter(|(_, node)| contact.is_of_rod(**node))
            {
                for i in 0..3 {
                    for j in 0..3 {
                        matrix[(3 * p + i) * size + 3 * q + j] += jacobian[3 * m + i][3 * n + j];
                    }
                }
            }
        }
    }
    matrix
}

#[test]
fn forces_and_jacobians_are_derivatives() {
    for model in SOFT_MODELS {
        for kind in 0..KINDS {
            let mut random = Random::new(20 + kind as u64);
            let (mut tested, mut tries) = (0, 0);
            while tested < 12 && tries < 400 {
                tries += 1;
                let Some(positions) = at_reach(kind, model, &mut random) else {
                    continue;
                };
                let mut contact = system(kind, model, &positions);
                contact.update_candidates(&positions);
                let previous: Vec<Vector3> = positions
                    .iter()
                    .map(|x| x + random.vector() * 1e-5)
                    .collect();
                for time_step in [f64::INFINITY, 1e-2] {
                    contact.evaluate(&positions, &previous, time_step);
                    let (forces, matrix) = (flat(&contact), dense(&contact));
                    if contact.contacts().is_empty() {
                        continue;
                    }
                    let step = 1e-4 * GAP;
                    let (mut slopes, mut changes) = (Vec::new(), vec![0.0; matrix.len()]);
                    for column in 0..3 * NODES {
                        let ends = [step, -step].map(|offset| {
                            let mut moved = positions.clone();
                            moved[column / 3][column % 3] += offset;
                            contact.evaluate(&moved, &previous, time_step);
                            (contact.energy(), flat(&contact))
                        });
                        slopes.push((ends[1].0 - ends[0].0) / (2.0 * step));
                        for row in 0..3 * NODES {
                            let change = (ends[0].1[row] - ends[1].1[row]) / (2.0 * step);
                            changes[row * 3 * NODES + column] = change;
                        }
                    }
                    if time_step.is_infinite() {
                        let error = relative_error(&forces, &slopes);
                        assert!(error < 1e-5, "{model:?} {kind}: force {error:e}");
                    }
                    let error = relative_error(&matrix, &changes);
                    assert!(error < 1e-4, "{model:?} {kind} {time_step}: {error:e}");
                    tested += 1;
                }
            }
            assert!(tested >= 12, "{model:?} {kind}: {tested} of {tries}");
        }
    }
}

/// Least gap between the surfaces of rod and obstacle over the threshold, by brute force from
/// samples along all edges.
fn least_gap(kind: usize, positions: &[Vector3]) -> f64 {
    let body = body(kind);
    if body.smooth.is_some() {
        return least_height(body, positions) - RADIUS;
    }
    let distance = |x: &Vector3| {
        let of_segment =
            |&[a, b]: &[usize; 2]| edge_distance(&[*x, *x, body.vertices[a], body.vertices[b]]);
        let core = body
            .segments
            .iter()
            .map(of_segment)
            .fold(f64::INFINITY, f64::min);
        let faces = body.faces.iter().filter_map(|face| {
            let [a, b, c] = face.map(|vertex| body.vertices[vertex]);
            foot::Foot::of(&[*x, a, b, c], 1.0).map(|foot| foot.distance.abs())
        });
        let nearest = faces.fold(core, f64::min) - body.radius;
        if body.hollow { -nearest } else { nearest }
    };
    let samples = positions.windows(2).flat_map(|ends| {
        (0..=40).map(move |k| ends[0] + (ends[1] - ends[0]) * (f64::from(k) / 40.0))
    });
    samples
        .map(|x| distance(&x) - RADIUS)
        .fold(f64::INFINITY, f64::min)
}

/// Least height of a node over any patch of a smooth mesh, m.
fn least_height(body: RigidBody, positions: &[Vector3]) -> f64 {
    let smooth = body.smooth.as_ref().unwrap();
    let feet = body
        .faces
        .iter()
        .zip(&smooth.corners)
        .flat_map(|(face, normals)| {
            let patch = patch::Patch {
                corners: face.map(|vertex| body.vertices[vertex]),
                normals: normals.map(|normal| smooth.normals[normal as usize]),
            };
            positions.iter().filter_map(move |x| {
                let at = patch.coordinates(x).ok()?;
                let is_over = at.weights.iter().all(|weight| *weight >= 0.0);
                let height = patch.foot(0, &at, 1.0).distance;
                // Not over the other side of the ball.
                (is_over && height > -0.1).then_some(height)
            })
        });
    feet.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_barrier_is_not_crossed_on_the_way() {
    for kind in 0..KINDS {
        let mut random = Random::new(50 + kind as u64);
        let (mut stopped, mut tries) = (0, 0);
        while stopped < 10 && tries < 200 {
            tries += 1;
            let model = ContactModel::IncrementalPotential;
            let Some(start) = at_reach(kind, model, &mut random) else {
                continue;
            };
            let size = 10f64.powf(-2.5 + 1.5 * random.symmetric());
            let fall = Vector3::z() * -size;
            let moves: Vec<Vector3> = start
                .iter()
                .map(|_| fall + random.vector() * (0.3 * size))
                .collect();
            let mut contact = system(kind, model, &start);
            contact.update_candidates(&start);
            let step = contact.largest_step(&start, &moves);
            assert!(step.fraction > 0.0 && step.fraction <= 1.0);
            stopped += usize::from(step.fraction < 1.0);
            let before = least_gap(kind, &start);
            for sample in 0..=20 {
                let part = step.fraction * f64::from(sample) / 20.0;
                let there: Vec<Vector3> = start
                    .iter()
                    .zip(&moves)
                    .map(|(x, m)| x + m * part)
                    .collect();
                let gap = least_gap(kind, &there);
                assert!(gap > 0.05 * before.min(GAP), "{kind} at {part}: {gap:e}");
            }
        }
        assert!(stopped >= 10, "{kind}: {stopped} of {tries}");
    }
}

#[test]
fn a_rod_that_falls_through_is_noticed() {
    for kind in 0..KINDS {
        for model in [ContactModel::ImplicitContact, ContactModel::Complementarity] {
            let mut random = Random::new(70 + kind as u64);
            let mut fell = 0;
            for _ in 0..40 {
                let Some(start) = at_reach(kind, model, &mut random) else {
                    continue;
                };
                let start: Vec<Vector3> = start.iter().map(|x| x + Vector3::z() * RADIUS).collect();
                let mut contact = system(kind, model, &start);
                contact.update_candidates(&start);
                let end: Vec<Vector3> = start.iter().map(|x| x - Vector3::z()).collect();
                assert!(contact.passage(&start, &end).is_some(), "{kind}");
                let aside: Vec<Vector3> = start.iter().map(|x| x + Vector3::z() * 0.05).collect();
                if kind + 1 < KINDS {
                    assert!(contact.passage(&start, &aside).is_none(), "{kind}");
                }
                fell += 1;
            }
            assert!(fell > 5, "{kind}: {fell}");
        }
    }
}

#[test]
fn nodes_that_fall_on_sides_of_a_smooth_mesh_are_noticed() {
    let sheet = 6;
    let body = body(sheet);
    let mut random = Random::new(80);
    for segment in &body.segments {
        let [from, to] = segment.map(|vertex| body.vertices[vertex]);
        if from.xy().amax().max(to.xy().amax()) > 0.23 {
            continue; // at the border
        }
        let at = from + (to - from) * (0.5 + 0.4 * random.symmetric());
        let fall = (Vector3::z() + random.vector() * 0.2) * 0.05;
        let path = [1.0, -1.0].map(|sign| vec![at + fall * sign, at + fall * (3.0 * sign)]);
        let mut contact = system(sheet, ContactModel::ImplicitContact, &path[0]);
        contact.update_candidates(&path[0]);
        assert!(contact.passage(&path[0], &path[1]).is_some(), "{segment:?}");
    }
}

#[test]
fn candidates_follow_an_obstacle_that_moves() {
    let mut random = Random::new(90);
    for kind in 0..KINDS {
        let mut found = 0;
        for _ in 0..20 {
            let model = ContactModel::ImplicitContact;
            let Some(start) = at_reach(kind, model, &mut random) else {
                continue;
            };
            let pose = Pose {
                rotation: UnitQuaternion::from_scaled_axis(random.vector()),
                translation: random.vector(),
            };
            let carried: Vec<Vector3> = start.iter().map(|x| pose.of(x)).collect();
            let [mut still, mut moved] = [0, 1].map(|_| system(kind, model, &start));
            still.update_candidates(&start);
            assert!(moved.candidates_are_complete(&start) || moved.candidates().is_empty());
            moved.place_obstacle(0, pose);
            assert!(!moved.candidates_are_complete(&carried));
            moved.update_candidates(&carried);
            assert_eq!(still.candidates(), moved.candidates(), "{kind}");
            found += still.candidates().len();
            let [before, after] = [(&still, &start), (&moved, &carried)]
                .map(|(contact, positions)| contact.nearest(positions).unwrap());
            assert!((before.distance - after.distance).abs() < 1e-12);
        }
        assert!(found > 20, "{kind}: {found}");
    }
}

#[test]
fn a_smooth_ball_that_turns_carries_points_of_its_surface() {
    let ball = 5;
    let mut random = Random::new(100);
    let model = ContactModel::ImplicitContact;
    let mut tested = 0;
    for _ in 0..10 {
        let Some(positions) = at_reach(ball, model, &mut random) else {
            continue;
        };
        let mut contact = system(ball, model, &positions);
        let (time_step, turn) = (1e-2, random.vector() * 0.02);
        let pose = Pose {
            rotation: UnitQuaternion::from_scaled_axis(turn),
            translation: Vector3::zeros(),
        };
        contact.place_obstacle(0, pose);
        contact.update_candidates(&positions);
        contact.evaluate(&positions, &positions, time_step);
        for one in contact.contacts() {
            let pair = contact.candidates()[one.candidate];
            let points = contact.obstacles.points(&positions);
            let nearest = contact.nearest_in_step(&pair, &points, 0.0).unwrap();
            let pair = nearest.settled(&contact.surface, &pair);
            let motion = evaluation::Motion {
                positions: &positions,
                previous: &positions,
                time_step,
            };
            let velocities = contact.velocities(&pair, &points.of(pair.nodes), &nearest, &motion);
            let corners = velocities.iter().zip(nearest.weights());
            let found: Vector3 = -corners.map(|(v, weight)| v * weight).sum::<Vector3>();
            let foot = positions[pair.nodes[0]] - nearest.normal() * nearest.distance();
            let expected = (foot - pose.back_of(&foot)) / time_step;
            // Up to the accuracy of the normals of 128 triangles.
            let error = (found - expected).norm() / expected.norm();
            assert!(error < 2e-3, "{error:e}");
            tested += 1;
        }
    }
    assert!(tested > 3, "{tested}");
}

#[test]
fn rods_within_obstacles_are_named_with_their_depth() {
    for kind in CLOSED {
        let deep: Vec<Vector3> = (0..NODES)
            .map(|k| Vector3::new(1e-3 * k as f64, 0.0, -0.05))
            .collect();
        let contact = system(kind, ContactModel::ImplicitContact, &deep);
        let overlaps = contact.initial_overlaps(&deep);
        assert!(
            overlaps.iter().any(|overlap| overlap.penetration() > 1.0),
            "{kind}"
        );
        let far: Vec<Vector3> = deep.iter().map(|x| x + Vector3::z()).collect();
        let contact = system(kind, ContactModel::ImplicitContact, &far);
        assert!(contact.initial_overlaps(&far).is_empty(), "{kind}");
    }
}

#[test]
fn an_obstacle_rubs_with_a_friction_of_its_own() {
    for kind in 0..KINDS {
        let mut random = Random::new(110 + kind as u64);
        let model = ContactModel::ImplicitContact;
        let positions = (0..100)
            .find_map(|_| at_reach(kind, model, &mut random))
            .unwrap();
        let mut contact = system(kind, model, &positions);
        contact.update_candidates(&positions);
        // Two metres a second, along x and y.
        let slid = Vector3::new(1.6e-3, -1.2e-3, 0.0);
        let previous: Vec<Vector3> = positions.iter().map(|x| x - slid).collect();
        contact.evaluate(&positions, &previous, 1e-3);
        assert!(!contact.contacts().is_empty());
        for one in contact.contacts() {
            let force = one.force_on_first();
            let pressure = force.dot(&one.normal) / one.normal.norm_squared();
            let along = force - one.normal * pressure;
            let ratio = along.norm() / (pressure * one.normal.norm());
            assert!((ratio - 0.4).abs() < 1e-3, "{kind}: {ratio}");
            assert!(along.dot(&slid) < 0.0);
        }
    }
}
