//! A stepper motor on a microcontroller, over a serial line that may corrupt, lose and repeat
//! bytes.
//!
//! Firmware: `scripts/firmware/stepper.c`. The host sends requests and the microcontroller
//! answers, in frames (`frame`) with a sequence number. One request at a time is outstanding, and
//! is resent until acknowledged (`line`). The motor executes a queue of moves, each a number of
//! steps in a number of microseconds; if no valid frame arrives for 300 ms while it moves, it
//! stops and rejects moves until the host sends a new hello.

mod frame;
#[cfg(test)]
mod hostile_tests;
mod line;

pub use line::{
    Acknowledgement as StepperAnswer, Link as StepperLink, Request as StepperRequest, SerialLine,
};

use super::{Driver, DriverError, Interpolant, JointState, Progress};
use line::{Acknowledgement, Link, Request};
use std::f64::consts::TAU;
use std::time::{Duration, Instant};

/// Duration of a move, s.
const MOVE: f64 = 0.02;
/// Time by which moves are sent in advance, s: the largest allowed delay of the line.
const AHEAD: f64 = 0.12;
/// Time between position requests at rest.
const STATUS_INTERVAL: Duration = Duration::from_millis(20);

/// A stepper motor as an axis.
pub struct StepperDriver {
    open: Box<dyn FnMut() -> std::io::Result<Box<dyn SerialLine>> + Send>,
    place: String,
    radians_per_step: f64,
    link: Option<Link>,
    /// Angle at the zero of the motor's step count, rad.
    zero: f64,
    /// Last reported count of the motor.
    position: i64,
    state: Option<JointState>,
    motion: Option<Motion>,
    asked: Instant,
}

struct Motion {
    path: Interpolant,
    /// Time up to which moves have been sent, s.
    sent: f64,
    /// Step count of the motor at that time.
    steps: i64,
}

impl StepperDriver {
    /// A motor at a serial port, with its number of steps per turn.
    pub fn new(port: &str, baud: u32, steps_per_turn: u32) -> Self {
        let path = port.to_owned();
        let open = move || -> std::io::Result<Box<dyn SerialLine>> {
            let port = serialport::new(path.as_str(), baud).timeout(Duration::from_millis(1));
            Ok(Box::new(port.open().map_err(std::io::Error::other)?))
        };
        Self::over(Box::new(open), port, steps_per_turn)
    }

    /// A motor at the other end of any line.
    pub fn over(
        open: Box<dyn FnMut() -> std::io::Result<Box<dyn SerialLine>> + Send>,
        place: &str,
        steps_per_turn: u32,
    ) -> Self {
        Self {
            open,
            place: place.to_owned(),
            radians_per_step: TAU / f64::from(steps_per_turn),
            link: None,
            zero: 0.0,
            position: 0,
            state: None,
            motion: None,
            asked: Instant::now(),
        }
    }

    fn lost(&self, reason: impl std::fmt::Display) -> DriverError {
        DriverError::Lost(format!("stepper at {}: {reason}", self.place))
    }

    fn ask(&mut self, request: Request) -> Result<Acknowledgement, DriverError> {
        let Some(link) = &mut self.link else {
            return Err(self.lost("not connected"));
        };
        let answer = link.ask(request).map_err(|error| self.lost(error))?;
        self.asked = Instant::now();
        self.position = i64::from(answer.position);
        self.state = Some(JointState {
            received: self.asked,
            stamp: None,
            positions: vec![self.zero + f64::from(answer.position) * self.radians_per_step],
            efforts: Vec::new(),
        });
        if answer.watchdog {
            return Err(DriverError::Aborted(format!(
                "stepper at {}: its watchdog stopped the motor: no valid frame arrived for 300 ms",
                self.place
            )));
        }
        Ok(answer)
    }

    /// Sends the moves that are due.
    fn feed(&mut self, elapsed: f64) -> Result<(), DriverError> {
        while let Some(mut motion) = self.motion.take() {
            let duration = motion.path.duration();
            if motion.sent >= elapsed + AHEAD || motion.sent >= duration {
                self.motion = Some(motion);
                break;
            }
            let next = (motion.sent + MOVE).min(duration);
            let angle = motion.path.at(next)[0];
            let target = ((angle - self.zero) / self.radians_per_step).round() as i64;
            let request = Request::Move {
                steps: (target - motion.steps) as i32,
                microseconds: ((next - motion.sent) * 1e6).round() as u32,
            };
            let answer = self.ask(request);
            let accepted = matches!(&answer, Ok(answer) if !answer.full);
            if accepted {
                motion.sent = next;
                motion.steps = target;
            }
            self.motion = Some(motion);
            if answer?.full {
                break;
            }
        }
        Ok(())
    }
}

impl Driver for StepperDriver {
    fn connect(&mut self, _: &[String]) -> Result<(), DriverError> {
        let line = (self.open)().map_err(|error| {
            self.lost(format_args!(
                "{error}; is the device connected, and does this user have access to it?"
            ))
        })?;
        self.link = Some(Link::new(line));
        self.ask(Request::Hello)?;
        Ok(())
    }

    fn reports_state(&self) -> bool {
        true
    }

    fn knows_position(&self) -> bool {
        false
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        if self.asked.elapsed() > STATUS_INTERVAL {
            self.ask(Request::Status)?;
        }
        Ok(self.state.clone())
    }

    /// The motor has no absolute sensor, so that its present position is taken as the first point.
    /// Nothing is sent before the first [`Driver::advance`], so that the other parts of a stream,
    /// which start at once, do not wait for the line.
    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        if self.link.is_none() {
            return Err(self.lost("not connected"));
        }
        self.zero = motion.first()[0] - self.position as f64 * self.radians_per_step;
        self.state = Some(JointState {
            received: self.asked,
            stamp: None,
            positions: motion.first().to_vec(),
            efforts: Vec::new(),
        });
        self.motion = Some(Motion {
            path: motion.clone(),
            sent: 0.0,
            steps: self.position,
        });
        Ok(())
    }

    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError> {
        self.feed(elapsed)?;
        let Some(motion) = &self.motion else {
            return Ok(Progress::Done);
        };
        let (all_sent, target) = (motion.sent >= motion.path.duration(), motion.steps);
        if !all_sent || self.asked.elapsed() < STATUS_INTERVAL / 2 {
            return Ok(Progress::Running);
        }
        let answer = self.ask(Request::Status)?;
        Ok(Progress::over(i64::from(answer.position) == target))
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        self.motion = None;
        if self.link.is_none() {
            return Ok(());
        }
        match self.ask(Request::Hold) {
            // The watchdog of the motor has stopped it.
            Ok(_) | Err(DriverError::Aborted(_)) => Ok(()),
            Err(error) => Err(error),
        }
    }
}
