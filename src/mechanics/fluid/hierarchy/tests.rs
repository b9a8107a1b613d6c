//! Tests of the hierarchical operator against the exact one.

use super::super::{Filament, FlowOperator};
use super::*;
use crate::mechanics::Vector3;
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

#[test]
fn measure() {
    for (count, side) in [(100, 0.03)] {
        let (filaments, positions) = helices(count, side);
        let f = densities(positions.len());
        let mut exact = FlowOperator::new(&filaments, 1.02);
        let t = std::time::Instant::now();
        exact.assemble(&positions);
        let t_ea = t.elapsed();
        let mut expected = vec![0.0; f.len()];
        let t = std::time::Instant::now();
        exact.multiply(&f, &mut expected);
        eprintln!("{count} {side} exact {t_ea:?} {:?}", t.elapsed());
        for order in [6] {
            let mut fast = HierarchicalOperator::new(&filaments, 1.02, order);
            fast.assemble(&positions);
            let t = std::time::Instant::now();
            fast.assemble(&positions);
            let ta = t.elapsed();
            let mut got = vec![0.0; f.len()];
            let t = std::time::Instant::now();
            for _ in 0..300 {
                fast.multiply(&f, &mut got);
            }
            let t = t.elapsed() / 300;
            eprintln!(
                "{order} {:.2e} {ta:?} {t:?}",
                relative_error(&got, &expected)
            );
        }
    }
}
