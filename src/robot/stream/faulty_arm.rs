//! An arm with a fault in simulated time, and the driver of its connection, for tests.

use super::*;
use std::sync::{Arc, Mutex, MutexGuard};

/// A simulated time source: a sleep advances its time.
#[derive(Clone)]
pub(super) struct Simulated(pub(super) Arc<Mutex<Instant>>);

impl Timer for Simulated {
    fn now(&self) -> Instant {
        *self.0.lock().unwrap()
    }

    fn sleep(&self, time: Duration) {
        *self.0.lock().unwrap() += time;
    }
}

/// Fault of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fault {
    None,
    /// The reports of the arm end.
    Silence,
    /// The joints stop, and reports continue.
    DrivesOff,
    /// One joint stops.
    FrozenJoint,
    /// One joint jumps to another position.
    Jump,
    /// One joint reports NaN.
    NotANumber,
    /// The server reports success, and the joints stop.
    FalseEnd,
    /// The server reports success, and the joints keep moving.
    EarlyEnd,
    /// The server aborts the motion, and the joints keep moving.
    FalseAbort,
    /// The server aborts the motion, and the joints stop.
    Abort,
    /// The connection is lost, and the joints keep moving.
    Lost,
    /// The connection is lost permanently.
    Gone,
    /// The server confirms requests to stop, but the joints keep moving. The user interrupts.
    DeafServer,
    /// The user interrupts.
    Interruption,
    /// The controller runs at reduced speed.
    Slow,
    /// The controller pauses for two seconds, and reports a constant setpoint.
    Pause,
    /// The joints stop before the last point.
    Short,
    /// The joints oscillate about the last point.
    Swinging,
    /// The joints are at another position at the start.
    Elsewhere,
    /// The server accepts no goal.
    Refusal,
    /// The driver panics.
    Panic,
    /// The clock of the robot jumps.
    ClockJump,
}

pub(super) const FAULTS: [Fault; 22] = [
    Fault::None,
    Fault::Silence,
    Fault::DrivesOff,
    Fault::FrozenJoint,
    Fault::Jump,
    Fault::NotANumber,
    Fault::FalseEnd,
    Fault::EarlyEnd,
    Fault::FalseAbort,
    Fault::Abort,
    Fault::Lost,
    Fault::Gone,
    Fault::DeafServer,
    Fault::Interruption,
    Fault::Slow,
    Fault::Pause,
    Fault::Short,
    Fault::Swinging,
    Fault::Elsewhere,
    Fault::Refusal,
    Fault::Panic,
    Fault::ClockJump,
];

/// The arm itself, which moves independently of its client.
pub(super) struct Arm {
    pub(super) fault: Fault,
    /// Time of the fault, s after the start.
    pub(super) moment: f64,
    pub(super) joint: usize,
    pub(super) begun: Option<Instant>,
    /// Goals with their times of arrival on the arm's own time, s.
    pub(super) goals: Vec<(f64, Interpolant)>,
    /// Time at which the arm stopped, on its own time, s.
    pub(super) stopped: Option<f64>,
    pub(super) requests: usize,
    pub(super) lost: bool,
}

impl Arm {
    /// An arm without a fault.
    pub(super) fn sound() -> Self {
        Self {
            fault: Fault::None,
            moment: f64::INFINITY,
            joint: 0,
            begun: None,
            goals: Vec::new(),
            stopped: None,
            requests: 0,
            lost: false,
        }
    }

    fn elapsed(&self, now: Instant) -> f64 {
        self.begun
            .map_or(0.0, |start| now.duration_since(start).as_secs_f64())
    }

    /// Accepts a goal, from its present joint positions.
    fn take(&mut self, goal: &Interpolant, now: Instant) {
        let time = self.own_time(now);
        let goal = match self.goals.last() {
            Some((since, last)) => {
                let since = time - since;
                goal.taken_at(last.at(since), last.velocity_at(since))
            }
            None => goal.clone(),
        };
        self.begun.get_or_insert(now);
        self.goals.push((time, goal));
    }

    /// Setpoint at a time of the arm, s.
    fn place(&self, time: f64) -> Vec<f64> {
        let came = self.goals.iter().rfind(|(since, _)| *since <= time);
        let (since, goal) = came.unwrap_or(&self.goals[0]);
        goal.at(time - since)
    }

    /// End of the last goal on the arm's own time, s.
    fn end(&self) -> f64 {
        let (since, last) = &self.goals[self.goals.len() - 1];
        since + last.duration()
    }

    /// The arm's own time, s, which stops while the arm is paused.
    fn own_time(&self, now: Instant) -> f64 {
        let elapsed = self.elapsed(now);
        let until = self.stopped.unwrap_or(f64::INFINITY);
        let late = (elapsed - self.moment).max(0.0);
        let time = match self.fault {
            Fault::DrivesOff | Fault::FalseEnd | Fault::Abort => elapsed.min(self.moment),
            Fault::Slow => elapsed * (0.1 + 0.8 * self.moment.min(1.0)),
            Fault::Pause => elapsed - late.min(2.0),
            _ => elapsed,
        };
        time.min(until)
    }

    pub(super) fn positions(&self, now: Instant) -> Vec<f64> {
        if self.begun.is_none() {
            let elsewhere = if self.fault == Fault::Elsewhere {
                0.3
            } else {
                0.0
            };
            return vec![elsewhere; 2];
        }
        let time = self.own_time(now);
        let mut positions = self.place(time);
        let is_late = self.elapsed(now) > self.moment;
        match self.fault {
            Fault::FrozenJoint if is_late => {
                positions[self.joint] = self.place(time.min(self.moment))[self.joint];
            }
            Fault::Jump if is_late => positions[self.joint] += 0.5,
            Fault::Short => positions.iter_mut().for_each(|q| *q *= 0.95),
            Fault::Swinging if time >= self.end() - 0.2 => {
                positions[self.joint] += 0.015 * (30.0 * self.elapsed(now)).sin();
            }
            _ => {}
        }
        positions
    }

