//! A pose of the gripper in the side view.

use super::equilibrium::Fold;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Way of the gripper, in L_gb, that takes as long as a turn by 1 rad.
const TURN: f64 = 1.0;

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

    /// The edge of a sheet that lies flat.
    pub const FLAT: Self = Self {
        gripper: [0.0; 2],
        angle: 0.0,
    };

    /// Orientation of the gripper in the frame of the sheet, which lies along x: the gripper's x axis is the tangent of the sheet,
    /// towards the gripper, its z axis the normal that points up where the sheet lies flat.
    pub fn orientation(&self) -> UnitQuaternion {
        rotation::from_vector(self.angle * Vector3::y()) * rotation::from_vector(PI * Vector3::z())
    }

    /// How far another pose is, as it counts for the time that the gripper takes: the way or the turn, whichever is more, in L_gb.
    pub fn way_to(&self, other: &Self) -> f64 {
        let [dx, dz] = [0, 1].map(|k| other.gripper[k] - self.gripper[k]);
        libm::hypot(dx, dz).max(TURN * (other.angle - self.angle).abs())
    }
}
