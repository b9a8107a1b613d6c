//! The loop of an overhand knot as a planar elastica.
//!
//! The loop leaves the braid along its axis, turns by 2π and enters it again along its axis (Jawed
//! et al. 2015). With the curvature 1/R at its ends
//!
//! ```text
//! (κ R)² = 1 − m sin²(θ/2),  0 ≤ θ ≤ 2π
//! ```
//!
//! The length of the loop is λ = 4 K(m) R. The distance of its ends is x R = (8 (K − E)/m − 4 K) R,
//! with the last end before the first.

use super::elliptic::complete_elliptic;

/// A loop with end radius 1 and elliptic parameter m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopElastica {
    /// The parameter m, 0 < m < 1; 0 is the circle.
    pub parameter: f64,
}

/// Parameter below which the difference K − E loses digits by cancellation; a series is accurate
/// there.
const SMALL_PARAMETER: f64 = 1e-4;

impl LoopElastica {
    /// Length of the loop over its end radius, λ/R = 4 K(m).
    pub fn length(self) -> f64 {
        4.0 * complete_elliptic(self.parameter)[0]
    }

    /// Length of the braid under the loop over the end radius, x = 8 (K − E)/m − 4 K.
    pub fn gap(self) -> f64 {
        let m = self.parameter;
        if m < SMALL_PARAMETER {
            return std::f64::consts::PI * m * (0.25 + 3.0 * m / 16.0);
        }
        let [first, second] = complete_elliptic(m);
        8.0 * (first - second) / m - 4.0 * first
    }

    /// Bending energy times R/EI: ½ ∫ (κR)² ds/R = 2 E(m).
    pub fn energy(self) -> f64 {
        2.0 * complete_elliptic(self.parameter)[1]
    }

    /// The loop over a gap of `gap` end radii, greater than 0 and at most 100.
    pub fn over(gap: f64) -> Self {
        // The gap is a smooth function of −ln(1 − m).
        let at = |stretched: f64| Self {
            parameter: -libm::expm1(-stretched),
        };
        let (mut low, mut high) = (0.0, 30.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if at(middle).gap() < gap {
                low = middle;
            } else {
                high = middle;
            }
        }
        at(0.5 * (low + high))
    }

    /// Points [x, y] of the loop at equal steps of the tangent angle θ from 0 to 2π, each with its
    /// arc length, all over R. The first point is the origin; the first tangent is along x.
    pub fn points(self, steps: usize) -> Vec<[f64; 3]> {
        let step = std::f64::consts::TAU / steps as f64;
        let mut points = vec![[0.0; 3]];
        for k in 0..steps {
            let angle = (k as f64 + 0.5) * step;
            let length = step / (1.0 - self.parameter * libm::sin(0.5 * angle).powi(2)).sqrt();
            let [x, y, s] = points[k];
            points.push([
                x + libm::cos(angle) * length,
                y + libm::sin(angle) * length,
                s + length,
            ]);
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_close_over_the_gap_and_have_the_length() {
        for parameter in [1e-6, 0.1, 0.5, 0.9, 0.99] {
            let elastica = LoopElastica { parameter };
            let [x, y, length] = *elastica.points(2000).last().unwrap();
            assert!((x + elastica.gap()).abs() < 1e-6, "{parameter}");
            assert!(y.abs() < 1e-10);
            assert!((length - elastica.length()).abs() < 1e-6);
        }
    }

    #[test]
    fn the_gap_is_found_again() {
        for gap in [0.01, 0.1, 1.0, 3.0, 20.0] {
            assert!((LoopElastica::over(gap).gap() - gap).abs() < 1e-9 * (1.0 + gap));
        }
    }

    #[test]
    fn the_series_of_the_gap_meets_its_closed_form() {
        let at = |parameter| LoopElastica { parameter }.gap();
        let (below, above) = (at(0.999_999 * SMALL_PARAMETER), at(SMALL_PARAMETER));
        assert!((above / below - 1.000_001).abs() < 1e-6);
    }
}
