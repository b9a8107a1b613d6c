//! Helpers of the derivative tests of contact: random contacts and vectors of dual numbers.

use super::closest_points::{ClosestPoints, FreeRatios};
use crate::mechanics::Vector3;
use crate::random::uniform_numbers;
use num_dual::DualNum;

/// Point–point, point–edge both ways, edge–edge.
pub(crate) const CLASSES: [FreeRatios; 4] =
    [[false, false], [true, false], [false, true], [true, true]];

/// A reproducible stream of random numbers.
pub(crate) struct Random(Box<dyn FnMut() -> f64>);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Box::new(uniform_numbers(seed)))
    }

    /// Uniform in [−1, 1).
    pub(crate) fn symmetric(&mut self) -> f64 {
        2.0 * (self.0)() - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vector3 {
        Vector3::new(self.symmetric(), self.symmetric(), self.symmetric())
    }
}

/// Twenty random pairs of edges a few radii long, nearly touching, that meet in the given class and stay
/// in it when they move a little.
pub(crate) fn edge_pairs_of_class(
    free: FreeRatios,
    radius: f64,
) -> Vec<([Vector3; 4], ClosestPoints)> {
    let mut random = Random::new(7);
    let mut pairs = Vec::new();
    while pairs.len() < 20 {
        let nodes = [(); 4].map(|()| random.vector() * 4.0 * radius);
        let closest = ClosestPoints::of(&nodes);
        let edges = [nodes[1] - nodes[0], nodes[3] - nodes[2]];
        let (lengths, separation) = (edges.map(|edge| edge.norm()), closest.separation);
        let sine = edges[0].cross(&edges[1]).norm() / (lengths[0] * lengths[1]);
        let is_settled = |k: usize| {
            if free[k] {
                (0.05..0.95).contains(&closest.ratios[k])
            } else {
                separation.dot(&edges[k]).abs() > 0.05 * separation.norm() * lengths[k]
            }
        };
        if closest.free == free
            && lengths.iter().all(|&length| length > radius)
            && (1.5 * radius..2.5 * radius).contains(&separation.norm())
            && sine > 0.2
            && is_settled(0)
            && is_settled(1)
        {
            pairs.push((nodes, closest));
        }
    }
    pairs
}

/// Largest deviation, relative to the largest expected number.
pub(crate) fn relative_error(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let deviation = found
        .iter()
        .zip(expected)
        .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    deviation / largest
}

/// Dual numbers over f64.
pub(crate) trait Dual: DualNum<Primitive = f64> + Copy {}
impl<D: DualNum<Primitive = f64> + Copy> Dual for D {}

/// A vector of dual numbers.
pub(crate) type DualVector<D> = [D; 3];

pub(crate) fn dual_node<D: Dual>(x: &[D], index: usize) -> DualVector<D> {
    std::array::from_fn(|axis| x[3 * index + axis])
}

pub(crate) fn add<D: Dual>(a: DualVector<D>, b: DualVector<D>) -> DualVector<D> {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

pub(crate) fn subtract<D: Dual>(a: DualVector<D>, b: DualVector<D>) -> DualVector<D> {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

pub(crate) fn scale<D: Dual>(a: DualVector<D>, factor: D) -> DualVector<D> {
    a.map(|component| component * factor)
}

pub(crate) fn dot<D: Dual>(a: DualVector<D>, b: DualVector<D>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm<D: Dual>(a: DualVector<D>) -> D {
    dot(a, a).sqrt()
}

pub(crate) fn unit<D: Dual>(a: DualVector<D>) -> DualVector<D> {
    scale(a, norm(a).recip())
}

pub(crate) fn cross<D: Dual>(a: DualVector<D>, b: DualVector<D>) -> DualVector<D> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Contact ratios as functions of the nodes, by the normal equations of the class.
pub(crate) fn dual_ratios<D: Dual>(x: &[D], closest: &ClosestPoints) -> [D; 2] {
    let e = subtract(dual_node(x, 1), dual_node(x, 0));
    let f = subtract(dual_node(x, 3), dual_node(x, 2));
    let offset = subtract(dual_node(x, 2), dual_node(x, 0));
    let held = closest.ratios.map(D::from);
    match closest.free {
        [false, false] => held,
        [true, false] => [dot(add(offset, scale(f, held[1])), e) / dot(e, e), held[1]],
        [false, true] => [
            held[0],
            dot(subtract(scale(e, held[0]), offset), f) / dot(f, f),
        ],
        [true, true] => {
            let determinant = dot(e, e) * dot(f, f) - dot(e, f) * dot(e, f);
            let (along_e, along_f) = (dot(offset, e), dot(offset, f));
            [
                (along_e * dot(f, f) - along_f * dot(e, f)) / determinant,
                (along_e * dot(e, f) - along_f * dot(e, e)) / determinant,
            ]
        }
    }
}
