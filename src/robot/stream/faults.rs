//! Streams to arms with random faults, in simulated time. Every motion must end as finished or
//! with a stop command, and its report must be true.
//!
//! `RODLAB_FAULT_CASES=100000 cargo test --release random_faults` runs more cases than continuous
//! integration.

use super::faulty_arm::{Arm, Connection, FAULTS, Fault, Simulated};
use super::tests::BOUNDS;
use super::*;
use std::sync::{Arc, Mutex, MutexGuard};

/// Number of cases, unless the environment variable sets another.
const CASES: u64 = 600;
const VARIABLE: &str = "RODLAB_FAULT_CASES";

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
