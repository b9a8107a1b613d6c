//! How far joints may be from where they should be, and how long a robot may be silent or stand still.

use crate::chain::JointKind;
use std::time::Duration;

/// A distance for joints that turn and one for joints that slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of joints that turn, rad.
    pub revolute: f64,
    /// Of joints that slide, m.
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
}

/// Bounds of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamBounds {
    /// Greatest distance of a joint from the first point at the start, and from the last point at the end.
    pub start: Tolerance,
    /// Greatest distance of a joint from the trajectory on the way.
    pub tracking: Tolerance,
    /// Longest silence.
    pub watchdog: Duration,
    /// Longest time for which an arm may stand still on its way. `None`: for any time where the feedback of its controller
    /// shows that the setpoint stands still, too, as in a pause, and not at all otherwise.
    pub longest_pause: Option<Duration>,
    /// Time after which a controller that takes goals comes to rest when nothing is sent any more. `None`: it has the whole motion.
    pub horizon: Option<Duration>,
}

impl Default for StreamBounds {
    /// Start and end within 0.02 rad and 2 mm, the way within 0.05 rad and 5 mm, silence of 0.3 s: reports of joints at 100 Hz may
    /// be lost 30 times before the arm is stopped, and the stop comes within half a second.
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
