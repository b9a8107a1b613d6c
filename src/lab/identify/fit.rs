//! Least squares with a trust region and bounds.
//!
//! The sum over all numbers i of ρ(rᵢ), rᵢ = (predicted − measured)/σᵢ, and of half the squares of
//! the priors is minimised by the method of Levenberg and Marquardt. With the Jacobian J of the
//! weighted residuals, a step solves
//!
//! ```text
//! (JᵀJ + λ D) s = −Jᵀr,    D = diag(JᵀJ)
//! ```
//!
//! and λ follows the ratio of the actual to the predicted decrease (Nielsen 1999). ρ is r²/2; with
//! the loss of Huber it is linear beyond 1.345 σ, and rows have the weights min(1, 1.345/|r|).
//! Coordinates at a bound are held if the step would cross the bound. Combinations that the data
//! do not determine would follow the noise without bound: a term Σ (u/5)²/2 keeps them within some
//! powers of e of the start. This term moves the estimate u of a coordinate with the standard error
//! s by the fraction s u/25 of s.
//!
//! The method is implemented here, and a failed simulation only shortens the step. The crate
//! `levenberg-marquardt` has no bounds and is built on another version of nalgebra. It ends at the
//! first point at which a residual cannot be computed, for example because a simulation does not
//! converge.

use super::error::IdentifyError;
use super::jacobian::Jacobian;
use super::problem::Problem;
use nalgebra::{DMatrix, DVector};

/// Treatment of large residuals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// Squares: best for normal noise.
    #[default]
    Squares,
    /// Linear beyond 1.345 standard deviations: for data with outliers.
    Huber,
}

/// Residual at which the loss of Huber becomes linear, in standard deviations: 95 % efficient for normal noise.
const HUBER: f64 = 1.345;
/// Distance from the start, in coordinates, over which the data must determine a combination.
const RANGE: f64 = 5.0;
/// Maximum number of Jacobians.
const MOST_ITERATIONS: usize = 60;
/// Maximum number of trials of a step.
const MOST_TRIALS: usize = 14;
/// Longest step of a coordinate: a factor of e^1.5, or 1.5 scales.
const LONGEST_STEP: f64 = 1.5;
/// Predicted decrease, in units of χ²/2, below which a step is negligible against the error bars.
const NEGLIGIBLE: f64 = 1e-8;
/// Step of a coordinate below which nothing changes.
const SHORTEST_STEP: f64 = 1e-10;

impl Loss {
    /// The loss ρ(r).
    pub fn value(self, residual: f64) -> f64 {
        let size = residual.abs();
        match self {
            Self::Huber if size > HUBER => HUBER * (size - 0.5 * HUBER),
            _ => 0.5 * residual * residual,
        }
    }

    /// The weight ρ'(r)/r.
    pub fn weight(self, residual: f64) -> f64 {
        match self {
            Self::Huber if residual.abs() > HUBER => HUBER / residual.abs(),
            _ => 1.0,
        }
    }
}

/// A point of the fit.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Coordinates of the keys.
    pub coordinates: Vec<f64>,
    /// The predicted numbers.
    pub predicted: Vec<f64>,
    /// Derivatives of the residuals, a column for each key.
    pub columns: Vec<Vec<f64>>,
    /// Jacobians computed so far.
    pub iterations: usize,
    /// Whether no step decreases the sum any more.
    pub has_converged: bool,
}

impl Estimate {
    /// The start of a fit.
    ///
    /// # Errors
    /// A simulation fails there.
    pub fn at_start(problem: &Problem<'_>) -> Result<Self, IdentifyError> {
        Self::at(problem, vec![0.0; problem.parameters.len()])
    }

    /// Evaluates the point of a fit at coordinates.
    ///
    /// # Errors
    /// A simulation fails there.
    pub fn at(problem: &Problem<'_>, coordinates: Vec<f64>) -> Result<Self, IdentifyError> {
        Ok(Self {
            predicted: (problem.predict(std::slice::from_ref(&coordinates))).remove(0)?,
            coordinates,
            columns: Vec::new(),
            iterations: 0,
            has_converged: false,
        })
    }
}

