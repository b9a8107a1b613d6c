//! Plan of two grippers with one rod, or with two, in the frame of the patterns.

use nalgebra::Vector3;
use rodlab_engine::mechanics::rotation;
use rodlab_lab::experiment::knot_of_patterns;
use rodlab_planning::knot::KnotInvariants;
use rodlab_planning::plan::deployment::{DeployedRod, GripperPose};
use rodlab_planning::plan::pattern::{Pattern, PatternPoint, Point};
use rodlab_planning::plan::tying::{
    GripperPoses, Handling, LiftPath, Passage, Place, Schedule, TiedRod, TyingTask,
};

/// Distance of points of patterns, m.
const SPACING: f64 = 5e-3;

/// A rod that is laid.
pub struct PlannedRod {
    /// The rod.
    pub rod: DeployedRod,
    /// Its whole pattern, the path of its end included.
    pub pattern: Pattern,
    /// Poses of the gripper that lays it.
    pub laying: Vec<GripperPose>,
}

impl PlannedRod {
    /// Points of the pattern, m.
    pub fn points(&self) -> Vec<Point> {
        let points = self.pattern.sampled(SPACING).into_iter();
        points.map(|point| point.position).collect()
    }
}

/// Motion of the end of a rod. Times are counted from its start, s.
pub struct Lead {
    /// Schedule of the end, and of the lifts of strands.
    pub schedule: Schedule,
    /// Poses of the gripper that leads the end.
    pub end: GripperPoses,
    /// Paths of the gripper that lifts strands.
    pub lifts: Vec<LiftPath>,
}

/// Plan of the grippers.
pub struct KnotPlan {
    /// The rods, in the order in which they are laid: the first by the first arm, the second by the second.
    pub rods: Vec<PlannedRod>,
    /// The crossings, in the order in which rods reach them again.
    pub passages: Vec<Passage>,
    /// Ends that are led, in the order in which they are: that of the last rod first, which its gripper holds still.
    pub leads: Vec<Lead>,
    /// The knot that was drawn; `None` where it depends on how ends are joined.
    pub drawn: Option<KnotInvariants>,
}

impl KnotPlan {
    /// The plan of rods with the crossings of their patterns.
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

    /// Strands that are lifted.
    pub fn lifts(&self) -> usize {
        self.leads.iter().map(|lead| lead.lifts.len()).sum()
    }

    /// Duration of tying by its schedules, s.
    pub fn duration(&self) -> f64 {
        let leads = self.leads.iter();
        leads.map(|lead| lead.schedule.duration()).sum()
    }
}

/// A hand at the end of a rod that lies.
fn lying(point: &PatternPoint, radius: f64) -> (Vector3<f64>, nalgebra::UnitQuaternion<f64>) {
    let yaw = rotation::from_vector(point.angle * Vector3::z());
    (point.position.push(radius), yaw)
}
