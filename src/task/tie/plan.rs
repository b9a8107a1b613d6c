//! What two grippers do when a rod is laid, in the frame of its pattern.

use crate::experiment::knot_of_patterns;
use crate::knot::KnotInvariants;
use crate::plan::deployment::{DeployedRod, GripperPose};
use crate::plan::pattern::{Pattern, Point};
use crate::plan::tying::{GripperPoses, Handling, LiftPath, Passage, Schedule, TiedRod, TyingTask};

/// Distance of points of the pattern, m.
const SPACING: f64 = 5e-3;

/// What the grippers do after the laying; times are counted from its end, s.
pub struct KnotPlan {
    /// The crossings, in the order in which the rod comes to them again.
    pub passages: Vec<Passage>,
    /// When its end is where, and when strands are lifted.
    pub schedule: Schedule,
    /// Poses of the gripper that leads the end.
    pub end: GripperPoses,
    /// Those of the one that lifts strands.
    pub lifts: Vec<LiftPath>,
    /// Points of the whole pattern, the path of the end included, m.
    pub points: Vec<Point>,
    /// The knot that was drawn; `None` where it depends on how ends are joined.
    pub drawn: Option<KnotInvariants>,
}

impl KnotPlan {
    /// The plan of a rod whose laying ends with the pose `last`, along the whole of its pattern.
    pub fn new(
        rod: &DeployedRod,
        whole: Pattern,
        passages: Vec<Passage>,
        last: &GripperPose,
    ) -> Self {
        let handling = Handling::usual([rod]);
        let tied = TiedRod { rod, curve: &whole };
        let schedule = Schedule::new(0, &tied, &passages, &handling);
        let task = TyingTask {
            rods: &[*rod],
            passages: &passages,
            pattern: &|place| whole.at(place.s),
        };
        let end = task.end_path(&schedule, (last.position, last.rotation));
        let lifts = task.lift_paths(&schedule, &handling);
        let points = whole.sampled(SPACING).into_iter();
        let points = points.map(|point| point.position).collect();
        Self {
            points,
            drawn: knot_of_patterns(&[whole], &passages),
            passages,
            schedule,
            end,
            lifts,
        }
    }
}
