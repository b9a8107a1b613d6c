//! How a knot is tied when the rod is laid: the poses of both grippers, with their errors.

use super::keys::{Deployment, Knot};
use super::planned::{PathError, Planned};
use crate::experiment::prepare::Jitter;
use crate::mechanics::rotation;
use crate::plan::deployment::GripperPose;
use crate::plan::pattern::Pattern;
use crate::plan::tying::{GripperPoses, Passage, Schedule, end_path, lift_paths, passages};

/// Least height of a hand that leads an end, or lifts a strand, in radii of the rod.
const FLOOR: f64 = 1.05;
/// Between the seeds of the two grippers.
const OTHER_GRIPPER: u64 = 1 << 32;

/// How a knot is tied when the rod is laid.
pub struct Tying {
    /// The crossings.
    pub passages: Vec<Passage>,
    /// The poses of the gripper that holds the rod's end, errors included.
    pub end: GripperPoses,
    /// When strands are taken hold of and let go (s), and the poses of the gripper that lifts them, errors included.
    pub lifts: Vec<([f64; 2], GripperPoses)>,
}

/// What is known of tying before the rod is laid.
pub struct TyingPlan {
    curve: Pattern,
    passages: Vec<Passage>,
    schedule: Schedule,
}

impl TyingPlan {
    /// The plan of a deployment; `None` where no knot is tied.
    pub fn new(deployment: &Deployment) -> Result<Option<Self>, PathError> {
        let Some(knot) = &deployment.knot else {
            return Ok(None);
        };
        let rod = deployment.rod.deployed();
        let curve = deployment.whole_pattern()?;
        let passages = passages(&curve, &rod, &knot.crossings)?;
        let schedule = Schedule::new(&passages, &rod, curve.length(), &knot.handling());
        Ok(Some(Self {
            curve,
            passages,
            schedule,
        }))
    }

    /// When the rod must be laid, s, so that all is done at `end`.
    pub fn laid_by(&self, end: f64) -> Result<f64, PathError> {
        let tying = self.schedule.duration();
        if tying < end {
            Ok(end - tying)
        } else {
            Err(PathError::NoTime {
                tying_s: tying,
                end_s: end,
            })
        }
    }

    /// What the grippers do from the `last` pose of the laying on, at a time in s.
    pub fn tying(
        self,
        deployment: &Deployment,
        planned: &Planned,
        last: &GripperPose,
        begin: f64,
    ) -> Tying {
        let pattern = |s: f64| planned.seen(vec![self.curve.at(s)])[0];
        let handling = deployment.knot.as_ref().map(Knot::handling);
        let handling = handling.expect("a knot that is tied");
        let rod = &planned.rod;
        let end = end_path(&self.schedule, &self.passages, rod, &pattern, last);
        let lifts = lift_paths(&self.schedule, &self.passages, rod, &pattern, &handling);
        // The table stops a hand that trembles.
        let floor = FLOOR * rod.radius;
        let disturbed = |jitter: &Jitter, poses: GripperPoses| -> GripperPoses {
            let poses = poses.into_iter().map(|(time, position, rotation)| {
                let time = begin + time;
                let (way, turn) = jitter.at(time);
                let mut position = position + way;
                position.z = position.z.max(floor);
                (time, position, rotation::from_vector(turn) * rotation)
            });
            poses.collect()
        };
        // Another gripper, whose jitter is another.
        let other = deployment.jitter_of_seed(deployment.seed.wrapping_add(OTHER_GRIPPER));
        Tying {
            end: disturbed(&deployment.jitter_of_seed(deployment.seed), end),
            lifts: lifts
                .into_iter()
                .map(|lift| {
                    let held = lift.held.map(|time| begin + time);
                    (held, disturbed(&other, lift.poses))
                })
                .collect(),
            passages: self.passages,
        }
    }
}
