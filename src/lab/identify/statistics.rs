//! Error bars: noise, covariance, and directions that the data do not determine.
//!
//! With the Jacobian J of predictions in units of the noise, the covariance of the coordinates is
//! C = (JᵀJ)⁻¹, the bound of Cramér and Rao for normal noise. The noise of a group of n numbers
//! follows from its residuals, σ² = Σ r²/(n − Σ hᵢ), with the leverages hᵢ = Jᵢ C Jᵢᵀ, the degrees
//! of freedom that the fit has used.
//!
//! If the model does not fit, consecutive residuals of a series are correlated and carry less
//! information than independent ones. If their correlation ϱ is above its chance value, σ² is
//! multiplied by (1 + ϱ)/(1 − ϱ).
//!
//! Numbers of an experiment may share errors that are smooth along their series ([`Shared`]), such
//! as those of a traced picture. With the covariance K of these errors, in units of the noise, the
//! covariance of the estimate is C (JᵀJ + Jᵀ K J) C.
//!
//! Eigenvectors v of JᵀJ with eigenvalue μ are combinations of coordinates with the standard error
//! 1/√μ. If this error exceeds 1, a factor of e, the data do not determine the combination.

use super::fit::{Estimate, Loss, Weighting, prior_rows};
use super::problem::Problem;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Fraction of the largest eigenvalue below which an eigenvalue is round-off of the differences.
const ROUND_OFF: f64 = 1e-10;
/// Standard error of a coordinate beyond which a combination is not determined.
const UNDETERMINED: f64 = 1.0;
/// Component of a direction below which a key does not belong to the direction.
const PART: f64 = 0.1;
/// Correlation, in standard deviations of its chance value, up to which it is ignored.
const CHANCE: f64 = 3.0;
/// Upper bound of a correlation in the error bars.
const LARGEST_CORRELATION: f64 = 0.98;
/// Ratio of the median of |r| to the standard deviation, for normal noise.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// A group of numbers with the same noise.
#[derive(Clone, Debug)]
pub struct Group {
    /// Name: the file and the quantity.
    pub name: String,
    /// Indices of its numbers among all.
    pub members: Vec<usize>,
    /// Indices of consecutive numbers of each series.
    pub pairs: Vec<[usize; 2]>,
    /// Standard deviation of its noise, if given; otherwise it is estimated.
    pub given: Option<f64>,
}

/// Errors that the numbers of an experiment share: the errors of two numbers n apart have the
/// correlation exp(−n/N).
#[derive(Clone, Copy, Debug)]
pub struct Shared {
    /// Standard deviation of the numbers, in their unit.
    pub deviation: f64,
    /// Ratio of N to the number of measurements of the experiment.
    pub length: f64,
}

/// A combination of keys that the data do not determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Component of the direction in each coordinate; a unit vector.
    pub parts: Vec<f64>,
    /// Standard error of the direction; infinite if nothing depends on it.
    pub standard_error: f64,
}

/// Errors of a fit.
#[derive(Clone, Debug)]
pub struct Statistics {
    /// Covariance of the coordinates.
    pub covariance: DMatrix<f64>,
    /// Combinations that are not determined, the worst first.
    pub undetermined: Vec<Direction>,
    /// Degrees of freedom: numbers minus the leverages of all groups.
    pub freedom: f64,
}

impl Statistics {
    /// Whether the data determine a key.
    pub fn determines(&self, key: usize) -> bool {
        let concerns = |direction: &Direction| direction.parts[key].abs() > PART;
        !self.undetermined.iter().any(concerns)
    }

    /// The standard error of a coordinate.
    pub fn standard_error(&self, key: usize) -> f64 {
        self.covariance[(key, key)].sqrt()
    }

    /// The correlation of two coordinates.
    pub fn correlation(&self, one: usize, other: usize) -> f64 {
        self.covariance[(one, other)] / (self.standard_error(one) * self.standard_error(other))
    }
}

impl Direction {
    /// Keys that belong to it, with their components.
    pub fn members(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let parts = self.parts.iter().copied().enumerate();
        parts.filter(|(_, part)| part.abs() > PART)
    }
}

/// Eigenvalues of JᵀJ from the largest, with their vectors.
fn directions(matrix: &DMatrix<f64>) -> Vec<(f64, DVector<f64>)> {
    let eigen = SymmetricEigen::new(matrix.clone());
    let vectors = eigen
        .eigenvectors
        .column_iter()
        .map(|column| column.into_owned());
    let mut all: Vec<(f64, DVector<f64>)> =
        eigen.eigenvalues.iter().copied().zip(vectors).collect();
    all.sort_by(|one, other| other.0.total_cmp(&one.0));
    all
}

