//! The clock of a motion: ours, or that of the robot where it keeps one.
//!
//! A simulated robot tells its own time (in ROS on the topic `/clock`): it may be faster than real time, or slower where it
//! cannot keep up, and what it should do when counts by that.

use super::Part;
use std::time::{Duration, Instant};

/// Most that a clock is taken to hasten: beyond it, it jumps.
const MOST_HASTE: f64 = 100.0;

/// Time of ours over which its haste is told at least, s: less would tell that of single messages.
const HASTE_OVER: f64 = 0.1;

/// Time since the start of a motion.
pub(super) struct MotionClock {
    start: Instant,
    /// The part whose clock counts, and its time at the start, s.
    robot: Option<(usize, f64)>,
    /// See [`MotionClock::haste`].
    haste: f64,
}

impl MotionClock {
    /// The clock of parts that are about to begin.
    ///
    /// # Errors
    /// A connection is lost.
    pub(super) fn of(parts: &mut [Part]) -> Result<Self, String> {
        let clocked = parts.iter_mut();
        for part in clocked.filter(|part| part.driver.clock().is_some()) {
            let heard = part.driver.state();
            heard.map_err(|error| format!("{}: {error}", part.name))?;
        }
        let clocks = parts.iter().enumerate();
        let mut clocks = clocks.filter_map(|(part, known)| Some((part, known.driver.clock()?.0)));
        Ok(Self {
            start: Instant::now(),
            robot: clocks.next(),
            haste: 1.0,
        })
    }

    /// They have been told to begin. A robot's own clock counts from before: it has begun a little later then, and never earlier.
    pub(super) fn set_off(&mut self) {
        self.start = Instant::now();
    }

    /// Time since the start, s.
    pub(super) fn elapsed(&mut self, parts: &[Part]) -> f64 {
        let robot = self
            .robot
            .and_then(|(part, began)| Some(parts[part].driver.clock()?.0 - began));
        let elapsed = robot.unwrap_or_else(|| self.start.elapsed().as_secs_f64());
        self.hasten(elapsed);
        elapsed
    }

    /// When, s after the start, what a part said last was so; `silence` is how long ago that was on our clock.
    pub(super) fn heard(&mut self, part: &Part, silence: Duration) -> f64 {
        let robot = self.robot.zip(part.driver.clock());
        // What comes with the time of the robot's clock is as old as that.
        let heard = match robot {
            Some(((_, began), (time, _))) => time - began,
            None => self.start.elapsed().as_secs_f64() - silence.as_secs_f64(),
        };
        self.hasten(heard);
        heard
    }

    /// Notes how fast the clock has been until it was so late, s after the start.
    fn hasten(&mut self, time: f64) {
        let ours = self.start.elapsed().as_secs_f64();
        self.haste = self.haste.max(time / ours.max(HASTE_OVER)).min(MOST_HASTE);
    }

    /// How many times as fast as ours the clock has been on the way, at most, and never below 1: what takes us a moment is
    /// longer on a fast one. One that was fast at the start, when the robot was told to begin, may become slow later.
    pub(super) fn haste(&self) -> f64 {
        self.haste
    }
}
