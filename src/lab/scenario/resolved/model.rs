//! Resolved contact and fluid models.

use crate::scenario::tables::Flow;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where friction acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum FrictionAt {
    /// On the centrelines.
    #[default]
    Centreline,
    /// On the surfaces.
    Surface,
}

impl FrictionAt {
    /// Whether it is the default, which resolved scenarios omit.
    fn is_centreline(&self) -> bool {
        *self == Self::Centreline
    }
}

/// Geometry of the centrelines in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Geometry {
    /// Straight edges between the nodes.
    #[default]
    Polyline,
    /// Smooth curves through the nodes.
    Smooth,
}

impl Geometry {
    fn is_polyline(&self) -> bool {
        *self == Self::Polyline
    }
}

/// Contact between rods and with planes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "model", rename_all = "kebab-case")]
pub enum Contact {
    /// No contact: everything passes through.
    None,
    /// The implicit contact model (thesis 2.2–2.3).
    Imc {
        /// Friction coefficient μ.
        friction: f64,
        /// Where friction acts.
        #[serde(skip_serializing_if = "FrictionAt::is_centreline")]
        friction_at: FrictionAt,
        /// Geometry of the centrelines.
        #[serde(skip_serializing_if = "Geometry::is_polyline")]
        geometry: Geometry,
        /// Distance tolerance δ, m.
        distance_tolerance: f64,
        /// Slip tolerance ν, m/s.
        slip_tolerance: f64,
        /// Factor of the adaptive contact stiffness.
        stiffness_factor: f64,
        /// Penetration that ends the run, as a fraction of the sum of the two radii.
        maximum_penetration: f64,
    },
    /// Incremental potential contact (thesis Eq. 2.1).
    Ipc {
        /// Friction coefficient μ.
        friction: f64,
        /// Where friction acts.
        #[serde(skip_serializing_if = "FrictionAt::is_centreline")]
        friction_at: FrictionAt,
        /// Geometry of the centrelines.
        #[serde(skip_serializing_if = "Geometry::is_polyline")]
        geometry: Geometry,
        /// Distance tolerance δ, m.
        distance_tolerance: f64,
        /// Slip tolerance ν, m/s.
        slip_tolerance: f64,
        /// Force of the barrier at a gap of δ/2, over the largest force near contact.
        stiffness_factor: f64,
    },
    /// Rigid contact by Signorini's and Coulomb's laws (thesis 3.3).
    Complementarity {
        /// Friction coefficient μ.
        friction: f64,
        /// Distance within which a pair counts as a possible contact, m.
        distance_tolerance: f64,
        /// Penetration that ends the run, as a fraction of the sum of the two radii.
        maximum_penetration: f64,
    },
}

impl Contact {
    /// Friction coefficient μ; 0 without contact.
    pub fn friction(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Imc { friction, .. }
            | Self::Ipc { friction, .. }
            | Self::Complementarity { friction, .. } => friction,
        }
    }

    /// Where friction acts.
    pub fn friction_at(&self) -> FrictionAt {
        match *self {
            Self::Imc { friction_at, .. } | Self::Ipc { friction_at, .. } => friction_at,
            Self::None | Self::Complementarity { .. } => FrictionAt::Centreline,
        }
    }

    /// Geometry of the centrelines.
    pub fn geometry(&self) -> Geometry {
        match *self {
            Self::Imc { geometry, .. } | Self::Ipc { geometry, .. } => geometry,
            Self::None | Self::Complementarity { .. } => Geometry::Polyline,
        }
    }

    /// Distance δ within which surfaces touch, m; `None` without contact.
    pub fn distance_tolerance(&self) -> Option<f64> {
        match *self {
            Self::None => None,
            Self::Imc {
                distance_tolerance, ..
            }
            | Self::Ipc {
                distance_tolerance, ..
            }
            | Self::Complementarity {
                distance_tolerance, ..
            } => Some(distance_tolerance),
        }
    }
}

/// The surrounding fluid.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "model", rename_all = "kebab-case")]
pub enum Fluid {
    /// A vacuum.
    None,
    /// Regularized Stokeslet segments (thesis 2.4.1).
    Rss {
        /// Dynamic viscosity, Pa s.
        viscosity: f64,
        /// Regularisation as a multiple of the rod radius.
        regularization: f64,
        /// Relative error allowed in the drag from the flow of distant nodes; 0 for none.
        far_field_error: f64,
        /// Whether the fluid resists rotation of rods about their own axes.
        spin: bool,
        /// Flow of the fluid without rods.
        #[serde(skip_serializing_if = "Option::is_none")]
        flow: Option<Flow>,
    },
    /// Resistive force theory.
    Resistive {
        /// Dynamic viscosity, Pa s.
        viscosity: f64,
        /// Whether the fluid resists rotation of rods about their own axes.
        spin: bool,
        /// Flow of the fluid without rods.
        #[serde(skip_serializing_if = "Option::is_none")]
        flow: Option<Flow>,
    },
    /// Drag quadratic in the velocity.
    Quadratic {
        /// Density of the fluid, kg/m³.
        density: f64,
        /// Drag coefficient normal to rods.
        normal_drag: f64,
        /// Drag coefficient along rods.
        tangential_drag: f64,
        /// Coefficient of the added mass normal to rods.
        added_mass: f64,
        /// Flow of the fluid without rods.
        #[serde(skip_serializing_if = "Option::is_none")]
        flow: Option<Flow>,
    },
}

impl Fluid {
    /// Flow of the fluid without rods; `None` for a fluid at rest.
    pub fn flow(&self) -> Option<&Flow> {
        match self {
            Self::None => None,
            Self::Rss { flow, .. }
            | Self::Resistive { flow, .. }
            | Self::Quadratic { flow, .. } => flow.as_ref(),
        }
    }
}
