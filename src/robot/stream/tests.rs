//! Streams to drivers that lag, stop reporting, leave the path or abort.

use super::*;
use crate::chain::Limits;
use crate::driver::RosVersion;
use std::cell::{Cell, RefCell};
use std::sync::{Arc, Mutex};

/// Calls recorded by a fake driver.
#[derive(Default)]
struct Notes {
    stopped: Option<Instant>,
    started: bool,
}

struct Arm {
    notes: Arc<Mutex<Notes>>,
    motion: Option<Interpolant>,
    start: Option<Instant>,
    /// Deviation of the arm from the trajectory.
    offset: fn(f64) -> f64,
    /// Time at which the reports of the arm end, s.
    silent_after: f64,
}

impl Driver for Arm {
    fn connect(&mut self, _: &[String]) -> Result<(), DriverError> {
        Ok(())
    }
    fn reports_state(&self) -> bool {
        true
    }
    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        let stopped = self.notes.lock().unwrap().stopped;
        let now = stopped.unwrap_or_else(Instant::now);
        let elapsed = self.start.map_or(0.0, |start| (now - start).as_secs_f64());
        let heard = elapsed.min(self.silent_after);
        let is_silent = elapsed > self.silent_after;
        let received = match self.start {
            Some(start) if is_silent => start + Duration::from_secs_f64(heard),
            _ => Instant::now(),
        };
        let at = self.motion.as_ref();
        let at = at.map_or(0.0, |known| known.at(heard)[0]);
        Ok(Some(JointState {
            received,
            stamp: None,
            positions: vec![at + (self.offset)(heard)],
            efforts: Vec::new(),
        }))
    }
    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        self.notes.lock().unwrap().started = true;
        self.motion = Some(motion.clone());
        self.start = Some(Instant::now());
        Ok(())
    }
    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError> {
        let duration = self.motion.as_ref().map_or(0.0, Interpolant::duration);
        Ok(Progress::over(elapsed > duration))
    }
    fn stop(&mut self) -> Result<(), DriverError> {
        let stopped = &mut self.notes.lock().unwrap().stopped;
        stopped.get_or_insert_with(Instant::now);
        Ok(())
    }
}

fn ramp(duration: f64) -> PartTrajectory {
    PartTrajectory {
        joints: vec!["a".into()],
        times: (0..=100).map(|k| duration * f64::from(k) / 100.0).collect(),
        points: (0..=100).map(|k| vec![0.01 * f64::from(k)]).collect(),
    }
}

pub(super) const BOUNDS: StreamBounds = StreamBounds {
    start: Tolerance {
        revolute: 0.02,
        prismatic: 0.002,
    },
    tracking: Tolerance {
        revolute: 0.1,
        prismatic: 0.01,
    },
    watchdog: Duration::from_millis(150),
    longest_pause: None,
    horizon: None,
};

fn run_two(
    offset: fn(f64) -> f64,
    silent_after: f64,
    supervisor: &dyn Supervisor,
) -> (Ending, [Arc<Mutex<Notes>>; 2], Duration) {
    let notes: [Arc<Mutex<Notes>>; 2] = Default::default();
    let arm = |which: usize, offset, silent_after| Part {
        name: format!("arm{which}"),
        driver: Box::new(Arm {
            notes: Arc::clone(&notes[which]),
            motion: None,
            start: None,
            offset,
            silent_after,
        }),
        trajectory: ramp(1.0),
        kinds: vec![JointKind::Revolute],
        limits: Vec::new(),
    };
    let mut parts = [arm(0, offset, silent_after), arm(1, |_| 0.0, f64::INFINITY)];
    let begin = Instant::now();
    let ending = stream(&mut parts, &BOUNDS, supervisor, &mut StreamLog::none());
    (ending, notes, begin.elapsed())
}

/// Whether a predicate holds for both arms.
fn all(notes: &[Arc<Mutex<Notes>>; 2], is_true: fn(&Notes) -> bool) -> bool {
    notes.iter().all(|notes| is_true(&notes.lock().unwrap()))
}

fn failure(ending: Ending) -> String {
    match ending {
        Ending::Failed(reason) => reason,
        other => panic!("{other:?}"),
    }
}

#[test]
fn two_arms_that_follow_come_to_the_end_together() {
    let (ending, notes, time) = run_two(|_| 0.01, f64::INFINITY, &|| false);
    assert_eq!(ending, Ending::Finished);
    assert!(time.as_secs_f64() < 3.0, "{time:?}");
    assert!(all(&notes, |notes| notes.stopped.is_none()));
}

