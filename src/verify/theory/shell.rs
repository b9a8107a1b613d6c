//! Drag of a sphere with a tail, with no-slip points on the surface of the sphere and a dense
//! solution.

use super::stokeslet::{adaptive_segment_integral, regularized_stokeslet};
use nalgebra::{DMatrix, DVector, Vector3};
use std::f64::consts::PI;

/// Number of points on the sphere. Between 200 and 800 points the drag with a tail changes by less
/// than 10⁻³.
const POINTS: usize = 400;
/// Regularisation of the points relative to their distance.
const REGULARIZATION: f64 = 0.5;

/// Drag per velocity (N s/m) of a sphere and a straight tail that move together along the tail.
/// The sphere has the given `radius` and is centred at the first of the `nodes`; nodes inside it
/// carry no force. The size of the shell is chosen so that it has Stokes' drag without a tail.
pub fn drag_of_sphere_with_tail(
    radius: f64,
    nodes: &[Vector3<f64>],
    regularization: f64,
    viscosity: f64,
) -> f64 {
    let alone = drag(radius, nodes[0], &[], regularization);
    let wanted = 0.75 * radius;
    let factor = 8.0 * PI * viscosity;
    factor * drag(radius * wanted / alone, nodes[0], nodes, regularization)
}

/// This drag divided by 8πη, for a shell with a given radius.
fn drag(shell: f64, centre: Vector3<f64>, nodes: &[Vector3<f64>], regularization: f64) -> f64 {
    let points: Vec<Vector3<f64>> = (0..POINTS)
        .map(|k| {
            let height = 1.0 - (2.0 * k as f64 + 1.0) / POINTS as f64;
            let (sin, cos) = libm::sincos(PI * (3.0 - 5f64.sqrt()) * k as f64);
            let across = (1.0 - height * height).sqrt();
            centre + Vector3::new(across * cos, across * sin, height) * shell
        })
        .collect();
    let blob = REGULARIZATION * shell * (4.0 * PI / POINTS as f64).sqrt();
    let wet: Vec<usize> = (0..nodes.len())
        .filter(|&k| (nodes[k] - centre).norm() > shell)
        .collect();
    let places: Vec<Vector3<f64>> = points
        .iter()
        .copied()
        .chain(wet.iter().map(|&k| nodes[k]))
        .collect();
    let count = places.len();
    let column_of = |node: usize| wet.iter().position(|&k| k == node).map(|k| POINTS + k);
    let mut matrix = DMatrix::zeros(3 * count, 3 * count);
    let mut lengths = vec![1.0; POINTS];
    lengths.resize(count, 0.0);
    for (i, x) in places.iter().enumerate() {
        for (j, y) in points.iter().enumerate() {
            let mut block = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * j);
            block += regularized_stokeslet(&(x - y), blob);
        }
        for k in 1..nodes.len() {
            let (start, end) = (&nodes[k - 1], &nodes[k]);
            let integrals = adaptive_segment_integral(x, start, end, regularization);
            for (node, integral) in [k - 1, k].into_iter().zip(integrals) {
                if let Some(column) = column_of(node) {
                    let mut block = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * column);
                    block += integral;
                    if i == 0 {
                        lengths[column] += 0.5 * (end - start).norm();
                    }
                }
            }
        }
    }
    let along = Vector3::z();
    let right_hand_side = DVector::from_fn(3 * count, |row, _| along[row % 3]);
    let densities = matrix
        .lu()
        .solve(&right_hand_side)
        .expect("the Stokeslet matrix is regular");
    (lengths.iter().enumerate())
        .map(|(i, length)| densities[3 * i + 2] * length)
        .sum()
}
