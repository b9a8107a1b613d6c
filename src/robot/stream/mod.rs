//! Safe streaming of trajectories to drivers on a common clock.
//!
//! [`check`] checks the motion before the first point is sent. [`stream`] then connects, compares
//! the joints with their first points, starts all parts at once, and watches their reports. A
//! motion is finished when the joints are observed at the last point and at rest, regardless of
//! what a controller reports. A silence longer than the watchdog's time, or a joint farther from
//! its trajectory than a tolerance, ends the motion of all parts. On any early end, every part is
//! commanded to stop, and is reported to hold only if its joints are observed at rest.
//!
//! | file | what |
//! |---|---|
//! | `check` | limits, before anything is sent |
//! | `start` | connections, and whether every joint is at its first point |
//! | `follow`, `reports` | whether an arm follows its trajectory, pauses, has arrived |
//! | `pieces` | a motion in goals that end by themselves |
//! | `pace`, `speed` | the speed of a motion relative to its plan, and its changes |
//! | `stop` | requests to stop, until the joints are at rest |
//! | `clock`, `timer` | the clock of the motion; time as a stream reads it |
//! | `cycles` | a deadline every millisecond, and real-time scheduling |
//! | `bounds`, `log` | tolerances; the log |
//! | `supervisor` | interruption, and the state of the motion for a display |

mod bounds;
mod check;
mod clock;
mod cycles;
mod follow;
mod log;
mod pace;
mod pieces;
mod reports;
mod speed;
mod start;
mod stop;
mod supervisor;
mod timer;

pub use bounds::{StreamBounds, Tolerance};
pub use check::{Fault, check};
pub use log::StreamLog;
pub use pieces::check_stops;
pub use supervisor::{StreamState, Supervisor};

use super::chain::{JointKind, Limits};
use super::driver::{Driver, DriverError, Interpolant, JointState, PartTrajectory, Progress};
use clock::MotionClock;
use cycles::{Cycles, RealTime};
use follow::{Circumstances, Follower, Motion};
use pace::Pace;
use pieces::{Division, Piece};
use speed::Speed;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use supervisor::Shown;
use timer::{SystemTimer, Timer};

/// Longest wait for the end of the motion after the time of the last point, s.
const OVERTIME: f64 = 5.0;
/// Longest time from the end that a controller reports until the joints are at rest at the last
/// point.
const SETTLING: Duration = Duration::from_secs(2);
/// Longest silence of a server that has not answered the goal yet; it may be busy, and nothing
/// moves yet.
const ACCEPTANCE: Duration = Duration::from_secs(1);
/// Lag of an arm above which it is logged, s.
const NOTICED_LAG: f64 = 1.0;

/// An arm or axis of a stream.
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// Driver of the part.
    pub driver: Box<dyn Driver>,
    /// Motion of the part.
    pub trajectory: PartTrajectory,
    /// Kind of each joint.
    pub kinds: Vec<JointKind>,
    /// Limits of each joint, for changes of the speed.
    pub limits: Vec<Limits>,
}

/// End of a stream.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// All joints are at their last points, and at rest.
    Finished,
    /// The user interrupted the motion; all joints are at rest.
    Interrupted,
    /// The motion failed: the reason, and the parts that were not observed at rest afterwards.
    Failed(String),
}

/// Number of motions in progress in this program.
static MOVING: AtomicUsize = AtomicUsize::new(0);

/// A motion in progress: from the first goal until every part has arrived or was commanded to
/// stop.
pub struct Moving(());

impl Moving {
    /// Records the start of a motion.
    pub fn begin() -> Self {
        MOVING.fetch_add(1, Ordering::SeqCst);
        Self(())
    }

    /// Whether a motion is in progress.
    pub fn is_under_way() -> bool {
        MOVING.load(Ordering::SeqCst) > 0
    }
}

