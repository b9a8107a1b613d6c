//! The size of the next time step: a fixed grid of times, or steps chosen by the local error.
//!
//! Where contact is frictional and a step of the grid fails, the next ones stay small, grow slowly, and still hit every time
//! of the grid. A tangle of rods in frictional contact that slips fails at the whole step many times in a row, and each
//! failure costs more than all the small steps in its place.
//!
//! Automatic steps lead evenly to the times that are wanted: those of outputs and of events, which are the corners of what
//! is prescribed. The local error does not predict events, so after an event steps begin small again; otherwise a
//! blow shorter than a step would be missed. Steps of a fixed grid are cut at events, and return to the grid.

use super::parameters::StepSize;
use serde::{Deserialize, Serialize};

/// Steps that end closer than this fraction of a step before a wanted time end at that time.
const SNAP: f64 = 1e-6;
/// Aimed-at fraction of the largest step that the error estimate would allow.
const SAFETY: f64 = 0.9;
/// Largest decay of the step from one to the next.
const DECAY: f64 = 0.2;
/// Iterations above which a step is thought too large for Newton's method, and shrinks.
const MANY_ITERATIONS: usize = 10;
/// Growth of a step below that of the fixed grid, after one that succeeded. Chosen by trial in a tangle of two flagella
/// with μ = 1, over 0.3 s: faster growth takes fewer steps and meets the next failure sooner.
const RECOVERY: f64 = 1.1;
/// First automatic step, and first after an event, as a part of the largest: the true scale is found within a few growths.
const FIRST_STEP: f64 = 1e-3;
/// Lower bound, as a part of the time to the next event: many corners close to each other, as of a table, are resolved
/// by some ten steps from one to the next.
const PART_OF_SPACING: f64 = 0.1;
/// First step of a scheme of several steps, as a part of those of its fixed grid: Euler's error, of second order in one
/// step, is then below the third order's of a whole step.
const FIRST_PART: f64 = 1.0 / 64.0;
/// Steps before a wanted time that are made even.
const EVEN_STEPS: f64 = 4.0;
/// An error beyond this multiple of the tolerance rejects the step.
const REJECTION: f64 = 4.0;

/// The memory of the step control; part of a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    /// Next step of automatic control, or of a fixed grid where steps have failed, s.
    proposal: f64,
}

/// Properties of a scheme that step control uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ErrorLaw {
    /// Power of the step with which the local error falls.
    pub order: i32,
    /// Largest growth of the step from one to the next.
    pub largest_growth: f64,
}

/// Decision on a solved step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decision {
    /// It is accepted.
    Accept,
    /// It is repeated with this size, s.
    Repeat(f64),
}

impl StepControl {
    /// Starts at time zero.
    pub(crate) fn new(size: &StepSize) -> Self {
        let proposal = match *size {
            StepSize::Fixed(step) => step,
            StepSize::Auto { maximum, .. } => FIRST_STEP * maximum,
        };
        Self { proposal }
    }

    /// The same for a scheme that needs earlier steps for its order: the first ones are so small that their lower order
    /// does not show, and grow to the whole step.
    pub(crate) fn beginning_small(size: &StepSize) -> Self {
        let whole = Self::new(size);
        match size {
            StepSize::Fixed(step) => Self {
                proposal: FIRST_PART * step,
            },
            StepSize::Auto { .. } => whole,
        }
    }

    /// End of the next step from `time`, no later than `until`.
    pub(crate) fn goal(&self, size: &StepSize, time: f64, until: f64) -> f64 {
        let (goal, step) = match *size {
            StepSize::Fixed(step) => {
                // Times k·step as products: sums would drift, and a step cut short returns to the grid.
                let done = (time / step + SNAP).floor();
                (self.goal_on_the_way(time, (done + 1.0) * step, step), step)
            }
            StepSize::Auto { maximum, .. } => {
                let step = self.proposal.min(maximum);
                // The last steps before a wanted time are even: a tiny one at the end would be followed by one so much
                // larger that differences over several steps lose their order.
                let remaining = until - time;
                if remaining < EVEN_STEPS * step {
                    let steps = (remaining / step - SNAP).ceil().max(1.0);
                    (time + remaining / steps, step)
                } else {
                    (time + step, step)
                }
            }
        };
        if goal >= until - SNAP * step {
            until
        } else {
            goal
        }
    }