/// Measured numbers and their noise.
pub struct Weighting<'a> {
    /// The measured numbers.
    pub measured: &'a [f64],
    /// Standard deviations of their noise.
    pub deviations: &'a [f64],
    /// Treatment of large residuals.
    pub loss: Loss,
}

impl Weighting<'_> {
    /// Residuals in standard deviations.
    pub fn residuals(&self, predicted: &[f64]) -> Vec<f64> {
        let numbers = predicted.iter().zip(self.measured).zip(self.deviations);
        numbers
            .map(|((predicted, measured), deviation)| (predicted - measured) / deviation)
            .collect()
    }

    fn cost(&self, problem: &Problem<'_>, coordinates: &[f64], predicted: &[f64]) -> f64 {
        let residuals = self.residuals(predicted);
        let data: f64 = residuals
            .iter()
            .map(|residual| self.loss.value(*residual))
            .sum();
        let priors = prior_rows(problem, coordinates);
        let distance: f64 = coordinates.iter().map(|at| (at / RANGE).powi(2)).sum();
        0.5 * distance
            + data
            + priors
                .iter()
                .map(|(_, residual, _)| 0.5 * residual * residual)
                .sum::<f64>()
    }

    /// JᵀJ and Jᵀr, with the rows of the priors.
    pub fn normal_equations(
        &self,
        problem: &Problem<'_>,
        estimate: &Estimate,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let count = estimate.coordinates.len();
        let residuals = self.residuals(&estimate.predicted);
        let (mut matrix, mut gradient) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (row, residual) in residuals.iter().enumerate() {
            let weight = self.loss.weight(*residual);
            let slope = |key: usize| estimate.columns[key][row] / self.deviations[row];
            for i in 0..count {
                gradient[i] += weight * slope(i) * residual;
                for j in 0..=i {
                    matrix[(i, j)] += weight * slope(i) * slope(j);
                }
            }
        }
        for (key, residual, slope) in prior_rows(problem, &estimate.coordinates) {
            matrix[(key, key)] += slope * slope;
            gradient[key] += slope * residual;
        }
        matrix.fill_upper_triangle_with_lower_triangle();
        (matrix, gradient)
    }
}

/// Priors: their key, residual in standard deviations, and its derivative.
pub fn prior_rows(problem: &Problem<'_>, coordinates: &[f64]) -> Vec<(usize, f64, f64)> {
    let keys = problem.parameters.iter().zip(coordinates).enumerate();
    let rows = keys.filter_map(|(key, (parameter, coordinate))| {
        let [expected, deviation] = parameter.prior?;
        let residual = (parameter.value(*coordinate) - expected) / deviation;
        Some((key, residual, parameter.slope(*coordinate) / deviation))
    });
    rows.collect()
}

