//! Path of the edge of a sheet in parts; each part is replanned if the sheet has slid.

use crate::cell::sums;
use nalgebra::Translation3;
use rodlab_planning::plan::fold::{Algorithm, FoldError, FoldPlanner, FoldPose, FoldedSheet};
use rodlab_robot::Pose;
use std::sync::Arc;

/// Clearance above the lower layer when an arm lays an edge down, m, since an arm is not accurate
/// enough to press the layers together.
const CLEARANCE: f64 = 1e-4;

/// Request for the path of a fold.
#[derive(Clone, Copy, Debug)]
pub struct FoldRequest {
    /// The sheet in the direction of the fold.
    pub sheet: FoldedSheet,
    /// Thickness of the sheet, m.
    pub thickness: f64,
    /// Distance by which the edge moves, m.
    pub target: f64,
    /// Algorithm that plans its path.
    pub algorithm: Algorithm,
    /// Number of parts of the path; a single one is not replanned.
    pub parts: usize,
}

/// The path of an edge.
#[derive(Clone, Debug)]
pub struct FoldWay {
    request: FoldRequest,
    planner: Arc<FoldPlanner>,
    /// Poses of the edge in each part, in L_gb; each part begins at the end of the previous one.
    parts: Vec<Vec<FoldPose>>,
    /// Estimated slide of the sheet during each part, m.
    slid: Vec<f64>,
}

impl FoldWay {
    /// Plans the path of a fold.
    ///
    /// # Errors
    /// The target cannot be reached.
    pub fn new(request: FoldRequest) -> Result<Self, FoldError> {
        let planner = FoldPlanner::shared(request.sheet.dimensionless(), request.algorithm);
        let unit = request.sheet.gravito_bending_length;
        let planned = planner.poses(request.target / unit)?.into_iter();
        let mut poses = vec![FoldPose::FLAT];
        poses.extend(planned.filter(|pose| *pose != FoldPose::FLAT));
        Ok(Self {
            planner,
            parts: in_parts(&poses, request.parts),
            slid: vec![0.0; request.parts],
            request,
        })
    }

    /// Parts.
    pub fn parts(&self) -> usize {
        self.parts.len()
    }

    /// Poses of the hand in a part, in the frame of the sheet. The origin is the middle of the
    /// edge of the flat sheet, half a thickness above the table; x points across the sheet, z up.
    pub fn hands(&self, part: usize) -> Vec<Pose> {
        let unit = self.request.sheet.gravito_bending_length;
        let slid = self.slid[part];
        let layer = self.request.thickness + CLEARANCE;
        let hand = |pose: &FoldPose| {
            let [x, z] = pose.gripper.map(|value| unit * value);
            let rise = layer * (x / self.request.target).clamp(0.0, 1.0);
            let place = Translation3::new(x + slid, 0.0, z + rise);
            Pose::from_parts(place, pose.orientation())
        };
        self.parts[part].iter().map(hand).collect()
    }

    /// Replans a part. `slid` is the total slide of the sheet after the part before, m.
    ///
    /// # Errors
    /// No path continues from the current state.
    pub fn replan(&mut self, part: usize, slid: f64) -> Result<(), FoldError> {
        let ends = [part - 1, part].map(|part| self.parts[part][self.parts[part].len() - 1]);
        let unit = self.request.sheet.gravito_bending_length;
        let farther = (slid - self.slid[part - 1]) / unit;
        let [from, to] = ends;
        self.parts[part] = self.planner.next_part(from, farther, to)?;
        self.slid[part] = slid;
        Ok(())
    }

    /// Keeps the planned path of a part, and copies the estimated slide of the part before.
    pub fn keep(&mut self, part: usize) {
        self.slid[part] = self.slid[part - 1];
    }

    /// Estimated slide of the sheet in a part, m.
    pub fn slid(&self, part: usize) -> f64 {
        self.slid[part]
    }
}

/// Cuts a path into parts of about the same duration.
fn in_parts(poses: &[FoldPose], parts: usize) -> Vec<Vec<FoldPose>> {
    let ways = sums(poses.windows(2).map(|pair| pair[0].way_to(&pair[1])));
    let last = poses.len() - 1;
    let end = |part: usize| {
        let way = ways[last] * part as f64 / parts as f64;
        ways.partition_point(|known| *known < way).min(last)
    };
    let cut = |part: usize| poses[end(part)..=end(part + 1)].to_vec();
    (0..parts).map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn a4(parts: usize) -> FoldWay {
        let request = FoldRequest {
            sheet: FoldedSheet {
                gravito_bending_length: 0.048,
                length: 0.297,
                least_suspended: 0.958,
            },
            thickness: 1e-4,
            target: 0.297,
            algorithm: Algorithm::Held { friction: 0.12 },
            parts,
        };
        FoldWay::new(request).unwrap()
    }

    #[test]
    fn parts_follow_each_other_and_take_about_as_long() {
        let (whole, parts) = (a4(1), a4(5));
        let joined: Vec<Pose> = (0..5).flat_map(|part| parts.hands(part)).collect();
        let all = whole.hands(0);
        assert_eq!(joined.len(), all.len() + 4);
        for part in 1..5 {
            let before = parts.hands(part - 1);
            assert_eq!(before[before.len() - 1], parts.hands(part)[0]);
        }
        let first = all[0].translation.vector;
        assert!(first.norm() < 1e-12);
        let last = all[all.len() - 1].translation.vector;
        assert!((last.x - 0.297).abs() < 1e-9 && (last.z - 2e-4).abs() < 1e-9);
    }

    #[test]
    fn a_replanned_part_starts_at_the_hand_and_ends_farther_by_the_slide() {
        let mut way = a4(5);
        let planned = way.hands(3);
        way.replan(3, 4e-3).unwrap();
        let replanned = way.hands(3);
        let away = |one: &Pose, other: &Pose| other.translation.vector - one.translation.vector;
        assert!(away(&planned[0], &replanned[0]).xy().norm() < 1e-9);
        let end = away(&planned[planned.len() - 1], &replanned[replanned.len() - 1]);
        assert!((end.x - 4e-3).abs() < 1e-9, "{end}");
        way.keep(4);
        assert_eq!(way.hands(4)[0], replanned[replanned.len() - 1]);
    }
}
