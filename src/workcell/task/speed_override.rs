//! The speed of motions relative to the planned one, which the user may change at any time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A speed relative to the planned one, from 0 (motions are held) to 1. Copies share it.
#[derive(Clone, Debug)]
pub struct SpeedOverride(Arc<AtomicU64>);

impl SpeedOverride {
    /// A shared speed.
    pub fn new(speed: f64) -> Self {
        Self(Arc::new(AtomicU64::new(speed.to_bits())))
    }

    /// The speed.
    pub fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    /// Changes the speed.
    pub fn set(&self, speed: f64) {
        self.0.store(speed.to_bits(), Ordering::Relaxed);
    }
}
