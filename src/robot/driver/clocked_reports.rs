//! Reports of joints, and the time of a simulated robot from a separate topic.

use super::JointState;
use crate::unix_time::unix_time;
use std::time::{Duration, Instant};

/// Longest wait for the first message of the clock to which the stamps belong.
const PATIENCE: Duration = Duration::from_secs(1);
/// Difference between a stamp and the time of this machine above which the stamp belongs to
/// another clock, s.
const OTHER_CLOCK: f64 = 60.0;

/// The last report and the last time that were received.
#[derive(Debug, Default)]
pub(super) struct ClockedReports {
    opened: Option<Instant>,
    state: Option<JointState>,
    clock: Option<(f64, Instant)>,
}

impl ClockedReports {
    /// Starts with a new connection; reports of an earlier one are kept.
    pub(super) fn open(&mut self) {
        self.opened = Some(Instant::now());
    }

    /// Stores a report, valid at `stamp`, s, on the robot's clock if the message has one. `None`
    /// changes nothing.
    pub(super) fn add(&mut self, state: Option<JointState>, stamp: Option<f64>) {
        if let Some(state) = state {
            self.state = Some(JointState { stamp, ..state });
        }
    }

    /// Stores the time of the robot's clock, s.
    pub(super) fn set_time(&mut self, time: f64) {
        self.clock = Some((time, Instant::now()));
    }

    /// The last report. A motion starts with the first report, and needs the clock of the robot
    /// from then on. If the stamp does not belong to the clock of this machine, the report is held
    /// back until a time of the robot's clock arrives, for at most [`PATIENCE`].
    pub(super) fn state(&self) -> Option<JointState> {
        let state = self.state.clone()?;
        let may_wait = self.opened.is_some_and(|at| at.elapsed() < PATIENCE);
        let waits = self.clock.is_none() && may_wait && is_of_another_clock(state.stamp);
        (!waits).then_some(state)
    }

    /// Whether a time has passed and a report has arrived after it, or none ever has.
    pub(super) fn is_past(&self, time: Instant) -> bool {
        let has_passed = Instant::now() > time;
        has_passed
            && self
                .state
                .as_ref()
                .is_none_or(|state| state.received > time)
    }

    /// The last time of the robot's clock, s, and when it was received.
    pub(super) fn clock(&self) -> Option<(f64, Instant)> {
        self.clock
    }
}

/// Whether a stamp, s, belongs to another clock than that of this machine. A stamp of zero means
/// no stamp.
fn is_of_another_clock(stamp: Option<f64>) -> bool {
    let ours = unix_time().as_secs_f64();
    stamp.is_some_and(|stamp| stamp > 0.0 && (stamp - ours).abs() > OTHER_CLOCK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Option<JointState> {
        JointState::heard(&["a".into()], &["a".to_owned()], |_| Some(0.5), |_| None)
    }

    #[test]
    fn a_time_is_past_once_a_report_has_arrived_after_it() {
        let mut reports = ClockedReports::default();
        let before = Instant::now();
        std::thread::sleep(Duration::from_millis(1));
        assert!(reports.is_past(before));
        reports.add(report(), None);
        assert!(reports.is_past(before));
        let later = Instant::now();
        std::thread::sleep(Duration::from_millis(1));
        assert!(!reports.is_past(later));
        assert!(!reports.is_past(later + Duration::from_secs(3600)));
    }

    #[test]
    fn a_report_of_a_simulated_robot_waits_for_the_clock() {
        let mut reports = ClockedReports::default();
        reports.open();
        reports.add(report(), Some(28.8));
        assert_eq!(reports.state(), None);
        reports.set_time(28.9);
        assert_eq!(reports.state().unwrap().stamp, Some(28.8));
    }

    #[test]
    fn other_reports_do_not_wait() {
        let now = unix_time();
        for stamp in [None, Some(0.0), Some(now.as_secs_f64())] {
            let mut reports = ClockedReports::default();
            reports.open();
            reports.add(report(), stamp);
            assert_eq!(reports.state().unwrap().positions, [0.5]);
        }
        // Waits for a missing clock only at the start.
        let mut reports = ClockedReports {
            opened: Instant::now().checked_sub(2 * PATIENCE),
            ..ClockedReports::default()
        };
        reports.add(report(), Some(28.8));
        assert!(reports.state().is_some());
    }
}