    /// End of the next step from `time` towards `next`, a time of the grid of steps `whole`: all the way, unless
    /// steps have failed.
    fn goal_on_the_way(&self, time: f64, next: f64, whole: f64) -> f64 {
        let remaining = next - time - SNAP * whole;
        if self.proposal >= remaining {
            next
        } else if 2.0 * self.proposal >= remaining {
            // Two equal steps rather than a tiny one at the end.
            0.5 * (time + next)
        } else {
            time + self.proposal
        }
    }

    /// Increases the steps of a fixed grid towards their whole size, after one that succeeded.
    pub(crate) fn recover(&mut self, whole: f64) {
        self.proposal = whole.min(RECOVERY * self.proposal);
    }

    /// The size of a step to report: that of the grid for a whole step, free of the rounding of times.
    pub(crate) fn size(&self, size: &StepSize, step: f64) -> f64 {
        match *size {
            StepSize::Fixed(whole) if (step - whole).abs() <= SNAP * whole => whole,
            _ => step,
        }
    }

    /// Decides on a step of automatic control by its local error as a multiple of the tolerance, and proposes the next.
    pub(crate) fn decide(
        &mut self,
        step: f64,
        error: f64,
        law: ErrorLaw,
        iterations: usize,
    ) -> Decision {
        let ratio = libm::pow(error.max(1e-300), -1.0 / f64::from(law.order));
        let mut factor = (SAFETY * ratio).clamp(DECAY, law.largest_growth);
        if iterations > MANY_ITERATIONS {
            factor = factor.min(0.7);
        }
        if error > REJECTION {
            self.proposal = step * factor.min(0.7);
            return Decision::Repeat(self.proposal);
        }
        // A step cut short by an output time does not invalidate the earlier proposal.
        self.proposal = if step < 0.99 * self.proposal && factor >= 1.0 {
            self.proposal
        } else {
            step * factor
        };
        Decision::Accept
    }

    /// Begins small after an event: with the first step of a simulation whose largest is `maximum`, unless a larger one is
    /// `harmless`, or the next event is as near as `spacing`, all in s.
    pub(crate) fn begin_again(&mut self, maximum: f64, harmless: f64, spacing: f64) {
        let first = FIRST_STEP * maximum;
        let dense = if spacing < maximum {
            PART_OF_SPACING * spacing
        } else {
            0.0
        };
        self.proposal = self.proposal.min(first.max(harmless).max(dense));
    }

    /// Accepts a step that may not be smaller, with any error, and proposes the same again.
    pub(crate) fn accept_least(&mut self, step: f64) {
        self.proposal = step;
    }

