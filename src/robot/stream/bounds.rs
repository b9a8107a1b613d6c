//! Tolerances of a stream: deviations of joints, and durations of silence and standstill.

use crate::chain::JointKind;
use std::time::Duration;

/// A distance for revolute joints and one for prismatic joints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Distance for revolute joints, rad.
    pub revolute: f64,
    /// Distance for prismatic joints, m.
    pub prismatic: f64,
}

impl Tolerance {
    /// The distance for a joint of a kind, rad or m.
    pub fn of(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => self.revolute,
            JointKind::Prismatic => self.prismatic,
        }
    }

    /// The larger distance of each kind.
    pub fn max(self, other: Self) -> Self {
        Self {
            revolute: self.revolute.max(other.revolute),
            prismatic: self.prismatic.max(other.prismatic),
        }
    }
}

/// Tolerances of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamBounds {
    /// Greatest distance of a joint from the first point at the start, and from the last point at the end.
    pub start: Tolerance,
    /// Greatest distance of a joint from the trajectory during the motion.
    pub tracking: Tolerance,
    /// Longest time without reports.
    pub watchdog: Duration,
    /// Longest pause of an arm during the motion. With `None`, a pause is allowed only if the
    /// feedback of the controller shows a constant setpoint; its length is then unlimited.
    pub longest_pause: Option<Duration>,
    /// Time after which a controller comes to rest when no more goals are sent. With `None`, the
    /// whole motion is sent as one goal.
    pub horizon: Option<Duration>,
}

impl Default for StreamBounds {
    /// Start and end within 0.02 rad and 2 mm, tracking within 0.05 rad and 5 mm, and silence of
    /// at most 0.3 s. With joint reports at 100 Hz, 30 reports may be lost before the arm is
    /// stopped, and the stop follows within half a second.
    fn default() -> Self {
        Self {
            start: Tolerance {
                revolute: 0.02,
                prismatic: 2e-3,
            },
            tracking: Tolerance {
                revolute: 0.05,
                prismatic: 5e-3,
            },
            watchdog: Duration::from_millis(300),
            longest_pause: None,
            horizon: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_that_turn_may_deviate_by_an_angle_and_slides_by_a_length() {
        let bounds = StreamBounds::default();
        for (tolerance, turn, slide) in [(bounds.start, 0.02, 2e-3), (bounds.tracking, 0.05, 5e-3)]
        {
            assert_eq!(tolerance.of(JointKind::Revolute), turn);
            assert_eq!(tolerance.of(JointKind::Prismatic), slide);
        }
    }
}
