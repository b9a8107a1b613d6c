//! Natural cubic splines through joint positions.

/// A natural cubic spline of several components over an increasing parameter.
pub(super) struct Spline {
    knots: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// Second derivatives at the knots.
    curvatures: Vec<Vec<f64>>,
}

impl Spline {
    /// The spline through values at knots, with zero second derivative at its ends.
    pub fn natural(knots: &[f64], values: &[Vec<f64>]) -> Self {
        let count = knots.len();
        let components = values[0].len();
        let mut curvatures = vec![vec![0.0; components]; count];
        // Thomas' algorithm on h₋ m₋/6 + (h₋ + h) m/3 + h m₊/6 = Δ/h − Δ₋/h₋.
        let mut factors = vec![0.0; count];
        for k in 1..count - 1 {
            let (before, after) = (knots[k] - knots[k - 1], knots[k + 1] - knots[k]);
            let pivot = (before + after) / 3.0 - before / 6.0 * factors[k - 1];
            factors[k] = after / 6.0 / pivot;
            for c in 0..components {
                let bend = (values[k + 1][c] - values[k][c]) / after
                    - (values[k][c] - values[k - 1][c]) / before;
                curvatures[k][c] = (bend - before / 6.0 * curvatures[k - 1][c]) / pivot;
            }
        }
        for k in (1..count - 1).rev() {
            for c in 0..components {
                curvatures[k][c] -= factors[k] * curvatures[k + 1][c];
            }
        }
        Self {
            knots: knots.to_vec(),
            values: values.to_vec(),
            curvatures,
        }
    }

    /// The last knot.
    pub fn end(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    /// The first knot.
    pub fn start(&self) -> f64 {
        self.knots[0]
    }

    fn segment(&self, at: f64) -> usize {
        let after = self.knots.partition_point(|knot| *knot <= at);
        after.clamp(1, self.knots.len() - 1) - 1
    }

    /// The values at a parameter.
    pub fn at(&self, at: f64) -> Vec<f64> {
        let k = self.segment(at);
        let length = self.knots[k + 1] - self.knots[k];
        let b = ((at - self.knots[k]) / length).clamp(0.0, 1.0);
        let a = 1.0 - b;
        (0..self.values[k].len())
            .map(|c| {
                let bent = (a * a * a - a) * self.curvatures[k][c]
                    + (b * b * b - b) * self.curvatures[k + 1][c];
                a * self.values[k][c] + b * self.values[k + 1][c] + bent * length * length / 6.0
            })
            .collect()
    }

    /// First, second and third derivative of each component.
    pub fn derivatives(&self, at: f64) -> Vec<[f64; 3]> {
        let k = self.segment(at);
        let length = self.knots[k + 1] - self.knots[k];
        let b = ((at - self.knots[k]) / length).clamp(0.0, 1.0);
        let a = 1.0 - b;
        (0..self.values[k].len())
            .map(|c| {
                let (m, n) = (self.curvatures[k][c], self.curvatures[k + 1][c]);
                let chord = (self.values[k + 1][c] - self.values[k][c]) / length;
                let bent = (3.0 * b * b - 1.0) * n - (3.0 * a * a - 1.0) * m;
                [chord + bent * length / 6.0, a * m + b * n, (n - m) / length]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_falls_with_the_fourth_power_of_the_spacing() {
        let error = |count: usize| {
            let knots: Vec<f64> = (0..=count)
                .map(|k| std::f64::consts::PI * k as f64 / count as f64)
                .collect();
            // The second derivative of the sine is zero at its zeros, like that of the spline at
            // its ends.
            let values: Vec<Vec<f64>> = knots.iter().map(|x| vec![x.sin()]).collect();
            let spline = Spline::natural(&knots, &values);
            let probe = |x: f64| {
                let [first, _, _] = spline.derivatives(x)[0];
                assert!((first - x.cos()).abs() < 3.0 / (count * count) as f64);
                (spline.at(x)[0] - x.sin()).abs()
            };
            (0..1000)
                .map(|k| probe(3.14e-3 * f64::from(k)))
                .fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(20), error(40));
        assert!((coarse / fine).log2() > 3.8, "{coarse} {fine}");
    }
}
