//! A motion sent as a sequence of goals that each end at rest. If this program ends, the current
//! goal of the controller brings the arm to rest.
//!
//! Each goal contains the motion of a short time and then a stop along the same path: a
//! [change of pace](super::pace) to zero over half of the horizon, which covers half of the path
//! that a motion at constant pace would cover. The next goal replaces the current one before it
//! stops. A changed pace is sent with the next goal, at once.

use super::check::first_fault_between;
use super::pace::Pace;
use crate::chain::Limits;
use crate::driver::{Interpolant, PartTrajectory};
use std::time::Duration;

/// Time from sending a goal to its first point, s. Controllers move the joints to this point from
/// their present positions.
const LEAD: f64 = 0.1;
/// Points closer than this to an end of a piece are omitted, s. A cubic between such a point and
/// the end would be too short for numerical accuracy.
const NEAR: f64 = 1e-3;
/// Largest time between points while the pace changes, s.
const CHANGE_SPACING: f64 = 0.02;
/// Number of places, per horizon, at which stops are checked in advance.
const CHECKS: f64 = 10.0;

/// The division of a motion into pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Division {
    /// Time from sending a piece to its end, s; at least 1 s.
    horizon: f64,
}

/// A piece of a motion.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Time at which the piece was sent, s after the start.
    sent: f64,
    /// Time at which its stop begins, s after the start; infinite for a piece that ends at rest
    /// anyway.
    stops: f64,
    /// Whether it ends at the end of the motion.
    is_last: bool,
    /// Motion of the piece, at times since the start.
    motion: Interpolant,
}

impl Division {
    /// A division into pieces that each end `horizon` (at least 1 s) after they are sent. The stop
    /// takes the second half of `horizon`; the next piece may be late by a quarter of it.
    pub(super) fn every(horizon: Duration) -> Self {
        Self {
            horizon: horizon.as_secs_f64(),
        }
    }

    fn until_stop(self) -> f64 {
        0.5 * self.horizon
    }

    /// The first piece of a motion, sent at the start.
    pub(super) fn first(self, path: &Interpolant, pace: &Pace) -> Piece {
        self.piece(path, pace, [0.0, 0.0])
    }

    /// The piece to send at a time after the start; `None` if it is too late, since the stop of
    /// `before` has begun.
    pub(super) fn next(
        self,
        before: &Piece,
        path: &Interpolant,
        pace: &Pace,
        elapsed: f64,
    ) -> Option<Piece> {
        let begin = elapsed + LEAD;
        let arrival = pace.time_of(path.duration());
        (begin <= before.stops.min(arrival - NEAR))
            .then(|| self.piece(path, pace, [elapsed, begin]))
    }

    /// Whether a motion continues after the lead of a piece sent at a time after the start.
    pub(super) fn continues(self, path: &Interpolant, pace: &Pace, elapsed: f64) -> bool {
        elapsed + LEAD < pace.time_of(path.duration()) - NEAR
    }

    fn piece(self, path: &Interpolant, pace: &Pace, [sent, begin]: [f64; 2]) -> Piece {
        let end = sent + self.horizon;
        let arrival = pace.time_of(path.duration());
        let is_last = arrival <= end;
        let ends_at_rest = is_last || pace.target() == 0.0;
        let stops = match ends_at_rest {
            true => f64::INFINITY,
            false => sent + self.until_stop(),
        };
        let motion = match ends_at_rest {
            true => course(path, pace, begin, arrival.min(end.max(pace.settled()))),
            false => {
                let stopping = pace.changed(stops, 0.0, self.until_stop());
                course(path, &stopping, begin, end)
            }
        };
        Piece {
            sent,
            stops,
            is_last,
            motion,
        }
    }

    /// A pace that changes to `target` with the piece sent at a time after the start; `None` while
    /// an earlier change continues, and where no piece may be sent.
    pub(super) fn changed(
        self,
        pace: &Pace,
        target: f64,
        elapsed: f64,
        before: &Piece,
    ) -> Option<Pace> {
        let begin = elapsed + LEAD;
        // A motion that is to be held stops as it would by itself. Any other change is over before
        // the stop of the piece begins.
        let duration = match target > 0.0 {
            true => self.until_stop() - LEAD,
            false => self.until_stop(),
        };
        (begin >= pace.settled() && begin <= before.stops)
            .then(|| pace.changed(begin, target, duration))
    }
}

impl Piece {
    /// Whether the next piece must be sent now.
    pub(super) fn is_over(&self, division: Division, elapsed: f64) -> bool {
        let interval = 0.5 * division.until_stop() - LEAD;
        !self.is_last && elapsed >= self.sent + interval
    }

    /// Whether it ends at the end of the motion.
    pub(super) fn is_last(&self) -> bool {
        self.is_last
    }

    /// The goal to send now: the motion at times from now on.
    pub(super) fn goal(&self) -> Interpolant {
        self.motion.clone().earlier_by(self.sent)
    }

