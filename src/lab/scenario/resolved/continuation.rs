//! Paths of equilibria as resolved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The path of equilibria that is followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Continuation {
    /// Parameter at the start.
    pub from: f64,
    /// Parameter at the end.
    pub to: f64,
    /// First step of the parameter, positive.
    pub step: f64,
    /// Largest step of the parameter, positive.
    pub largest_step: f64,
    /// What a step prescribes.
    pub method: PathMethod,
    /// Whether branches that leave at bifurcations are followed, too.
    pub switch_branches: bool,
    /// Most points on one branch.
    pub most_points: usize,
}

/// What a step along a path prescribes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum PathMethod {
    /// The parameter.
    Natural,
    /// The arclength of the path.
    Arclength,
}
