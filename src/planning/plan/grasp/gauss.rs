//! Gauss collocation: the implicit Runge–Kutta method of order 2s with s stages (Hairer & Wanner, Solving Ordinary
//! Differential Equations II, sec. IV.5).

use rodlab_engine::mechanics::kirchhoff::numerics::gauss_legendre;
use std::sync::LazyLock;

/// Number of stages s of a step; the method has the order 10.
pub const STAGES: usize = 5;

/// The method's coefficients for a step of length 1.
#[derive(Debug)]
pub struct GaussRule {
    /// c, positions of the stages.
    pub nodes: [f64; STAGES],
    /// b, the weights of quadrature.
    pub weights: [f64; STAGES],
    /// a: integrals of the Lagrange polynomials from 0 to each stage.
    pub matrix: [[f64; STAGES]; STAGES],
    /// Derivatives, at the end of the step, of the Lagrange polynomials of its start and its
    /// stages.
    pub end_slope: [f64; STAGES + 1],
    /// Barycentric weights of the polynomial through the start of the step and the stages.
    barycentric: [f64; STAGES + 1],
}

/// The rule, computed at its first use.
pub static RULE: LazyLock<GaussRule> = LazyLock::new(GaussRule::new);

impl GaussRule {
    fn new() -> Self {
        let mut points = gauss_legendre(STAGES);
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        let nodes: [f64; STAGES] = std::array::from_fn(|stage| points[stage].0);
        let weights = std::array::from_fn(|stage| points[stage].1);
        let lagrange = |stage: usize, x: f64| -> f64 {
            (0..STAGES)
                .filter(|other| *other != stage)
                .map(|other| (x - nodes[other]) / (nodes[stage] - nodes[other]))
                .product()
        };
        // The rule integrates its own polynomials exactly.
        let matrix = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let end = nodes[row];
                let parts = points
                    .iter()
                    .map(|(x, weight)| weight * end * lagrange(column, x * end));
                parts.sum()
            })
        });
        let with_start: [f64; STAGES + 1] =
            std::array::from_fn(|point| if point == 0 { 0.0 } else { nodes[point - 1] });
        let barycentric = std::array::from_fn(|point| {
            let factors = (0..=STAGES)
                .filter(|other| *other != point)
                .map(|other| with_start[point] - with_start[other]);
            1.0 / factors.product::<f64>()
        });
        let mut rule = Self {
            nodes,
            weights,
            matrix,
            barycentric,
            end_slope: [0.0; STAGES + 1],
        };
        let at_end = rule.interpolation(1.0);
        rule.end_slope = std::array::from_fn(|point| {
            let others = (0..=STAGES).filter(|other| *other != point);
            let sum: f64 = others.map(|other| 1.0 / (1.0 - with_start[other])).sum();
            at_end[point] * sum
        });
        rule
    }

    /// Values of the Lagrange polynomials of the start of the step and of its stages at `x` in [0, 1].
    pub fn interpolation(&self, x: f64) -> [f64; STAGES + 1] {
        let distance = |point: usize| {
            if point == 0 {
                x
            } else {
                x - self.nodes[point - 1]
            }
        };
        if let Some(hit) = (0..=STAGES).find(|point| distance(*point) == 0.0) {
            return std::array::from_fn(|point| f64::from(u8::from(point == hit)));
        }
        let terms: [f64; STAGES + 1] =
            std::array::from_fn(|point| self.barycentric[point] / distance(point));
        let sum: f64 = terms.iter().sum();
        terms.map(|term| term / sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for degree in 0..STAGES as i32 {
            for (row, node) in RULE.matrix.iter().zip(RULE.nodes) {
                let sum: f64 = (0..STAGES)
                    .map(|k| row[k] * RULE.nodes[k].powi(degree))
                    .sum();
                assert!((sum - node.powi(degree + 1) / f64::from(degree + 1)).abs() < 1e-15);
            }
        }
        for degree in 0..2 * STAGES as i32 {
            let sum: f64 = (0..STAGES)
                .map(|k| RULE.weights[k] * RULE.nodes[k].powi(degree))
                .sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-15);
        }
    }

    #[test]
    fn polynomials_are_interpolated_exactly() {
        for x in [0.0, 0.3, RULE.nodes[2], 1.0] {
            let values = RULE.interpolation(x);
            for degree in 1..=STAGES as i32 {
                let sum: f64 = (0..STAGES)
                    .map(|k| values[k + 1] * RULE.nodes[k].powi(degree))
                    .sum();
                assert!((sum - x.powi(degree)).abs() < 1e-13);
            }
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        }
        for degree in 1..=STAGES as i32 {
            let slope: f64 = (0..STAGES)
                .map(|k| RULE.end_slope[k + 1] * RULE.nodes[k].powi(degree))
                .sum();
            assert!((slope - f64::from(degree)).abs() < 1e-11);
        }
    }
}
