//! Checks by joint reports whether an arm follows its trajectory.
//!
//! A controller may run a trajectory more slowly than planned, because of a speed slider, a pause
//! or a late start. A single part may lag without bound, as long as it moves along its path.
//! Several parts, or a motion sent in pieces, must keep the clock: each may lag by at most
//! [`LATENESS`].

use super::bounds::{StreamBounds, Tolerance};
use super::pace::Pace;
use super::reports::{Reports, STILL};
use crate::chain::JointKind;
use crate::driver::{Interpolant, JointState, PartTrajectory, range_of};

/// Allowed lag of an arm, s, up to which it may be away from its trajectory.
pub(super) const LATENESS: f64 = 0.3;
/// Time, s, after which an arm counts as still if it does not move while its trajectory does.
const WINDOW: f64 = 0.2;
/// Time within which an arm must start to move, s.
const START: f64 = 2.0;
/// Time after which a constant setpoint counts as still, s; feedback is less frequent than joint
/// reports.
const GRACE: f64 = 0.1;
/// Least motion of a trajectory that is compared with that of the arm, as a fraction of the
/// tracking tolerance.
const NOTICEABLE: f64 = 0.2;
/// Fraction of the motion of the trajectory below which an arm counts as still.
const STILL_PART: f64 = 0.1;
/// Growth of the lag after which an arm counts as still, s.
const SLOW: f64 = 1.0;
/// Number of samples of the trajectory within the allowed lag, and of trial lags if the lag grows.
const SAMPLES: usize = 16;

/// Follows one part.
pub(super) struct Follower {
    joints: Vec<String>,
    kinds: Vec<JointKind>,
    path: Interpolant,
    pub(super) reports: Reports,
    setpoints: Reports,
    /// Time by which the arm lags behind the clock of the motion, beyond [`LATENESS`], s.
    lag: f64,
    /// Time of the trajectory that the arm has reached, s.
    reached: f64,
    has_moved: bool,
    /// Time since which the arm has been still during the motion, on the clock of the motion, s.
    still_since: Option<f64>,
    /// Whether the standstill was reported as a pause.
    is_paused: bool,
    /// Lag when the joints came to rest, s.
    lag_at_rest: Option<f64>,
    /// Largest distances from the trajectory at the time of the last report.
    tracking: Tolerance,
}

/// Result of the check of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// The arm follows, or has not started yet.
    Follows,
    /// The controller of the arm has paused; returned once per pause.
    Pauses,
    /// The arm moves again after a pause.
    Resumes,
}

/// Context of a report.
pub(super) struct Circumstances<'a> {
    /// Time of the report on the clock of the motion, s.
    pub time: f64,
    /// Pace of the motion: the place on the trajectory that is due at each time of this clock.
    pub pace: &'a Pace,
    /// Rate of that clock relative to real time, at least 1.
    pub rate: f64,
    /// Largest rate of that clock so far.
    pub greatest_rate: f64,
    /// Whether the controller has accepted the motion.
    pub is_accepted: bool,
    /// Whether the controller has reported the end of the motion.
    pub is_done: bool,
    /// Whether the part must keep the clock: other parts move, too, or the motion is sent in
    /// pieces.
    pub keeps_clock: bool,
    /// Setpoint of the controller, if reported.
    pub setpoint: Option<&'a JointState>,
    /// Bounds of the motion.
    pub bounds: &'a StreamBounds,
}

impl Circumstances<'_> {
    /// Place on the trajectory at the time of the report, of an arm that is late by `lag`, s.
    pub(super) fn place(&self, lag: f64) -> f64 {
        self.pace.place(self.time - lag)
    }
}

impl Follower {
    pub(super) fn new(trajectory: &PartTrajectory, kinds: &[JointKind]) -> Self {
        Self {
            joints: trajectory.joints.clone(),
            kinds: kinds.to_vec(),
            path: trajectory.interpolant(),
            reports: Reports::new(kinds),
            setpoints: Reports::new(kinds),
            lag: 0.0,
            reached: 0.0,
            has_moved: false,
            still_since: None,
            is_paused: false,
            lag_at_rest: None,
            tracking: Tolerance::default(),
        }
    }

    /// Time by which the arm lags behind the clock of the motion, s.
    pub(super) fn lag(&self) -> f64 {
        self.lag
    }

    /// Largest distances of the joints from the trajectory at the time of the last report.
    pub(super) fn tracking(&self) -> Tolerance {
        self.tracking
    }

    /// Whether the arm has begun to move.
    pub(super) fn has_moved(&self) -> bool {
        self.has_moved
    }

