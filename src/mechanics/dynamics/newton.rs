//! Newton's method for one implicit stage, with a line search that stays out of the way.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Stage, System};

/// When Newton's method stops.
#[derive(Clone, Copy, Debug)]
pub struct Stopping {
    /// Largest residual of a free unknown, N.
    pub force: f64,
    /// Largest correction of a position, m.
    pub displacement: f64,
    /// Most iterations.
    pub iterations: usize,
}

/// Scratch of Newton's method.
#[derive(Clone, Debug)]
pub struct Newton {
    direction: Vec<f64>,
    trial: Vec<f64>,
}

/// Reductions of the step along one direction before it is taken as it is.
const LINE_SEARCH_STEPS: usize = 12;
/// A step is accepted when the force along the direction has fallen below this fraction.
const SUFFICIENT_REDUCTION: f64 = 0.9;

impl Newton {
    /// Scratch for so many unknowns.
    pub fn new(unknowns: usize) -> Self {
        Self {
            direction: vec![0.0; unknowns],
            trial: vec![0.0; unknowns],
        }
    }

    /// Solves R(q) = 0, starting from `unknowns` and leaving the solution there; returns the number of
    /// linear solves. The frames and the residual of `system` are those of the solution.
    ///
    /// # Errors
    /// [`Divergence`] when the iterations run out or a number is not finite.
    pub fn solve(
        &mut self,
        system: &mut System,
        stage: &Stage,
        unknowns: &mut [f64],
        stopping: &Stopping,
    ) -> Result<usize, Divergence> {
        let mut last_move = 0.0;
        for iteration in 0..=stopping.iterations {
            system.linearize(unknowns, Some(stage));
            let (residual, unknown) = system.worst_residual();
            if residual <= stopping.force && last_move <= stopping.displacement {
                return Ok(iteration);
            }
            let failed = Divergence {
                iterations: iteration,
                residual,
                unknown,
            };
            if !residual.is_finite() || iteration == stopping.iterations {
                return Err(failed);
            }
            let solved = system
                .factor()
                .and_then(|_| system.direction(&mut self.direction));
            if solved.is_err() || self.direction.iter().any(|d| !d.is_finite()) {
                return Err(Divergence {
                    residual: f64::NAN,
                    ..failed
                });
            }
            let length = self.line_search(system, stage, unknowns);
            last_move = 0.0;
            for (k, (q, d)) in unknowns.iter_mut().zip(&self.direction).enumerate() {
                *q += length * d;
                if k % STRIDE != 3 {
                    last_move = f64::max(last_move, (length * d).abs());
                }
            }
        }
        unreachable!("the last iteration returns")
    }

    /// Length of the step along the Newton direction: the whole of it, unless that neither lowers the
    /// residual nor the force d·R along the direction d; then a root of d·R between the two ends is
    /// approached by regula falsi (Matthies and Strang 1979).
    fn line_search(&mut self, system: &mut System, stage: &Stage, unknowns: &[f64]) -> f64 {
        let before = system.squared_residual();
        let slope = |system: &System, direction: &[f64]| -> f64 {
            direction
                .iter()
                .zip(&system.residual)
                .map(|(d, r)| d * r)
                .sum()
        };
        let initial = slope(system, &self.direction);
        let (mut low, mut high) = ((0.0, initial), None);
        let mut length = 1.0;
        for _ in 0..LINE_SEARCH_STEPS {
            for (k, trial) in self.trial.iter_mut().enumerate() {
                *trial = unknowns[k] + length * self.direction[k];
            }
            system.evaluate(&self.trial, Some(stage));
            let after = system.squared_residual();
            let now = slope(system, &self.direction);
            if after <= before || now.abs() <= SUFFICIENT_REDUCTION * initial.abs() {
                return length;
            }
            if !now.is_finite() || now * initial < 0.0 {
                high = Some((length, now));
            } else {
                low = (length, now);
            }
            length = match high {
                Some((end, force)) if force.is_finite() => {
                    let root = low.0 + (end - low.0) * (low.1 / (low.1 - force));
                    root.clamp(low.0 + 0.1 * (end - low.0), low.0 + 0.9 * (end - low.0))
                }
                Some((end, _)) => 0.5 * (low.0 + end),
                // The force has grown without changing its sign: no root within reach, take the step.
                None => return length,
            };
        }
        length
    }
}