#[test]
fn a_supervisor_is_shown_how_far_the_arms_are() {
    struct Shows(RefCell<Vec<StreamState>>);
    impl Supervisor for Shows {
        fn is_interrupted(&self) -> bool {
            false
        }
        fn show(&self, state: &StreamState) {
            self.0.borrow_mut().push(*state);
        }
    }
    let shows = Shows(RefCell::default());
    let (ending, _, _) = run_two(|_| 0.01, f64::INFINITY, &shows);
    assert_eq!(ending, Ending::Finished);
    let states = shows.0.into_inner();
    assert!(states.len() > 1, "{states:?}");
    assert!(states.windows(2).all(|pair| pair[0].time <= pair[1].time));
    for state in &states {
        assert_eq!((state.duration, state.tracking.prismatic), (1.0, 0.0));
        assert!(state.time <= 1.0 && state.lag >= 0.0, "{state:?}");
    }
    // The first arm reports 0.01 rad beyond its trajectory, or less where it is late.
    let off = states.iter().map(|state| state.tracking.revolute);
    let off = off.fold(0.0, f64::max);
    assert!(off > 5e-3 && off < BOUNDS.tracking.revolute, "{off}");
}

#[test]
fn an_arm_away_from_its_first_point_is_not_moved() {
    let (ending, notes, _) = run_two(|_| 0.05, f64::INFINITY, &|| false);
    let reason = failure(ending);
    assert!(reason.contains("a is at 0.0500 rad"), "{reason}");
    assert!(all(&notes, |notes| !notes.started));
}

#[test]
fn silence_stops_both_arms_within_half_a_second() {
    let begin = Instant::now();
    let (ending, notes, _) = run_two(|_| 0.0, 0.3, &|| false);
    let reason = failure(ending);
    assert!(reason.contains("arm0: no report of its joints"), "{reason}");
    assert!(
        reason.contains("no report of its joints has come since"),
        "{reason}"
    );
    let stopped = notes[1].lock().unwrap().stopped.unwrap();
    assert!(stopped.duration_since(begin).as_secs_f64() < 0.8);
    assert!(all(&notes, |notes| notes.stopped.is_some()));
}

#[test]
fn an_arm_that_leaves_the_path_stops_both() {
    let (ending, notes, _) = run_two(|time| 0.5 * (time - 0.2).max(0.0), f64::INFINITY, &|| false);
    assert!(failure(ending).contains("from its trajectory"));
    assert!(all(&notes, |notes| notes.stopped.is_some()));
}

/// An arm with its own clock, which runs at 50 times real time until the arm has received the
/// command, and at a tenth of real time afterwards, like a simulation on a busy machine. The arm
/// then follows its trajectory.
struct Simulated {
    trajectory: PartTrajectory,
    start: Option<Instant>,
    now: Instant,
}

impl Simulated {
    /// Time at which the arm receives a command, s on our clock.
    const HEARS: f64 = 0.02;

    fn time(&self) -> f64 {
        let ours = self
            .start
            .map_or(0.0, |start| (self.now - start).as_secs_f64());
        50.0 * ours.min(Self::HEARS) + 0.1 * (ours - Self::HEARS).max(0.0)
    }
}

impl Driver for Simulated {
    fn connect(&mut self, _: &[String]) -> Result<(), DriverError> {
        Ok(())
    }
    fn reports_state(&self) -> bool {
        true
    }
    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        // The first report after the start is late; the clock has jumped by then.
        if self.start == Some(self.now) {
            std::thread::sleep(Duration::from_millis(20));
        }
        self.now = Instant::now();
        let since = self.time() - 50.0 * Self::HEARS;
        Ok(Some(JointState {
            received: self.now,
            stamp: None,
            positions: self.trajectory.at(since.max(0.0)),
            efforts: Vec::new(),
        }))
    }
    fn clock(&self) -> Option<(f64, Instant)> {
        Some((self.time(), self.now))
    }
    fn start(&mut self, _: &Interpolant) -> Result<(), DriverError> {
        self.now = Instant::now();
        self.start = Some(self.now);
        Ok(())
    }
    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError> {
        let end = self.trajectory.duration() + 50.0 * Self::HEARS;
        Ok(Progress::over(elapsed > end))
    }
    fn stop(&mut self) -> Result<(), DriverError> {
        Ok(())
    }
}

