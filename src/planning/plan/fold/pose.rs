//! A pose of the gripper in the side view.

use super::equilibrium::Fold;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Distance of the gripper, in L_gb, that takes as long as a rotation by 1 rad.
const TURN: f64 = 1.0;

/// Position of the held edge, in L_gb from its initial position, and its angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoldPose {
    /// (x̄, z̄).
    pub gripper: [f64; 2],
    /// α, rad.
    pub angle: f64,
}

impl FoldPose {
    /// The pose of a fold.
    pub fn of(fold: &Fold) -> Self {
        Self {
            gripper: fold.gripper,
            angle: fold.angle,
        }
    }

    /// The edge of a flat sheet.
    pub const FLAT: Self = Self {
        gripper: [0.0; 2],
        angle: 0.0,
    };

    /// Orientation of the gripper in the frame of the sheet, which lies along x. The gripper's x
    /// axis is the tangent of the sheet, towards the gripper; its z axis is the normal that points
    /// up on the flat sheet.
    pub fn orientation(&self) -> UnitQuaternion {
        rotation::from_vector(self.angle * Vector3::y()) * rotation::from_vector(PI * Vector3::z())
    }

    /// Distance to another pose for the timing of the gripper: the larger of displacement and
    /// rotation, in L_gb.
    pub fn way_to(&self, other: &Self) -> f64 {
        let [dx, dz] = [0, 1].map(|k| other.gripper[k] - self.gripper[k]);
        libm::hypot(dx, dz).max(TURN * (other.angle - self.angle).abs())
    }
}
