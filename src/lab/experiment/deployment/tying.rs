//! Tying of a knot after the rods are laid: the poses of all grippers, with their errors.
//!
//! There are two grippers. With one rod, one gripper lays the rod and leads its end, and the other
//! one lifts strands. With two rods, each gripper lays one. The first gripper releases its rod
//! after laying it and lifts strands while the second leads the end of its own rod. Then the first
//! grasps the end of its rod again and leads it while the second lifts strands.

use super::gripper_path::GripperPath;
use super::keys::{Deployment, Knot};
use super::planned::PathError;
use crate::experiment::prepare::Jitter;
use rodlab_engine::mechanics::rotation;
use rodlab_planning::plan::deployment::DeployedRod;
use rodlab_planning::plan::pattern::Pattern;
use rodlab_planning::plan::tying::{
    GripperPoses, Handling, Passage, Place, Schedule, TiedRod, TyingTask, passages,
};
use serde::{Deserialize, Serialize};

/// Least height of a gripper that leads an end or lifts a strand, in radii of the rod.
const FLOOR: f64 = 1.05;
/// Pause between leading one end and grasping the other, s.
const CHANGE: f64 = 1.0;

/// Part of the rod that is grasped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// The node nearest to the gripper, apart from the ends.
    Strand,
    /// The last laid end of a rod.
    End,
}

/// A rod that a gripper grasps, moves, and releases.
#[derive(Clone, Debug)]
pub struct Hold {
    /// Number of the rod.
    pub rod: usize,
    /// Part of the rod that is grasped.
    pub part: Part,
    /// Times of grasp and release, s.
    pub held: [f64; 2],
    /// Poses of the gripper with errors.
    pub poses: GripperPoses,
}

/// Tying of a knot after the rods are laid.
pub struct Tying {
    /// The crossings.
    pub passages: Vec<Passage>,
    /// Grasps of each gripper, in order.
    pub holds: [Vec<Hold>; 2],
    /// Times at which the grippers that laid rods release them, s; `None` if a gripper holds its
    /// rod until the end.
    pub released: Vec<Option<f64>>,
    /// Time at which everything is finished, s.
    pub end: f64,
}

/// Plan of the tying, made before rods are laid.
pub struct TyingPlan {
    curves: Vec<Pattern>,
    rods: Vec<DeployedRod>,
    passages: Vec<Passage>,
    handling: Handling,
    /// Schedules in the order in which ends are led.
    schedules: Vec<Schedule>,
}

impl TyingPlan {
    /// The plan of a deployment; `None` without a knot.
    pub fn new(deployment: &Deployment) -> Result<Option<Self>, PathError> {
        let Some(knot) = &deployment.knot else {
            return Ok(None);
        };
        let layings = deployment.layings();
        let mut curves = Vec::new();
        for laying in &layings {
            curves.push(laying.whole_pattern()?);
        }
        let rods: Vec<DeployedRod> = layings.iter().map(|laying| laying.rod.deployed()).collect();
        let tied = rods.iter().zip(&curves);
        let tied: Vec<TiedRod<'_>> = tied.map(|(rod, curve)| TiedRod { rod, curve }).collect();
        let passages = passages(&tied, &knot.crossings)?;
        let handling = Knot::handling(knot);
        let numbered = tied.iter().enumerate().rev();
        let led = numbered.filter(|(_, tied)| tied.is_led());
        let schedules = led.map(|(number, tied)| Schedule::new(number, tied, &passages, &handling));
        Ok(Some(Self {
            schedules: schedules.collect(),
            passages,
            handling,
            rods,
            curves,
        }))
    }

    /// Duration of tying, s.
    fn duration(&self) -> f64 {
        let last = self.rods.len() - 1;
        let waits = self
            .schedules
            .iter()
            .filter(|schedule| schedule.rod != last);
        let changes = CHANGE * waits.count() as f64;
        changes + self.schedules.iter().map(Schedule::duration).sum::<f64>()
    }

    /// Time by which rods must be laid, s, so that tying is finished at `end`.
    pub fn laid_by(&self, end: f64) -> Result<f64, PathError> {
        let tying = self.duration();
        if tying < end {
            Ok(end - tying)
        } else {
            Err(PathError::NoTime {
                tying_s: tying,
                end_s: end,
            })
        }
    }