    /// A failed step proposes a smaller one.
    pub(crate) fn failed(&mut self, step: f64) {
        self.proposal = self.proposal.min(step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fixed_grid_hits_output_times_and_returns_to_the_grid() {
        let size = StepSize::Fixed(0.3);
        let control = StepControl::new(&size);
        let mut time = 0.0;
        let mut ends = Vec::new();
        for until in [1.0, 2.0] {
            while time < until {
                time = control.goal(&size, time, until);
                ends.push(time);
            }
        }
        let expected = [0.3, 0.6, 0.9, 1.0, 1.2, 1.5, 1.8, 2.0];
        assert_eq!(ends.len(), expected.len());
        for (end, expected) in ends.iter().zip(expected) {
            assert!((end - expected).abs() < 1e-12);
        }
        assert_eq!((ends[3], ends[7]), (1.0, 2.0));
    }

    #[test]
    fn automatic_steps_lead_evenly_to_a_wanted_time() {
        let size = StepSize::Auto {
            tolerance: 1e-2,
            maximum: 1.0,
        };
        let control = StepControl { proposal: 0.3 };
        let (mut time, mut steps) = (0.0, Vec::new());
        for until in [2.0, 4.0] {
            while time < until {
                let goal = control.goal(&size, time, until);
                steps.push(goal - time);
                time = goal;
            }
            assert_eq!(time, until);
        }
        let least = (EVEN_STEPS - 1.0) / EVEN_STEPS * 0.3;
        assert!(
            steps.iter().all(|&step| step > least && step < 0.3 + 1e-12),
            "{steps:?}"
        );
    }

    #[test]
    fn failed_steps_of_a_fixed_grid_stay_small_and_recover_on_the_grid() {
        let size = StepSize::Fixed(1.0);
        let mut control = StepControl::new(&size);
        control.failed(0.25);
        let (mut time, mut steps) = (3.0, Vec::new());
        while time < 10.0 {
            let goal = control.goal(&size, time, 10.0);
            steps.push((time, goal - time));
            time = goal;
            control.recover(1.0);
        }
        for whole in 3..10 {
            let on_the_grid = |&&(start, _): &&(f64, f64)| start == f64::from(whole);
            assert!(steps.iter().any(|step| on_the_grid(&step)), "{steps:?}");
        }
        assert_eq!(steps[0].1, 0.25);
        assert!(
            steps.iter().all(|(_, step)| *step > 0.2 && *step <= 1.0),
            "no step is tiny: {steps:?}"
        );
        assert_eq!(steps.last().unwrap().1, 1.0);
    }

    #[test]
    fn a_step_with_too_large_an_error_is_repeated() {
        let law = ErrorLaw {
            order: 2,
            largest_growth: 1.5,
        };
        let mut control = StepControl { proposal: 0.1 };
        let Decision::Repeat(smaller) = control.decide(0.1, 1.01 * REJECTION, law, 2) else {
            panic!("an error of four tolerances is accepted");
        };
        assert!(smaller < 0.07 && smaller > 0.01, "{smaller}");
        assert_eq!(
            control.decide(0.1, 0.99 * REJECTION, law, 2),
            Decision::Accept
        );
        assert!(control.proposal < 0.1, "the next step is smaller");
    }

    #[test]
    fn steps_begin_small_after_an_event_unless_they_need_not() {
        let after = |harmless: f64, spacing: f64| {
            let mut control = StepControl { proposal: 0.5 };
            control.begin_again(1.0, harmless, spacing);
            control.proposal
        };
        assert_eq!(after(0.0, f64::INFINITY), FIRST_STEP);
        assert_eq!(after(0.02, f64::INFINITY), 0.02);
        assert_eq!(after(7.0, f64::INFINITY), 0.5);
        assert_eq!(after(0.0, 0.4), 0.1 * 0.4);
    }

    #[test]
    fn automatic_steps_follow_the_error() {
        let size = StepSize::Auto {
            tolerance: 1e-2,
            maximum: 1.0,
        };
        let mut control = StepControl::new(&size);
        let law = ErrorLaw {
            order: 2,
            largest_growth: 1.5,
        };
        // Local error 0.05 h²: the step that meets 1e-6 is √(1e-6/0.05).
        let (tolerance, mut step) = (1e-6, 1e-3);
        for _ in 0..60 {
            match control.decide(step, 0.05 * step * step / tolerance, law, 2) {
                Decision::Accept => step = control.goal(&size, 0.0, 10.0),
                Decision::Repeat(smaller) => step = smaller,
            }
        }
        let ideal = (tolerance / 0.05_f64).sqrt();
        assert!(step < ideal && step > 0.7 * ideal, "{step} against {ideal}");
    }
}
