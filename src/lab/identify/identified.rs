//! Result of an identification, as written to `identified.json`. All quantities are in SI units.

use super::advice::{experiment_for, in_words};
use super::data::Datum;
use super::fit::{Estimate, Weighting};
use super::problem::Problem;
use super::statistics::{Group, Statistics, student_95};
use libm::exp;
use serde::Serialize;

/// The result of an identification.
#[derive(Clone, Debug, Serialize)]
pub struct Identified {
    /// The fitted keys.
    pub parameters: Vec<IdentifiedKey>,
    /// Correlations of the errors of the keys, in their order.
    pub correlations: Vec<Vec<f64>>,
    /// Combinations of keys that the data do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Groups of numbers with the same noise.
    pub groups: Vec<Noise>,
    /// Measured numbers.
    pub measurements: usize,
    /// Degrees of freedom: measured numbers minus the keys that they determine.
    pub degrees_of_freedom: f64,
    /// χ² over the degrees of freedom: about 1 if the noise is given and the model fits, 1 if the
    /// noise is estimated.
    pub reduced_chi_squared: f64,
    /// Derivatives computed.
    pub iterations: usize,
    /// Whether the fit has converged.
    pub converged: bool,
    /// Remarks, a sentence each.
    pub remarks: Vec<String>,
    /// Residuals, a row for each measured number.
    #[serde(skip)]
    pub residuals: Vec<Residual>,
}

/// A fitted key.
#[derive(Clone, Debug, Serialize)]
pub struct IdentifiedKey {
    /// The dotted key.
    pub key: String,
    /// The estimate.
    pub value: f64,
    /// The SI unit; empty if the key has none.
    pub unit: String,
    /// Standard error of the key; `None` if the data do not determine the key.
    pub standard_error: Option<f64>,
    /// Interval that contains the true value with a probability of 95 %; `None` if the data do not
    /// determine the key.
    pub interval_95: Option<[f64; 2]>,
    /// Value at the start.
    pub start: f64,
    /// Whether the estimate is at a bound.
    pub at_bound: bool,
}

/// A combination of keys that the data do not determine.
#[derive(Clone, Debug, Serialize)]
pub struct Undetermined {
    /// Relative changes of the keys, as a unit vector, that change the data least.
    pub changes: Vec<(String, f64)>,
    /// The same in a sentence.
    pub words: String,
    /// Advice on what to measure in addition.
    pub advice: String,
}

/// The noise of a group of numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Noise {
    /// The file and the quantity.
    pub group: String,
    /// Measured numbers.
    pub measurements: usize,
    /// Standard deviation of the noise, estimated or given.
    pub standard_deviation: f64,
    /// Whether it was given.
    pub given: bool,
    /// Root mean square of the residuals.
    pub root_mean_square: f64,
    /// Correlation of consecutive residuals; about 0 if the model fits.
    pub correlation: f64,
    /// Factor by which correlated residuals widen the error bars.
    pub widened_by: f64,
}

/// A row of `residuals.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct Residual {
    /// Name of the scenario.
    pub scenario: String,
    /// The file.
    pub file: String,
    /// The line in it.
    pub line: usize,
    /// The series: a marker with its axis, or a column.
    pub series: String,
    /// Time, s.
    pub time_s: Option<f64>,
    /// The measured number.
    pub measured: f64,
    /// The prediction.
    pub predicted: f64,
    /// Measured less predicted.
    pub residual: f64,
    /// Residual in standard deviations of the noise.
    pub standardised: f64,
    /// Name of the group.
    #[serde(skip)]
    pub group: String,
}

/// Correlation of neighbouring residuals beyond which the model is reported not to fit.
const NOTABLE_CORRELATION: f64 = 0.5;

impl Identified {
    /// Builds the result at an estimate.
    pub fn new(
        problem: &Problem<'_>,
        estimate: &Estimate,
        weighting: &Weighting<'_>,
        groups: &[Group],
        widening: &[(f64, f64)],
        statistics: &Statistics,
    ) -> Self {
        let residuals = residuals(problem, estimate, weighting, groups, widening);
        let noise = noise(&residuals, weighting, groups, widening);
        let keys = 0..problem.parameters.len();
        let parameters: Vec<IdentifiedKey> = keys
            .clone()
            .map(|key| identified_key(problem, estimate, statistics, key))
            .collect();
        let correlations = keys.clone().map(|one| {
            keys.clone()
                .map(|other| {
                    if one == other {
                        1.0
                    } else {
                        statistics.correlation(one, other)
                    }
                })
                .collect()
        });
        let names: Vec<&str> = problem
            .parameters
            .iter()
            .map(|one| one.key.as_str())
            .collect();
        let undetermined: Vec<Undetermined> = statistics
            .undetermined
            .iter()
            .map(|direction| {
                let changes: Vec<(String, f64)> = direction
                    .members()
                    .map(|(key, part)| (names[key].to_owned(), part))
                    .collect();
                Undetermined {
                    words: in_words(&changes, direction.standard_error),
                    advice: experiment_for(&changes),
                    changes,
                }
            })
            .collect();
        let squares: f64 = residuals
            .iter()
            .map(|one| 2.0 * weighting.loss.value(one.standardised))
            .sum();
        Self {
            correlations: correlations.collect(),
            remarks: remarks(&parameters, &noise, estimate.has_converged),
            parameters,
            undetermined,
            groups: noise,
            measurements: residuals.len(),
            degrees_of_freedom: statistics.freedom,
            reduced_chi_squared: squares / statistics.freedom,
            iterations: estimate.iterations,
            converged: estimate.has_converged,
            residuals,
        }
    }
}

