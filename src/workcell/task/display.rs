//! Display of the progress of a task.

use super::stage::Stage;
use super::stopped::LaidLength;
use rodlab_robot::StreamState;

/// Shows the progress of a task.
pub trait Display {
    /// A step begins: its number, from one, of a number of steps.
    fn step(&self, number: usize, of: usize, stage: &Stage);

    /// The state of a motion, five times per second, with the laid part of the rod if the motion
    /// lays one.
    fn motion(&self, state: &StreamState, laid: Option<LaidLength>);
}

/// Shows nothing.
pub struct Hidden;

impl Display for Hidden {
    fn step(&self, _: usize, _: usize, _: &Stage) {}

    fn motion(&self, _: &StreamState, _: Option<LaidLength>) {}
}
