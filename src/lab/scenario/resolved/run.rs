//! Time as resolved.

use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

/// Whether the scene moves in time or rests.
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
    /// With everything as placed.
    Placed,
    /// In the equilibrium at time zero.
    Equilibrium,
}

impl Begin {
    // The signature that serialisation asks for.
    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde passes a reference"
    )]
    fn is_placed(&self) -> bool {
        *self == Self::Placed
    }
}

impl Time {
    /// The size of steps that have one, and the end of a dynamic run, s; `None` for others.
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
    /// Third order except for inertia, damps fast modes; drag of other nodes' motion to third order too.
    BackwardDifferences,
}

/// Size of the time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// The same step always, s.
    Fixed(f64),
    /// Chosen by the local error.
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
