//! Finds the keys with which a scenario comes closest to exact numbers, such as a wanted shape.
//!
//! The method is that of the fit, without noise. The standard deviation is set to a fraction of
//! the root mean square of the residuals in each round, until the residuals no longer decrease.
//! Targets that the keys can reach are then met to the precision of the equilibria.

use super::error::IdentifyError;
use super::fit::{Estimate, Loss, Weighting, minimise};
use super::jacobian::Jacobian;
use super::parameter::Parameter;
use super::problem::{Experiment, Problem};
use super::statistics::{Group, statistics};

/// Standard deviation over the root mean square of the residuals.
const PART: f64 = 0.1;
/// Maximum number of rounds, and the decrease of the residuals in a round below which no other
/// follows.
const ROUNDS: usize = 12;
const DECREASE: f64 = 0.99;

/// Values of the keys that come closest.
#[derive(Clone, Debug)]
pub struct Closest {
    /// Values of the keys.
    pub values: Vec<f64>,
    /// Root mean square of the residuals at the start, and at `values`.
    pub residuals: [f64; 2],
    /// Derivatives computed.
    pub iterations: usize,
    /// Whether no step decreases the residuals any more.
    pub converged: bool,
    /// Combinations of keys that can change together without an effect: each key by its index,
    /// with its component.
    pub undetermined: Vec<Vec<(usize, f64)>>,
}

/// Finds the values of keys with which an experiment predicts its numbers best, until the root mean square of the residuals is below
/// `negligible`.
///
/// # Errors
/// A simulation fails at the start, or the caller asked to stop.
pub fn closest(
    experiment: &Experiment,
    parameters: &[Parameter],
    jacobian: &dyn Jacobian,
    negligible: f64,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Closest, IdentifyError> {
    let problem = Problem {
        experiments: std::slice::from_ref(experiment),
        parameters,
        goes_on,
        windows: 1,
    };
    let wanted: Vec<f64> = problem.data().map(|(_, datum)| datum.value).collect();
    let mut estimate = Estimate::at_start(&problem)?;
    let residual = |estimate: &Estimate| {
        let pairs = estimate.predicted.iter().zip(&wanted);
        let squares: f64 = pairs.map(|(one, other)| (one - other).powi(2)).sum();
        (squares / wanted.len() as f64).sqrt()
    };
    let start = residual(&estimate);
    let mut last = start;
    for _ in 0..ROUNDS {
        let deviations = vec![PART * last.max(negligible); wanted.len()];
        let weighting = Weighting {
            measured: &wanted,
            deviations: &deviations,
            loss: Loss::Squares,
        };
        estimate.has_converged = false;
        estimate = minimise(&problem, jacobian, &weighting, estimate, &mut |_, _| {})?;
        let now = residual(&estimate);
        let is_last = now < negligible || now > DECREASE * last;
        last = now;
        if is_last {
            break;
        }
    }
    // Without noise, a combination is undetermined only below the level of round-off.
    let deviations = vec![negligible; wanted.len()];
    let weighting = Weighting {
        measured: &wanted,
        deviations: &deviations,
        loss: Loss::Squares,
    };
    let all = Group {
        name: String::new(),
        members: (0..wanted.len()).collect(),
        pairs: Vec::new(),
        given: None,
    };
    let found = statistics(&problem, &estimate, &weighting, &[all], None);
    let directions = found.undetermined.iter();
    Ok(Closest {
        values: problem.values(&estimate.coordinates),
        residuals: [start, last],
        iterations: estimate.iterations,
        converged: estimate.has_converged,
        undetermined: directions.map(|one| one.members().collect()).collect(),
    })
}
