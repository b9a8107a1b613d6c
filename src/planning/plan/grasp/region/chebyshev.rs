//! Chebyshev collocation: functions on [0, 1] represented by their values at Chebyshev points
//! (Trefethen, Spectral Methods in MATLAB, chs. 6 and 12).

use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Matrices that map values at the points to derivatives and integrals.
#[derive(Debug)]
pub struct Chebyshev {
    /// The points, from 0 to 1.
    pub points: DVector<f64>,
    /// Derivatives at the points.
    pub derivative: DMatrix<f64>,
    /// Second derivatives at the points.
    pub second_derivative: DMatrix<f64>,
    /// Integrals from 0 to the points.
    pub integral: DMatrix<f64>,
    /// The integral from 0 to 1: its last row.
    pub weights: DVector<f64>,
}

impl Chebyshev {
    /// The matrices for polynomials of a degree, with one more point than the degree.
    ///
    /// # Panics
    /// The degree is 0.
    pub fn new(degree: usize) -> Self {
        assert!(degree > 0, "constants have no derivatives");
        let place = |index: usize| 0.5 * (1.0 - libm::cos(PI * index as f64 / degree as f64));
        let points = DVector::from_fn(degree + 1, |index, _| place(index));
        let weight = |index: usize| {
            let end = if index == 0 || index == degree {
                2.0
            } else {
                1.0
            };
            if index.is_multiple_of(2) { end } else { -end }
        };
        let mut derivative = DMatrix::from_fn(degree + 1, degree + 1, |row, column| {
            if row == column {
                0.0
            } else {
                weight(row) / weight(column) / (points[row] - points[column])
            }
        });
        // Constants have no slope.
        for row in 0..=degree {
            derivative[(row, row)] = -derivative.row(row).sum();
        }
        // The Chebyshev coefficients of the polynomial through all points, and the primitives of
        // T_k over y = 2x − 1.
        let polynomial = |order: usize, x: f64| {
            libm::cos(order as f64 * libm::acos((2.0 * x - 1.0).clamp(-1.0, 1.0)))
        };
        let primitive = |order: usize, x: f64| match order {
            0 => 2.0 * x - 1.0,
            1 => 0.5 * (2.0 * x - 1.0) * (2.0 * x - 1.0),
            _ => {
                let (k, above, below) = (order as f64, order + 1, order - 1);
                0.5 * (polynomial(above, x) / (k + 1.0) - polynomial(below, x) / (k - 1.0))
            }
        };
        let count = degree + 1;
        let values = DMatrix::from_fn(count, count, |row, order| polynomial(order, points[row]));
        let integrals = DMatrix::from_fn(count, count, |row, order| {
            0.5 * (primitive(order, points[row]) - primitive(order, 0.0))
        });
        let coefficients = values
            .try_inverse()
            .expect("Chebyshev polynomials are independent");
        let integral = integrals * coefficients;
        Self {
            second_derivative: &derivative * &derivative,
            derivative,
            weights: integral.row(degree).transpose(),
            integral,
            points,
        }
    }

    /// The polynomial through all points at `x` (barycentric formula; Berrut and Trefethen 2004).
    pub fn interpolated(&self, values: &DVector<f64>, x: f64) -> f64 {
        let degree = self.points.len() - 1;
        let (mut above, mut below) = (0.0, 0.0);
        for (index, (point, value)) in self.points.iter().zip(values.iter()).enumerate() {
            if x == *point {
                return *value;
            }
            let end = if index == 0 || index == degree {
                0.5
            } else {
                1.0
            };
            let weight = if index.is_multiple_of(2) { end } else { -end } / (x - point);
            above += weight * value;
            below += weight;
        }
        above / below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_differentiated_and_integrated_exactly() {
        let rule = Chebyshev::new(12);
        for power in 0..=12 {
            let n = f64::from(power);
            let values = rule.points.map(|x| x.powi(power));
            let slopes = &rule.derivative * &values;
            let bends = &rule.second_derivative * &values;
            let sums = &rule.integral * &values;
            for (index, x) in rule.points.iter().enumerate() {
                let slope = if power > 0 {
                    n * x.powi(power - 1)
                } else {
                    0.0
                };
                let bend = if power > 1 {
                    n * (n - 1.0) * x.powi(power - 2)
                } else {
                    0.0
                };
                assert!((slopes[index] - slope).abs() < 1e-11, "{power}");
                assert!((bends[index] - bend).abs() < 1e-8, "{power}");
                assert!((sums[index] - x.powi(power + 1) / (n + 1.0)).abs() < 1e-13);
            }
            let between = rule.interpolated(&values, 0.37);
            assert!((between - 0.37_f64.powi(power)).abs() < 1e-13);
            assert!((rule.weights.dot(&values) - 1.0 / (n + 1.0)).abs() < 1e-13);
        }
    }
}
