//! Parameters of the time integration, with the reason for each default.

/// How a simulation advances in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegrationParameters {
    /// Time integration scheme.
    pub scheme: Scheme,
    /// Size of the time step.
    pub step: StepSize,
    /// Newton stops when the residual of every degree of freedom is below this multiple of the force
    /// scale: the largest of EI/L² of the stiffest rod, the nodal loads and the contact forces.
    /// Smaller costs an iteration or two; larger lets errors of that size into the momentum balance.
    pub force_tolerance: f64,
    /// ... and when the last correction moved no node by more than this multiple of the rod radius.
    pub displacement_tolerance: f64,
    /// Newton iterations after which a step counts as failed and is halved.
    pub maximum_iterations: usize,
    /// Smallest step before the run is given up, s.
    pub minimum_step: f64,
}

/// Time integration schemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// First order, damps fast modes.
    ImplicitEuler,
    /// Second order, conserves momentum and nearly energy.
    ImplicitMidpoint,
    /// Third order but for inertia, damps fast modes: backward differences, drag of the predicted motion.
    BackwardDifferences,
}

/// Fixed or error-controlled time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepSize {
    /// The same step always (halved and retried only where Newton fails), s.
    Fixed(f64),
    /// Chosen by the local error, between bounds.
    Auto {
        /// Local error allowed per step, as a multiple of the rod radius.
        tolerance: f64,
        /// Largest step, s.
        maximum: f64,
    },
}

impl StepSize {
    /// Largest step that may be taken, s.
    pub fn largest(&self) -> f64 {
        match *self {
            Self::Fixed(step) | Self::Auto { maximum: step, .. } => step,
        }
    }

    /// The same with steps chosen by the error no larger than `largest`, s; fixed steps stay.
    pub(super) fn limited(self, largest: f64) -> Self {
        match self {
            Self::Fixed(_) => self,
            Self::Auto { tolerance, maximum } => Self::Auto {
                tolerance,
                maximum: maximum.min(largest),
            },
        }
    }
}

impl Default for IntegrationParameters {
    fn default() -> Self {
        Self {
            scheme: Scheme::ImplicitEuler,
            step: StepSize::Fixed(1e-3),
            force_tolerance: 1e-6,
            displacement_tolerance: 1e-4,
            maximum_iterations: 40,
            minimum_step: 1e-9,
        }
    }
}
