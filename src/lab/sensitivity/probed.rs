//! Derivatives of probes at the outputs of a run.

use super::chosen::{Chosen, rates};
use super::error::SensitivityError;
use super::problem::{Key, Moment, Problem, Source};
use std::fmt::Write;

/// Maximum number of passes to find a suitable ε.
const PASSES: usize = 3;

/// Values of probes and their derivatives with respect to keys, in SI units.
#[derive(Clone, Debug)]
pub struct Derivatives {
    /// Columns of the probes.
    pub columns: Vec<String>,
    /// The keys.
    pub keys: Vec<Key>,
    /// A row for each output.
    pub rows: Vec<Row>,
    /// Accepted steps.
    pub steps: u64,
}

/// Values and derivatives at one time.
#[derive(Clone, Debug)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Value of each column; `None` if it is undefined.
    pub values: Vec<Option<f64>>,
    /// Derivative of each column with respect to each key: a list for each key.
    pub derivatives: Vec<Vec<Option<f64>>>,
}

/// Differentiates probes of a scenario with respect to its keys, at its outputs. `of` names probes
/// or their columns; an empty list means all.
///
/// # Errors
/// See [`SensitivityError`].
pub fn derivatives(
    source: Source<'_>,
    of: &[String],
    keys: &[String],
) -> Result<Derivatives, SensitivityError> {
    derivatives_at(source, of, keys, None, &|| true)
}

/// Computes [`derivatives`] at given times (s, ascending; by default the outputs), until `goes_on`
/// returns false. An equilibrium has one row, whatever the times.
///
/// # Errors
/// See [`SensitivityError`].
pub fn derivatives_at(
    source: Source<'_>,
    of: &[String],
    keys: &[String],
    times: Option<&[f64]>,
    goes_on: &dyn Fn() -> bool,
) -> Result<Derivatives, SensitivityError> {
    let mut problem = Problem::new(source, keys)?;
    let chosen = Chosen::new(problem.base(), of)?;
    let times = times.map_or_else(|| problem.output_times(), <[f64]>::to_vec);
    let mut found = None;
    for _ in 0..PASSES {
        let (mut rows, mut steps) = (Vec::new(), 0);
        let amplitudes = problem.follow(&times, goes_on, &mut |moment| {
            rows.push(row(&chosen, &problem, moment));
            steps = moment.steps;
        })?;
        found = Some((rows, steps));
        if !problem.adapt(&amplitudes)? {
            break;
        }
    }
    let (rows, steps) = found.unwrap_or_default();
    Ok(Derivatives {
        columns: chosen.columns,
        keys: problem.keys().to_vec(),
        rows,
        steps,
    })
}

/// Checks that a scenario has the derivatives of [`derivatives`], without computing a step.
///
/// # Errors
/// See [`SensitivityError`].
pub fn refuse_unsuitable(
    source: Source<'_>,
    of: &[String],
    keys: &[String],
) -> Result<(), SensitivityError> {
    let problem = Problem::new(source, keys)?;
    Chosen::new(problem.base(), of)?;
    problem.start().map(drop)
}

/// The values and derivatives at a moment.
fn row(chosen: &Chosen, problem: &Problem<'_>, moment: &Moment<'_>) -> Row {
    let Moment {
        sensitivity,
        steps,
        time,
    } = *moment;
    let of_key = |(index, key): (usize, &Key)| {
        let runs = problem.neighbours_of(index);
        let [plus, minus] = sensitivity.neighbours(index);
        let [plus, minus] = [
            chosen.values(&runs[0], plus, steps),
            chosen.values(&runs[1], minus, steps),
        ];
        rates(&plus, &minus, 2.0 * key.step)
    };
    Row {
        time,
        values: chosen.values(problem.base(), sensitivity.base(), steps),
        derivatives: problem.keys().iter().enumerate().map(of_key).collect(),
    }
}

impl Derivatives {
    /// Relative change of a column per relative change of a key, (p/y) dy/dp, in a row; `None` if
    /// the column is 0 or undefined.
    pub fn elasticity(&self, row: &Row, key: usize, column: usize) -> Option<f64> {
        let derivative = row.derivatives[key][column]?;
        let value = row.values[column].filter(|value| *value != 0.0)?;
        Some(self.keys[key].value / value * derivative)
    }

    /// All rows as CSV: the time, then each column and its derivatives with respect to the keys,
    /// `d_COLUMN_d_KEY`.
    pub fn to_csv(&self) -> String {
        let mut text = "time_s".to_owned();
        for column in &self.columns {
            let _ = write!(text, ",{column}");
            for key in &self.keys {
                let _ = write!(text, ",d_{column}_d_{}", key.key);
            }
        }
        text.push('\n');
        let cell = |text: &mut String, value: Option<f64>| {
            text.push(',');
            if let Some(value) = value {
                // Writing to a string cannot fail.
                let _ = write!(text, "{value:?}");
            }
        };
        for row in &self.rows {
            let _ = write!(text, "{:?}", row.time);
            for (column, value) in row.values.iter().enumerate() {
                cell(&mut text, *value);
                for of_key in &row.derivatives {
                    cell(&mut text, of_key[column]);
                }
            }
            text.push('\n');
        }
        text
    }
}
