//! The last reports of the joints of a part, and whether they show the joints at rest.

use super::bounds::Tolerance;
use crate::chain::JointKind;
use crate::driver::{JointState, range_of};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Movement below which a joint counts as still: larger than encoder noise.
pub(super) const STILL: Tolerance = Tolerance {
    revolute: 1e-3,
    prismatic: 1e-4,
};
/// Time without movement after which joints are at rest, s.
const REST: f64 = 0.1;
/// Time without movement after which joints are at rest after a stop request, which may have been
/// ignored. Motion slower than 4 mrad/s or 0.4 mm/s is not detected.
const REST_AFTER_STOP: Duration = Duration::from_millis(250);
/// Age up to which a report counts as current.
const FRESH: Duration = Duration::from_millis(250);
/// Time for which reports are stored, s.
const KEPT: f64 = 2.0;

/// Reports of a part, with times on two clocks.
pub(super) struct Reports {
    kinds: Vec<JointKind>,
    kept: VecDeque<Report>,
}

struct Report {
    /// Time of reception.
    received: Instant,
    /// Time on the clock of the motion, s.
    time: f64,
    positions: Vec<f64>,
}

impl Reports {
    pub(super) fn new(kinds: &[JointKind]) -> Self {
        Self {
            kinds: kinds.to_vec(),
            kept: VecDeque::new(),
        }
    }

    /// Stores a report; `false` if it is not new. `time` is on the clock of the motion, s.
    pub(super) fn add(&mut self, state: &JointState, time: f64) -> bool {
        if (self.kept.back()).is_some_and(|last| last.received == state.received) {
            return false;
        }
        self.kept.push_back(Report {
            received: state.received,
            time,
            positions: state.positions.clone(),
        });
        // Keep the last report before the stored period, too.
        while self.kept.len() > 2 && self.kept[1].time < time - KEPT {
            self.kept.pop_front();
        }
        true
    }

    /// Positions of the last report, rad or m.
    pub(super) fn last(&self) -> Option<&[f64]> {
        Some(&self.kept.back()?.positions)
    }

    /// Greatest movement of a joint in the last `window`, s, on the clock of the motion, as a
    /// multiple of `unit`; `None` if the reports do not reach back that far.
    pub(super) fn movement(&self, window: f64, unit: &Tolerance) -> Option<f64> {
        let last = self.kept.back()?;
        let begin = last.time - window;
        let first = self.kept.iter().rposition(|report| report.time <= begin)?;
        Some(self.spread(first, unit))
    }

    /// Whether the joints have not moved in the last tenth of a second, on the clock of the motion.
    pub(super) fn are_at_rest(&self) -> bool {
        self.movement(REST, &STILL)
            .is_some_and(|moved| moved <= 1.0)
    }

    /// Whether the joints have not moved in the last quarter of a second according to the times of
    /// reception, with reports still arriving at `now`.
    pub(super) fn have_come_to_rest(&self, now: Instant) -> bool {
        let Some(last) = self.kept.back() else {
            return false;
        };
        let reaches_back =
            |report: &Report| last.received.duration_since(report.received) >= REST_AFTER_STOP;
        let is_fresh = now.duration_since(last.received) < FRESH;
        let first = self.kept.iter().rposition(reaches_back);
        is_fresh && first.is_some_and(|first| self.spread(first, &STILL) <= 1.0)
    }

    /// Largest range of the positions of a joint since a report, as a multiple of `unit`.
    fn spread(&self, first: usize, unit: &Tolerance) -> f64 {
        let joints = self.kinds.iter().enumerate().map(|(joint, kind)| {
            let reports = self.kept.iter().skip(first);
            let positions = || reports.clone().map(|report| report.positions[joint]);
            // A position that is not a number counts as unbounded movement.
            if !positions().all(f64::is_finite) {
                return f64::INFINITY;
            }
            let [low, high] = range_of(positions());
            (high - low) / unit.of(*kind)
        });
        joints.fold(0.0, f64::max)
    }
}
