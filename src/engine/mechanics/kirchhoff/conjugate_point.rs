//! First loss of stability of a helical rod with clamped ends, by conjugate points.

use super::helix::{Helix, StateMatrix};
use super::numerics::{bisect, find_zero};
use super::straight_rod::stability_determinant;
use nalgebra::{Matrix6, SMatrix};
use std::convert::Infallible;

/// Step of the search along the rod, as an angle: ‖(κ, τ, ω)‖ times arc length.
const STEP: f64 = 0.05;
/// End of the search for a conjugate point: a rod stable up to here is called unbounded. In fact
/// only the pulled straight rod (0, 1, 2) is; around it the boundary recedes without limit.
const FARTHEST: f64 = 100.0;
/// Curvature below which a direction counts as straight: the critical distance is even in κ, so
/// that the error is of the order of its square.
const STRAIGHT: f64 = 1e-5;
/// Two zeros of the determinant closer than this fraction of a step, squared, cannot be
/// distinguished from one double zero in round-off.
const DOUBLE_ZERO: f64 = 1e-10;

/// Point at which a direction of the (κ, τ, ω) space first loses stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalDistance {
    /// ‖(κ, τ, ω)‖ for a rod of unit length.
    pub distance: f64,
    /// Estimate of its absolute error.
    pub error_estimate: f64,
}

/// Relative width of the interval in which a zero of the determinant is found.
const ROUND_OFF: f64 = 1e-13;

/// Columns of the propagator that start with moment and force: solutions with θ(0) = ρ(0) = 0.
type Solutions = SMatrix<f64, 12, 6>;

/// Distance at which the helical rod of unit length along the direction of `helix` loses
/// stability; `None` if it stays stable up to a distance of 100.
///
/// A helix with clamped ends is stable if and only if no conjugate point lies in (0, L] (Borum &
/// Bretl 2020). At a conjugate point s a solution of the linearised equations that is not
/// identically zero has θ = ρ = 0 at 0 and at s. This means det J(s) = 0, with J(s) the 6×6 block
/// of exp(A s) that takes (μ, ν) at 0 to (θ, ρ) at s. The rod of length 1 at distance S is, scaled,
/// the rod of length S at distance 1: the first conjugate point of the unit direction is the
/// critical distance.
pub fn critical_distance(helix: &Helix) -> Option<CriticalDistance> {
    let direction = helix.scaled(1.0 / helix.distance());
    if direction.curvature.abs() < STRAIGHT {
        return straight_rod(&direction);
    }
    let first = first_zero(&direction, STEP)?;
    // A second search with another grid and other round-off estimates the error.
    let again = first_zero(&direction, 0.83 * STEP)?;
    Some(CriticalDistance {
        distance: first.distance,
        error_estimate: first.error_estimate + (first.distance - again.distance).abs(),
    })
}

fn straight_rod(direction: &Helix) -> Option<CriticalDistance> {
    let determinant =
        |length| stability_determinant(direction.torsion, direction.twisting_moment, length);
    let steps = (FARTHEST / STEP) as usize;
    let sign = determinant(STEP).signum();
    let after = (2..=steps).find(|step| determinant(*step as f64 * STEP) * sign <= 0.0)?;
    let end = after as f64 * STEP;
    Some(CriticalDistance {
        distance: bisect(end - STEP, end, determinant),
        error_estimate: direction.curvature.powi(2) + 1e-14 * end,
    })
}

fn first_zero(direction: &Helix, step: f64) -> Option<CriticalDistance> {
    let equations = direction.linearised_equations();
    let propagator = exponential(&(equations * step));
    let mut starts = Solutions::zeros();
    starts.fixed_view_mut::<6, 6>(6, 0).fill_with_identity();
    // Solutions and determinants at the last two steps.
    let mut before = Point::new(step, propagator * starts);
    let mut previous = Point::new(2.0 * step, propagator * before.solutions);
    for index in 3..=(FARTHEST / step) as usize {
        let next = Point::new(index as f64 * step, propagator * previous.solutions);
        let between = |from: &Point, to: &Point| {
            let ends = [from, to].map(|point| (point.at, point.determinant));
            let zero = find_zero(ends, ROUND_OFF, |_, at| {
                Ok::<_, Infallible>((at, from.moved(&equations, at - from.at).determinant))
            });
            zero.ok().map(|distance| CriticalDistance {
                distance,
                error_estimate: ROUND_OFF * distance,
            })
        };
        if next.determinant * previous.determinant <= 0.0 {
            return between(&previous, &next);
        }
        let dips = previous.determinant.abs() < before.determinant.abs()
            && previous.determinant.abs() < next.determinant.abs();
        if dips {
            let least = before.least_determinant_before(&equations, next.at);
            if least.determinant * before.determinant < 0.0 {
                return between(&before, &least);
            }
            let depth = (least.determinant / before.determinant).abs();
            if depth < DOUBLE_ZERO {
                return Some(CriticalDistance {
                    distance: least.at,
                    error_estimate: step * depth.max(f64::EPSILON).sqrt(),
                });
            }
        }
        (before, previous) = (previous, next);
    }
    None
}