    /// Reads a report.
    ///
    /// # Errors
    /// The arm is too far from its trajectory, or does not follow it.
    pub(super) fn report(
        &mut self,
        state: &JointState,
        now: &Circumstances<'_>,
    ) -> Result<Motion, String> {
        if !self.reports.add(state, now.time) {
            return Ok(Motion::Follows);
        }
        if let Some(setpoint) = now.setpoint {
            self.setpoints.add(setpoint, now.time);
        }
        let first = |joint: usize| [self.path.first()[joint]; 2];
        let from_start = self.distance(&state.positions, first, now.bounds);
        self.has_moved |= from_start.1 > NOTICEABLE;
        self.find_lag(state, now)?;
        self.tracking = self.tracking_at(&state.positions, now.place(self.lag));
        self.look_for_stop(now)
    }

    /// Finds the lag at which the arm is within the tolerance of its trajectory.
    fn find_lag(&mut self, state: &JointState, now: &Circumstances<'_>) -> Result<(), String> {
        let due = now.time - self.lag;
        let (worst, distance) = self.distance_at(&state.positions, due, now);
        if distance <= 1.0 {
            self.reached = self.reached.max(due);
            return Ok(());
        }
        let most = match now.keeps_clock {
            false => f64::INFINITY,
            // A clock that was fast when the arm received the command may be slow now.
            true => (LATENESS * (now.greatest_rate - now.rate) - self.lag).max(0.0),
        };
        let room = (due - self.reached).min(most);
        for k in 1..=SAMPLES {
            let more = room * k as f64 / SAMPLES as f64;
            if more > 0.0 && self.distance_at(&state.positions, due - more, now).1 <= 1.0 {
                self.lag += more;
                self.reached = self.reached.max(due - more);
                return Ok(());
            }
        }
        if distance.is_infinite() {
            let joint = &self.joints[worst];
            return Err(format!("{joint} reports a position that is not a number"));
        }
        let kind = self.kinds[worst];
        let allowed = now.bounds.tracking.of(kind);
        Err(format!(
            "{} is {:.4} {unit} from its trajectory; allowed: {allowed} {unit}",
            self.joints[worst],
            distance * allowed,
            unit = kind.unit(),
        ))
    }

    /// Largest distances of positions from a place on the trajectory, s.
    fn tracking_at(&self, positions: &[f64], place: f64) -> Tolerance {
        let should = self.path.at(place);
        let mut largest = Tolerance::default();
        for (kind, (at, should)) in self.kinds.iter().zip(positions.iter().zip(&should)) {
            let largest = match kind {
                JointKind::Revolute => &mut largest.revolute,
                JointKind::Prismatic => &mut largest.prismatic,
            };
            *largest = largest.max((at - should).abs());
        }
        largest
    }

    /// The joint farthest from the recent part of its trajectory, and its distance relative to the
    /// tolerance.
    fn distance_at(&self, positions: &[f64], due: f64, now: &Circumstances<'_>) -> (usize, f64) {
        let lateness = LATENESS * now.rate;
        // A lagging arm may also be catching up.
        let ends = [due - lateness, now.time.min(due + lateness)];
        let [since, until] = ends.map(|time| now.pace.place(time));
        let knots = self.path.times();
        let [first, last] = [since, until].map(|end| knots.partition_point(|t| *t < end));
        let samples = (0..=SAMPLES).map(|k| since + (until - since) * k as f64 / SAMPLES as f64);
        // If there are many points, a few suffice, since they are close together.
        let stride = (last - first).div_ceil(4 * SAMPLES).max(1);
        let knots = knots[first..last].iter().step_by(stride).copied();
        let places: Vec<Vec<f64>> = samples
            .chain(knots)
            .map(|place| self.path.at(place))
            .collect();
        let range = |joint: usize| range_of(places.iter().map(|place| place[joint]));
        self.distance(positions, range, now.bounds)
    }

