//! The path along which a rod is laid, and the gripper's poses for it.

use super::{
    DeployedRod, DeploymentError, GripperPose, OptimalGrasps, Scheme, Spare, Trajectory,
    checked_trajectory, with_spare_laid,
};
use crate::plan::pattern::{Pattern, PatternPoint};

/// A path for laying.
#[derive(Clone, Debug)]
pub struct LaidPath {
    /// The pattern with lead-in and lead-out.
    pub points: Vec<PatternPoint>,
    /// Poses of the gripper at these points.
    pub poses: Vec<GripperPose>,
    /// Length of the lead-in, m.
    pub lead_in: f64,
    /// Whether the path is longer than the pattern and its lead-in.
    pub lays_spare: bool,
    /// Number of replaced outputs of a network.
    pub rejected: usize,
}

impl LaidPath {
    /// The path along a pattern with its lead-in and, depending on `spare`, with the rest of the
    /// rod. The points are at most `step` apart, m. `way` is the scheme of the gripper and the
    /// solver for its grasps.
    ///
    /// # Errors
    /// There is no grasp at some point.
    pub fn new(
        pattern: Pattern,
        rod: &DeployedRod,
        spare: &Spare<'_>,
        step: f64,
        way: (Scheme, OptimalGrasps<'_>),
    ) -> Result<Self, DeploymentError> {
        let length = pattern.length();
        let pattern = with_spare_laid(pattern, rod, spare);
        Self::along(&pattern, length, rod, step, way)
    }

    /// The path along a whole laid curve. `length`, m, is the part with the pattern and its
    /// lead-in.
    ///
    /// # Errors
    /// There is no grasp at some point.
    pub fn along(
        pattern: &Pattern,
        length: f64,
        rod: &DeployedRod,
        step: f64,
        (scheme, grasps): (Scheme, OptimalGrasps<'_>),
    ) -> Result<Self, DeploymentError> {
        let points = pattern.sampled(step);
        let Trajectory { poses, rejected } = checked_trajectory(&points, rod, scheme, grasps)?;
        Ok(Self {
            lead_in: pattern.lead_in(),
            lays_spare: pattern.length() > length,
            points,
            poses,
            rejected,
        })
    }
}