/// The solutions at an arc length.
#[derive(Clone, Copy)]
struct Point {
    at: f64,
    solutions: Solutions,
    determinant: f64,
}

impl Point {
    /// The determinant of θ/s and ρ/s² for μ and s ν of unit size; this scaling keeps it bounded.
    fn new(at: f64, solutions: Solutions) -> Self {
        let mut block: Matrix6<f64> = solutions.fixed_view::<6, 6>(0, 0).into_owned();
        let inverse = 1.0 / at;
        for mut row in block.row_iter_mut().take(3) {
            row *= inverse;
        }
        for mut row in block.row_iter_mut().skip(3) {
            row *= inverse * inverse;
        }
        for mut column in block.column_iter_mut().skip(3) {
            column *= inverse;
        }
        Self {
            at,
            solutions,
            determinant: block.determinant(),
        }
    }

    fn moved(&self, equations: &StateMatrix, by: f64) -> Self {
        Self::new(
            self.at + by,
            exponential(&(equations * by)) * self.solutions,
        )
    }

    /// The point between here and `end` with the least determinant, multiplied by its sign here:
    /// golden-section search.
    fn least_determinant_before(&self, equations: &StateMatrix, end: f64) -> Self {
        let sign = self.determinant.signum();
        let at = |s: f64| self.moved(equations, s - self.at);
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (self.at, end);
        let mut left = at(high - golden * (high - low));
        let mut right = at(low + golden * (high - low));
        while high - low > 1e-9 * end {
            if sign * left.determinant < 0.0 {
                return left;
            }
            if sign * left.determinant < sign * right.determinant {
                high = right.at;
                right = left;
                left = at(high - golden * (high - low));
            } else {
                low = left.at;
                left = right;
                right = at(low + golden * (high - low));
            }
        }
        if sign * left.determinant < sign * right.determinant {
            left
        } else {
            right
        }
    }
}

/// The exponential of a matrix with a norm far below 1, by its series to round-off.
fn exponential(matrix: &StateMatrix) -> StateMatrix {
    let mut power = StateMatrix::identity();
    let mut sum = power;
    for order in 1..=12 {
        power = power * matrix / f64::from(order);
        sum += power;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::test_support::{assert_close, reference_rows};
    use std::f64::consts::TAU;

    fn critical(curvature: f64, torsion: f64, twisting_moment: f64) -> Option<f64> {
        let helix = Helix {
            curvature,
            torsion,
            twisting_moment,
        };
        critical_distance(&helix).map(|critical| critical.distance)
    }

    #[test]
    fn classical_values() {
        // The planar ring, Euler's column with clamped ends and Greenhill's twisted rod.
        for (direction, expected) in [
            ([1.0, 0.0, 0.0], TAU),
            ([0.0, 1.0, 0.0], TAU),
            ([0.0, 0.0, 1.0], 8.986_818_915_818_13),
        ] {
            let [curvature, torsion, moment] = direction;
            let found = critical(curvature, torsion, moment).unwrap();
            assert!((found - expected).abs() < 1e-9, "{direction:?}: {found}");
        }
        assert_eq!(critical(0.0, 1.0, 2.0), None);
    }

    #[test]
    fn the_limit_of_the_straight_rod_is_reached_evenly() {
        for (torsion, moment) in [(0.3, 1.0), (-0.6, 0.8), (1.0, 0.2)] {
            let straight = critical(0.0, torsion, moment).unwrap();
            for curvature in [1e-1, 1e-2, 1e-3, 1e-4, 2e-5] {
                let helical = critical(curvature, torsion, moment).unwrap();
                let bound = 5.0 * curvature * curvature + 2e-5 * curvature;
                assert!(
                    (helical - straight).abs() < bound * straight + 1e-6,
                    "κ = {curvature}: {helical} {straight}"
                );
            }
        }
    }

    #[test]
    fn a_mirror_image_is_as_stable() {
        for (curvature, torsion, moment) in [(1.0, 1.0, 1.0), (0.2, -0.9, 0.3), (0.7, 0.1, -0.7)] {
            let [one, other] =
                [1.0, -1.0].map(|sign| critical(curvature, sign * torsion, sign * moment).unwrap());
            assert!((one - other).abs() < 1e-9);
        }
    }

    #[test]
    fn the_boundary_agrees_with_the_reference() {
        let Some(rows) = reference_rows("helix/boundary_directions.csv") else {
            return;
        };
        let mut count = 0;
        for row in rows {
            let found = critical(row[0], row[1], row[2]);
            // The reference found no conjugate point; there is one, far away.
            if row[3].is_nan() {
                assert!(found.is_none_or(|distance| distance > 40.0), "{row:?}");
            } else {
                assert_close(found.unwrap(), row[3], 1e-8);
                count += 1;
            }
        }
        assert!(count > 200);
    }
}