    /// The first quantity of a joint that exceeds its limits, as text.
    pub(super) fn fault(&self, joints: &[String], limits: &[Limits]) -> Option<String> {
        let mut joints = joints.iter().zip(limits).enumerate();
        joints.find_map(|(joint, (name, limits))| {
            let (what, _, value, [low, high]) = first_fault_between(&self.motion, joint, limits)?;
            Some(format!(
                "{name}: {what} {value:.6}; allowed: {low:.6} to {high:.6}"
            ))
        })
    }
}

/// The motion along `path` at a pace, between two times since the start.
fn course(path: &Interpolant, pace: &Pace, begin: f64, end: f64) -> Interpolant {
    let mut ends = vec![begin];
    for bend in pace.bends() {
        // A stop begins where a change of pace ends.
        if bend > ends[ends.len() - 1] + NEAR && bend < end - NEAR {
            ends.push(bend);
        }
    }
    ends.push(end);
    let mut times = vec![begin];
    for section in ends.windows(2) {
        let (from, to) = (section[0], section[1]);
        if pace.is_changing(0.5 * (from + to)) {
            let count = ((to - from) / CHANGE_SPACING).ceil().max(1.0);
            times.extend((1..count as usize).map(|k| from + (to - from) * k as f64 / count));
        } else {
            let [first, last] = [from + NEAR, to - NEAR].map(|time| {
                let place = pace.place(time);
                path.times().partition_point(|known| *known < place)
            });
            let knots = path.times()[first..last.max(first)].iter();
            // A motion that is held passes no points.
            times.extend(
                knots
                    .map(|place| pace.time_of(*place))
                    .filter(|time| *time < to),
            );
        }
        times.push(to);
    }
    let places = times.iter().map(|time| pace.place(*time));
    let points = places.clone().map(|place| path.at(place)).collect();
    let velocities = times.iter().zip(places).map(|(time, place)| {
        let rate = pace.rate(*time);
        let along = path.velocity_at(place);
        along.into_iter().map(|velocity| rate * velocity).collect()
    });
    let velocities = velocities.collect();
    Interpolant::with_velocities(times, points, velocities)
}

