//! Paths of equilibria as typed.

use crate::scenario::quantity::Quantity;
use crate::scenario::resolved::PathMethod;
use crate::scenario::units::Dimensionless;
use schemars::JsonSchema;
use serde::Deserialize;

/// The path of equilibria that time.mode = "continuation" follows. A parameter stands in the place of time:
/// clamps that move and loads with a schedule take it for their time.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "continuation")]
pub struct Continuation {
    /// Parameter at the start. Default: 0.
    pub from: Option<Quantity<Dimensionless>>,
    /// Parameter at the end. A path that turns back may also end where it began.
    pub to: Option<Quantity<Dimensionless>>,
    /// First step of the parameter. Default: a hundredth of the range.
    pub step: Option<Quantity<Dimensionless>>,
    /// Largest step of the parameter. Default: a fiftieth of the range.
    pub largest_step: Option<Quantity<Dimensionless>>,
    /// "arclength" (the default: passes folds, where the parameter turns back) or "natural" (the parameter
    /// only grows; at a fold the run fails or jumps to a distant equilibrium).
    pub method: Option<PathMethod>,
    /// Whether the branches that leave at bifurcations of the first branch are followed, too. Default: true.
    pub switch_branches: Option<bool>,
    /// Most points on one branch. Default: 1000.
    pub most_points: Option<i64>,
}