    /// Motion of the grippers from the time (s) at which all rods are laid. The gripper that holds
    /// its rod continues on its path.
    pub fn tying(self, layings: &[Deployment], paths: &mut [GripperPath], begin: f64) -> Tying {
        // Even with a single rod the second gripper has its own jitter.
        let other = layings[0].by_another_gripper();
        let jitters = [&layings[0], &other].map(Deployment::trembling);
        let last = paths.len() - 1;
        let is_let_go = other.release.is_some();
        let pattern = |place: Place| {
            paths[place.rod]
                .seen
                .seen(vec![self.curves[place.rod].at(place.s)])[0]
        };
        let task = TyingTask {
            rods: &self.rods,
            passages: &self.passages,
            pattern: &pattern,
        };
        let mut holds = [Vec::new(), Vec::new()];
        let mut released: Vec<Option<f64>> =
            paths.iter().map(|path| Some(path.laid_by())).collect();
        released[last] = None;
        let mut led = GripperPoses::new();
        let mut time = begin;
        for schedule in &self.schedules {
            let rod = schedule.rod;
            let radius = self.rods[rod].radius;
            let [leading, lifting] = [rod % 2, (rod + 1) % 2];
            let first = if rod == last {
                paths[rod]
                    .planned
                    .last()
                    .map(|pose| (pose.position, pose.rotation))
            } else {
                released[last].get_or_insert(time);
                time += CHANGE;
                None
            };
            let lying = || {
                let place = pattern(Place {
                    rod,
                    s: self.rods[rod].length,
                });
                let position = place.position.push(radius);
                let yaw = rotation::from_vector(place.angle * nalgebra::Vector3::z());
                (position, yaw)
            };
            let first = first.unwrap_or_else(lying);
            let end = task.end_path(schedule, first);
            let end = disturbed(&jitters[leading], end, time, radius);
            let arrived = time + schedule.duration();
            if rod == last {
                led = end;
            } else {
                holds[leading].push(Hold {
                    rod,
                    part: Part::End,
                    held: [time, if is_let_go { arrived } else { f64::INFINITY }],
                    poses: end,
                });
            }
            for lift in task.lift_paths(schedule, &self.handling) {
                let radius = self.rods[lift.rod].radius;
                holds[lifting].push(Hold {
                    rod: lift.rod,
                    part: Part::Strand,
                    held: lift.held.map(|held| time + held),
                    poses: disturbed(&jitters[lifting], lift.poses, time, radius),
                });
            }
            time = arrived;
        }
        paths[last].led = led;
        Tying {
            passages: self.passages,
            holds,
            released,
            end: time,
        }
    }
}

/// Poses of a gripper with jitter from a time on, s; the table limits them from below.
fn disturbed(jitter: &Jitter, poses: GripperPoses, begin: f64, radius: f64) -> GripperPoses {
    let poses = poses.into_iter().map(|(time, position, rotation)| {
        let time = begin + time;
        let (way, turn) = jitter.at(time);
        let mut position = position + way;
        position.z = position.z.max(FLOOR * radius);
        (time, position, rotation::from_vector(turn) * rotation)
    });
    poses.collect()
}

#[cfg(test)]
mod tests {
    use crate::experiment::deployment::{DeploymentOutcome, TiedKnot};
    use crate::experiment::{from_text, load, prepare};
    use crate::run::{RunOptions, run};
    use rodlab_planning::knot::KnotInvariants;
    use std::path::Path;

    /// Outcome of a scenario of the repository with changed keys.
    fn tied(name: &str, overrides: &[&str]) -> TiedKnot {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let file = root.join(format!("scenarios/{name}.toml"));
        let overrides: Vec<String> = overrides.iter().map(|key| (*key).to_owned()).collect();
        let loaded = load(&file, &overrides).unwrap();
        let again = from_text(name, &loaded.scenario.to_toml(), Path::new(""), &[]);
        assert_eq!(again.unwrap().scenario, loaded.scenario);
        let prepared = prepare(&loaded.scenario).unwrap();
        let directory = tempfile::tempdir().unwrap();
        let finished = run(&prepared, &RunOptions::new(directory.path())).unwrap();
        DeploymentOutcome::of(&finished.case).unwrap().knot.unwrap()
    }

    fn invariants(determinant: u64, signature: i64) -> Option<KnotInvariants> {
        Some(KnotInvariants {
            determinant,
            signature,
        })
    }

    #[test]
    fn a_trefoil_is_tied_on_the_table() {
        let knot = tied("tied_trefoil", &[]);
        assert_eq!(knot.pattern, invariants(3, -2));
        assert!(knot.is_tied());
    }

    #[test]
    fn an_end_that_is_led_over_everything_ties_nothing() {
        let over = "deployment.knot.crossings=[\"over\", \"over\", \"over\"]";
        let knot = tied("tied_trefoil", &[over]);
        assert_eq!(
            (knot.pattern, knot.rod),
            (invariants(1, 0), invariants(1, 0))
        );
    }

    #[test]
    fn a_reef_knot_of_two_rods_is_tied_on_the_table() {
        let knot = tied("tied_reef", &[]);
        assert_eq!(knot.pattern, invariants(9, 0));
        assert!(knot.is_tied(), "{knot:?}");
    }
}
