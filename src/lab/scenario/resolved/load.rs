//! Clamps as resolved.

use super::movement::Movement;
use crate::scenario::place::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Degrees of freedom that a clamp holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Hold {
    /// The position of the node.
    Position,
    /// Tangent and material frame at the node.
    Frame,
    /// Position and frame.
    Both,
}

/// A held or driven node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Clamp {
    /// Name of the rod.
    pub rod: String,
    /// Node along the rod.
    pub at: Place,
    /// Held degrees of freedom.
    pub hold: Hold,
    /// Displacement from the placed position, m.
    #[serde(skip_serializing_if = "is_zero")]
    pub offset: [f64; 3],
    /// Rotation vector about the node, relative to the placed orientation, rad.
    #[serde(skip_serializing_if = "is_zero")]
    pub rotation: [f64; 3],
    /// Motion of the clamp. The default axis is the tangent at the node, the default fixed point
    /// the node.
    #[serde(flatten)]
    pub movement: Movement,
}

impl Clamp {
    /// Whether the clamp starts away from the placed rod.
    pub fn is_elsewhere(&self) -> bool {
        !(is_zero(&self.offset) && is_zero(&self.rotation))
    }
}

fn is_zero(vector: &[f64; 3]) -> bool {
    *vector == [0.0; 3]
}
