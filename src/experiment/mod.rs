//! Experiments: a scenario becomes a scene, with what is observed of it.

mod derived;
mod flagella;
pub(crate) mod helix;
pub(crate) mod knot;
mod probes;
#[cfg(test)]
mod probes_tests;
mod scene;

pub use derived::{DerivedNumbers, DerivedRod, derived_numbers};
pub use helix::stability::{discrete_critical_distance, estimated_critical_distance};
pub use knot::{
    KnotEnding, KnotMonitor, KnotObserver, KnotOutcome, KnotRow, KnotSample, read_knot_series,
};
pub use scene::{prepare, try_scene};
