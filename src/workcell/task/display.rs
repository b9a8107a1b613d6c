//! Display of the progress of a task.

use super::stage::Stage;
use super::stopped::LaidLength;
use rodlab_robot::StreamState;
use std::path::Path;

/// Shows the progress of a task.
pub trait Display {
    /// A step begins: its number, from one, of a number of steps.
    fn step(&self, number: usize, of: usize, stage: &Stage);

    /// The state of a motion, five times per second, with the laid part of the rod if the motion
    /// lays one.
    fn motion(&self, state: &StreamState, laid: Option<LaidLength>);

    /// The last reported positions of the joints of an arm, rad or m; called in every cycle of a
    /// motion.
    fn joints(&self, _arm: &str, _joints: &[f64]) {}

    /// A file of the results was written.
    fn wrote(&self, _file: &Path) {}
}

/// Shows everything on several displays.
pub struct Displays<'a>(pub Vec<&'a dyn Display>);

impl Display for Displays<'_> {
    fn step(&self, number: usize, of: usize, stage: &Stage) {
        self.0.iter().for_each(|one| one.step(number, of, stage));
    }

    fn motion(&self, state: &StreamState, laid: Option<LaidLength>) {
        self.0.iter().for_each(|one| one.motion(state, laid));
    }

    fn joints(&self, arm: &str, joints: &[f64]) {
        self.0.iter().for_each(|one| one.joints(arm, joints));
    }

    fn wrote(&self, file: &Path) {
        self.0.iter().for_each(|one| one.wrote(file));
    }
}

/// Shows nothing.
pub struct Hidden;

impl Display for Hidden {
    fn step(&self, _: usize, _: usize, _: &Stage) {}

    fn motion(&self, _: &StreamState, _: Option<LaidLength>) {}
}
