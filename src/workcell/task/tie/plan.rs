//! Plan of the motions of two grippers with one or two rods, in the frame of the patterns.

use nalgebra::Vector3;
use rodlab_engine::mechanics::rotation;
use rodlab_lab::experiment::knot_of_patterns;
use rodlab_planning::knot::KnotInvariants;
use rodlab_planning::plan::deployment::{DeployedRod, GripperPose};
use rodlab_planning::plan::pattern::{Pattern, PatternPoint, Point};
use rodlab_planning::plan::tying::{
    GripperPoses, Handling, LiftPath, Passage, Place, Schedule, TiedRod, TyingTask,
};

/// Spacing of points of patterns, m.
const SPACING: f64 = 5e-3;

/// Plan of a rod that is laid.
pub struct PlannedRod {
    /// The rod.
    pub rod: DeployedRod,
    /// The whole pattern of the rod, including the path of its end.
    pub pattern: Pattern,
    /// Poses of the gripper that lays the rod.
    pub laying: Vec<GripperPose>,
}

impl PlannedRod {
    /// Points of the pattern, m.
    pub fn points(&self) -> Vec<Point> {
        let points = self.pattern.sampled(SPACING).into_iter();
        points.map(|point| point.position).collect()
    }
}

/// Motion of the end of a rod. Times are relative to the start of this motion, s.
pub struct Lead {
    /// Schedule of the end and of the lifts of strands.
    pub schedule: Schedule,
    /// Poses of the gripper that leads the end.
    pub end: GripperPoses,
    /// Paths of the gripper that lifts strands.
    pub lifts: Vec<LiftPath>,
}

/// Plan of the grippers.
pub struct KnotPlan {
    /// The rods in the order in which they are laid: the first by the first arm, the second by the
    /// second.
    pub rods: Vec<PlannedRod>,
    /// The crossings in the order of their second passes.
    pub passages: Vec<Passage>,
    /// Motions of the ends in sequence. The end of the last rod is first, since its gripper still
    /// holds it.
    pub leads: Vec<Lead>,
    /// The knot of the patterns; `None` if it depends on how the ends are joined.
    pub drawn: Option<KnotInvariants>,
}

impl KnotPlan {
    /// Creates the plan from rods and the crossings of their patterns.
    pub fn new(rods: Vec<PlannedRod>, passages: Vec<Passage>) -> Self {
        let deployed: Vec<DeployedRod> = rods.iter().map(|planned| planned.rod).collect();
        let handling = Handling::usual(&deployed);
        let pattern = |place: Place| rods[place.rod].pattern.at(place.s);
        let task = TyingTask {
            rods: &deployed,
            passages: &passages,
            pattern: &pattern,
        };
        let last = rods.len() - 1;
        let led = rods
            .iter()
            .enumerate()
            .rev()
            .filter_map(|(number, planned)| {
                let tied = TiedRod {
                    rod: &planned.rod,
                    curve: &planned.pattern,
                };
                let schedule = tied
                    .is_led()
                    .then(|| Schedule::new(number, &tied, &passages, &handling))?;
                let first = match planned.laying.last() {
                    Some(pose) if number == last => (pose.position, pose.rotation),
                    _ => lying(
                        &pattern(Place {
                            rod: number,
                            s: planned.rod.length,
                        }),
                        planned.rod.radius,
                    ),
                };
                Some(Lead {
                    end: task.end_path(&schedule, first),
                    lifts: task.lift_paths(&schedule, &handling),
                    schedule,
                })
            });
        let leads = led.collect();
        let curves = rods.iter().map(|planned| &planned.pattern);
        Self {
            drawn: knot_of_patterns(curves, &passages),
            leads,
            passages,
            rods,
        }
    }

    /// Number of strands that are lifted.
    pub fn lifts(&self) -> usize {
        self.leads.iter().map(|lead| lead.lifts.len()).sum()
    }

    /// Duration of tying according to the schedules, s.
    pub fn duration(&self) -> f64 {
        let leads = self.leads.iter();
        leads.map(|lead| lead.schedule.duration()).sum()
    }
}

/// Pose of a hand at the end of a lying rod.
fn lying(point: &PatternPoint, radius: f64) -> (Vector3<f64>, nalgebra::UnitQuaternion<f64>) {
    let yaw = rotation::from_vector(point.angle * Vector3::z());
    (point.position.push(radius), yaw)
}
