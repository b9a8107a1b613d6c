//! Knots that are pulled tight (thesis 2.5) or until they invert (thesis 3).

pub(crate) mod monitor;
pub(crate) mod observer;
pub(crate) mod tied_knot;
pub(crate) mod tightening;

pub use observer::{KnotObserver, KnotSample};
