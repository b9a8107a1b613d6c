//! A motion sent as a sequence of goals that each end at rest. If this program ends, the current
//! goal of the controller brings the arm to rest.
//!
//! Each goal contains the motion of a short time and then a stop along the same path. A stop that
//! begins at the time `t` of the motion lasts `T`. With `u` from 0 to 1 during the stop, the arm
//! is at the position of the time `t + T (u − u³ + u⁴/2)` of the motion. The speed along the path
//! is then multiplied by `1 − 3 u² + 2 u³`, and the stop covers half of the path that a motion at
//! full speed would cover. The next goal replaces the current one before it stops.

use super::check::first_fault_between;
use crate::chain::Limits;
use crate::driver::{Interpolant, PartTrajectory};
use std::time::Duration;

/// Time from sending a goal to its first point, s. Controllers move the joints to this point from
/// their present positions.
const LEAD: f64 = 0.1;
/// Points closer than this to an end of a piece are omitted, s. A cubic between such a point and
/// the end would be too short for numerical accuracy.
const NEAR: f64 = 1e-3;
/// Largest time between the points of a stop, s.
const STOP_SPACING: f64 = 0.02;
/// Smallest number of points of a stop.
const STOP_POINTS: usize = 16;

/// A piece of a motion.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Time at which the piece must be sent, s after the start.
    sent: f64,
    /// Time at which its stop begins, s after the start; infinite for the last piece.
    stops: f64,
    /// Motion of the piece, at times since the start.
    motion: Interpolant,
}

/// Divides a motion into pieces that each end `horizon` (at least 1 s) after they are sent. The
/// stop takes the second half of `horizon`; the next piece may be late by a quarter of it.
pub(super) fn pieces(path: &Interpolant, horizon: Duration) -> Vec<Piece> {
    let horizon = horizon.as_secs_f64();
    let until_stop = 0.5 * horizon;
    let interval = 0.5 * until_stop - LEAD;
    let mut pieces = Vec::new();
    loop {
        let sent = interval * pieces.len() as f64;
        let begin = if pieces.is_empty() { 0.0 } else { sent + LEAD };
        if sent + horizon >= path.duration() {
            pieces.push(Piece {
                sent,
                stops: f64::INFINITY,
                motion: between(path, begin, path.duration()),
            });
            return pieces;
        }
        let stops = sent + until_stop;
        let mut motion = between(path, begin, stops);
        add_stop(&mut motion, path, stops, until_stop);
        pieces.push(Piece {
            sent,
            stops,
            motion,
        });
    }
}

impl Piece {
    /// Whether the piece must be sent now.
    pub(super) fn is_due(&self, elapsed: f64) -> bool {
        elapsed >= self.sent
    }

    /// The goal to send at a time after the start; `None` if it is too late, since the stop of
    /// `before` has begun.
    pub(super) fn goal(&self, before: &Self, elapsed: f64) -> Option<Interpolant> {
        let begin = elapsed + LEAD;
        (begin <= before.stops.min(self.motion.duration() - NEAR))
            .then(|| between(&self.motion, begin, self.motion.duration()).earlier_by(elapsed))
    }

    /// Motion of the piece, at times since the start.
    pub(super) fn motion(&self) -> &Interpolant {
        &self.motion
    }
}

/// The part of a motion between two times.
fn between(path: &Interpolant, begin: f64, end: f64) -> Interpolant {
    let times = path.times();
    let count_until = |until: f64| times.partition_point(|time| *time < until);
    let first = count_until(begin + NEAR);
    let inner = first..count_until(end - NEAR).max(first);
    let ends = |of: fn(&Interpolant, f64) -> Vec<f64>, inner: &[Vec<f64>]| {
        let mut rows = vec![of(path, begin)];
        rows.extend_from_slice(inner);
        rows.push(of(path, end));
        rows
    };
    let mut kept = vec![begin];
    kept.extend_from_slice(&times[inner.clone()]);
    kept.push(end);
    Interpolant::with_velocities(
        kept,
        ends(Interpolant::at, &path.points()[inner.clone()]),
        ends(Interpolant::velocity_at, &path.velocities()[inner]),
    )
}

/// Adds the stop along `path` from its time `begin`, over `duration`, s.
fn add_stop(motion: &mut Interpolant, path: &Interpolant, begin: f64, duration: f64) {
    let count = ((duration / STOP_SPACING).ceil() as usize).max(STOP_POINTS);
    for k in 1..=count {
        let u = k as f64 / count as f64;
        let place = begin + duration * u * (1.0 - u * u * (1.0 - 0.5 * u));
        let speed = (1.0 - u) * (1.0 - u) * (1.0 + 2.0 * u);
        let velocity = path.velocity_at(place);
        motion.push(
            begin + duration * u,
            path.at(place),
            velocity.iter().map(|v| speed * v).collect(),
        );
    }
}

