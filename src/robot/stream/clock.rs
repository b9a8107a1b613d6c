//! The clock of a motion: that of this machine, or that of the robot if it has one.
//!
//! A simulated robot publishes its own time (in ROS on the topic `/clock`), which may be faster or
//! slower than real time. The trajectory follows this clock.

use super::Part;
use super::follow::LATENESS;
use super::timer::Timer;
use crate::driver::JointState;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Largest clock rate relative to real time; faster changes count as a jump.
const FASTEST: f64 = 100.0;
/// Largest clock rate relative to its greatest rate so far.
const FASTER: f64 = 4.0;
/// Longest jump of a clock that may be caused by late messages, s.
const JUMP: f64 = 2.0;
/// Machine time after which a jump that persists is an error.
const LONGEST_JUMP: Duration = Duration::from_millis(300);
/// Machine time over which the rate of a clock is measured.
const RATE_WINDOW: Duration = Duration::from_millis(100);
/// Machine time for which a measured rate is valid.
const RATE_MEMORY: Duration = Duration::from_secs(1);

/// Time since the start of a motion.
pub(super) struct MotionClock {
    start: Instant,
    robot: Option<RobotClock>,
}

/// The clock of a robot.
struct RobotClock {
    /// The part whose clock is used.
    part: usize,
    /// Time of the clock at the start, s.
    began: f64,
    /// Machine time and clock time, s, of the start.
    first: (Instant, f64),
    /// Last time without a jump, s, and its time of reception.
    last: (f64, Instant),
    /// Time of the last jump, if the clock has not returned since.
    jumped: Option<Instant>,
    /// Recent pairs of machine time and clock time, s.
    kept: VecDeque<(Instant, f64)>,
    /// Recent rates and the times of their measurement.
    rates: VecDeque<(Instant, f64)>,
    greatest_rate: f64,
}

impl MotionClock {
    /// The clock of parts that are about to start.
    pub(super) fn of(parts: &[Part], timer: &dyn Timer) -> Self {
        let clocks = parts.iter().enumerate();
        let mut clocks = clocks.filter_map(|(part, known)| Some((part, known.driver.clock()?)));
        Self {
            start: timer.now(),
            robot: clocks.next().map(|(part, (began, received))| RobotClock {
                part,
                began,
                first: (received, began),
                last: (began, received),
                jumped: None,
                kept: VecDeque::from([(received, began)]),
                rates: VecDeque::new(),
                greatest_rate: 1.0,
            }),
        }
    }

    /// Records that the parts have been started. A robot's clock has started before, so that the
    /// motion starts slightly late but never early.
    pub(super) fn set_off(&mut self, timer: &dyn Timer) {
        self.start = timer.now();
    }

    /// Reads the clocks.
    ///
    /// # Errors
    /// The clock of the robot has jumped.
    pub(super) fn read(&mut self, parts: &[Part]) -> Result<(), String> {
        let Some(robot) = &mut self.robot else {
            return Ok(());
        };
        let part = &parts[robot.part];
        let Some((time, received)) = part.driver.clock() else {
            return Ok(());
        };
        robot
            .read(time, received)
            .map_err(|reason| format!("{}: {reason}", part.name))
    }

    /// Time since the start, s.
    pub(super) fn elapsed(&self, timer: &dyn Timer) -> f64 {
        match &self.robot {
            Some(robot) => robot.since_start(timer.now()),
            None => timer.now().duration_since(self.start).as_secs_f64(),
        }
    }

    /// Time since the start for which a report is valid, s: the time of reception, or the stamp on
    /// the clock of a robot. Reports and clock times arrive over different connections, so that
    /// the stamp may differ from the last clock time. A stamp that differs by more than the
    /// allowed lag belongs to another clock.
    pub(super) fn time_of(&self, report: &JointState) -> f64 {
        let Some(robot) = &self.robot else {
            return match report.received.checked_duration_since(self.start) {
                Some(since) => since.as_secs_f64(),
                None => -self.start.duration_since(report.received).as_secs_f64(),
            };
        };
        let heard = robot.since_start(report.received);
        let stamped = report.stamp.map(|stamp| stamp - robot.began);
        let is_near = |stamped: &f64| (stamped - heard).abs() <= LATENESS * self.rate();
        stamped.filter(is_near).unwrap_or(heard)
    }

    /// Largest recent rate of the clock relative to real time, at least 1. Processing delays are
    /// longer on a fast clock.
    pub(super) fn rate(&self) -> f64 {
        let Some(robot) = &self.robot else { return 1.0 };
        robot
            .rates
            .iter()
            .fold(1.0, |most, (_, rate)| rate.max(most))
    }

    /// The greatest [rate](Self::rate) since the start.
    pub(super) fn greatest_rate(&self) -> f64 {
        self.robot.as_ref().map_or(1.0, |robot| robot.greatest_rate)
    }
}

impl RobotClock {
    /// Time since the start, s. After a jump the clock is assumed to continue at its previous rate.
    fn since_start(&self, now: Instant) -> f64 {
        let known = self.last.0 - self.began;
        let rate = self.rates.back().map_or(1.0, |(_, rate)| *rate);
        match self.jumped {
            None => known,
            Some(_) => known + rate * now.saturating_duration_since(self.last.1).as_secs_f64(),
        }
    }

    fn read(&mut self, time: f64, received: Instant) -> Result<(), String> {
        let since = received.saturating_duration_since(self.last.1);
        let by = time - self.last.0;
        let most = JUMP + FASTER * self.greatest_rate * since.as_secs_f64();
        // A time that is not a number counts as a jump, too.
        if !(by >= 0.0 && by <= most) {
            let jumped = *self.jumped.get_or_insert(received);
            if received.saturating_duration_since(jumped) > LONGEST_JUMP {
                return Err(format!("the clock of the robot has jumped by {by:.3} s"));
            }
            return Ok(());
        }
        self.jumped = None;
        if by == 0.0 {
            return Ok(());
        }
        self.last = (time, received);
        self.kept.push_back((received, time));
        while self.kept.len() > 2 && received.duration_since(self.kept[1].0) > RATE_WINDOW {
            self.kept.pop_front();
        }
        // Consider recent rates and the rate since the start, since a clock that sometimes waits
        // for a busy machine is fast in between.
        let over = |since: (Instant, f64)| {
            let span = received.saturating_duration_since(since.0).max(RATE_WINDOW);
            (time - since.1) / span.as_secs_f64()
        };
        let rate = over(self.kept[0]).max(over(self.first)).min(FASTEST);
        self.greatest_rate = self.greatest_rate.max(rate);
        self.rates.push_back((received, rate));
        while received.duration_since(self.rates[0].0) > RATE_MEMORY {
            self.rates.pop_front();
        }
        Ok(())
    }
}
