//! Clamps, loads and planes as resolved.

use super::movement::Movement;
use crate::scenario::place::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a clamp holds.
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
    /// What is held.
    pub hold: Hold,
    /// How it moves: about the tangent at the node, with the node as the fixed point, where it does not say otherwise.
    #[serde(flatten)]
    pub movement: Movement,
}

/// An external load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Load {
    /// What acts.
    #[serde(flatten)]
    pub kind: LoadKind,
    /// Factor at given times in s, piecewise linear; 1 where empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub schedule: Vec<(f64, f64)>,
}

/// In which frame the components of a load are constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum LoadFrame {
    /// That of the scene: a fixed direction.
    #[default]
    Space,
    /// The material frame of the rod: the load turns with it.
    Material,
}

impl LoadFrame {
    fn is_space(&self) -> bool {
        *self == Self::Space
    }
}

/// Kinds of external load.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum LoadKind {
    /// Weight of every rod.
    Gravity {
        /// Acceleration of free fall, m/s².
        acceleration: [f64; 3],
    },
    /// A force on a node.
    Force {
        /// Name of the rod.
        rod: String,
        /// Node along the rod.
        at: Place,
        /// The force, N.
        force: [f64; 3],
        /// Frame of the components.
        #[serde(skip_serializing_if = "LoadFrame::is_space")]
        frame: LoadFrame,
    },
    /// A moment on an edge.
    Moment {
        /// Name of the rod.
        rod: String,
        /// Edge along the rod.
        at: Place,
        /// The moment, N m.
        moment: [f64; 3],
        /// Frame of the components.
        #[serde(skip_serializing_if = "LoadFrame::is_space")]
        frame: LoadFrame,
    },
    /// A force per natural length.
    Distributed {
        /// Name of the rod; `None` means all rods.
        rod: Option<String>,
        /// Force per length, N/m.
        force_per_length: [f64; 3],
        /// Frame of the components.
        #[serde(skip_serializing_if = "LoadFrame::is_space")]
        frame: LoadFrame,
    },
    /// Linear drag.
    Drag {
        /// Name of the rod; `None` means all rods.
        rod: Option<String>,
        /// Coefficient of the velocity per length, N s/m².
        translation: f64,
        /// Coefficient of the spin per length, N s.
        rotation: f64,
    },
}

/// A rigid half space: the side that `normal` points to is free.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plane {
    /// Any point of the surface, m.
    pub point: [f64; 3],
    /// Unit normal.
    pub normal: [f64; 3],
    /// Friction coefficient; `None` takes that of the contact model.
    pub friction: Option<f64>,
    /// Whether it is a no-slip wall of the flow; `None` is true with regularized Stokeslets, false otherwise.
    pub wall: Option<bool>,
}
