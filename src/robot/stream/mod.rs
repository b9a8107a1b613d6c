//! Safe streaming: trajectories to drivers on one clock.
//!
//! [`check`] looks at every point before the first is sent. [`stream`] then connects, compares where the joints stand
//! with the first point, starts all parts at once, and watches: an arm that is not heard of for longer than the
//! watchdog's time, or that is farther from where it should be than a tolerance, ends the motion of all. Whatever
//! ends it early, every part is told to hold, and the log is complete.

mod check;
mod clock;
mod log;

pub use check::{Fault, check};
pub use log::StreamLog;

use super::driver::{Driver, DriverError, PartTrajectory, Progress};
use clock::MotionClock;
use std::time::{Duration, Instant};

/// Time between looks at the drivers.
const CYCLE: Duration = Duration::from_millis(2);
/// Longest wait for a first report of where the joints are.
const FIRST_STATE: Duration = Duration::from_secs(2);
/// Longest wait for the end after the last point's time, s.
const OVERTIME: f64 = 5.0;
/// An arm may be late by this, s, before its distance from where it should be counts.
const LATENESS: f64 = 0.3;

/// An arm or axis of a stream.
pub struct Part {
    /// Its name.
    pub name: String,
    /// What moves it.
    pub driver: Box<dyn Driver>,
    /// Its motion.
    pub trajectory: PartTrajectory,
}

/// Bounds of a stream.
#[derive(Clone, Copy, Debug)]
pub struct StreamBounds {
    /// Greatest distance of a joint from the first point at the start, rad or m.
    pub start_tolerance: f64,
    /// Greatest distance of a joint from where it should be, rad or m.
    pub tracking_tolerance: f64,
    /// Longest silence.
    pub watchdog: Duration,
}

/// How a stream ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// All parts came to their last points.
    Finished,
    /// Somebody asked for the end; all parts hold.
    Interrupted,
    /// Something went wrong; all parts were told to hold.
    Failed(String),
}

/// Streams parts to their drivers until all are done, `is_interrupted` says so, or something goes wrong.
pub fn stream(
    parts: &mut [Part],
    bounds: &StreamBounds,
    is_interrupted: &dyn Fn() -> bool,
    log: &mut StreamLog,
) -> Ending {
    let ending = run(parts, bounds, is_interrupted, log);
    if ending == Ending::Finished {
        log.event("finished");
        return ending;
    }
    let mut said = match &ending {
        Ending::Failed(reason) => reason.clone(),
        _ => "interrupted".into(),
    };
    log.event(&said);
    for part in parts.iter_mut() {
        match part.driver.hold() {
            Ok(()) => log.event(&format!("{} holds", part.name)),
            Err(error) => {
                let reason = format!("{} could not be told to hold: {error}", part.name);
                log.event(&reason);
                said = format!("{said}; {reason}");
            }
        }
    }
    match ending {
        Ending::Failed(_) => Ending::Failed(said),
        // An arm that may still move is more than an interruption.
        Ending::Interrupted if said != "interrupted" => Ending::Failed(said),
        other => other,
    }
}

fn run(
    parts: &mut [Part],
    bounds: &StreamBounds,
    is_interrupted: &dyn Fn() -> bool,
    log: &mut StreamLog,
) -> Ending {
    let started = prepare(parts, bounds, is_interrupted, log);
    if let Err(ending) = started {
        return ending;
    }
    let mut clock = match MotionClock::of(parts) {
        Ok(clock) => clock,
        Err(reason) => return Ending::Failed(reason),
    };
    for part in parts.iter_mut() {
        if let Err(error) = part.driver.start(&part.trajectory) {
            return failed(part, &error);
        }
    }
    clock.set_off();
    log.event("started");
    let mut done = vec![false; parts.len()];
    let longest = parts
        .iter()
        .map(|part| part.trajectory.duration())
        .fold(0.0, f64::max);
    loop {
        let elapsed = clock.elapsed(parts);
        if is_interrupted() {
            return Ending::Interrupted;
        }
        for (part, done) in parts.iter_mut().zip(&mut done) {
            if !*done {
                match part.driver.advance(elapsed) {
                    Ok(Progress::Running) => {}
                    Ok(Progress::Done) => {
                        *done = true;
                        log.event(&format!("{} is done", part.name));
                    }
                    Err(error) => return failed(part, &error),
                }
            }
            if let Err(reason) = watch(part, bounds, &clock, *done, log) {
                return Ending::Failed(reason);
            }
        }
        log.commanded(elapsed, parts);
        if done.iter().all(|done| *done) {
            log.commanded(f64::INFINITY, parts);
            return Ending::Finished;
        }
        if elapsed > longest + OVERTIME * clock.haste() {
            let late: Vec<&str> = parts
                .iter()
                .zip(&done)
                .filter(|(_, done)| !**done)
                .map(|(part, _)| part.name.as_str())
                .collect();
            return Ending::Failed(format!(
                "{}: no end {OVERTIME} s after the time of the last point",
                late.join(", ")
            ));
        }
        std::thread::sleep(CYCLE);
    }
}

