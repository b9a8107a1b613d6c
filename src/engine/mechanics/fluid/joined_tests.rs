//! Tests of the flow around filaments that meet.

use super::*;
use crate::mechanics::test_support::{assert_close_in, line};
use crate::mechanics::{Matrix3, Vector3};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

const VISCOSITY: f64 = 0.1;
const RADIUS: f64 = 1e-3;

fn model(far_field_error: f64) -> FluidModel {
    FluidModel::RegularizedStokeslets {
        viscosity: VISCOSITY,
        regularization: 1.02,
        far_field_error,
    }
}

/// Open filaments through the given nodes.
fn filaments(shapes: &[Vec<Vector3>]) -> (Vec<Filament>, Vec<Vector3>) {
    let mut first_node = 0;
    let filaments = shapes.iter().map(|nodes| {
        first_node += nodes.len();
        Filament {
            first_node: first_node - nodes.len(),
            nodes: nodes.len(),
            closed: false,
            radius: RADIUS,
        }
    });
    (filaments.collect(), shapes.concat())
}

/// A fluid around filaments; nodes at the same position are joined.
fn joined(model: &FluidModel, shapes: &[Vec<Vector3>]) -> (Fluid, Vec<Vector3>) {
    let (filaments, positions) = filaments(shapes);
    let mut connections = Connections::default();
    for a in 0..positions.len() {
        let before = (0..a).find(|b| positions[*b] == positions[a]);
        connections.joined.extend(before.map(|b| [a, b]));
    }
    let mut fluid = Fluid::new(model, &filaments).unwrap();
    fluid.connect(&connections, &positions);
    (fluid, positions)
}

fn drag(
    fluid: &mut Fluid,
    positions: &[Vector3],
    velocities: &[Vector3],
) -> (Vec<Vector3>, Vec<Matrix3>) {
    let mut forces = vec![Vector3::zeros(); positions.len()];
    let mut resistance = vec![Matrix3::zeros(); positions.len()];
    fluid
        .drag(positions, velocities, &[], &mut forces, &mut resistance)
        .unwrap();
    (forces, resistance)
}

/// Test motions: steady, rotating, and uneven.
fn motions(positions: &[Vector3]) -> [Vec<Vector3>; 3] {
    let rate = Vector3::new(3.0, -2.0, 5.0);
    [
        vec![Vector3::new(0.01, 0.02, -0.01); positions.len()],
        positions.iter().map(|x| rate.cross(x)).collect(),
        positions
            .iter()
            .map(|x| Vector3::new((40.0 * x.y).sin(), (30.0 * x.z).cos(), 50.0 * x.x) * 0.01)
            .collect(),
    ]
}

fn difference(got: &[Vector3], expected: &[Vector3]) -> f64 {
    let norm = |v: Vec<Vector3>| v.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
    let apart = got.iter().zip(expected).map(|(a, b)| a - b).collect();
    norm(apart) / norm(expected.to_vec())
}

/// A helix of 68 nodes about a centre.
fn helix(centre: Vector3) -> Vec<Vector3> {
    (0..68)
        .map(|i| {
            let z = 0.2 * f64::from(i) / 67.0;
            let angle = 2.0 * PI * z / 0.05;
            centre + Vector3::new(0.01 * angle.cos(), 0.01 * angle.sin(), z)
        })
        .collect()
}

/// Cuts a filament at a node, which both pieces then share.
fn cut(whole: &[Vector3], node: usize) -> [Vec<Vector3>; 2] {
    [whole[..=node].to_vec(), whole[node..].to_vec()]
}

/// Combines the forces on the nodes of the pieces into those on the nodes of the whole.
fn put_together(forces: &[Vector3], node: usize) -> Vec<Vector3> {
    let mut whole = forces[..=node].to_vec();
    whole[node] += forces[node + 1];
    whole.extend_from_slice(&forces[node + 2..]);
    whole
}

