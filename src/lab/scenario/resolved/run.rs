//! Time as resolved.

use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

/// Whether the scene moves in time, rests, or follows a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "mode", rename_all = "kebab-case")]
pub enum Time {
    /// Newton's method without inertia.
    Static,
    /// Equilibria along a path.
    Continuation,
    /// Time steps from zero to `end`.
    Dynamic {
        /// Time integration scheme.
        scheme: Scheme,
        /// Size of the steps.
        #[serde(flatten)]
        step: Step,
        /// End of the simulated time, s.
        end: f64,
        /// Where the motion begins.
        #[serde(skip_serializing_if = "Begin::is_placed")]
        begin: Begin,
    },
}

/// Where a motion begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Begin {
    /// With all rods as placed.
    Placed,
    /// With the rods in equilibrium at time zero.
    Equilibrium,
}

impl Begin {
    // The signature that serde requires.
    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde passes a reference"
    )]
    fn is_placed(&self) -> bool {
        *self == Self::Placed
    }
}

impl Time {
    /// Message for friction in a run that finds equilibria.
    pub const RESTING_FRICTION: &str = "an equilibrium does not determine the direction of \
        friction; allowed: time.mode = \"dynamic\" with time.begin = \"placed\"";

    /// Whether the run finds equilibria.
    pub fn finds_equilibria(&self) -> bool {
        match self {
            Self::Static | Self::Continuation => true,
            Self::Dynamic { begin, .. } => !begin.is_placed(),
        }
    }

    /// Fixed step size (`None` if automatic) and end of a dynamic run, s; `None` for other runs.
    pub fn steps(&self) -> Option<(Option<f64>, f64)> {
        match *self {
            Self::Static | Self::Continuation => None,
            Self::Dynamic { step, end, .. } => match step {
                Step::Fixed(step) => Some((Some(step), end)),
                Step::Auto { .. } => Some((None, end)),
            },
        }
    }
}

/// Time integration schemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Scheme {
    /// First order, damps fast modes.
    ImplicitEuler,
    /// Second order, conserves momentum and nearly energy.
    ImplicitMidpoint,
    /// Third order except for inertia, damps fast modes. Drag due to the motion of other nodes is
    /// also third order.
    BackwardDifferences,
}

/// Size of the time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A fixed step, s.
    Fixed(f64),
    /// Step chosen by the local error.
    Auto {
        /// Local error allowed per step, as a multiple of the rod radius.
        tolerance: f64,
        /// Largest step, s.
        maximum: f64,
    },
}

impl Serialize for Step {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Fixed(step) => {
                let mut table = serializer.serialize_map(Some(1))?;
                table.serialize_entry("step", step)?;
                table.end()
            }
            Self::Auto { tolerance, maximum } => {
                let mut table = serializer.serialize_map(Some(3))?;
                table.serialize_entry("step", "auto")?;
                table.serialize_entry("tolerance", tolerance)?;
                table.serialize_entry("maximum_step", maximum)?;
                table.end()
            }
        }
    }
}
