//! The progress bar.

use super::decimals::decimals;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use rodlab_engine::mechanics::dynamics::StepReport;
use rodlab_engine::mechanics::statics::PathPoint;
use std::time::{Duration, Instant};

/// Ticks of a whole bar.
const LENGTH: u64 = 10_000;

/// Time between redraws; steps are often far shorter.
const REFRESH: Duration = Duration::from_millis(100);

/// A progress bar on standard error. The bar shows the fraction of the simulated time, step size,
/// iterations, contacts and the remaining time, or the progress of a path.
pub struct Progress {
    bar: ProgressBar,
    start: f64,
    end: f64,
    drawn: Option<Instant>,
}

/// The group of bars of a sweep, and the name of this run.
#[derive(Clone, Debug)]
pub struct AmongBars {
    /// All bars.
    pub bars: MultiProgress,
    /// Name of the run.
    pub name: String,
}

impl Progress {
    /// A bar of its own, or in a group with other runs. Nothing is drawn if `visible` is false or
    /// standard error is not a terminal.
    pub fn bar(visible: bool, among: Option<&AmongBars>) -> ProgressBar {
        let template =
            |text: &str| ProgressStyle::with_template(text).expect("the template is right");
        match among {
            _ if !visible => ProgressBar::hidden(),
            None => ProgressBar::new(LENGTH).with_style(template("{wide_bar} {msg}, {eta} left")),
            Some(among) => among.bars.add(
                ProgressBar::new(LENGTH)
                    .with_style(template("{prefix:.dim} {bar:20} {wide_msg}"))
                    .with_prefix(among.name.clone()),
            ),
        }
    }

    /// A bar from `start` to `end` (simulated times in s, or parameters) at position `now`.
    pub fn new(bar: ProgressBar, now: f64, [start, end]: [f64; 2]) -> Self {
        let progress = Self {
            bar,
            start,
            end,
            drawn: None,
        };
        progress.bar.set_position(progress.position(now));
        // The progress of an earlier call must not affect the estimated speed.
        progress.bar.reset_eta();
        progress
    }

    /// Shows the step just taken.
    pub fn update(&mut self, report: &StepReport) {
        let end = self.end;
        self.show(report.time, || {
            format!(
                "{} of {} s, step {:.1e} s, {} iterations, {} contacts",
                decimals(report.time, 3),
                end,
                report.step,
                report.newton_iterations,
                report.contacts
            )
        });
    }

    /// Shows the point of a path just found, and the number of points.
    pub fn update_path(&mut self, point: &PathPoint, points: usize) {
        let end = self.end;
        self.show(point.parameter, || {
            format!(
                "branch {}, parameter {:.4} of {}, {points} points",
                point.branch, point.parameter, end
            )
        });
    }

    fn show(&mut self, now: f64, message: impl Fn() -> String) {
        if self.bar.is_hidden() || self.drawn.is_some_and(|drawn| drawn.elapsed() < REFRESH) {
            return;
        }
        self.drawn = Some(Instant::now());
        self.bar.set_position(self.position(now));
        self.bar.set_message(message());
    }

    fn position(&self, now: f64) -> u64 {
        (LENGTH as f64 * (now - self.start) / (self.end - self.start)) as u64
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