#[test]
fn two_pieces_have_the_drag_of_the_whole() {
    let whole = helix(Vector3::zeros());
    let (mut one, _) = joined(&model(0.0), std::slice::from_ref(&whole));
    let (mut two, positions) = joined(&model(0.0), &cut(&whole, 30));
    for (motion, in_pieces) in motions(&whole).iter().zip(&motions(&positions)) {
        let (expected, resistance) = drag(&mut one, &whole, motion);
        let (forces, of_pieces) = drag(&mut two, &positions, in_pieces);
        let error = difference(&put_together(&forces, 30), &expected);
        assert!(error < 1e-5, "{error:e}");
        let error = (of_pieces[30] + of_pieces[31] - resistance[30]).norm();
        assert!(error < 1e-6 * resistance[30].norm(), "{error:e}");
    }
}

#[test]
fn many_pieces_by_clusters_have_the_drag_of_the_wholes() {
    // 1,104 nodes, 16 of which coincide with others.
    let side = |k: usize| Vector3::new((k % 4) as f64, (k / 4) as f64, 0.0) * 0.03;
    let wholes: Vec<_> = (0..16).map(|k| helix(side(k))).collect();
    let pieces: Vec<_> = wholes.iter().flat_map(|whole| cut(whole, 33)).collect();
    let (mut exact, whole) = joined(&model(0.0), &wholes);
    let (mut clusters, positions) = joined(&model(1e-4), &pieces);
    for (motion, in_pieces) in motions(&whole).iter().zip(&motions(&positions)) {
        let (expected, _) = drag(&mut exact, &whole, motion);
        let (forces, _) = drag(&mut clusters, &positions, in_pieces);
        let together: Vec<Vector3> = forces
            .chunks_exact(69)
            .flat_map(|forces| put_together(forces, 33))
            .collect();
        let error = difference(&together, &expected);
        assert!(error < 2e-4, "{error:e}");
    }
}

/// The arms of a Y and a rod through its centre, all with a node there.
fn star() -> Vec<Vec<Vector3>> {
    let o = Vector3::zeros();
    let end = |x: f64, y: f64, z: f64| Vector3::new(x, y, z) * 0.02;
    vec![
        line(o, end(1.0, 0.0, 0.0), 8),
        line(end(-0.5, 0.9, 0.0), o, 7),
        line(end(-0.5, -0.9, 0.1), end(0.5, 0.9, -0.1), 10),
        line(o, end(0.1, 0.2, 1.0), 9),
    ]
}

#[test]
fn a_star_has_the_drag_of_a_dense_solution() {
    let shapes = star();
    let (mut fluid, positions) = joined(&model(0.0), &shapes);
    // The distinct points, and the point of each node.
    let mut points: Vec<Vector3> = Vec::new();
    let point_of: Vec<usize> = (positions.iter())
        .map(|x| {
            let known = points.iter().position(|point| point == x);
            known.unwrap_or_else(|| {
                points.push(*x);
                points.len() - 1
            })
        })
        .collect();
    assert_eq!(points.len(), positions.len() - 3);
    let mut matrix = DMatrix::zeros(3 * points.len(), 3 * points.len());
    let mut lengths = vec![0.0; positions.len()];
    let mut first = 0;
    for shape in &shapes {
        for edge in first..first + shape.len() - 1 {
            let [start, end] = [edge, edge + 1].map(|node| positions[node]);
            for node in [edge, edge + 1] {
                lengths[node] += 0.5 * (end - start).norm();
            }
            for (row, x) in points.iter().enumerate() {
                let integrals =
                    segment_integral_by_quadrature(x, &start, &end, 1.02 * RADIUS, 1e-11);
                for (node, a) in [edge, edge + 1].into_iter().zip(&integrals) {
                    let place = (3 * row, 3 * point_of[node]);
                    let mut block = matrix.fixed_view_mut::<3, 3>(place.0, place.1);
                    block += a;
                }
            }
        }
        first += shape.len();
    }
    let inverse = matrix.try_inverse().unwrap();
    for motion in motions(&positions) {
        let mut velocities = DVector::zeros(3 * points.len());
        for (point, u) in point_of.iter().zip(&motion) {
            velocities.fixed_rows_mut::<3>(3 * point).copy_from(u);
        }
        let densities = &inverse * velocities * (8.0 * PI * VISCOSITY);
        let expected: Vec<Vector3> = (point_of.iter().zip(&lengths))
            .map(|(point, length)| -densities.fixed_rows::<3>(3 * point) * *length)
            .collect();
        let (forces, _) = drag(&mut fluid, &positions, &motion);
        let error = difference(&forces, &expected);
        assert!(error < 1e-4, "{error:e}");
    }
}

