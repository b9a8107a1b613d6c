//! Samples of a motion as a joint trajectory.

use super::resolved::Arm;
use crate::robot::{Column, JointTrajectory, SAMPLE};

impl Arm {
    /// Every so many samples of a motion; the last point is one more step at rest where it falls between.
    pub(super) fn sampled(&self, samples: &[Vec<f64>], stride: usize) -> JointTrajectory {
        let last = samples.len() - 1;
        let count = last.div_ceil(stride);
        let columns = self.chain.joints.iter().map(|joint| Column {
            part: self.name.clone(),
            joint: Some(joint.name.clone()),
            kind: joint.kind,
        });
        JointTrajectory {
            columns: columns.collect(),
            times: (0..=count).map(|k| (k * stride) as f64 * SAMPLE).collect(),
            points: (0..=count)
                .map(|k| samples[(k * stride).min(last)].clone())
                .collect(),
        }
    }
}
