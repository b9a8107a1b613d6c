//! The knot determinant: |Δ(−1)| with the Alexander polynomial Δ, 2n + 1 for the overhand knot of unknotting number n.
//!
//! The determinant follows from a projection. An arc runs from one passage below to the next, and
//! every crossing gives the equation 2 over − before − after = 0 of Fox's colourings. The
//! determinant is any cofactor of the matrix of these equations. The determinant is computed modulo
//! the prime 2⁶¹ − 1, which is exact if the determinant is smaller than half of the prime.

use super::closure::{closed_far_away, joined_far_away};
use super::projection::{Crossing, crossings, some_crossings};
use rodlab_engine::mechanics::Vector3;

const PRIME: i128 = (1 << 61) - 1;
/// Number of directions in which crossings are counted.
const VIEWS: usize = 100;

/// Determinant of the knot that results when the ends of an open curve are joined far away.
///
/// The joining path leaves the ends along the line through both, away from each other, and closes
/// outside the curve's extent: for a rod pulled at both ends this is the usual definition of its
/// knot. `None` if two segments cross in space, or if no direction of projection was found in which
/// all crossings are clear.
pub fn determinant(nodes: &[Vector3]) -> Option<u64> {
    determinant_of_closed(&closed_far_away(nodes)?)
}

/// Determinant of the knot of two rods that are closed to one curve: far away their starts are
/// joined, and their ends are joined. All four are pulled along the unit vector `axis`, two to
/// each side. `None` as for [`determinant`].
pub fn determinant_of_pair(rods: [&[Vector3]; 2], axis: &Vector3) -> Option<u64> {
    determinant_of_closed(&joined_far_away(rods, axis)?)
}

/// Determinant of a closed polygon, whose last node is joined to the first. `None` as for [`determinant`].
pub fn determinant_of_closed(nodes: &[Vector3]) -> Option<u64> {
    Some(cofactor(&some_crossings(nodes)?))
}

/// The smallest number of crossings of a closed polygon seen from many directions, an upper bound
/// for its knot. `None` if no direction was found in which all crossings are clear.
pub fn fewest_crossings(nodes: &[Vector3]) -> Option<usize> {
    // A lattice along a spiral over a hemisphere; seen from behind, crossings are the same.
    let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let direction = |k: usize| {
        let z = (k as f64 + 0.5) / VIEWS as f64;
        let (sine, cosine) = libm::sincos(golden_angle * k as f64);
        let across = (1.0 - z * z).sqrt();
        Vector3::new(across * cosine, across * sine, z)
    };
    (0..VIEWS)
        .filter_map(|k| Some(crossings(nodes, &direction(k))?.len()))
        .min()
}

/// |det| of the colouring matrix without its last row and column.
fn cofactor(crossings: &[Crossing]) -> u64 {
    let mut unders: Vec<f64> = crossings.iter().map(|crossing| crossing.under).collect();
    unders.sort_by(f64::total_cmp);
    let arcs = unders.len();
    // Arc k runs from passage k − 1 below to passage k; the last passage is followed by arc 0.
    let arc = |place: f64| unders.partition_point(|&under| under < place) % arcs.max(1);
    let size = arcs.saturating_sub(1);
    let mut matrix = vec![vec![0i128; arcs]; arcs];
    for (row, crossing) in matrix.iter_mut().zip(crossings) {
        let before = arc(crossing.under);
        row[arc(crossing.over)] += 2;
        row[before] -= 1;
        row[(before + 1) % arcs] -= 1;
    }
    determinant_modulo_prime(matrix, size)
}

