//! The time of this computer.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Time since the beginning of 1970; zero if the clock is before it.
pub fn unix_time() -> Duration {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.unwrap_or_default()
}
