//! Knots that are pulled tight (thesis 2.5) or until they invert (thesis 3).

pub(crate) mod monitor;
pub(crate) mod observer;
mod outcome;
mod row;
pub(crate) mod tied_knot;
pub(crate) mod tightening;

pub use monitor::KnotMonitor;
pub use observer::{KnotObserver, KnotSample};
pub use outcome::{KnotEnding, KnotOutcome};
pub use row::{KnotRow, read_knot_series};
