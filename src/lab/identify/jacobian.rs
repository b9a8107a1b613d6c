//! Derivatives of predictions with respect to the coordinates of the fitted keys.

use super::error::IdentifyError;
use super::problem::Problem;

/// Source of derivatives.
pub trait Jacobian {
    /// Derivatives of all predictions, a column for each key, at `coordinates`, where the predictions are `here`.
    ///
    /// # Errors
    /// Predictions fail on both sides, or the caller asked to stop.
    fn derivatives(
        &self,
        problem: &Problem<'_>,
        coordinates: &[f64],
        here: &[f64],
    ) -> Result<Vec<Vec<f64>>, IdentifyError>;
}

/// Central differences of whole runs, which run in parallel. If a run fails on one side, for
/// example beyond a limit of a key, the difference is one-sided.
#[derive(Clone, Copy, Debug)]
pub struct CentralDifferences {
    /// Step of a coordinate. The error of the difference is of second order in this step, but the
    /// error of equilibria, about 1e-9 of the result, is divided by the step.
    pub step: f64,
}

impl Default for CentralDifferences {
    fn default() -> Self {
        Self { step: 1e-3 }
    }
}

impl Jacobian for CentralDifferences {
    fn derivatives(
        &self,
        problem: &Problem<'_>,
        coordinates: &[f64],
        here: &[f64],
    ) -> Result<Vec<Vec<f64>>, IdentifyError> {
        let count = coordinates.len();
        let shifted = |index: usize, step: f64| {
            let mut point = coordinates.to_vec();
            point[index] += step;
            point
        };
        let points: Vec<Vec<f64>> = (0..count)
            .flat_map(|index| [shifted(index, self.step), shifted(index, -self.step)])
            .collect();
        let mut sides = problem.predict(&points).into_iter();
        let mut columns = Vec::with_capacity(count);
        for _ in 0..count {
            let (above, below) = (sides.next(), sides.next());
            let (Some(above), Some(below)) = (above, below) else {
                break;
            };
            let slope = |high: &[f64], low: &[f64], width: f64| {
                let pairs = high.iter().zip(low);
                pairs.map(|(high, low)| (high - low) / width).collect()
            };
            columns.push(match (above, below) {
                (Err(IdentifyError::Interrupted), _) | (_, Err(IdentifyError::Interrupted)) => {
                    return Err(IdentifyError::Interrupted);
                }
                (Ok(above), Ok(below)) => slope(&above, &below, 2.0 * self.step),
                (Ok(above), Err(_)) => slope(&above, here, self.step),
                (Err(_), Ok(below)) => slope(here, &below, self.step),
                (Err(error), Err(_)) => return Err(error),
            });
        }
        Ok(columns)
    }
}
