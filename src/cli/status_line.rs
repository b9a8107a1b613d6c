//! The line that shows the progress of a task on the terminal.

use super::common::Common;
use indicatif::{ProgressBar, ProgressDrawTarget};
use rodlab_robot::StreamState;
use rodlab_workcell::task::{Display, LaidLength, Stage, described};
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
