//! The flagella experiment as resolved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rods that a builder makes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BuilderRod {
    /// Radius of each rod, m.
    pub radius: f64,
    /// Nodes of each rod.
    pub nodes: usize,
}

/// Helical flagella on the corners of a regular polygon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flagella {
    /// Number of flagella M.
    pub count: usize,
    /// Radius of the helices, m.
    pub helix_radius: f64,
    /// Pitch of the helices, m.
    pub pitch: f64,
    /// Length of the helices along their axes, m.
    pub axial_length: f64,
    /// Side of the polygon on whose corners the axes stand, m.
    pub side: f64,
    /// Rate of turning of the heads, rad/s.
    pub angular_velocity: f64,
    /// Whether a straight inlet and a ramp lead from the axis to the helix.
    pub hook: bool,
    /// What is held at the head.
    pub head: Head,
}

/// What is held at the head of a flagellum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Head {
    /// The first node and the material frame there.
    Node,
    /// Both nodes of the first edge and its frame: the usual clamp of other codes.
    Edge,
}