    /// The joint farthest outside a range, and its distance relative to the tracking tolerance.
    fn distance(
        &self,
        positions: &[f64],
        range: impl Fn(usize) -> [f64; 2],
        bounds: &StreamBounds,
    ) -> (usize, f64) {
        let distances = self.kinds.iter().enumerate().map(|(joint, kind)| {
            let [low, high] = range(joint);
            let position = positions[joint];
            // A position that is not a number counts as infinitely far.
            let distance = if position.is_finite() {
                (low - position).max(position - high).max(0.0)
            } else {
                f64::INFINITY
            };
            (joint, distance / bounds.tracking.of(*kind))
        });
        distances
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, 0.0))
    }

    /// Detects an arm that does not move while its trajectory does.
    fn look_for_stop(&mut self, now: &Circumstances<'_>) -> Result<Motion, String> {
        if !self.is_still(now) {
            self.still_since = None;
            return Ok(match std::mem::take(&mut self.is_paused) {
                true => Motion::Resumes,
                false => Motion::Follows,
            });
        }
        let since = *self.still_since.get_or_insert(now.time);
        if !self.has_moved {
            // The arm may start late: the driver may still wait for an answer to its goal, and
            // several parts are checked against their common clock.
            let is_early = now.time / now.rate < START && !now.is_done;
            return match is_early || !now.is_accepted || now.keeps_clock {
                true => Ok(Motion::Follows),
                false => Err("its joints do not begin to move (are its drives on?)".into()),
            };
        }
        let longest = now.bounds.longest_pause;
        let may_pause = !now.keeps_clock
            && !now.is_done
            && match longest {
                Some(longest) => (now.time - since) / now.rate <= longest.as_secs_f64(),
                None => {
                    let may_show = self.setpoints.last().is_some();
                    self.setpoint_is_still(now) || (may_show && now.time - since < GRACE * now.rate)
                }
            };
        if may_pause {
            return Ok(match std::mem::replace(&mut self.is_paused, true) {
                true => Motion::Follows,
                false => Motion::Pauses,
            });
        }
        let advice = match (now.keeps_clock, longest) {
            (true, _) => "no part may pause where several parts move or `streaming.horizon` is set",
            (false, Some(_)) => "longer than `streaming.longest_pause` of the cell file",
            (false, None) => {
                "its drives are off, or it is paused; where the controller does not report its \
                 setpoint, `streaming.longest_pause` of the cell file allows pauses"
            }
        };
        Err(format!(
            "its joints do not move although its trajectory does: {advice}"
        ))
    }

    /// Whether the arm stands still although its trajectory moved at all times within the allowed
    /// lag.
    fn is_still(&mut self, now: &Circumstances<'_>) -> bool {
        let window = WINDOW * now.rate;
        let moved = self.reports.movement(window, &now.bounds.tracking);
        let (Some(moved), Some(noise)) = (moved, self.reports.movement(window, &STILL)) else {
            return false;
        };
        // If the trajectory is slow, only the growing lag shows that the arm is still.
        let lag = self.lag;
        self.lag_at_rest = (noise <= 1.0).then(|| self.lag_at_rest.unwrap_or(lag));
        let falls_behind = (self.lag_at_rest).is_some_and(|then| lag - then > SLOW * now.rate);
        let due = now.time - self.lag;
        let since = due - LATENESS * now.rate;
        let until = now.time.min(due + LATENESS * now.rate);
        let least = (0..=SAMPLES).map(|k| {
            let end = since + (until - since) * k as f64 / SAMPLES as f64;
            let ends = [end - window, end].map(|time| self.path.at(now.pace.place(time)));
            let range = |joint: usize| [ends[0][joint]; 2];
            self.distance(&ends[1], range, now.bounds).1
        });
        let least = least.fold(f64::INFINITY, f64::min);
        falls_behind || (least > NOTICEABLE && moved < STILL_PART * least)
    }

    /// Whether the setpoint of the controller is constant while the arm is still.
    fn setpoint_is_still(&self, now: &Circumstances<'_>) -> bool {
        let [arm, setpoint] = [&self.reports, &self.setpoints]
            .map(|reports| reports.movement(WINDOW * now.rate, &now.bounds.tracking));
        let places = self.reports.last().zip(self.setpoints.last());
        arm.zip(setpoint)
            .is_some_and(|(arm, setpoint)| setpoint < arm + 0.1 * NOTICEABLE)
            && places.is_some_and(|(at, setpoint)| {
                let range = |joint: usize| [setpoint[joint]; 2];
                self.distance(at, range, now.bounds).1 <= 1.0
            })
    }

    /// Whether the joints are at the last point and at rest, once the trajectory is over.
    pub(super) fn has_arrived(&self, now: &Circumstances<'_>) -> bool {
        now.place(self.lag) >= self.path.duration()
            && self.reports.are_at_rest()
            && self.missed_joint(now.bounds).is_none()
    }

    /// The joint that is not at the last point according to the last report, with its distance, as
    /// text.
    pub(super) fn missed_joint(&self, bounds: &StreamBounds) -> Option<String> {
        let positions = self.reports.last()?;
        apart(
            &self.joints,
            &self.kinds,
            positions,
            self.path.last(),
            bounds,
        )
    }
}

/// A joint that is farther from a point than the start tolerance, as text; `None` if all are near.
pub(super) fn apart(
    joints: &[String],
    kinds: &[JointKind],
    positions: &[f64],
    point: &[f64],
    bounds: &StreamBounds,
) -> Option<String> {
    let all = joints.iter().zip(kinds).zip(positions.iter().zip(point));
    let mut apart =
        all.filter(|((_, kind), (at, should))| !((*at - *should).abs() <= bounds.start.of(**kind)));
    apart.next().map(|((joint, kind), (at, should))| {
        let unit = kind.unit();
        format!(
            "{joint} is at {at:.4} {unit}, {:.4} {unit} from {should:.4} {unit}; allowed: {} {unit}",
            (at - should).abs(),
            bounds.start.of(*kind)
        )
    })
}
