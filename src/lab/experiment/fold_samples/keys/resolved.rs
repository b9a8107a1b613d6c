//! Samples of folds as resolved.

use crate::experiment::data_set::Span;
use serde::Serialize;

/// Folds at many places of the gripper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoldSamples {
    /// The places.
    pub points: Points,
    /// Suspended lengths, L_gb.
    pub suspended_length: Span,
    /// Below it is the penalty region, L_gb.
    pub least_suspended_length: f64,
}

/// Places of the gripper.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Points {
    /// Points of Sobol's sequence in the workspace, evenly in √x̄ and √z̄.
    Sobol {
        /// Number of points.
        count: usize,
        /// Number of the first one.
        first: usize,
    },
    /// A grid: (column + ½, row + ½) times the spacing.
    Grid {
        /// Distance of neighbours, L_gb.
        spacing: f64,
    },
}