/// Minimises the sum from an estimate whose derivatives may be missing. `report` receives each accepted point with its root mean
/// square residual, in standard deviations.
///
/// # Errors
/// The caller asked to stop, or all simulations near an estimate fail.
pub fn minimise(
    problem: &Problem<'_>,
    jacobian: &dyn Jacobian,
    weighting: &Weighting<'_>,
    start: Estimate,
    report: &mut dyn FnMut(&Estimate, f64),
) -> Result<Estimate, IdentifyError> {
    let ranges: Vec<[f64; 2]> = problem.parameters.iter().map(|one| one.range()).collect();
    let mut estimate = start;
    let mut cost = weighting.cost(problem, &estimate.coordinates, &estimate.predicted);
    let (mut damping, mut growth) = (1e-3, 2.0);
    for _ in 0..MOST_ITERATIONS {
        let columns = jacobian.derivatives(problem, &estimate.coordinates, &estimate.predicted)?;
        estimate.columns = columns;
        estimate.iterations += 1;
        report(&estimate, root_mean_square(cost, weighting.measured.len()));
        let (mut matrix, mut gradient) = weighting.normal_equations(problem, &estimate);
        for (key, at) in estimate.coordinates.iter().enumerate() {
            matrix[(key, key)] += RANGE.powi(-2);
            gradient[key] += at * RANGE.powi(-2);
        }
        let mut has_moved = false;
        for _ in 0..MOST_TRIALS {
            let step = step(&matrix, &gradient, damping, &estimate.coordinates, &ranges);
            let predicted = -(gradient.dot(&step) + 0.5 * step.dot(&(&matrix * &step)));
            if predicted < NEGLIGIBLE || step.amax() < SHORTEST_STEP {
                estimate.has_converged = true;
                return Ok(estimate);
            }
            let point: Vec<f64> = (estimate.coordinates.iter().zip(step.iter()))
                .map(|(coordinate, step)| coordinate + step)
                .collect();
            let trial = problem.predict(std::slice::from_ref(&point)).remove(0);
            let trial = match trial {
                Err(IdentifyError::Interrupted) => return Err(IdentifyError::Interrupted),
                Err(_) => None,
                Ok(values) => Some((weighting.cost(problem, &point, &values), values)),
            };
            match trial {
                Some((lower, values)) if lower < cost => {
                    let ratio = (cost - lower) / predicted;
                    let shrink = 1.0 - (2.0 * ratio - 1.0).powi(3);
                    damping = (damping * shrink.max(1.0 / 3.0)).max(1e-12);
                    growth = 2.0;
                    // A decrease in the last digits is due to round-off.
                    let is_over = cost - lower < NEGLIGIBLE * 0.1;
                    (estimate.coordinates, estimate.predicted, cost) = (point, values, lower);
                    has_moved = !is_over;
                    break;
                }
                _ => {
                    damping *= growth;
                    growth *= 2.0;
                }
            }
        }
        if !has_moved {
            // Steps were rejected until they were far shorter than the error bars, or simulations
            // fail all around.
            estimate.has_converged = gradient_is_small(&matrix, &gradient, cost);
            return Ok(estimate);
        }
    }
    Ok(estimate)
}

fn root_mean_square(cost: f64, numbers: usize) -> f64 {
    (2.0 * cost / numbers as f64).sqrt()
}

/// Whether moving any one coordinate alone decreases the sum by at most 1e-4, or by at most 1e-4
/// of the sum.
fn gradient_is_small(matrix: &DMatrix<f64>, gradient: &DVector<f64>, cost: f64) -> bool {
    let decrease =
        |key: usize| gradient[key] * gradient[key] / matrix[(key, key)].max(f64::MIN_POSITIVE);
    (0..gradient.len()).all(|key| decrease(key) < 1e-4 * cost.max(1.0))
}

/// Computes the damped step without the coordinates at a bound that it would cross.
fn step(
    matrix: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
    coordinates: &[f64],
    ranges: &[[f64; 2]],
) -> DVector<f64> {
    let is_free = |key: &usize| {
        let ([least, most], at) = (ranges[*key], coordinates[*key]);
        !(at <= least && gradient[*key] > 0.0 || at >= most && gradient[*key] < 0.0)
    };
    let free: Vec<usize> = (0..coordinates.len()).filter(is_free).collect();
    let largest = free
        .iter()
        .map(|key| matrix[(*key, *key)])
        .fold(0.0, f64::max);
    let damped = DMatrix::from_fn(free.len(), free.len(), |i, j| {
        let entry = matrix[(free[i], free[j])];
        match i == j {
            true => entry + damping * entry.max(1e-12 * largest).max(f64::MIN_POSITIVE),
            false => entry,
        }
    });
    let right = DVector::from_fn(free.len(), |i, _| -gradient[free[i]]);
    let mut step = DVector::zeros(coordinates.len());
    let Some(solution) = damped.cholesky().map(|factor| factor.solve(&right)) else {
        return step;
    };
    let shorten = (LONGEST_STEP / solution.amax()).min(1.0);
    for (key, part) in free.iter().zip(solution.iter()) {
        let [least, most] = ranges[*key];
        step[*key] = (coordinates[*key] + shorten * part).clamp(least, most) - coordinates[*key];
    }
    step
}