fn failed(part: &Part, error: &DriverError) -> Ending {
    Ending::Failed(format!("{}: {error}", part.name))
}

/// Connects, and compares where the joints stand with the first point.
fn prepare(
    parts: &mut [Part],
    bounds: &StreamBounds,
    is_interrupted: &dyn Fn() -> bool,
    log: &mut StreamLog,
) -> Result<(), Ending> {
    for part in parts.iter_mut() {
        let connected = part.driver.connect(&part.trajectory.joints);
        connected.map_err(|error| failed(part, &error))?;
        log.event(&format!("{} is connected", part.name));
    }
    let begin = Instant::now();
    for part in parts.iter_mut().filter(|part| part.driver.reports_state()) {
        let state = loop {
            match part.driver.state() {
                Ok(Some(state)) => break state,
                Ok(None) => {}
                Err(error) => return Err(failed(part, &error)),
            }
            if is_interrupted() {
                return Err(Ending::Interrupted);
            }
            if begin.elapsed() > FIRST_STATE {
                return Err(Ending::Failed(format!(
                    "{}: no report of all of its joints ({}) in {} s; compare the names in the cell file with the robot's, and its topic of joint states",
                    part.name,
                    part.trajectory.joints.join(", "),
                    FIRST_STATE.as_secs()
                )));
            }
            std::thread::sleep(CYCLE);
        };
        // A motor without a sensor begins where it stands.
        if part.driver.knows_position() {
            let first = &part.trajectory.points[0];
            for ((joint, at), should) in part
                .trajectory
                .joints
                .iter()
                .zip(&state.positions)
                .zip(first)
            {
                if !((at - should).abs() <= bounds.start_tolerance) {
                    return Err(Ending::Failed(format!(
                        "{}: {joint} stands at {at:.4}, but the trajectory begins at {should:.4}; allowed: {} apart. Nothing was moved: bring the arm to the first point, or plan from where it stands",
                        part.name, bounds.start_tolerance
                    )));
                }
            }
        }
    }
    Ok(())
}

/// Hears where a part is; says what is wrong with it.
fn watch(
    part: &mut Part,
    bounds: &StreamBounds,
    clock: &MotionClock,
    done: bool,
    log: &mut StreamLog,
) -> Result<(), String> {
    if !part.driver.reports_state() {
        return Ok(());
    }
    let state = part
        .driver
        .state()
        .map_err(|error| format!("{}: {error}", part.name))?;
    let Some(state) = state else { return Ok(()) };
    let silence = state.received.elapsed();
    let heard = clock.heard(part, silence);
    log.state(part, &state, heard);
    let told = part.driver.clock().map(|(_, told)| told.elapsed());
    let quiet = told.map_or(silence, |told| silence.max(told));
    if quiet > bounds.watchdog && !done {
        return Err(format!(
            "{}: nothing was heard of its joints for {:.0} ms; allowed: {:.0} ms",
            part.name,
            quiet.as_secs_f64() * 1e3,
            bounds.watchdog.as_secs_f64() * 1e3
        ));
    }
    if !part.driver.knows_position() {
        return Ok(());
    }
    let lateness = LATENESS * clock.haste();
    let farthest = farthest(&part.trajectory, &state.positions, heard, lateness);
    let Some((joint, distance)) = farthest else {
        return Ok(());
    };
    if !(distance <= bounds.tracking_tolerance) {
        return Err(format!(
            "{}: {joint} is {distance:.4} from where it should be; allowed: {}",
            part.name, bounds.tracking_tolerance
        ));
    }
    Ok(())
}

/// The joint farthest from all places where it should have been lately, and how far.
fn farthest<'a>(
    trajectory: &'a PartTrajectory,
    positions: &[f64],
    time: f64,
    lateness: f64,
) -> Option<(&'a str, f64)> {
    let instants: Vec<Vec<f64>> = (0..=10)
        .map(|k| trajectory.at(time - lateness * f64::from(k) / 10.0))
        .collect();
    let distances = trajectory.joints.iter().enumerate().map(|(index, joint)| {
        let places = instants.iter().map(|instant| instant[index]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        let position = positions[index];
        // A position that is no number is infinitely far.
        let distance = if position.is_finite() {
            (low - position).max(position - high).max(0.0)
        } else {
            f64::INFINITY
        };
        (joint.as_str(), distance)
    });
    distances.max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests;
