//! Tests of the hierarchical operator against the exact one.

use super::super::{Filament, FlowOperator};
use super::interactions::Interactions;
use super::tree::Tree;
use super::*;
use crate::linalg::instruction_set::InstructionSet;
use crate::mechanics::Vector3;
use crate::mechanics::fluid::chain::links;
use std::f64::consts::PI;

const NODES: usize = 68;

fn helices(count: usize, side: f64) -> (Vec<Filament>, Vec<Vector3>) {
    let polygon = 0.5 * side / (PI / count as f64).sin();
    let mut filaments = Vec::new();
    let mut positions = Vec::new();
    for k in 0..count {
        filaments.push(Filament {
            first_node: k * NODES,
            nodes: NODES,
            closed: false,
            radius: 1e-3,
        });
        let place = 2.0 * PI * k as f64 / count as f64;
        let axis = Vector3::new(place.cos(), place.sin(), 0.0) * polygon;
        for i in 0..NODES {
            let height = i as f64 / (NODES - 1) as f64;
            let angle = 8.0 * PI * height;
            let spoke = Vector3::new(angle.cos(), angle.sin(), 0.0) * 0.01;
            positions.push(axis + spoke + Vector3::z() * (0.2 * height));
        }
    }
    (filaments, positions)
}

fn densities(nodes: usize) -> Vec<f64> {
    (0..3 * nodes)
        .map(|i| 1.0 + (0.7 * i as f64).sin())
        .collect()
}

fn relative_error(got: &[f64], expected: &[f64]) -> f64 {
    let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut got.iter().zip(expected).map(|(a, b)| a - b)) / norm(&mut expected.iter().copied())
}

fn product(operator: &mut HierarchicalOperator, positions: &[Vector3]) -> Vec<f64> {
    let mut velocities = vec![0.0; 3 * positions.len()];
    operator.assemble(positions);
    operator.multiply(&densities(positions.len()), &mut velocities);
    velocities
}

fn exact_product(filaments: &[Filament], positions: &[Vector3]) -> Vec<f64> {
    let mut velocities = vec![0.0; 3 * positions.len()];
    let mut operator = FlowOperator::new(filaments, 1.02);
    operator.assemble(positions);
    operator.multiply(&densities(positions.len()), &mut velocities);
    velocities
}

#[test]
fn errors_fall_with_the_order() {
    for side in [0.03, 0.003] {
        let (filaments, positions) = helices(20, side);
        let expected = exact_product(&filaments, &positions);
        for (order, bound) in [(4, 5e-4), (6, 5e-5), (8, 6e-6), (10, 8e-7), (12, 2e-7)] {
            let mut operator = HierarchicalOperator::new(&filaments, 1.02, order);
            let error = relative_error(&product(&mut operator, &positions), &expected);
            assert!(error < bound, "side {side}, order {order}: {error:e}");
        }
    }
}

/// Rings and open rods of different radii, in any order.
fn mixture() -> (Vec<Filament>, Vec<Vector3>) {
    let (mut filaments, mut positions) = helices(8, 0.05);
    for (k, filament) in filaments.iter_mut().enumerate() {
        filament.radius = 4e-4 * (k + 1) as f64;
        filament.closed = k % 3 == 0;
        if filament.closed {
            for (i, x) in positions[filament.range()].iter_mut().enumerate() {
                let angle = 2.0 * PI * i as f64 / NODES as f64;
                *x = Vector3::new(0.05 * angle.cos(), 0.05 * angle.sin(), 0.03 * k as f64);
            }
        }
    }
    (filaments, positions)
}

#[test]
fn rings_and_rods_of_different_radii_keep_their_error() {
    let (filaments, positions) = mixture();
    let expected = exact_product(&filaments, &positions);
    let mut operator = HierarchicalOperator::new(&filaments, 1.02, 10);
    let error = relative_error(&product(&mut operator, &positions), &expected);
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn every_pair_of_nodes_is_in_one_pair_of_clusters() {
    let (filaments, positions) = mixture();
    let mut tree = Tree::default();
    tree.build(&links(&filaments, 1.02), &positions);
    let mut interactions = Interactions::default();
    interactions.find(&tree);
    let nodes = |cluster: usize| &tree.order[tree.clusters[cluster].nodes.clone()];
    let mut met = vec![0; positions.len() * positions.len()];
    for lists in [&interactions.far, &interactions.near] {
        assert!(lists.iter().any(|sources| !sources.is_empty()));
        for (target, sources) in lists.iter().enumerate() {
            for &source in sources {
                for &i in nodes(target) {
                    for &j in nodes(source) {
                        met[i * positions.len() + j] += 1;
                    }
                }
            }
        }
    }
    assert!(met.iter().all(|&times| times == 1));
}

#[test]
fn near_clusters_alone_are_exact() {
    // So few nodes that no two clusters are far from each other.
    let (filaments, positions) = helices(3, 0.002);
    let positions: Vec<_> = positions
        .iter()
        .map(|x| Vector3::new(x.x, x.y, 0.1 * x.z))
        .collect();
    let expected = exact_product(&filaments, &positions);
    let mut operator = HierarchicalOperator::new(&filaments, 1.02, 2);
    let error = relative_error(&product(&mut operator, &positions), &expected);
    assert!(error < 1e-14, "{error:e}");
}

#[test]
fn diagonal_blocks_are_exact() {
    let (filaments, positions) = mixture();
    let mut exact = FlowOperator::new(&filaments, 1.02);
    exact.assemble(&positions);
    let mut operator = HierarchicalOperator::new(&filaments, 1.02, 4);
    operator.assemble(&positions);
    for node in 0..positions.len() {
        let block = operator.block(node, node).unwrap();
        let expected = exact.block(node, node);
        let rounding = f64::from(f32::EPSILON);
        assert!(
            (block - expected).norm() < rounding * expected.norm(),
            "{node}"
        );
    }
}

#[test]
fn three_products_are_three_times_one() {
    let (filaments, positions) = mixture();
    let mut operator = HierarchicalOperator::new(&filaments, 1.02, 4);
    operator.assemble(&positions);
    let size = 3 * positions.len();
    let vectors: [Vec<f64>; 3] = std::array::from_fn(|k| {
        (0..size)
            .map(|i| ((k + 2) as f64 * i as f64).sin())
            .collect()
    });
    let mut together = [(); 3].map(|()| vec![0.0; size]);
    operator.multiply_three(&vectors, &mut together);
    for (vector, product) in vectors.iter().zip(&together) {
        let mut alone = vec![0.0; size];
        operator.multiply(vector, &mut alone);
        assert_eq!(&alone, product);
    }
}

#[test]
fn all_instruction_sets_and_thread_counts_give_the_same_bytes() {
    let (filaments, positions) = helices(10, 0.01);
    let mut results = Vec::new();
    for set in InstructionSet::available() {
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let mut operator = HierarchicalOperator::with_instruction_set(&filaments, 1.02, 5, set);
            let pool = pool.build().unwrap();
            results.push(pool.install(|| product(&mut operator, &positions)));
        }
    }
    for result in &results[1..] {
        assert_eq!(&results[0], result);
    }
}

#[test]
fn a_product_depends_only_on_the_positions() {
    let (filaments, positions) = helices(10, 0.03);
    let (_, elsewhere) = helices(10, 0.004);
    let mut operator = HierarchicalOperator::new(&filaments, 1.02, 5);
    let first = product(&mut operator, &positions);
    product(&mut operator, &elsewhere);
    assert_eq!(first, product(&mut operator, &positions));
}
