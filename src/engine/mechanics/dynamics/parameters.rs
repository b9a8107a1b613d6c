//! Parameters of the time integration, with the reason for each default.

/// Settings of time stepping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegrationParameters {
    /// Time integration scheme. Implicit Euler by default: the scheme of the thesis. This scheme
    /// handles impacts and friction directly, and damps motions that its steps do not resolve.
    pub scheme: Scheme,
    /// Size of the time step, s. 1 ms by default: a clamped rod with a radius of a millimetre, a
    /// modulus of a MPa and a length of some centimetres swings in tenths of a second. At walking
    /// speed it moves by less than its own radius per step.
    pub step: StepSize,
    /// Newton stops when the residual of every degree of freedom is below this multiple of the force
    /// scale: the largest of EI/L² of the stiffest rod, the nodal loads and the contact forces.
    ///
    /// 1e-6 by default. Newton's method converges quadratically, so that one more iteration gains
    /// six digits. At 1e-3 the errors of many steps show in the momentum; at 1e-10 rounding errors
    /// of stiff rods are reached.
    pub force_tolerance: f64,
    /// The last correction must also have moved every node by at most this multiple of the radius
    /// of the thinnest rod.
    ///
    /// 1e-4 by default, a hundredth of the gap of a contact: a larger correction may have closed a
    /// contact whose force is missing.
    pub displacement_tolerance: f64,
    /// Newton iterations after which a step counts as failed and is halved. 40 by default: steps
    /// take two to six, those with many new contacts up to thirty; later convergence is rare.
    pub maximum_iterations: usize,
    /// Smallest step before the run is given up, s. 1 ns by default, a millionth of the default
    /// step: twenty halvings.
    pub minimum_step: f64,
}

/// Time integration schemes; `dynamics/scheme` derives them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// First order, damps fast modes, and allows jumps of the velocity.
    ImplicitEuler,
    /// Second order, conserves momentum and nearly energy, without damping.
    ImplicitMidpoint,
    /// Third order except for inertia, which is of second order. Damps fast modes; uses the drag
    /// of the predicted motion.
    BackwardDifferences,
}

/// Fixed or error-controlled time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepSize {
    /// A constant step, s, halved and retried only if Newton's method fails.
    Fixed(f64),
    /// Steps chosen by the local error, between bounds.
    Auto {
        /// Local error allowed per step, as a multiple of the radius of the thinnest rod.
        tolerance: f64,
        /// Largest step, s; the first one is a thousandth of it.
        maximum: f64,
    },
}

impl StepSize {
    /// Largest step allowed, s.
    pub(crate) fn largest(&self) -> f64 {
        match *self {
            Self::Fixed(step) | Self::Auto { maximum: step, .. } => step,
        }
    }

    /// Limits steps chosen by the error to `largest`, s; fixed steps are unchanged.
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
