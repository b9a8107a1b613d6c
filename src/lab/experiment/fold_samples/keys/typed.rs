//! Typed samples of folds.

use crate::scenario::keys::{Dimensionless, Quantity};
use schemars::JsonSchema;
use serde::Deserialize;

/// Folds at many positions (x̄, z̄) of the gripper, in L_gb, relative to the initial position of
/// the edge of the flat sheet.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "fold_samples")]
pub struct FoldSamples {
    /// Places of the gripper.
    pub points: Option<Points>,
    /// Suspended lengths l̄_s of the workspace, in L_gb. Default: 0.5 to 6.84.
    pub suspended_length: Option<Lengths>,
    /// Suspended length, in L_gb, below which the bent sheet is creased: the penalty region.
    /// Default: 0.958.
    pub least_suspended_length: Option<Quantity<Dimensionless>>,
}

/// Suspended lengths.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "suspended_lengths")]
pub struct Lengths {
    /// The shortest.
    pub from: Option<Quantity<Dimensionless>>,
    /// The longest.
    pub to: Option<Quantity<Dimensionless>>,
}

/// Places of the gripper.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "places")]
pub enum Points {
    /// Points of Sobol's sequence that lie in the workspace, denser where x̄ or z̄ is small:
    /// uniform in √x̄ and √z̄.
    Sobol(Sobol),
    /// A grid over the workspace, uniform in x̄ and z̄.
    Grid(Grid),
}

/// Points of Sobol's sequence in the workspace.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "sobol_places")]
pub struct Sobol {
    /// Number of points.
    pub count: Option<i64>,
    /// Number of the first point. Default: 0. Later points of the sequence are other samples: for
    /// tests, or for the shares of a sweep.
    pub first: Option<i64>,
}

/// A grid of places.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "grid_of_places")]
pub struct Grid {
    /// Spacing of the grid, in L_gb.
    pub spacing: Option<Quantity<Dimensionless>>,
}