/// Computes the inverse of JᵀJ over the directions above round-off.
fn inverse(directions: &[(f64, DVector<f64>)]) -> DMatrix<f64> {
    let count = directions.len();
    let floor = ROUND_OFF * directions.first().map_or(0.0, |first| first.0);
    let mut inverse = DMatrix::zeros(count, count);
    for (value, vector) in directions.iter().filter(|(value, _)| *value > floor) {
        for i in 0..count {
            for j in 0..count {
                inverse[(i, j)] += vector[i] * vector[j] / value;
            }
        }
    }
    inverse
}

/// Row of the Jacobian of a number, in units of its noise.
fn row(estimate: &Estimate, weighting: &Weighting<'_>, number: usize) -> Vec<f64> {
    let slopes = estimate.columns.iter();
    slopes
        .map(|column| column[number] / weighting.deviations[number])
        .collect()
}

/// The leverage of a number.
fn leverage(inverse: &DMatrix<f64>, row: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (i, one) in row.iter().enumerate() {
        for (j, other) in row.iter().enumerate() {
            sum += one * inverse[(i, j)] * other;
        }
    }
    sum
}

/// Leverages of all numbers.
fn leverages(problem: &Problem<'_>, estimate: &Estimate, weighting: &Weighting<'_>) -> Vec<f64> {
    let (matrix, _) = weighting.normal_equations(problem, estimate);
    let inverse = inverse(&directions(&matrix));
    let numbers = 0..weighting.measured.len();
    numbers
        .map(|number| leverage(&inverse, &row(estimate, weighting, number)))
        .collect()
}

/// Computes standard deviations of the noise of groups, from their residuals if none is given.
pub fn noise(
    problem: &Problem<'_>,
    estimate: &Estimate,
    weighting: &Weighting<'_>,
    groups: &[Group],
) -> Vec<f64> {
    let leverages = match estimate.columns.is_empty() {
        true => vec![0.0; weighting.measured.len()],
        false => leverages(problem, estimate, weighting),
    };
    let of = |group: &Group| {
        if let Some(given) = group.given {
            return given;
        }
        let count = group.members.len() as f64;
        let used: f64 = group.members.iter().map(|member| leverages[*member]).sum();
        // A group that determines a key by itself has no residual.
        let free = (count - used).max(0.1 * count);
        let residual = |member: &usize| estimate.predicted[*member] - weighting.measured[*member];
        let squares = group.members.iter().map(|member| residual(member).powi(2));
        let sizes = group.members.iter().map(|member| residual(member).abs());
        let size = weighting_size(group, weighting);
        let deviation = match weighting.loss {
            Loss::Squares => (squares.sum::<f64>() / free).sqrt(),
            Loss::Huber => median(sizes.collect()) / MEDIAN * (count / free).sqrt(),
        };
        deviation.max(1e-9 * size).max(f64::MIN_POSITIVE.sqrt())
    };
    groups.iter().map(of).collect()
}

/// Root mean square of the measured numbers of a group.
fn weighting_size(group: &Group, weighting: &Weighting<'_>) -> f64 {
    let squares = group
        .members
        .iter()
        .map(|member| weighting.measured[*member].powi(2));
    (squares.sum::<f64>() / group.members.len() as f64).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() % 2 {
        0 => 0.5 * (values[half - 1] + values[half]),
        _ => values[half],
    }
}

/// Error bars at an estimate.
pub fn statistics(
    problem: &Problem<'_>,
    estimate: &Estimate,
    weighting: &Weighting<'_>,
    groups: &[Group],
    shared: Option<Shared>,
) -> Statistics {
    let count = estimate.coordinates.len();
    let residuals = weighting.residuals(&estimate.predicted);
    // With the loss of Huber, the covariance uses JᵀJ of all rows with weight 1.
    let plain = Weighting {
        loss: Loss::Squares,
        ..*weighting
    };
    let (matrix, _) = plain.normal_equations(problem, estimate);
    let directions = directions(&matrix);
    let inverse = inverse(&directions);
    let mut middle = DMatrix::zeros(count, count);
    let mut freedom = 0.0;
    for group in groups {
        let factor = robust_factor(weighting.loss, group, &residuals);
        for member in &group.members {
            let row = row(estimate, weighting, *member);
            freedom += 1.0 - leverage(&inverse, &row);
            for i in 0..count {
                for j in 0..count {
                    middle[(i, j)] += factor * row[i] * row[j];
                }
            }
        }
    }
    for (key, _, slope) in prior_rows(problem, &estimate.coordinates) {
        middle[(key, key)] += slope * slope;
    }
    if let Some(shared) = shared {
        middle += of_shared(problem, estimate, weighting, shared);
    }
    let covariance = product(&product(&inverse, &middle), &inverse);
    let floor = ROUND_OFF * directions.first().map_or(0.0, |first| first.0);
    let undetermined = directions.iter().rev().filter_map(|(value, vector)| {
        let error = match *value > floor {
            true => vector.dot(&(&covariance * vector)).sqrt(),
            false => f64::INFINITY,
        };
        (error > UNDETERMINED).then(|| Direction {
            parts: vector.iter().copied().collect(),
            standard_error: error,
        })
    });
    Statistics {
        undetermined: undetermined.collect(),
        covariance,
        freedom: freedom.max(1.0),
    }
}