fn identified_key(
    problem: &Problem<'_>,
    estimate: &Estimate,
    statistics: &Statistics,
    key: usize,
) -> IdentifiedKey {
    let parameter = &problem.parameters[key];
    let at = estimate.coordinates[key];
    let value = parameter.value(at);
    let error = statistics.standard_error(key);
    let is_determined = statistics.determines(key) && error.is_finite();
    let half = student_95(statistics.freedom) * error;
    let interval = match parameter.is_logarithmic {
        true => [value * exp(-half), value * exp(half)],
        false => [
            value - half * parameter.scale,
            value + half * parameter.scale,
        ],
    };
    IdentifiedKey {
        key: parameter.key.clone(),
        value,
        unit: parameter.unit.clone(),
        standard_error: is_determined.then_some(error * parameter.slope(at)),
        interval_95: is_determined.then_some(interval),
        start: parameter.start,
        at_bound: parameter
            .bounds
            .iter()
            .any(|bound| bound.is_finite() && (value - bound).abs() <= 1e-9 * bound.abs()),
    }
}

fn residuals(
    problem: &Problem<'_>,
    estimate: &Estimate,
    weighting: &Weighting<'_>,
    groups: &[Group],
    widening: &[(f64, f64)],
) -> Vec<Residual> {
    let mut names = vec![("", 1.0); weighting.measured.len()];
    for (group, (_, widened)) in groups.iter().zip(widening) {
        for member in &group.members {
            names[*member] = (&group.name, *widened);
        }
    }
    let scenarios = problem.experiments.iter().flat_map(|one| {
        let count: usize = one.files.iter().map(|file| file.data.len()).sum();
        std::iter::repeat_n(one.scenario.name(), count)
    });
    let rows = problem.data().zip(scenarios).enumerate();
    rows.map(|(index, ((file, datum), scenario))| {
        let Datum {
            line,
            time,
            value,
            series,
            ..
        } = datum;
        let residual = value - estimate.predicted[index];
        Residual {
            scenario: scenario.to_owned(),
            file: file.path.display().to_string(),
            line: *line,
            series: series.clone(),
            time_s: *time,
            measured: *value,
            predicted: estimate.predicted[index],
            residual,
            standardised: residual / weighting.deviations[index] * names[index].1,
            group: names[index].0.to_owned(),
        }
    })
    .collect()
}

fn noise(
    residuals: &[Residual],
    weighting: &Weighting<'_>,
    groups: &[Group],
    widening: &[(f64, f64)],
) -> Vec<Noise> {
    let of = |(index, group): (usize, &Group)| {
        let (correlation, widened_by) = widening[index];
        let count = group.members.len();
        let mean = |square: &dyn Fn(usize) -> f64| {
            let sum: f64 = group.members.iter().map(|member| square(*member)).sum();
            (sum / count as f64).sqrt()
        };
        Noise {
            group: group.name.clone(),
            measurements: count,
            standard_deviation: mean(&|member| (weighting.deviations[member] / widened_by).powi(2)),
            given: group.given.is_some(),
            root_mean_square: mean(&|member| residuals[member].residual.powi(2)),
            correlation,
            widened_by,
        }
    };
    groups.iter().enumerate().map(of).collect()
}

fn remarks(parameters: &[IdentifiedKey], noise: &[Noise], has_converged: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    if !has_converged {
        remarks.push(
            "the fit has not converged; give a start value closer to the solution by --set KEY=VALUE, or give --bounds"
                .to_owned(),
        );
    }
    for parameter in parameters.iter().filter(|parameter| parameter.at_bound) {
        remarks.push(format!(
            "`{}` is at its bound {:.6e}; its error bar assumes that it is not",
            parameter.key, parameter.value
        ));
    }
    for group in noise
        .iter()
        .filter(|group| group.correlation > NOTABLE_CORRELATION && group.widened_by > 1.0)
    {
        remarks.push(format!(
            "the residuals of {} are not independent noise (correlation of neighbours {:.2}): the \
             scenario lacks an effect that was measured; error bars are widened by a factor of \
             {:.1}",
            group.group, group.correlation, group.widened_by
        ));
    }
    remarks
}