#[test]
fn nodes_at_one_place_without_a_joint_resist_that_they_part() {
    // Two rods that begin at one place; one of them moves away. The tie holds for a while and then
    // releases.
    let shapes = [
        line(Vector3::zeros(), Vector3::x() * 0.02, 8),
        line(Vector3::zeros(), Vector3::y() * 0.02, 8),
    ];
    let (filaments, mut positions) = filaments(&shapes);
    let mut fluid = Fluid::new(&model(0.0), &filaments).unwrap();
    fluid.connect(&Connections::default(), &positions);
    assert_eq!(fluid.met_by_chance(), [[0, 9]]);
    let mut velocities = vec![Vector3::zeros(); 18];
    velocities[9..].fill(Vector3::y());
    let mut last = None;
    for _ in 0..100 {
        let (forces, _) = drag(&mut fluid, &positions, &velocities);
        let power: f64 = forces.iter().zip(&velocities).map(|(f, v)| f.dot(v)).sum();
        assert!(power < 0.0);
        // When the tie releases, at the distance ε, the power grows by a quarter; if it released
        // at ε/5 it would grow fourfold.
        let change = last.map_or(0.0, |last: f64| (power / last - 1.0).abs());
        assert!(change < 0.3, "{change}");
        last = Some(power);
        for x in &mut positions[9..] {
            x.y += 2e-5;
        }
    }
}

/// A wire along x, and a tail that slides along it, from a given place.
fn tail_on_a_wire(x: f64) -> (Vec<Filament>, Vec<Vector3>, Connections) {
    let foot = Vector3::x() * x;
    let (filaments, positions) = filaments(&[
        line(Vector3::zeros(), Vector3::x() * 0.04, 20),
        line(foot, foot + Vector3::z() * 0.01, 5),
    ]);
    let sliding = Sliding {
        node: 21,
        rail: 0..21,
        closed: false,
    };
    let connections = Connections {
        joined: Vec::new(),
        sliding: vec![sliding],
    };
    (filaments, positions, connections)
}

#[test]
fn a_node_that_slides_passes_the_nodes_of_its_rail_smoothly() {
    let (filaments, placed, connections) = tail_on_a_wire(0.016);
    let mut fluid = Fluid::new(&model(0.0), &filaments).unwrap();
    fluid.connect(&connections, &placed);
    // The tail slides over two edges of the wire.
    let mut drags = Vec::new();
    for k in 0..=40 {
        let (_, positions, _) = tail_on_a_wire(0.016 + 1e-4 * f64::from(k));
        let mut velocities = vec![Vector3::zeros(); positions.len()];
        velocities[21..].fill(Vector3::x() * 0.01);
        let (forces, _) = drag(&mut fluid, &positions, &velocities);
        drags.push(-forces[21..].iter().map(|f| f.x).sum::<f64>());
    }
    // Drag of an isolated cylinder across the flow: 4πηLU/(ln(2L/r) − 1/2).
    let alone = 4.0 * PI * VISCOSITY * 0.01 * 0.01 / (20f64.ln() - 0.5);
    let [least, most] = [f64::min, f64::max].map(|f| drags.iter().copied().reduce(f).unwrap());
    assert!(least > alone, "{least:e} {alone:e}");
    assert!(most < 2.0 * alone, "{most:e} {alone:e}");
    assert!(most / least < 1.1, "{least:e} {most:e}");
    for pair in drags.windows(2) {
        assert!((pair[1] / pair[0] - 1.0).abs() < 0.03, "{pair:?}");
    }
}

