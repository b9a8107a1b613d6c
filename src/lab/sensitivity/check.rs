//! Differences of whole runs, to check derivatives.
//!
//! Central differences D with steps h = 10⁻³ p and 2h are extrapolated, (4 D(h) − D(2h))/3, with
//! an error of fourth order.

use super::chosen::{Chosen, rates};
use super::error::SensitivityError;
use super::problem::{Key, Problem, Source};
use crate::run::{Mode, PreparedRun};
use rodlab_engine::mechanics::dynamics::Simulation;

/// h over the absolute value of the number.
const RELATIVE_STEP: f64 = 1e-3;
/// h over ε, for numbers that are 0.
const STEPS: f64 = 1e3;

/// Derivatives of the probes at the end of a run, from the differences of four runs for each key:
/// a list for each key.
///
/// # Errors
/// See [`SensitivityError`].
pub fn differences(
    source: Source<'_>,
    of: &[String],
    keys: &[String],
) -> Result<Vec<Vec<Option<f64>>>, SensitivityError> {
    let problem = Problem::new(source, keys)?;
    let chosen = Chosen::new(problem.base(), of)?;
    let of_key = |key: &Key| {
        let step = match key.value {
            0.0 => STEPS * key.step,
            value => RELATIVE_STEP * value.abs(),
        };
        let central = |step: f64| {
            let at = |value: f64| {
                let run = problem.run_with(&key.key, value)?;
                at_end(&problem, &chosen, &run)
            };
            let (plus, minus) = (at(key.value + step)?, at(key.value - step)?);
            Ok::<_, SensitivityError>(rates(&plus, &minus, 2.0 * step))
        };
        let (fine, coarse) = (central(step)?, central(2.0 * step)?);
        let pairs = fine.into_iter().zip(coarse);
        Ok(pairs
            .map(|(fine, coarse)| Some((4.0 * fine? - coarse?) / 3.0))
            .collect())
    };
    problem.keys().iter().map(of_key).collect()
}

/// Values at the end of a run.
fn at_end(
    problem: &Problem<'_>,
    chosen: &Chosen,
    run: &PreparedRun,
) -> Result<Vec<Option<f64>>, SensitivityError> {
    let mut simulation = Simulation::new(&run.scene, &problem.integration())?;
    let mut steps = 0;
    match run.mode {
        Mode::Dynamic { settles, .. } => {
            if settles {
                simulation.find_equilibrium()?;
            }
            for time in problem.output_times() {
                while simulation.time() < time {
                    simulation.advance(time)?;
                    steps += 1;
                }
            }
        }
        Mode::Static | Mode::Continuation(_) => {
            simulation.find_equilibrium()?;
            steps = 1;
        }
    }
    Ok(chosen.values(run, &simulation, steps))
}
