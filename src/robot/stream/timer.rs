//! Time as a stream reads it: of the machine, or simulated in tests.

use std::time::{Duration, Instant};

/// A source of time.
pub(super) trait Timer {
    /// The present.
    fn now(&self) -> Instant;

    /// Lets time pass.
    fn sleep(&self, time: Duration);
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
}