#[test]
fn a_tail_on_its_rail_drags_like_one_that_touches_it() {
    let drag_of = |lifted: f64, slides: bool| {
        let (filaments, mut positions, connections) = tail_on_a_wire(0.0193);
        positions[21..].iter_mut().for_each(|x| x.z += lifted);
        let mut fluid = Fluid::new(&model(0.0), &filaments).unwrap();
        if slides {
            fluid.connect(&connections, &positions);
        }
        let mut velocities = vec![Vector3::zeros(); positions.len()];
        velocities[21..].fill(Vector3::x() * 0.01);
        let (forces, _) = drag(&mut fluid, &positions, &velocities);
        -forces[21..].iter().map(|f| f.x).sum::<f64>()
    };
    let on_it = drag_of(0.0, true);
    let [touching, above] = [2.0, 3.0].map(|radii| drag_of(radii * RADIUS, false));
    assert_close_in(above, on_it, touching, 0.3);
}

#[test]
fn a_node_at_rest_on_a_moving_rail_moves_with_it() {
    // Everything moves as one, so replacing the sliding node by a node of the wire makes little
    // difference.
    let (filaments, positions, connections) = tail_on_a_wire(0.02);
    let mut slides = Fluid::new(&model(0.0), &filaments).unwrap();
    slides.connect(&connections, &positions);
    let mut welded = Fluid::new(&model(0.0), &filaments).unwrap();
    let weld = Connections {
        joined: vec![[21, 10]],
        sliding: Vec::new(),
    };
    welded.connect(&weld, &positions);
    for motion in &motions(&positions)[..2] {
        let (expected, _) = drag(&mut welded, &positions, motion);
        let (forces, _) = drag(&mut slides, &positions, motion);
        let error = difference(&forces, &expected);
        assert!(error < 1e-5, "{error:e}");
    }
}

#[test]
fn restored_memory_of_ties_and_slides_continues_with_the_same_bytes() {
    let (filaments, placed, mut connections) = tail_on_a_wire(0.0151);
    connections.joined.push([0, 1]);
    let fluid = || {
        let mut fluid = Fluid::new(&model(0.0), &filaments).unwrap();
        // Two nodes of the wire begin at one place and separate later.
        let mut placed = placed.clone();
        placed[1] = placed[0];
        fluid.connect(&connections, &placed);
        fluid
    };
    let scene = |step: usize| {
        let (_, mut positions, _) = tail_on_a_wire(0.0151 + 2e-4 * step as f64);
        positions[1].x = 1e-4 + 1e-4 * step as f64;
        let motion = motions(&positions)[1].clone();
        (positions, motion)
    };
    let mut whole = fluid();
    for step in 0..4 {
        let (positions, velocities) = scene(step);
        drag(&mut whole, &positions, &velocities);
    }
    let mut restored = fluid();
    restored.restore(whole.memory()).unwrap();
    for step in 4..16 {
        let (positions, velocities) = scene(step);
        let expected = drag(&mut whole, &positions, &velocities);
        assert_eq!(
            expected,
            drag(&mut restored, &positions, &velocities),
            "{step}"
        );
    }
    assert_eq!(whole.memory(), restored.memory());
    // A fluid without these ties cannot restore their memory.
    let mut other = Fluid::new(&model(0.0), &filaments).unwrap();
    assert_eq!(
        other.restore(whole.memory()),
        Err(FluidError::ForeignMemory)
    );
}

#[test]
fn pieces_have_the_resistive_drag_of_the_whole() {
    let resistive = FluidModel::Resistive {
        viscosity: VISCOSITY,
    };
    let whole = line(Vector3::zeros(), Vector3::x() * 0.05, 20);
    let (mut one, _) = joined(&resistive, std::slice::from_ref(&whole));
    let (mut two, positions) = joined(&resistive, &cut(&whole, 12));
    for (motion, in_pieces) in motions(&whole).iter().zip(&motions(&positions)) {
        let (expected, _) = drag(&mut one, &whole, motion);
        let (forces, _) = drag(&mut two, &positions, in_pieces);
        let error = difference(&put_together(&forces, 12), &expected);
        assert!(error < 1e-14, "{error:e}");
    }
}