/// Checks the interpolated goals of a motion sent in pieces against limits, one per joint.
///
/// # Errors
/// A message about the first fault of each joint.
pub fn check_stops(
    trajectory: &PartTrajectory,
    limits: &[Limits],
    horizon: Duration,
) -> Result<(), Vec<String>> {
    let pieces = pieces(&trajectory.interpolant(), horizon);
    let joints = trajectory.joints.iter().zip(limits).enumerate();
    let faults = joints.filter_map(|(joint, (name, limits))| {
        pieces.iter().find_map(|piece| {
            let (what, point, value, [low, high]) =
                first_fault_between(&piece.motion, joint, limits)?;
            Some(format!(
                "{name}: {what} {value:.6} in a stop from the motion at {:.2} s; allowed: {low:.6} to {high:.6}. A longer `streaming.horizon` stops more gently, and without it no stops are sent",
                piece.motion.times()[point].min(piece.stops)
            ))
        })
    });
    let faults: Vec<String> = faults.collect();
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints that rise to 1 rad and 0.7 rad over a time, with points at 100 Hz.
    fn rise(duration: f64) -> PartTrajectory {
        PartTrajectory::smooth(
            &[("a", 1.0), ("b", -0.7)],
            duration,
            (100.0 * duration) as usize,
        )
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Each goal moves the joints from their positions at its arrival.
    #[test]
    fn a_controller_that_takes_all_pieces_follows_the_motion() {
        for (duration, horizon, late) in [(5.0, 1.0, 0.0), (5.0, 1.5, 0.1), (7.3, 2.0, 0.03)] {
            let path = rise(duration).interpolant();
            let pieces = pieces(&path, Duration::from_secs_f64(horizon));
            assert!(pieces.len() > 4);
            let mut goals = vec![(0.0, pieces[0].motion.clone())];
            for pair in pieces.windows(2) {
                let now = pair[1].sent + late;
                let (sent, last) = &goals[goals.len() - 1];
                let [point, velocity] = [last.at(now - sent), last.velocity_at(now - sent)];
                let goal = pair[1].goal(&pair[0], now).unwrap();
                assert!((goal.times()[0] - LEAD).abs() < 1e-9);
                goals.push((now, goal.taken_at(point, velocity)));
            }
            for step in 0..=(1000.0 * duration) as usize {
                let now = 1e-3 * step as f64;
                let (sent, goal) = goals.iter().rfind(|(sent, _)| *sent <= now).unwrap();
                let off = apart(&goal.at(now - sent), &path.at(now));
                assert!(off < 2e-5, "{off} at {now} of {duration}");
            }
        }
    }

    #[test]
    fn every_piece_ends_at_rest_on_the_path_within_the_horizon() {
        let path = rise(5.0).interpolant();
        let horizon = 1.2;
        let pieces = pieces(&path, Duration::from_secs_f64(horizon));
        for piece in &pieces {
            let motion = &piece.motion;
            assert!(motion.duration() - piece.sent <= horizon + 1e-9);
            let last = &motion.velocities()[motion.times().len() - 1];
            assert!(last.iter().all(|velocity| *velocity == 0.0));
            for step in 0..=100 {
                let span = motion.duration() - motion.times()[0];
                let point = motion.at(motion.times()[0] + 0.01 * f64::from(step) * span);
                // The second joint is a multiple of the first on the whole path.
                assert!((point[1] + 0.7 * point[0]).abs() < 1e-6, "{point:?}");
            }
        }
        let last = pieces[pieces.len() - 1].motion.last();
        assert_eq!(last, path.last());
    }

    #[test]
    fn a_piece_that_comes_too_late_is_not_sent() {
        const SLACK: f64 = 0.25;
        let path = rise(5.0).interpolant();
        let pieces = pieces(&path, Duration::from_secs(1));
        let due = pieces[1].sent;
        assert!(!pieces[1].is_due(due - 1e-3) && pieces[1].is_due(due));
        assert!(pieces[1].goal(&pieces[0], due + 0.99 * SLACK).is_some());
        assert!(pieces[1].goal(&pieces[0], due + 1.01 * SLACK).is_none());
        assert!(pieces[1].goal(&pieces[0], due + 10.0).is_none());
    }

    #[test]
    fn stops_are_checked_against_limits() {
        let limits = Limits {
            lower: -2.0,
            upper: 2.0,
            velocity: 1.0,
            acceleration: 1.0,
            jerk: 10.0,
        };
        let motion = rise(4.0);
        let check = |horizon| check_stops(&motion, &[limits; 2], Duration::from_secs_f64(horizon));
        // The motion reaches 0.47 rad/s and 0.36 rad/s²; a stop from there in half a second takes
        // at least 1.4 rad/s².
        let faults = check(1.0).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert!(faults[0].contains("a: acceleration"), "{faults:?}");
        assert!(faults[0].contains("longer `streaming.horizon`"));
        assert_eq!(check(2.0), Ok(()));
    }
}