fn determinant_modulo_prime(mut matrix: Vec<Vec<i128>>, size: usize) -> u64 {
    let mut determinant = 1i128;
    for column in 0..size {
        let Some(pivot) = (column..size).find(|&row| matrix[row][column].rem_euclid(PRIME) != 0)
        else {
            return 0;
        };
        if pivot != column {
            matrix.swap(pivot, column);
            determinant = -determinant;
        }
        let value = matrix[column][column].rem_euclid(PRIME);
        determinant = (determinant * value).rem_euclid(PRIME);
        let inverse = inverse(value);
        let pivot_row = matrix[column].clone();
        for row in &mut matrix[column + 1..size] {
            let factor = (row[column].rem_euclid(PRIME) * inverse).rem_euclid(PRIME);
            if factor != 0 {
                for k in column..size {
                    row[k] = (row[k] - factor * pivot_row[k].rem_euclid(PRIME)).rem_euclid(PRIME);
                }
            }
        }
    }
    let determinant = determinant.rem_euclid(PRIME);
    determinant.min(PRIME - determinant) as u64
}

/// Inverse modulo the prime, by Fermat's little theorem.
fn inverse(value: i128) -> i128 {
    let (mut base, mut exponent, mut result) = (value, PRIME - 2, 1i128);
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = result * base % PRIME;
        }
        base = base * base % PRIME;
        exponent >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn curve(points: usize, at: impl Fn(f64) -> Vector3) -> Vec<Vector3> {
        (0..points)
            .map(|k| at(k as f64 / (points - 1) as f64))
            .collect()
    }

    #[test]
    fn a_line_and_an_arc_are_unknots() {
        let line = curve(20, |t| Vector3::new(t, 0.0, 0.0));
        assert_eq!(determinant(&line), Some(1));
        let arc = curve(20, |t| Vector3::new((4.0 * t).cos(), (4.0 * t).sin(), t));
        assert_eq!(determinant(&arc), Some(1));
    }

    #[test]
    fn parallel_segments_do_not_cross() {
        // The tail of a pulled rod is parallel to the path that closes it.
        let mut hook = curve(20, |t| Vector3::new(t, 0.0, 0.0));
        hook.extend(curve(20, |t| Vector3::new(1.0 - t, 0.5, 0.0)));
        hook.extend(curve(20, |t| Vector3::new(2.0 * t, 1.0, 0.0)));
        assert_eq!(determinant(&hook), Some(1));
    }

    #[test]
    fn torus_knots_and_the_figure_eight_have_their_determinants() {
        let torus = |q: f64| {
            move |t: f64| {
                let angle = 0.01 + (TAU - 0.02) * t;
                let radius = 2.0 + (q * angle).cos();
                Vector3::new(
                    radius * (2.0 * angle).cos(),
                    radius * (2.0 * angle).sin(),
                    -(q * angle).sin(),
                )
            }
        };
        for q in [3, 5, 7, 9] {
            let closed = curve(400, torus(f64::from(q)));
            assert_eq!(cofactor(&crossings_of(&closed)), q as u64, "(2, {q})");
        }
        let figure_eight = curve(400, |t| {
            let angle = TAU * t * 0.999;
            let radius = 2.0 + (2.0 * angle).cos();
            Vector3::new(
                radius * (3.0 * angle).cos(),
                radius * (3.0 * angle).sin(),
                (4.0 * angle).sin(),
            )
        });
        assert_eq!(determinant_of_closed(&figure_eight), Some(5));
    }

    #[test]
    fn a_trefoil_seen_well_has_three_crossings_and_a_ring_none() {
        let trefoil = curve(200, |t| {
            let angle = 0.01 + (TAU - 0.02) * t;
            Vector3::new(
                angle.sin() + 2.0 * (2.0 * angle).sin(),
                angle.cos() - 2.0 * (2.0 * angle).cos(),
                -(3.0 * angle).sin(),
            )
        });
        assert_eq!(fewest_crossings(&trefoil), Some(3));
        let ring = curve(50, |t| {
            let angle = 6.0 * t;
            Vector3::new(angle.cos(), angle.sin(), 0.2 * (3.0 * angle).sin())
        });
        assert_eq!(fewest_crossings(&ring), Some(0));
    }

    /// Crossings of a curve closed by its last segment.
    fn crossings_of(closed: &[Vector3]) -> Vec<Crossing> {
        crossings(closed, &Vector3::new(0.123, 0.218, 0.968).normalize()).unwrap()
    }
}
