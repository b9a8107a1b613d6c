//! The progress bar.

use crate::mechanics::dynamics::StepReport;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Ticks of a whole bar.
const LENGTH: u64 = 10_000;

/// Time between redraws; steps are often far shorter.
const REFRESH: Duration = Duration::from_millis(100);

/// A bar on standard error: simulated time of the end, step size, iterations, contacts, time left.
pub(super) struct Progress {
    bar: ProgressBar,
    end: f64,
    drawn: Option<Instant>,
}

impl Progress {
    /// A bar that starts at the simulated time `start` and is full at `end`, both in s.
    ///
    /// Nothing is drawn unless `visible`, nor where standard error is no terminal.
    pub fn new(visible: bool, start: f64, end: f64) -> Self {
        let bar = if visible {
            ProgressBar::new(LENGTH)
        } else {
            ProgressBar::hidden()
        };
        let style = ProgressStyle::with_template("{wide_bar} {msg}, {eta} left")
            .expect("the template is right");
        bar.set_style(style);
        let progress = Self {
            bar,
            end,
            drawn: None,
        };
        progress.bar.set_position(progress.position(start));
        // What an earlier call has done says nothing about the speed of this one.
        progress.bar.reset_eta();
        progress
    }

    /// Shows the step just taken.
    pub fn update(&mut self, report: &StepReport) {
        if self.bar.is_hidden() || self.drawn.is_some_and(|drawn| drawn.elapsed() < REFRESH) {
            return;
        }
        self.drawn = Some(Instant::now());
        self.bar.set_position(self.position(report.time));
        self.bar.set_message(format!(
            "{:.3} of {} s, step {:.1e} s, {} iterations, {} contacts",
            report.time, self.end, report.step, report.newton_iterations, report.contacts
        ));
    }

    fn position(&self, time: f64) -> u64 {
        (LENGTH as f64 * time / self.end) as u64
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
