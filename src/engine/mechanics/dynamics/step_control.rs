//! The size of the next time step: a fixed grid of times, or steps chosen by the local error.
//!
//! With frictional contact, if a step of the grid fails, the next ones stay small and grow slowly;
//! they still end at every time of the grid. In a tangle of rods in frictional contact that slips,
//! the whole step fails many times in a row, and each failure costs more than all the small steps
//! that replace it.
//!
//! Automatic steps approach the required times in even steps: output times and events, which are
//! the corners of prescribed motions and schedules. The local error does not predict events, so
//! steps start small again after an event; otherwise a blow shorter than a step would be missed.
//! Steps of a fixed grid are cut at events and return to the grid.

use super::parameters::StepSize;
use serde::{Deserialize, Serialize};

/// A step that would end closer than this fraction of a step before a required time ends at that
/// time.
const SNAP: f64 = 1e-6;
/// Target, as a fraction of the largest step that the error estimate would allow.
const SAFETY: f64 = 0.9;
/// Smallest ratio of a step to the one before.
const DECAY: f64 = 0.2;
/// Number of iterations above which the step is considered too large for Newton's method and is
/// reduced.
const MANY_ITERATIONS: usize = 10;
/// Growth factor of a step smaller than the fixed grid's, after a successful one. Found by trial
/// in a tangle of two flagella with μ = 1, over 0.3 s: faster growth takes fewer steps but meets
/// the next failure sooner.
const RECOVERY: f64 = 1.1;
/// First automatic step, and first after an event, as a fraction of the largest: a few growths
/// reach the right scale.
const FIRST_STEP: f64 = 1e-3;
/// Lower bound of the step after an event, as a fraction of the time to the next event: closely
/// spaced corners, as of a table, are resolved by some ten steps each.
const PART_OF_SPACING: f64 = 0.1;
/// First step of a multistep scheme, as a fraction of the steps of its fixed grid: the error of
/// Euler's method, of second order in one step, is then below that of a whole step of third order.
const FIRST_PART: f64 = 1.0 / 64.0;
/// Number of steps before a required time that are made equal.
const EVEN_STEPS: f64 = 4.0;
/// An error beyond this multiple of the tolerance rejects the step.
const REJECTION: f64 = 4.0;

/// The memory of the step control; part of a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    /// Next automatic step, or next step of a fixed grid after a failure, s.
    proposal: f64,
}

/// Properties of a scheme that step control uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ErrorLaw {
    /// Power of the step to which the local error is proportional.
    pub order: i32,
    /// Largest growth of the step from one to the next.
    pub largest_growth: f64,
}

/// Decision on a solved step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decision {
    /// It is accepted.
    Accept,
    /// The step is repeated with this size, s.
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

    /// The initial state for a scheme that needs earlier steps for its order. The first steps are
    /// so small that their lower order does not matter, and grow to the whole step.
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
                // Grid times are computed as k·step: sums would drift, and a step that was cut
                // short returns to the grid.
                let done = (time / step + SNAP).floor();
                (self.goal_on_the_way(time, (done + 1.0) * step, step), step)
            }
            StepSize::Auto { maximum, .. } => {
                let step = self.proposal.min(maximum);
                // The last steps before a required time are equal. A tiny last step would be
                // followed by a much larger one, and differences over several steps would lose
                // their order.
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

    /// End of the next step from `time` towards `next`, a time of the grid of steps `whole`; equal
    /// to `next` unless steps have failed.
    fn goal_on_the_way(&self, time: f64, next: f64, whole: f64) -> f64 {
        let remaining = next - time - SNAP * whole;
        if self.proposal >= remaining {
            next
        } else if 2.0 * self.proposal >= remaining {
            // Take two equal steps rather than a tiny one at the end.
            0.5 * (time + next)
        } else {
            time + self.proposal
        }
    }

    /// Increases the steps of a fixed grid towards their whole size, after a successful one.
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

    /// Accepts or repeats an automatic step by its local error, as a multiple of the tolerance,
    /// and proposes the next.
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

    /// Restarts with a small step after an event. The step is at least the first step of a
    /// simulation whose largest step is `maximum`. It may be larger if that is `harmless`, or if
    /// the next event is closer than `maximum`; `spacing` is the time to this event. All in s.
    pub(crate) fn begin_again(&mut self, maximum: f64, harmless: f64, spacing: f64) {
        let first = FIRST_STEP * maximum;
        let dense = if spacing < maximum {
            PART_OF_SPACING * spacing
        } else {
            0.0
        };
        self.proposal = self.proposal.min(first.max(harmless).max(dense));
    }

    /// Accepts a step of the smallest size with any error, and proposes the same size again.
    pub(crate) fn accept_least(&mut self, step: f64) {
        self.proposal = step;
    }

    /// Proposes a smaller step after a failed one.
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
        // With a local error of 0.05 h², the step that meets 1e-6 is √(1e-6/0.05).
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
