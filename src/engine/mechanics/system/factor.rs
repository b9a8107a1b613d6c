//! The factor of a load over time.

use super::events::Event;
use crate::mechanics::scene::{Load, piecewise_linear};

/// The factor of a load as a function of time.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    /// Index of the load in the scene; `None` for other forces.
    pub load: Option<usize>,
    /// Factor at given times, s; 1 where empty.
    pub schedule: Vec<(f64, f64)>,
    /// Another factor.
    pub factor: f64,
}

impl Scale {
    /// Creates the factor of a load of the scene.
    pub(crate) fn of(number: usize, load: &Load) -> Self {
        Self {
            load: Some(number),
            schedule: load.schedule.clone(),
            factor: 1.0,
        }
    }

    /// Creates the constant factor 1, for forces that are not loads of the scene.
    pub(crate) fn steady() -> Self {
        Self {
            load: None,
            schedule: Vec::new(),
            factor: 1.0,
        }
    }

    /// Sets the additional factor if this is the factor of the given load of the scene.
    pub(crate) fn set_factor(&mut self, load: usize, factor: f64) {
        if self.load == Some(load) {
            self.factor = factor;
        }
    }

    /// Corners of its schedule.
    pub(crate) fn events(&self) -> impl Iterator<Item = Event> {
        self.schedule.iter().map(|corner| Event::of_load(corner.0))
    }

    /// Value of the factor at `time`.
    pub(crate) fn at(&self, time: f64) -> f64 {
        self.factor * piecewise_linear(&self.schedule, time).unwrap_or(1.0)
    }
}
