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
    /// Displacement from where the rod is placed, m.
    #[serde(skip_serializing_if = "is_zero")]
    pub offset: [f64; 3],
    /// Rotation vector about the node in the same way, rad.
    #[serde(skip_serializing_if = "is_zero")]
    pub rotation: [f64; 3],
    /// Its motion: by default about the tangent at the node, with the node as the fixed point.
    #[serde(flatten)]
    pub movement: Movement,
}

impl Clamp {
    /// Whether it is elsewhere than where the rod is placed.
    pub fn is_elsewhere(&self) -> bool {
        !(is_zero(&self.offset) && is_zero(&self.rotation))
    }
}

fn is_zero(vector: &[f64; 3]) -> bool {
    *vector == [0.0; 3]
}
