//! A pose of the gripper in the side view.

use super::equilibrium::Fold;
use serde::{Deserialize, Serialize};

/// Where the gripper holds the edge, in L_gb from where it lay, and by which angle it is turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoldPose {
    /// (x̄, z̄).
    pub gripper: [f64; 2],
    /// α, rad.
    pub angle: f64,
}

impl FoldPose {
    /// That of a fold.
    pub fn of(fold: &Fold) -> Self {
        Self {
            gripper: fold.gripper,
            angle: fold.angle,
        }
    }
}
