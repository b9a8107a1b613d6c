//! Resolved samples of folds.

use crate::experiment::data_set::Span;
use serde::Serialize;

/// Folds at many positions of the gripper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoldSamples {
    /// Places of the gripper.
    pub points: Points,
    /// Suspended lengths, L_gb.
    pub suspended_length: Span,
    /// Suspended length below which the penalty region begins, L_gb.
    pub least_suspended_length: f64,
}

/// Places of the gripper.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Points {
    /// Points of Sobol's sequence in the workspace, uniform in √x̄ and √z̄.
    Sobol {
        /// Number of points.
        count: usize,
        /// Number of the first one.
        first: usize,
    },
    /// A grid: (column + ½, row + ½) times the spacing.
    Grid {
        /// Spacing of the grid, L_gb.
        spacing: f64,
    },
}
