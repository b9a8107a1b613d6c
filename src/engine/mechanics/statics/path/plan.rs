//! The plan of a path: its range and its steps.

use serde::{Deserialize, Serialize};

/// Start and end of a path, and the steps along it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathPlan {
    /// Path parameter at the start.
    pub from: f64,
    /// Path parameter at the end; smaller than `from` for a path that runs backwards.
    pub to: f64,
    /// First step of the parameter, positive.
    pub step: f64,
    /// Largest step, as a fraction of the whole range of λ: bounds the change of the parameter and
    /// the root mean square of the nodes' displacement over the rods' extent.
    pub largest_step: f64,
    /// Quantity that a step holds fixed.
    pub method: PathMethod,
    /// Whether branches that leave at bifurcations are followed.
    pub switch_branches: bool,
    /// Most points on one branch; a branch may turn back without end.
    pub most_points: usize,
}

/// Condition that a step along the path prescribes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PathMethod {
    /// The parameter itself. At a fold no equilibrium is near: the path ends there, or jumps to a distant one.
    Natural,
    /// The arclength along the tangent (Keller 1977, Eq. 4.7), which passes folds.
    Arclength,
}

impl PathPlan {
    /// Signed range of the parameter.
    pub(crate) fn range(&self) -> f64 {
        self.to - self.from
    }
}
