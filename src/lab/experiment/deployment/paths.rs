//! The paths of all grippers of a deployment: rods are laid one after the other, then knots are
//! tied.

use super::gripper_path::{BRINGING, GripperPath, UnpacedPath};
use super::keys::Deployment;
use super::planned::PathError;
use super::tying::{Part, Tying, TyingPlan};
use rodlab_planning::plan::tying::GripperPoses;
use serde::Serialize;

/// Motions of all grippers.
pub struct DeploymentPaths {
    /// The paths of the grippers that lay rods, in the order of laying.
    pub rods: Vec<GripperPath>,
    /// The tying of the knot afterwards, if any.
    pub tying: Option<Tying>,
}

impl DeploymentPaths {
    /// The paths of a deployment with the duration `end`, s, as in [`UnpacedPath::paced`].
    /// `friction` is that of the table. The time is divided so that all rods are laid at the same
    /// pace.
    ///
    /// # Errors
    /// A pattern cannot be laid, or there is too little time.
    pub fn new(
        deployment: &Deployment,
        friction: f64,
        end: f64,
        step: Option<f64>,
    ) -> Result<Self, PathError> {
        let layings = deployment.layings();
        let plan = TyingPlan::new(deployment)?;
        let end = match &plan {
            Some(plan) => plan.laid_by(end)?,
            None => end,
        };
        let bringing = BRINGING * (layings.len() - 1) as f64;
        if end <= bringing {
            return Err(PathError::NoTimeForSecond {
                brought_s: BRINGING,
                end_s: end,
            });
        }
        let mut unpaced: Vec<UnpacedPath<'_>> = Vec::new();
        for laying in &layings {
            let pivot = unpaced.first().map(UnpacedPath::first_point);
            unpaced.push(UnpacedPath::new(laying, friction, pivot)?);
        }
        let whole: f64 = unpaced.iter().map(UnpacedPath::duration).sum();
        let last = unpaced.len() - 1;
        let mut rods = Vec::new();
        let mut begin = 0.0;
        for (index, path) in unpaced.into_iter().enumerate() {
            let laid_by = if index == last {
                end
            } else {
                let until = begin + (end - bringing) * path.duration() / whole;
                step.map_or(until, |step| step * (until / step).ceil())
            };
            rods.push(path.paced([begin, laid_by], step)?);
            begin = laid_by + BRINGING;
        }
        let tying = plan.map(|plan| plan.tying(&layings, &mut rods, end));
        Ok(Self { rods, tying })
    }

    /// Time at which the grippers have finished, s.
    pub fn end(&self) -> f64 {
        let laid_by = self.rods.last().map_or(0.0, GripperPath::laid_by);
        self.tying.as_ref().map_or(laid_by, |tying| tying.end)
    }
}

/// Task of a gripper with a rod, from grasp to release.
#[derive(Clone, Debug, PartialEq)]
pub struct GripperTask {
    /// Number of the gripper, from 1.
    pub gripper: usize,
    /// Number of the rod, from 1.
    pub rod: usize,
    /// Kind of work.
    pub work: GripperWork,
    /// Times (s), places (m) and orientations.
    pub poses: GripperPoses,
}

/// Kinds of work of grippers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GripperWork {
    /// Lays a rod. The gripper of the last rod keeps its end and ties with it.
    Lay,
    /// Lifts a strand, and puts it down again.
    Lift,
    /// Grasps the end of a rod again and leads it.
    Lead,
}

impl DeploymentPaths {
    /// The tasks of all grippers, in the order in which they begin.
    pub fn tasks(&self) -> Vec<GripperTask> {
        let laying = self
            .rods
            .iter()
            .enumerate()
            .map(|(index, path)| GripperTask {
                gripper: index + 1,
                rod: index + 1,
                work: GripperWork::Lay,
                poses: path.followed(),
            });
        let holds = self
            .tying
            .iter()
            .flat_map(|tying| tying.holds.iter().enumerate());
        let holds = holds.flat_map(|(index, holds)| {
            holds.iter().map(move |hold| GripperTask {
                gripper: index + 1,
                rod: hold.rod + 1,
                work: match hold.part {
                    Part::Strand => GripperWork::Lift,
                    Part::End => GripperWork::Lead,
                },
                poses: hold.poses.clone(),
            })
        });
        let mut tasks: Vec<GripperTask> = laying.chain(holds).collect();
        let begin = |task: &GripperTask| task.poses.first().map_or(0.0, |pose| pose.0);
        tasks.sort_by(|one, other| begin(one).total_cmp(&begin(other)));
        tasks
    }
}

#[cfg(test)]
mod tests {
    use super::super::gripper_path::tests::deployment;
    use super::super::keys::{Pattern, Second};
    use super::*;

    #[test]
    fn a_second_rod_is_laid_when_the_first_one_lies() {
        let first = deployment();
        let given = Deployment {
            second: Some(Second {
                scheme: first.scheme,
                lead_in: 0.0,
                pattern: Pattern::Line { length: 0.2 },
                rod: first.rod,
            }),
            ..first
        };
        let paths = DeploymentPaths::new(&given, 0.4, 50.0, Some(0.005)).unwrap();
        let [first, second] = &paths.rods[..] else {
            panic!("two rods");
        };
        let (begin, _) = second.laid[0];
        assert!((begin - first.laid_by() - BRINGING).abs() < 1e-9);
        assert_eq!((second.laid_by(), paths.end()), (50.0, 50.0));
        // The circle with its lead-in is longer than the line.
        assert!(first.laid_by() > 2.0 * (second.laid_by() - begin));
        let none = DeploymentPaths::new(&given, 0.4, BRINGING, None);
        assert!(matches!(none, Err(PathError::NoTimeForSecond { .. })));
    }
}
