//! The progress bar.

use crate::mechanics::dynamics::StepReport;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
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

/// The bars of the runs of a sweep, and what this run is called among them.
#[derive(Clone, Debug)]
pub struct AmongBars {
    /// All bars.
    pub bars: MultiProgress,
    /// Name of the run.
    pub name: String,
}

impl Progress {
    /// A bar of its own, or among those of other runs. Nothing is drawn unless `visible`, nor where standard
    /// error is no terminal.
    pub fn bar(visible: bool, among: Option<&AmongBars>) -> ProgressBar {
        let template =
            |text: &str| ProgressStyle::with_template(text).expect("the template is right");
        match among {
            _ if !visible => ProgressBar::hidden(),
            None => ProgressBar::new(LENGTH).with_style(template("{wide_bar} {msg}, {eta} left")),
            Some(among) => among.bars.add(
                ProgressBar::new(LENGTH)
                    .with_style(template("{prefix:.dim} {wide_bar} {msg}, {eta} left"))
                    .with_prefix(among.name.clone()),
            ),
        }
    }

    /// A bar that starts at the simulated time `start` and is full at `end`, both in s.
    pub fn new(bar: ProgressBar, start: f64, end: f64) -> Self {
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
