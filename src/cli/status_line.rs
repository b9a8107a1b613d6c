//! The line that shows the progress of a task on the terminal.

use super::common::Common;
use indicatif::{ProgressBar, ProgressDrawTarget};
use rodlab_robot::StreamState;
use rodlab_workcell::task::{Display, LaidLength, Stage};
use std::cell::RefCell;

/// Updates per second.
const RATE: u8 = 5;

/// Shows step, time, laid length and tracking error on standard error, if it is a terminal.
pub struct StatusLine {
    line: ProgressBar,
    step: RefCell<String>,
}

impl StatusLine {
    /// The line of a task; hidden with `--quiet`.
    pub fn new(common: &Common) -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(RATE);
        let line = ProgressBar::with_draw_target(None, target);
        Self {
            line: common.progress(line, "{msg}"),
            step: RefCell::default(),
        }
    }
}

impl Drop for StatusLine {
    fn drop(&mut self) {
        self.line.finish_and_clear();
    }
}

impl Display for StatusLine {
    fn step(&self, number: usize, of: usize, stage: &Stage) {
        let words = format!("{number} of {of}: {}", stage.words);
        self.line.set_message(words.clone());
        self.step.replace(words);
    }

    fn motion(&self, state: &StreamState, laid: Option<LaidLength>) {
        let state = described(state, laid);
        self.line
            .set_message(format!("{}, {state}", self.step.borrow()));
    }
}

/// The state of a motion as text.
fn described(state: &StreamState, laid: Option<LaidLength>) -> String {
    let mut words = format!("{:.1} of {:.1} s", state.time, state.duration);
    match state.pace {
        Some(pace) if pace < 1e-3 => words += ", held",
        Some(pace) if pace < 0.999 => words += &format!(" at {:.0} %", 1e2 * pace),
        _ => {}
    }
    if let Some(LaidLength {
        laid_m: Some(laid),
        path_m,
    }) = laid
    {
        words += &format!(", {:.1} of {:.1} cm laid", 1e2 * laid, 1e2 * path_m);
    }
    let off = state.tracking;
    if off.revolute > 0.0 {
        words += &format!(", joints {:.2}°", off.revolute.to_degrees());
    }
    if off.prismatic > 0.0 {
        words += &format!(", slides {:.2} mm", 1e3 * off.prismatic);
    }
    if off.revolute > 0.0 || off.prismatic > 0.0 {
        words += " off";
    }
    if state.lag >= 0.1 {
        words += &format!(", {:.1} s late", state.lag);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_robot::Tolerance;

    #[test]
    fn a_motion_is_described_by_its_time_length_and_tracking() {
        let mut state = StreamState {
            time: 12.34,
            lag: 0.0,
            duration: 40.0,
            tracking: Tolerance::default(),
            pace: None,
        };
        assert_eq!(described(&state, None), "12.3 of 40.0 s");
        let laid = Some(LaidLength {
            laid_m: Some(0.312),
            path_m: 0.654,
        });
        state.tracking.revolute = 0.01;
        state.lag = 0.42;
        assert_eq!(
            described(&state, laid),
            "12.3 of 40.0 s, 31.2 of 65.4 cm laid, joints 0.57° off, 0.4 s late"
        );
        state.pace = Some(0.5);
        let words = described(&state, None);
        assert!(
            words.starts_with("12.3 of 40.0 s at 50 %, joints"),
            "{words}"
        );
        state.pace = Some(0.0);
        let words = described(&state, None);
        assert!(words.starts_with("12.3 of 40.0 s, held, joints"), "{words}");
        state.tracking.prismatic = 2e-4;
        let words = described(&state, None);
        assert!(
            words.contains("joints 0.57°, slides 0.20 mm off"),
            "{words}"
        );
    }
}
