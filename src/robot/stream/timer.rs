//! Source of time of a stream: the machine, or simulated in tests.

use std::time::{Duration, Instant};

/// A source of time.
pub(super) trait Timer {
    /// The present time.
    fn now(&self) -> Instant;

    /// Waits.
    fn sleep(&self, time: Duration);

    /// Whether it is the time of the machine.
    fn is_real(&self) -> bool {
        false
    }
}

/// The time of the machine.
pub(super) struct SystemTimer;

impl Timer for SystemTimer {
    fn now(&self) -> Instant {
        Instant::now()
    }

    fn sleep(&self, time: Duration) {
        std::thread::sleep(time);
    }

    fn is_real(&self) -> bool {
        true
    }
}