/// Jᵀ K J of shared errors.
fn of_shared(
    problem: &Problem<'_>,
    estimate: &Estimate,
    weighting: &Weighting<'_>,
    shared: Shared,
) -> DMatrix<f64> {
    let keys = estimate.coordinates.len();
    let mut sum = DMatrix::zeros(keys, keys);
    let mut first = 0;
    for experiment in problem.experiments {
        let count: usize = experiment.files.iter().map(|file| file.data.len()).sum();
        let rows: Vec<Vec<f64>> = (first..first + count)
            .map(|number| row(estimate, weighting, number))
            .collect();
        let decay = libm::exp(-1.0 / (shared.length * count as f64));
        let size = |number: usize| shared.deviation / weighting.deviations[first + number];
        // Sum over all earlier numbers, each with its decay.
        let mut before = vec![0.0; keys];
        for (number, row) in rows.iter().enumerate() {
            let own: Vec<f64> = row.iter().map(|one| one * size(number)).collect();
            for i in 0..keys {
                for j in 0..keys {
                    sum[(i, j)] += own[i] * own[j] + own[i] * before[j] + before[i] * own[j];
                }
            }
            for (before, own) in before.iter_mut().zip(&own) {
                *before = decay * (*before + own);
            }
        }
        first += count;
    }
    sum
}

/// Multiplies two matrices; nalgebra would sum in an order that depends on the processor.
fn product(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(one.nrows(), other.ncols(), |i, j| {
        (0..one.ncols()).map(|k| one[(i, k)] * other[(k, j)]).sum()
    })
}

/// Correlation of consecutive residuals of a group, and the factor by which it widens error bars.
pub fn widening(group: &Group, residuals: &[f64]) -> (f64, f64) {
    let correlation = correlation(group, residuals);
    let chance = CHANCE / (group.pairs.len().max(1) as f64).sqrt();
    let counted = match correlation > chance {
        true => correlation.min(LARGEST_CORRELATION),
        false => 0.0,
    };
    (correlation, ((1.0 + counted) / (1.0 - counted)).sqrt())
}

/// Correlation of consecutive residuals in a series.
fn correlation(group: &Group, residuals: &[f64]) -> f64 {
    let products = group
        .pairs
        .iter()
        .map(|[one, other]| residuals[*one] * residuals[*other]);
    let squares = group
        .pairs
        .iter()
        .map(|[one, other]| 0.5 * (residuals[*one].powi(2) + residuals[*other].powi(2)));
    let squares: f64 = squares.sum();
    match squares > 0.0 {
        true => products.sum::<f64>() / squares,
        false => 0.0,
    }
}

/// Variance of Huber's estimate over the variance of least squares with the same σ: E ψ² / (E ψ')²
/// (Huber 1981).
fn robust_factor(loss: Loss, group: &Group, residuals: &[f64]) -> f64 {
    if loss == Loss::Squares {
        return 1.0;
    }
    let count = group.members.len() as f64;
    let weights = group
        .members
        .iter()
        .map(|member| (residuals[*member], loss.weight(residuals[*member])));
    let (mut squares, mut linear) = (0.0, 0.0);
    for (residual, weight) in weights {
        squares += (weight * residual).powi(2);
        linear += if weight < 1.0 { 0.0 } else { 1.0 };
    }
    (squares / count) / (linear / count).powi(2).max(1e-4)
}

/// Quantile t of Student's distribution with 95 % of the probability between −t and t, by the
/// expansion of Cornish and Fisher.
pub fn student_95(freedom: f64) -> f64 {
    let z: f64 = 1.959_963_984_540_054;
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    z + terms[0] / freedom + terms[1] / freedom.powi(2) + terms[2] / freedom.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedom, expected) in [
            (5.0, 2.5706),
            (10.0, 2.2281),
            (30.0, 2.0423),
            (1e9, 1.95996),
        ] {
            let found = student_95(freedom);
            assert!((found - expected).abs() < 4e-3, "{freedom}: {found}");
        }
    }

    #[test]
    fn a_combination_on_which_nothing_depends_is_undetermined() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1e6, -1e6, -1e6, 1e6]);
        let found = directions(&matrix);
        assert!((found[0].0 - 2e6).abs() < 1e-3 && found[1].0.abs() < 1e-3);
        let inverse = inverse(&found);
        // 1/μ times the square of the component 1/√2.
        assert!((inverse[(0, 0)] - 2.5e-7).abs() < 1e-12, "{inverse}");
    }
}