#[test]
fn an_arm_that_starts_late_on_a_fast_clock_may_catch_up() {
    let there = ramp(0.1);
    let mut and_back = ramp(0.1);
    for (there, back) in (51..=100).zip((0..50).rev()) {
        and_back.points[there] = and_back.points[back].clone();
    }
    for trajectory in [there, and_back] {
        let mut parts = [Part {
            name: "arm".into(),
            driver: Box::new(Simulated {
                trajectory: trajectory.clone(),
                start: None,
                now: Instant::now(),
            }),
            trajectory,
            kinds: vec![JointKind::Revolute],
            limits: Vec::new(),
        }];
        let ending = stream(&mut parts, &BOUNDS, &|| false, &mut StreamLog::none());
        assert_eq!(ending, Ending::Finished);
    }
}

#[test]
fn an_interruption_leaves_both_arms_still() {
    let calls = Cell::new(0);
    let interrupt = || {
        calls.set(calls.get() + 1);
        calls.get() > 50
    };
    let (ending, notes, _) = run_two(|_| 0.0, f64::INFINITY, &interrupt);
    assert_eq!(ending, Ending::Interrupted);
    assert!(all(&notes, |notes| notes.stopped.is_some()));
}

#[test]
fn a_missing_server_is_reported_at_once() {
    let driver = crate::driver::RosbridgeDriver::new("127.0.0.1:1", RosVersion::One, "/a", "/s");
    let mut parts = [Part {
        name: "arm".into(),
        driver: Box::new(driver),
        trajectory: ramp(1.0),
        kinds: vec![JointKind::Revolute],
        limits: Vec::new(),
    }];
    let ending = stream(&mut parts, &BOUNDS, &|| false, &mut StreamLog::none());
    assert!(failure(ending).contains("is the server started?"));
}

fn limits() -> Limits {
    Limits {
        lower: -1.0,
        upper: 2.0,
        velocity: 1.0,
        acceleration: 5.0,
        jerk: 80.0,
    }
}

/// A smooth step of one unit in the time T, with velocity up to 15/8 /T, acceleration up to 5.8/T²
/// and jerk up to 60/T³.
fn smooth(duration: f64) -> PartTrajectory {
    PartTrajectory::smooth(&[("a", 1.0)], duration, 200)
}

/// With one row per second, the differences of the rows are slow, but the cubics between them are
/// not.
#[test]
fn the_cubics_between_points_are_checked() {
    let coarse = PartTrajectory {
        joints: vec!["a".into()],
        times: vec![0.0, 1.0],
        points: vec![vec![0.0], vec![0.9]],
    };
    let limits = Limits {
        acceleration: 2.0,
        jerk: f64::INFINITY,
        ..limits()
    };
    let first_fault = |limits| check(&coarse, &[limits]).unwrap_err().remove(0);
    let found = |fault: &Fault| (fault.what, fault.is_between);
    let fault = first_fault(limits);
    assert_eq!(found(&fault), ("velocity", true), "{fault}");
    let fault = first_fault(Limits {
        velocity: 10.0,
        ..limits
    });
    assert_eq!(found(&fault), ("acceleration", true), "{fault}");
    assert!((fault.value - 5.4).abs() < 1e-9);
}

#[test]
fn limits_are_checked_before_the_first_point() {
    assert_eq!(check(&smooth(2.0), &[limits()]), Ok(()));
    let fault = |trajectory: &PartTrajectory, limits: Limits| {
        check(trajectory, &[limits]).unwrap_err().remove(0)
    };
    let fast = fault(&smooth(1.5), limits());
    assert_eq!(fast.what, "velocity");
    assert!((40..80).contains(&fast.point), "{fast}");
    for (what, limits) in [
        (
            "acceleration",
            Limits {
                acceleration: 1.4,
                ..limits()
            },
        ),
        (
            "jerk",
            Limits {
                jerk: 6.0,
                ..limits()
            },
        ),
        (
            "position",
            Limits {
                upper: 0.5,
                ..limits()
            },
        ),
    ] {
        assert_eq!(fault(&smooth(2.0), limits).what, what);
    }
    // A ramp starts with a jerk.
    assert_eq!(fault(&ramp(2.0), limits()).what, "acceleration");
    let mut jumped = smooth(2.0);
    jumped.points[100][0] += 0.1;
    assert_eq!(fault(&jumped, limits()).point, 99);
}
