//! Curves in the plane and their arc length.

use super::{PatternError, Point};
use rodlab_engine::mechanics::kirchhoff::numerics::gauss_legendre;
use serde::{Deserialize, Serialize};

/// Number of Gauss points on each piece of a curve.
const QUADRATURE: usize = 5;
/// Maximum number of Newton iterations for the parameter at an arc length.
const ITERATIONS: usize = 20;
/// Step of the finite differences of the curvature, as a fraction of a piece.
const DIFFERENCE: f64 = 0.02;

/// A smooth curve with a parameter u.
pub trait PlaneCurve: Send + Sync {
    /// End of the parameter, which starts at 0.
    fn end(&self) -> f64;
    /// Number of pieces; on each the curve is nearly a polynomial.
    fn pieces(&self) -> usize;
    /// Position and its first two derivatives.
    fn at(&self, u: f64) -> [Point; 3];
}

/// A point of a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternPoint {
    /// Arc length, m.
    pub s: f64,
    /// Place, m.
    pub position: Point,
    /// Direction of the tangent, counter-clockwise from x, rad.
    pub angle: f64,
    /// Curvature κ, positive to the left, 1/m.
    pub curvature: f64,
    /// κ' = dκ/ds, 1/m².
    pub curvature_slope: f64,
    /// κ'' = d²κ/ds², 1/m³.
    pub curvature_bend: f64,
}

/// Arc length at the ends of a curve's pieces.
#[derive(Clone, Debug)]
pub struct ArcLength {
    sums: Vec<f64>,
    rule: Vec<(f64, f64)>,
}

impl ArcLength {
    pub fn of(curve: &dyn PlaneCurve) -> Result<Self, PatternError> {
        let rule = gauss_legendre(QUADRATURE);
        let pieces = curve.pieces();
        let width = curve.end() / pieces as f64;
        let mut sums = Vec::with_capacity(pieces + 1);
        sums.push(0.0);
        let mut sum = 0.0;
        for piece in 0..pieces {
            let start = piece as f64 * width;
            let length = between(curve, &rule, start, start + width);
            if !(length > 1e-9 * width && length.is_finite()) {
                return Err(PatternError::Degenerate(
                    "the derivative of the curve is zero somewhere, or the curve has no length",
                ));
            }
            sum += length;
            sums.push(sum);
        }
        Ok(Self { sums, rule })
    }

    pub fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// The point at an arc length.
    pub fn at(&self, curve: &dyn PlaneCurve, s: f64) -> PatternPoint {
        let pieces = self.sums.len() - 1;
        let width = curve.end() / pieces as f64;
        let piece = self.sums.partition_point(|sum| *sum <= s);
        let piece = piece.saturating_sub(1).min(pieces - 1);
        let (start, known) = (piece as f64 * width, self.sums[piece]);
        let mut u = start + width * (s - known) / (self.sums[piece + 1] - known);
        for _ in 0..ITERATIONS {
            let speed = curve.at(u)[1].norm();
            let change = (s - known - between(curve, &self.rule, start, u)) / speed;
            u = (u + change).clamp(0.0, curve.end());
            if change.abs() < 1e-13 * curve.end() {
                break;
            }
        }
        let [position, velocity, acceleration] = curve.at(u);
        let speed = velocity.norm();
        // Central differences inside the curve, one-sided differences at its ends.
        let step = DIFFERENCE * width;
        let middle = u.clamp(2.0 * step, curve.end() - 2.0 * step);
        let [before, here, after] =
            [middle - step, middle, middle + step].map(|u| curvature(&curve.at(u)));
        let by_u = (after - before) / (2.0 * step);
        let by_u_twice = (after - 2.0 * here + before) / (step * step);
        let speed_slope = velocity.dot(&acceleration) / speed;
        PatternPoint {
            s,
            position,
            angle: libm::atan2(velocity.y, velocity.x),
            curvature: curvature(&[position, velocity, acceleration]),
            curvature_slope: by_u / speed,
            curvature_bend: (by_u_twice - by_u * speed_slope / speed) / (speed * speed),
        }
    }
}

fn between(curve: &dyn PlaneCurve, rule: &[(f64, f64)], from: f64, to: f64) -> f64 {
    let parts = rule
        .iter()
        .map(|(x, weight)| weight * curve.at(from + (to - from) * x)[1].norm());
    (to - from) * parts.sum::<f64>()
}

fn curvature([_, velocity, acceleration]: &[Point; 3]) -> f64 {
    velocity.perp(acceleration) / velocity.norm().powi(3)
}