/// Checks the stops of a motion sent in pieces against limits, one per joint. The motion may have to
/// stop anywhere.
///
/// # Errors
/// A message about the first fault of each joint.
pub fn check_stops(
    trajectory: &PartTrajectory,
    limits: &[Limits],
    horizon: Duration,
) -> Result<(), Vec<String>> {
    let path = trajectory.interpolant();
    let duration = 0.5 * horizon.as_secs_f64();
    let spacing = horizon.as_secs_f64() / CHECKS;
    let count = ((path.duration() - NEAR) / spacing).ceil() as usize;
    let mut faults: Vec<Option<String>> = vec![None; limits.len()];
    for k in 0..count {
        let begin = spacing * k as f64;
        let stopping = Pace::constant(1.0).changed(begin, 0.0, duration);
        let end = stopping.time_of(path.duration()).min(begin + duration);
        let stop = course(&path, &stopping, begin, end);
        for (joint, fault) in faults.iter_mut().enumerate() {
            let found = || first_fault_between(&stop, joint, &limits[joint]);
            *fault = fault.take().or_else(|| {
                let (what, _, value, [low, high]) = found()?;
                Some(format!(
                    "{}: {what} {value:.6} in a stop from the motion at {begin:.2} s; allowed: {low:.6} to {high:.6}. A longer `streaming.horizon` stops more gently, and without it no stops are sent",
                    trajectory.joints[joint]
                ))
            });
        }
    }
    let faults: Vec<String> = faults.into_iter().flatten().collect();
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

    /// Sends the pieces of a motion over time, `late` seconds after they are due, with the pace that
    /// `wanted` returns at each time. Returns the goals with their times, and the pace.
    fn send(
        path: &Interpolant,
        horizon: f64,
        late: f64,
        wanted: impl Fn(f64) -> f64,
    ) -> (Vec<(f64, Interpolant)>, Pace) {
        let division = Division::every(Duration::from_secs_f64(horizon));
        let mut pace = Pace::constant(wanted(0.0));
        let mut last = division.first(path, &pace);
        let mut goals = vec![(0.0, last.goal())];
        for now in (1..).map(|k| 2e-3 * f64::from(k)) {
            let is_wanted = pace.target() != wanted(now);
            let changed = is_wanted.then(|| division.changed(&pace, wanted(now), now, &last));
            let changed = changed.flatten();
            if last.is_last() && changed.is_none() {
                return (goals, pace);
            }
            let is_due = last.is_over(division, now - late);
            if is_due || changed.is_some() {
                pace = changed.unwrap_or(pace);
                let Some(next) = division.next(&last, path, &pace, now) else {
                    continue;
                };
                last = next;
                let (sent, before) = &goals[goals.len() - 1];
                let [point, velocity] = [before.at(now - sent), before.velocity_at(now - sent)];
                let goal = last.goal();
                assert!((goal.times()[0] - LEAD).abs() < 1e-9);
                let spacings = goal.times().windows(2).map(|pair| pair[1] - pair[0]);
                assert!(spacings.fold(f64::INFINITY, f64::min) > 0.5 * NEAR);
                let limits = Limits {
                    lower: -1.0,
                    upper: 1.0,
                    velocity: 1.0,
                    acceleration: 3.0,
                    jerk: f64::INFINITY,
                };
                let fault = last.fault(&["a".into(), "b".into()], &[limits; 2]);
                assert_eq!(fault, None);
                goals.push((now, goal.taken_at(point, velocity)));
            }
        }
        unreachable!()
    }

    /// Each goal moves the joints from their positions at its arrival. The cubic over [`LEAD`] is
    /// off by LEAD⁴/384 of the fourth derivative of the motion, which is below 80 rad/s⁴ in these
    /// changes of pace; the next cubic may begin at this distance.
    #[test]
    fn a_controller_that_takes_all_pieces_follows_the_motion_at_its_pace() {
        let slower = |time: f64| if time < 1.7 { 1.0 } else { 0.35 };
        let held = |time: f64| if (1.2..4.3).contains(&time) { 0.0 } else { 0.8 };
        let varied = |time: f64| (0.25 * (1.0 + (0.6 * time) as i32 as f64)).min(1.0);
        let paces: [&dyn Fn(f64) -> f64; 4] = [&|_| 1.0, &slower, &held, &varied];
        for (duration, horizon, late) in [(5.0, 1.0, 0.0), (5.0, 1.5, 0.1), (7.3, 2.0, 0.03)] {
            for (which, wanted) in paces.iter().enumerate() {
                let path = rise(duration).interpolant();
                let (goals, pace) = send(&path, horizon, late, wanted);
                assert!(goals.len() > 4);
                let arrival = pace.time_of(duration);
                assert!(arrival.is_finite() && (arrival > duration) == (which > 0));
                for step in 0..=(1000.0 * arrival) as usize {
                    let now = 1e-3 * step as f64;
                    let (sent, goal) = goals.iter().rfind(|(sent, _)| *sent <= now).unwrap();
                    let off = apart(&goal.at(now - sent), &path.at(pace.place(now)));
                    let most = 2.0 * LEAD.powi(4) / 384.0 * 80.0;
                    assert!(off < most, "{off} at {now} of {duration}, pace {which}");
                }
            }
        }
    }

    #[test]
    fn every_goal_ends_at_rest_on_the_path_within_the_horizon() {
        let path = rise(5.0).interpolant();
        let horizon = 1.2;
        let wanted = |time: f64| if time < 2.0 { 1.0 } else { 0.5 };
        let (goals, _) = send(&path, horizon, 0.0, wanted);
        for (_, goal) in &goals {
            assert!(goal.duration() <= horizon + 1e-9);
            let last = &goal.velocities()[goal.times().len() - 1];
            assert!(last.iter().all(|velocity| velocity.abs() < 1e-9));
            for step in 0..=100 {
                let point = goal.at(0.01 * f64::from(step) * goal.duration());
                // The second joint is a multiple of the first on the whole path.
                assert!((point[1] + 0.7 * point[0]).abs() < 1e-6, "{point:?}");
            }
        }
        let off = apart(goals[goals.len() - 1].1.last(), path.last());
        assert!(off < 1e-12, "{off}");
    }

    #[test]
    fn a_piece_that_comes_too_late_is_not_sent() {
        const DUE: f64 = 0.25 - LEAD;
        const SLACK: f64 = 0.25;
        let path = rise(5.0).interpolant();
        let (division, pace) = (Division::every(Duration::from_secs(1)), Pace::constant(1.0));
        let first = division.first(&path, &pace);
        let next = |elapsed| division.next(&first, &path, &pace, elapsed);
        assert!(!first.is_over(division, DUE - 1e-3) && first.is_over(division, DUE));
        assert!(next(DUE + 0.99 * SLACK).is_some());
        assert!(next(DUE + 1.01 * SLACK).is_none());
        assert!(next(DUE + 10.0).is_none());
    }

    /// A motion that waits does not end, and no piece of it comes too late.
    #[test]
    fn a_held_motion_can_be_resumed_at_any_time() {
        let path = rise(5.0).interpolant();
        let division = Division::every(Duration::from_secs(1));
        let first = division.first(&path, &Pace::constant(1.0));
        let held = division.changed(&Pace::constant(1.0), 0.0, 0.1, &first);
        let held = held.unwrap();
        let waits = division.next(&first, &path, &held, 0.1).unwrap();
        assert!(!waits.is_last() && held.time_of(5.0) == f64::INFINITY);
        // Not before the joints are at rest.
        assert!(division.changed(&held, 1.0, 0.4, &waits).is_none());
        let later = division.next(&waits, &path, &held, 100.0).unwrap();
        let resumed = division.changed(&held, 1.0, 200.0, &later).unwrap();
        let moves = division.next(&later, &path, &resumed, 200.0).unwrap();
        assert!(moves.motion.at(200.8)[0] > moves.motion.at(200.1)[0] + 1e-6);
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
