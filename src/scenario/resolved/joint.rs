//! Joints and bodies as resolved.

use super::load::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Two nodes that are one point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Joint {
    /// Name by which messages call it.
    pub name: String,
    /// Names of the two rods.
    pub rods: [String; 2],
    /// Node along each.
    pub at: [Place; 2],
    /// What it leaves free.
    #[serde(flatten)]
    pub kind: JointKind,
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum JointKind {
    /// Every rotation.
    Ball,
    /// None.
    Rigid,
    /// Rotation of the second rod about an axis that turns with the first.
    Hinge {
        /// Unit vector, as placed.
        axis: [f64; 3],
    },
}

/// A mass or rigid body at a node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name by which messages call it.
    pub name: String,
    /// Name of the rod.
    pub rod: String,
    /// Node along it.
    pub at: Place,
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia about the two material directors and the tangent, kg m²; `None` for a point mass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia: Option<[f64; 3]>,
}

/// What joins the rods of a network.
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

/// Which ends of the rods of a network are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum HeldEnds {
    /// All.
    #[default]
    All,
    /// Those at which ends of two rods meet.
    Corners,
}
