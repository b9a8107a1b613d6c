//! Streams to arms with random faults, in simulated time. Every motion must end as finished or
//! with a stop command, and its report must be true.
//!
//! `RODLAB_FAULT_CASES=100000 cargo test --release random_faults` runs more cases than continuous
//! integration.

use super::tests::BOUNDS;
use super::*;
use crate::driver::Interpolant;
use std::sync::{Arc, Mutex, MutexGuard};

/// Number of cases, unless the environment variable sets another.
const CASES: u64 = 600;
const VARIABLE: &str = "RODLAB_FAULT_CASES";

/// A simulated time source: a sleep advances its time.
#[derive(Clone)]
struct Simulated(Arc<Mutex<Instant>>);

impl Timer for Simulated {
    fn now(&self) -> Instant {
        *self.0.lock().unwrap()
    }

    fn sleep(&self, time: Duration) {
        *self.0.lock().unwrap() += time;
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Fault of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
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

const FAULTS: [Fault; 22] = [
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
struct Arm {
    fault: Fault,
    /// Time of the fault, s after the start.
    moment: f64,
    joint: usize,
    begun: Option<Instant>,
    /// Goals with their times of arrival on the arm's own time, s.
    goals: Vec<(f64, Interpolant)>,
    /// Time at which the arm stopped, on its own time, s.
    stopped: Option<f64>,
    requests: usize,
    lost: bool,
}

impl Arm {
    /// An arm without a fault.
    fn sound() -> Self {
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

    fn positions(&self, now: Instant) -> Vec<f64> {
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

    fn moves(&self, now: Instant) -> bool {
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
struct Connection {
    arm: Arc<Mutex<Arm>>,
    timer: Simulated,
    report: Option<JointState>,
    setpoint: Option<JointState>,
    clock: Option<(f64, Instant)>,
    has_clock: bool,
    /// Time between two received clock times; joint reports may overtake them.
    clock_period: Duration,
    opened: Instant,
}

impl Connection {
    /// A connection to an arm without a clock.
    fn to(arm: &Arc<Mutex<Arm>>, timer: &Simulated, opened: Instant) -> Self {
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

fn rise(duration: f64) -> PartTrajectory {
    PartTrajectory::smooth(&[("a", 1.0), ("b", -0.7)], duration, 50)
}

/// Interrupts the motion or changes its speed.
struct User {
    asks: bool,
    /// Time of the interruption, s after the start.
    moment: f64,
    /// Speeds in turn, each for 0.7 s, before the last; the second of them holds the motion if it
    /// is below one half.
    speeds: Option<[f64; 3]>,
    timer: Simulated,
    begin: Instant,
}

impl User {
    fn elapsed(&self) -> f64 {
        let since = self.timer.now().duration_since(self.begin);
        since.as_secs_f64()
    }
}

impl Supervisor for User {
    fn is_interrupted(&self) -> bool {
        self.asks && self.elapsed() > self.moment || self.elapsed() > 60.0
    }

    fn pace(&self) -> f64 {
        let Some(speeds) = self.speeds else {
            return 1.0;
        };
        let which = ((self.elapsed() / 0.7) as usize).min(2);
        match (which, speeds[which]) {
            (1, speed) if speed < 0.5 => 0.0,
            (_, speed) => speed,
        }
    }
}

/// Runs a case; returns what is wrong with its end.
fn run_case(seed: u64) -> Result<(), String> {
    let mut random = Random(seed);
    let fault = FAULTS[random.below(FAULTS.len() as u64) as usize];
    let duration = 1.0 + random.part();
    let moment = match fault {
        Fault::None => 0.5,
        _ => duration * random.part(),
    };
    let is_alone = random.below(3) > 0;
    let horizon = (random.below(3) == 0).then(|| Duration::from_secs(1));
    let keeps_clock = !is_alone || horizon.is_some();
    let bounds = StreamBounds { horizon, ..BOUNDS };
    let timer = Simulated(Arc::new(Mutex::new(Instant::now())));
    let begin = timer.now();
    let arm = |fault, joint| {
        Arc::new(Mutex::new(Arm {
            fault,
            moment,
            joint,
            ..Arm::sound()
        }))
    };
    let faulty = arm(fault, random.below(2) as usize);
    let sound = arm(Fault::None, 0);
    let has_clock = fault == Fault::ClockJump || random.below(2) > 0;
    let clock_period = Duration::from_millis([8, 80][random.below(2) as usize]);
    let part = |name: &str, arm: &Arc<Mutex<Arm>>| Part {
        name: name.into(),
        driver: Box::new(Connection {
            has_clock,
            clock_period,
            ..Connection::to(arm, &timer, begin)
        }),
        trajectory: rise(duration),
        kinds: vec![JointKind::Revolute; 2],
        limits: Vec::new(),
    };
    let mut parts = vec![part("one", &faulty)];
    if !is_alone {
        parts.push(part("other", &sound));
    }
    let user = User {
        asks: matches!(fault, Fault::Interruption | Fault::DeafServer),
        moment,
        // A third of the motions in pieces is slowed down, held for a while and resumed.
        speeds: match horizon.is_some() && random.below(3) == 0 {
            true => Some([random.part(), random.part(), 0.2 + 0.8 * random.part()]),
            false => None,
        },
        timer: timer.clone(),
        begin,
    };
    let is_paced = user.speeds.is_some();
    let mut log = StreamLog::none();
    let ending = stream_by(&timer, &mut parts, &bounds, &user, &mut log);
    let took = timer.now().duration_since(begin).as_secs_f64();
    drop(parts);
    let now = timer.now();
    let arms = [&faulty, &sound].map(|arm| {
        arm.lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    });
    let count = if is_alone { 1 } else { 2 };
    let arms = &arms[..count];
    let wrong = |what: &str| {
        Err(format!(
            "seed {seed}, {fault:?} at {moment:.3} of {duration:.3} s, alone: {is_alone}, in pieces: {}, at changing speed: {is_paced}: {what}: {ending:?}",
            horizon.is_some()
        ))
    };
    if took > 12.0 * duration + 15.0 {
        return wrong("it took too long");
    }
    let path = rise(duration).interpolant();
    let is_there = |arm: &Arm| {
        let pairs = arm.positions(now);
        let mut pairs = pairs.iter().zip(path.last());
        !arm.moves(now) && pairs.all(|(a, b)| (a - b).abs() <= BOUNDS.start.revolute)
    };
    let has_started = arms.iter().any(|arm| arm.begun.is_some());
    match &ending {
        Ending::Finished => {
            if !arms.iter().all(|arm| is_there(arm)) {
                return wrong("it did not arrive");
            }
        }
        Ending::Interrupted => {
            if has_started && arms.iter().any(|arm| arm.moves(now)) {
                return wrong("it moves on");
            }
        }
        Ending::Failed(reason) => {
            let may_move = arms.iter().any(|arm| arm.moves(now));
            if may_move && !reason.contains("watch the arm") {
                return wrong("it moves on without a word");
            }
        }
    }
    if has_started && ending != Ending::Finished {
        let unreachable = |arm: &Arm| arm.fault == Fault::Gone;
        if arms
            .iter()
            .any(|arm| arm.begun.is_some() && arm.requests == 0 && !unreachable(arm))
        {
            return wrong("it was not commanded to stop");
        }
    }
    // A fault at this time of the motion determines how the motion ends.
    let is_early = (0.2 * duration..0.7 * duration).contains(&moment);
    let should = match fault {
        // The end cannot be reached before the last piece is sent.
        Fault::EarlyEnd if horizon.is_some() => "Failed",
        Fault::None | Fault::EarlyEnd => "Finished",
        Fault::Slow | Fault::Pause if !keeps_clock => "Finished",
        Fault::ClockJump if faulty_is_glitch(arms) => "Finished",
        Fault::Interruption => "Interrupted",
        // The arm may be at rest at its goal before the timeout.
        Fault::DeafServer if !arms[0].moves(now) => "Interrupted",
        _ => "Failed",
    };
    let is = match ending {
        Ending::Finished => "Finished",
        Ending::Interrupted => "Interrupted",
        Ending::Failed(_) => "Failed",
    };
    // A motion sent in pieces lets a slow arm catch up at each piece.
    let slowest = if horizon.is_some() { 0.3 } else { 0.5 };
    let slow_enough = fault != Fault::Slow || !keeps_clock || moment < slowest && !is_paced;
    // The last piece may already have been sent.
    let is_decided = fault != Fault::EarlyEnd || horizon.is_none() || moment < 0.2;
    // A pause of an arm is not noticed while the motion is held.
    let is_noticed = fault != Fault::Pause || !is_paced;
    if is_early && slow_enough && is_decided && is_noticed && is != should {
        return wrong(&format!("it should have {should}"));
    }
    Ok(())
}

/// One arm arrives before the user holds the motion; the other one waits and then continues.
#[test]
fn a_motion_is_held_after_one_of_its_arms_has_arrived() {
    struct Holds(Simulated, Instant);
    impl Supervisor for Holds {
        fn is_interrupted(&self) -> bool {
            false
        }
        fn pace(&self) -> f64 {
            let elapsed = self.0.now().duration_since(self.1).as_secs_f64();
            if (1.5..4.0).contains(&elapsed) {
                0.0
            } else {
                1.0
            }
        }
    }
    let timer = Simulated(Arc::new(Mutex::new(Instant::now())));
    let begin = timer.now();
    let arms = [1.0, 3.0].map(|duration| {
        let arm = Arc::new(Mutex::new(Arm::sound()));
        (arm, rise(duration))
    });
    let mut parts = arms.clone().map(|(arm, trajectory)| Part {
        name: "arm".into(),
        driver: Box::new(Connection::to(&arm, &timer, begin)),
        trajectory,
        kinds: vec![JointKind::Revolute; 2],
        limits: Vec::new(),
    });
    let horizon = Some(Duration::from_secs(1));
    let bounds = StreamBounds { horizon, ..BOUNDS };
    let user = Holds(timer.clone(), begin);
    let ending = stream_by(&timer, &mut parts, &bounds, &user, &mut StreamLog::none());
    assert_eq!(ending, Ending::Finished);
    let took = timer.now().duration_since(begin).as_secs_f64();
    // It is held for 2.5 s; stopping and starting take half a second each, at half the speed.
    assert!((5.4..6.2).contains(&took), "{took}");
}

/// Whether the clock of the arm returns from its jump.
fn faulty_is_glitch(arms: &[MutexGuard<'_, Arm>]) -> bool {
    arms[0].joint != 0
}

#[test]
fn motions_with_random_faults_end_finished_or_commanded_to_stop() {
    let given = std::env::var(VARIABLE).ok();
    let cases = given.and_then(|cases| cases.parse().ok()).unwrap_or(CASES);
    let wrong: Vec<String> = (0..cases).filter_map(|seed| run_case(seed).err()).collect();
    assert!(
        wrong.is_empty(),
        "{} of {cases} cases:\n{}",
        wrong.len(),
        wrong[..wrong.len().min(20)].join("\n")
    );
}