impl Drop for Moving {
    fn drop(&mut self) {
        MOVING.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Streams parts to their drivers until all have arrived, the supervisor interrupts, or an error
/// occurs.
pub fn stream(
    parts: &mut [Part],
    bounds: &StreamBounds,
    supervisor: &dyn Supervisor,
    log: &mut StreamLog,
) -> Ending {
    stream_by(&SystemTimer, parts, bounds, supervisor, log)
}

fn stream_by(
    timer: &dyn Timer,
    parts: &mut [Part],
    bounds: &StreamBounds,
    supervisor: &dyn Supervisor,
    log: &mut StreamLog,
) -> Ending {
    if let Err(ending) = start::prepare(parts, bounds, supervisor, timer, log) {
        log.event(match &ending {
            Ending::Failed(reason) => reason,
            _ => "interrupted",
        });
        return ending;
    }
    let _moving = Moving::begin();
    // The threads of connections, which have started by now, keep their scheduling.
    let real_time = timer.is_real().then(RealTime::requested);
    if let Some(real_time) = &real_time {
        log.event(real_time.in_words());
    }
    let mut cycles = Cycles::from(timer.now(), real_time);
    // A panic must not leave an arm moving.
    let run = catch_unwind(AssertUnwindSafe(|| {
        run(timer, &mut cycles, parts, bounds, supervisor, log)
    }));
    log.event(&cycles.summary());
    let ending = run.unwrap_or_else(|_| {
        Ending::Failed("an internal error of this program ended the motion".into())
    });
    let reason = match &ending {
        Ending::Finished => {
            log.event("finished");
            return ending;
        }
        Ending::Failed(reason) => reason.as_str(),
        Ending::Interrupted => "interrupted",
    };
    log.event(reason);
    let left = stop::stop(parts, timer, log);
    if left.is_empty() {
        return ending;
    }
    // An arm that may still move is an error, not an interruption.
    Ending::Failed(format!("{reason}; {}", left.join("; ")))
}

/// A part and the state of its motion.
struct Watched {
    /// The whole motion, at times of the trajectory.
    path: Interpolant,
    follower: Option<Follower>,
    /// The last goal of a motion that is sent in pieces; `None` if it is sent whole.
    piece: Option<Piece>,
    /// Whether the driver has reported the end.
    is_done: bool,
    has_arrived: bool,
    /// Time at which the part should have arrived.
    due_since: Option<Instant>,
    lag_is_logged: bool,
}

fn run(
    timer: &dyn Timer,
    cycles: &mut Cycles,
    parts: &mut [Part],
    bounds: &StreamBounds,
    supervisor: &dyn Supervisor,
    log: &mut StreamLog,
) -> Ending {
    let division = bounds.horizon.map(Division::every);
    let mut speed = Speed::of(parts, division, supervisor.pace());
    let mut watched: Vec<Watched> = parts
        .iter()
        .map(|part| {
            let path = part.trajectory.interpolant();
            let division = division.filter(|_| part.driver.sends_goals());
            Watched {
                follower: (part.driver.reports_state())
                    .then(|| Follower::new(&part.trajectory, &part.kinds)),
                piece: division.map(|division| division.first(&path, &speed.pace)),
                path,
                is_done: false,
                has_arrived: false,
                due_since: None,
                lag_is_logged: false,
            }
        })
        .collect();
    let mut clock = MotionClock::of(parts, timer);
    let motions: Vec<Interpolant> = watched
        .iter()
        .map(|watched| match &watched.piece {
            Some(first) => first.goal(),
            None => watched.path.clone(),
        })
        .collect();
    for (part, motion) in parts.iter_mut().zip(&motions) {
        if let Err(error) = part.driver.start(motion) {
            return failed(part, &error);
        }
    }
    clock.set_off(timer);
    log.event("started");
    let longest = parts
        .iter()
        .map(|part| part.trajectory.duration())
        .fold(0.0, f64::max);
    let mut shown = Shown::default();
    loop {
        if supervisor.is_interrupted() {
            return Ending::Interrupted;
        }
        if let Some(reason) = supervisor.forbids() {
            return Ending::Failed(reason);
        }
        let elapsed = clock.elapsed(timer);
        let changed = speed.follow(supervisor.pace(), parts, &mut watched, elapsed, log);
        if let Err(ending) = changed {
            return ending;
        }
        let states = match advance(parts, &mut watched, &speed, division, elapsed, log) {
            Ok(states) => states,
            Err(ending) => return ending,
        };
        if let Err(reason) = clock.read(parts) {
            return Ending::Failed(reason);
        }
        let keeps_clock = parts.len() > 1 || bounds.horizon.is_some();
        for ((part, watched), state) in parts.iter().zip(&mut watched).zip(&states) {
            let watch = Watch {
                supervisor,
                bounds,
                clock: &clock,
                pace: &speed.pace,
                timer,
                keeps_clock,
            };
            if let Err(reason) = watch.look(part, watched, state.as_ref(), log) {
                return Ending::Failed(format!("{}: {reason}", part.name));
            }
        }
        log.commanded(speed.pace.place(elapsed), &speed.pace, parts);
        if watched.iter().all(|part| part.is_done && part.has_arrived) {
            log.commanded(f64::INFINITY, &speed.pace, parts);
            return Ending::Finished;
        }
        let followers = || watched.iter().filter_map(|part| part.follower.as_ref());
        let lag = followers().map(Follower::lag).fold(0.0, f64::max);
        if shown.is_due(timer.now()) {
            let tracking = followers().map(Follower::tracking);
            supervisor.show(&StreamState {
                time: speed.pace.place(elapsed - lag).clamp(0.0, longest),
                lag,
                duration: longest,
                tracking: tracking.fold(Tolerance::default(), Tolerance::max),
                pace: speed.adjustable(elapsed),
            });
        }
        if elapsed - lag > speed.pace.time_of(longest) + OVERTIME * clock.rate() {
            let late = parts.iter().zip(&watched);
            let late = late.filter(|(_, watched)| !watched.is_done);
            let late: Vec<&str> = late.map(|(part, _)| part.name.as_str()).collect();
            return Ending::Failed(format!(
                "{}: not finished {OVERTIME} s after the time of the last point",
                late.join(", ")
            ));
        }
        cycles.wait(timer);
    }
}

fn failed(part: &Part, error: &DriverError) -> Ending {
    Ending::Failed(format!("{}: {error}", part.name))
}

/// Advances every driver, and reads its joint positions.
fn advance(
    parts: &mut [Part],
    watched: &mut [Watched],
    speed: &Speed,
    division: Option<Division>,
    elapsed: f64,
    log: &mut StreamLog,
) -> Result<Vec<Option<JointState>>, Ending> {
    let mut states = Vec::with_capacity(parts.len());
    for (part, watched) in parts.iter_mut().zip(watched) {
        speed.send_next(part, watched, elapsed, division)?;
        if !watched.is_done {
            match part.driver.advance(elapsed) {
                Ok(Progress::Running) => {}
                Ok(Progress::Done)
                    if watched.piece.as_ref().is_some_and(|piece| !piece.is_last()) =>
                {
                    return Err(Ending::Failed(format!(
                        "{}: its controller reported the end of the motion before the next piece was sent",
                        part.name
                    )));
                }
                Ok(Progress::Done) => {
                    watched.is_done = true;
                    log.event(&format!("{} reports the end", part.name));
                }
                Err(error) => return Err(failed(part, &error)),
            }
        }
        states.push(part.driver.state().map_err(|error| failed(part, &error))?);
    }
    Ok(states)
}

/// Context for the check of a part.
struct Watch<'a> {
    supervisor: &'a dyn Supervisor,
    bounds: &'a StreamBounds,
    clock: &'a MotionClock,
    pace: &'a Pace,
    timer: &'a dyn Timer,
    keeps_clock: bool,
}

impl Watch<'_> {
    /// Evaluates the last report of a part.
    fn look(
        &self,
        part: &Part,
        watched: &mut Watched,
        state: Option<&JointState>,
        log: &mut StreamLog,
    ) -> Result<(), String> {
        let Some(state) = state else {
            watched.has_arrived = watched.is_done;
            return Ok(());
        };
        let time = self.clock.time_of(state);
        log.state(part, state, time);
        if let Some(reason) = (self.supervisor).refuses(&part.name, time, state) {
            return Err(reason);
        }
        let has_moved = (watched.follower.as_ref()).is_none_or(Follower::has_moved);
        let is_accepted = part.driver.is_accepted();
        self.listen(part, state, is_accepted || has_moved)?;
        let Some(follower) = &mut watched.follower else {
            watched.has_arrived = watched.is_done;
            return Ok(());
        };
        let now = Circumstances {
            time,
            pace: self.pace,
            rate: self.clock.rate(),
            greatest_rate: self.clock.greatest_rate(),
            is_accepted,
            is_done: watched.is_done,
            keeps_clock: self.keeps_clock,
            setpoint: part.driver.setpoint(),
            bounds: self.bounds,
        };
        let motion = follower.report(state, &now).map_err(|reason| {
            let known = match (watched.is_done, is_accepted) {
                (true, _) => "; its controller has reported the end of the motion",
                (false, false) => "; its controller has not answered the goal",
                (false, true) => "",
            };
            format!("{reason}{known}")
        })?;
        let name = &part.name;
        match motion {
            Motion::Follows => {}
            Motion::Pauses => {
                log.event(&format!("{name} is paused"));
                tracing::warn!("{name} is paused before its last point; Ctrl-C ends the motion");
            }
            Motion::Resumes => log.event(&format!("{name} moves again")),
        }
        if follower.lag() > NOTICED_LAG * now.rate && !watched.lag_is_logged {
            watched.lag_is_logged = true;
            log.event(&format!("{name} is slower than its trajectory"));
        }
        watched.has_arrived = follower.has_arrived(&now);
        if watched.has_arrived
            || !watched.is_done
            || now.place(follower.lag()) < part.trajectory.duration()
        {
            watched.due_since = None;
            return Ok(());
        }
        let since = *watched.due_since.get_or_insert(self.timer.now());
        if self.timer.now().duration_since(since) > SETTLING {
            let reason = follower.missed_joint(self.bounds);
            return Err(format!(
                "its controller reports the end, but {}",
                reason.unwrap_or_else(|| "its joints are not at rest".into())
            ));
        }
        Ok(())
    }

    /// Checks that reports arrive, and that the clock of the robot runs if it has one.
    fn listen(&self, part: &Part, state: &JointState, may_move: bool) -> Result<(), String> {
        let age = |received: Instant| self.timer.now().saturating_duration_since(received);
        let clock = part.driver.clock().map(|(_, received)| age(received));
        let quiet = clock.map_or(age(state.received), |clock| clock.max(age(state.received)));
        let allowed = match may_move {
            true => self.bounds.watchdog,
            false => self.bounds.watchdog.max(ACCEPTANCE),
        };
        if quiet > allowed {
            return Err(format!(
                "no report of its joints for {:.0} ms; allowed: {:.0} ms",
                quiet.as_secs_f64() * 1e3,
                allowed.as_secs_f64() * 1e3
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod faults;
#[cfg(test)]
mod faulty_arm;
#[cfg(test)]
mod tests;
