//! The factor of a load over time.

use crate::mechanics::scene::piecewise_linear;

/// The factor of a load as a function of time.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Number of the load in the scene, if it is one.
    pub load: Option<usize>,
    /// Factor at given times, s; 1 where empty.
    pub schedule: Vec<(f64, f64)>,
    /// Another factor.
    pub factor: f64,
}

impl Scale {
    /// Its value at `time`.
    pub(crate) fn at(&self, time: f64) -> f64 {
        self.factor * piecewise_linear(&self.schedule, time).unwrap_or(1.0)
    }
}