    pub(super) fn moves(&self, now: Instant) -> bool {
        let before = now - Duration::from_millis(60);
        let pairs = self.positions(now);
        let earlier = self.positions(before);
        pairs
            .iter()
            .zip(&earlier)
            .any(|(a, b)| (a - b).abs() > 2e-3)
    }
}

/// A driver of the arm.
pub(super) struct Connection {
    pub(super) arm: Arc<Mutex<Arm>>,
    pub(super) timer: Simulated,
    pub(super) report: Option<JointState>,
    pub(super) setpoint: Option<JointState>,
    pub(super) clock: Option<(f64, Instant)>,
    pub(super) has_clock: bool,
    /// Time between two received clock times; joint reports may overtake them.
    pub(super) clock_period: Duration,
    pub(super) opened: Instant,
}

impl Connection {
    /// A connection to an arm without a clock.
    pub(super) fn to(arm: &Arc<Mutex<Arm>>, timer: &Simulated, opened: Instant) -> Self {
        Self {
            arm: Arc::clone(arm),
            timer: timer.clone(),
            report: None,
            setpoint: None,
            clock: None,
            has_clock: false,
            clock_period: Duration::ZERO,
            opened,
        }
    }

    fn arm(&self) -> MutexGuard<'_, Arm> {
        self.arm
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Reads what has arrived by now.
    fn read(&mut self) -> Result<(), DriverError> {
        let now = self.timer.now();
        let arm = Arc::clone(&self.arm);
        let mut arm = arm
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let is_late = arm.begun.is_some() && arm.elapsed(now) > arm.moment;
        if is_late && matches!(arm.fault, Fault::Lost | Fault::Gone) && arm.requests == 0 {
            arm.lost = true;
        }
        if arm.lost {
            return Err(DriverError::Lost("the connection is lost".into()));
        }
        assert!(
            !(is_late && arm.fault == Fault::Panic && arm.requests == 0),
            "a fault of a driver"
        );
        if is_late && arm.fault == Fault::Silence {
            return Ok(());
        }
        let since = now.duration_since(self.opened);
        if self
            .report
            .as_ref()
            .is_none_or(|last| now - last.received >= Duration::from_millis(8))
        {
            let mut positions = arm.positions(now);
            if is_late && arm.fault == Fault::NotANumber {
                positions[arm.joint] = f64::NAN;
            }
            let received = now;
            let mut time = 1000.0 + since.as_secs_f64();
            self.report = Some(JointState {
                received,
                stamp: Some(time),
                positions,
                efforts: Vec::new(),
            });
            if is_late && arm.fault == Fault::ClockJump {
                let lasts = arm.joint == 0 || arm.elapsed(now) < arm.moment + 0.05;
                time += if lasts { 30.0 } else { 0.0 };
            }
            let is_due = self
                .clock
                .is_none_or(|(_, last)| received - last >= self.clock_period);
            if self.has_clock && is_due {
                self.clock = Some((time, received));
            }
            if arm.begun.is_some() {
                let is_off = matches!(arm.fault, Fault::DrivesOff | Fault::FrozenJoint);
                let time = if is_off {
                    arm.elapsed(now)
                } else {
                    arm.own_time(now)
                };
                let positions = arm.place(time);
                self.setpoint = Some(JointState {
                    received,
                    stamp: None,
                    positions,
                    efforts: Vec::new(),
                });
            }
        }
        Ok(())
    }
}

impl Driver for Connection {
    fn connect(&mut self, _: &[String]) -> Result<(), DriverError> {
        if self.arm().fault == Fault::Gone && self.arm().begun.is_some() {
            return Err(DriverError::Lost("no connection".into()));
        }
        self.arm().lost = false;
        Ok(())
    }

    fn reports_state(&self) -> bool {
        true
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        self.read()?;
        Ok(self.report.clone())
    }

    fn setpoint(&self) -> Option<&JointState> {
        self.setpoint.as_ref()
    }

    fn clock(&self) -> Option<(f64, Instant)> {
        self.clock
    }

    fn sends_goals(&self) -> bool {
        true
    }

    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        let now = self.timer.now();
        let mut arm = self.arm();
        if arm.fault != Fault::Refusal {
            arm.take(motion, now);
        }
        Ok(())
    }

    fn advance(&mut self, _: f64) -> Result<Progress, DriverError> {
        self.read()?;
        let now = self.timer.now();
        let arm = self.arm();
        if arm.begun.is_none() {
            return Err(DriverError::Refused(
                "the controller rejected the goal".into(),
            ));
        }
        let is_late = arm.elapsed(now) > arm.moment;
        match arm.fault {
            Fault::FalseEnd | Fault::EarlyEnd if is_late => return Ok(Progress::Done),
            Fault::FalseAbort | Fault::Abort if is_late => {
                return Err(DriverError::Aborted(
                    "the controller aborted the motion".into(),
                ));
            }
            _ => {}
        }
        let is_over = arm.own_time(now) >= arm.end() + 0.01;
        Ok(Progress::over(is_over))
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        let now = self.timer.now();
        let mut arm = self.arm();
        if arm.lost {
            return Err(DriverError::Lost("the connection is lost".into()));
        }
        arm.requests += 1;
        if arm.fault != Fault::DeafServer && arm.stopped.is_none() {
            arm.stopped = Some(arm.own_time(now));
        }
        Ok(())
    }
}
