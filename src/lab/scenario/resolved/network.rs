//! Choices of networks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Joints of the rods of a network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum NetworkJoint {
    /// Balls.
    #[default]
    Ball,
    /// Welds.
    Rigid,
}

/// Held ends of the rods of a network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum HeldEnds {
    /// All.
    #[default]
    All,
    /// Nodes at which the ends of two rods meet.
    Corners,
}
