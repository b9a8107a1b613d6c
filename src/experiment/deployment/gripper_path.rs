//! The path of the gripper, with the errors that it is given: made before the run, followed during it.

use super::keys::Deployment;
use super::planned::{PathError, Planned};
use super::tying::{Tying, TyingPlan};
use crate::experiment::prepare::Jitter;
use crate::mechanics::scene::Motion;
use crate::mechanics::{Vector3, rotation};
use crate::plan::deployment::{
    Feasibility, GripperPose, MOST_POSES, hanging_rod, laid_after, times, trajectory,
};
use crate::plan::pattern::{Pattern, PatternPoint};
use crate::plan::tying::GripperPoses;
use std::f64::consts::TAU;

/// Distance of neighbouring poses along the pattern, m.
const POSE_SPACING: f64 = 3e-3;
/// The same of the poses by which times are found, m.
const TIMING_SPACING: f64 = 12e-3;
/// Poses per period of the fastest jitter.
const POSES_PER_PERIOD: f64 = 10.0;

/// What is laid where and when.
pub struct GripperPath {
    /// Length of the pattern, its lead-in included, m.
    pub length: f64,
    /// The pattern.
    pub curve: Pattern,
    /// What it asks for.
    pub feasibility: Feasibility,
    /// Times (s) of the poses and what has been laid then, m.
    pub laid: Vec<(f64, f64)>,
    /// The pattern at these times, where the planner sees it.
    pub points: Vec<PatternPoint>,
    /// The poses as planned.
    pub planned: Vec<GripperPose>,
    /// Displacement (m) and turn (rad) of the gripper from them.
    pub jitter: Vec<(Vector3, Vector3)>,
    /// The poses, errors included.
    pub poses: Vec<GripperPose>,
    /// What the planner believes.
    pub seen: Planned,
    /// The rod at the start, m.
    pub start: Vec<Vector3>,
    /// What comes after, where a knot is tied.
    pub tying: Option<Tying>,
}

impl GripperPath {
    /// The path of a deployment that ends after `end`, s; poses lie at whole numbers of steps of `step` where steps have
    /// a size, s. `friction` is that of the table.
    ///
    /// # Errors
    /// The pattern cannot be laid.
    pub fn new(
        deployment: &Deployment,
        friction: f64,
        end: f64,
        step: Option<f64>,
    ) -> Result<Self, PathError> {
        let rod = deployment.rod.deployed();
        let curve = deployment.laid_pattern()?;
        let plan = TyingPlan::new(deployment)?;
        let end = match &plan {
            Some(plan) => plan.laid_by(end)?,
            None => end,
        };
        let length = curve.length();
        let refuse_many = |count: f64| {
            if count > MOST_POSES {
                Err(PathError::TooManyPoses(count))
            } else {
                Ok(())
            }
        };
        refuse_many(length / POSE_SPACING)?;
        let feasibility = Feasibility::of(&curve, POSE_SPACING, &rod, Some(friction))?;
        let planned = Planned::new(deployment, &curve);
        let scheme = deployment.scheme.into();
        let grasps = deployment.solver.into();
        let coarse = trajectory(
            &planned.seen(curve.sampled(TIMING_SPACING)),
            &planned.rod,
            scheme,
            grasps,
        )?;
        let passed = times(&coarse, 1.0);
        let duration = passed.last().copied().unwrap_or(0.0);
        let spacing = deployment.pose_spacing(end, length);
        let spacing = step.map_or(spacing, |step| {
            // A hair less than a whole number is that number.
            step * (spacing / step + 1e-9).floor().max(1.0)
        });
        refuse_many(end / spacing)?;
        let count = (end / spacing - 1e-6).ceil().max(1.0) as usize;
        let at: Vec<f64> = (0..=count)
            .map(|index| (spacing * index as f64).min(end))
            .collect();
        let laid: Vec<(f64, f64)> = at
            .iter()
            .map(|&time| (time, laid_after(&coarse, &passed, time / end * duration)))
            .collect();
        let mut points: Vec<PatternPoint> = laid.iter().map(|&(_, s)| curve.at(s)).collect();
        // Angles go over into each other.
        for index in 1..points.len() {
            let turns = (points[index - 1].angle - points[index].angle) / TAU;
            points[index].angle += TAU * turns.round();
        }
        let seen = planned.seen(points);
        let poses = trajectory(&seen, &planned.rod, scheme, grasps)?;
        let start = hanging_rod(&seen[0], &planned.rod, scheme, deployment.rod.edges)?;
        let tying = plan.zip(poses.last());
        let tying = tying.map(|(plan, last)| plan.tying(deployment, &planned, last, end));
        let jitter = deployment.jitter_of_seed(deployment.seed);
        let jitter: Vec<_> = laid.iter().map(|(time, _)| jitter.at(*time)).collect();
        let disturbed = poses.iter().zip(&jitter).map(|(pose, jitter)| GripperPose {
            position: pose.position + jitter.0,
            rotation: rotation::from_vector(jitter.1) * pose.rotation,
            ..pose.clone()
        });
        Ok(Self {
            length,
            curve,
            feasibility,
            laid,
            points: seen,
            poses: disturbed.collect(),
            planned: poses,
            jitter,
            seen: planned,
            start,
            tying,
        })
    }

    /// When the gripper has done its work, s.
    pub fn end(&self) -> f64 {
        let tied = self.tying.as_ref().and_then(|tying| tying.end.last());
        let laid = self.laid.last().map(|(time, _)| *time);
        tied.map(|pose| pose.0).or(laid).unwrap_or(0.0)
    }

    /// Direction of the rod at the gripper at the start.
    pub fn first_direction(&self) -> Vector3 {
        self.poses[0].rotation * Vector3::x()
    }

    /// The motion of the rod's end with the gripper.
    pub fn motion(&self) -> Motion {
        let first = &self.poses[0];
        let laying = self.laid.iter().zip(&self.poses);
        let laying = laying.map(|((time, _), pose)| (*time, pose.position, pose.rotation));
        // It begins with the last pose of the laying.
        let after = self.tying.iter().flat_map(|tying| &tying.end[1..]).copied();
        let timed: GripperPoses = laying.chain(after).collect();
        let timed = || timed.iter();
        Motion {
            translation: timed()
                .map(|(time, position, _)| (*time, position - first.position))
                .collect(),
            orientation: timed()
                .map(|(time, _, rotation)| (*time, rotation * first.rotation.inverse()))
                .collect(),
            pivot: Some(first.position),
            ..Motion::default()
        }
    }

    /// Largest speed of the gripper, m/s.
    pub fn largest_speed(&self) -> f64 {
        let times = self.laid.windows(2).map(|pair| pair[1].0 - pair[0].0);
        let moves = self
            .poses
            .windows(2)
            .map(|pair| (pair[1].position - pair[0].position).norm());
        moves
            .zip(times)
            .map(|(way, time)| way / time)
            .fold(0.0, f64::max)
    }
}

impl Deployment {
    /// The trembling of a gripper.
    pub fn jitter_of_seed(&self, seed: u64) -> Jitter {
        Jitter::new([self.jitter, self.jitter_angle], self.jitter_period, seed)
    }

    /// Time between poses that follows pattern and jitter, s.
    fn pose_spacing(&self, end: f64, length: f64) -> f64 {
        let along = end * POSE_SPACING / length;
        if self.jitter > 0.0 || self.jitter_angle > 0.0 {
            along.min(self.jitter_period / POSES_PER_PERIOD)
        } else {
            along
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::super::keys::{Pattern, Rod, Scheme, Solver};
    use super::*;

    /// A circle.
    pub fn deployment() -> Deployment {
        Deployment {
            scheme: Scheme::Optimal,
            solver: Solver::Exact,
            lead_in: 0.1,
            length_error: 0.0,
            frame_shift: [0.0; 2],
            frame_turn: 0.0,
            jitter: 0.0,
            jitter_angle: 0.0,
            jitter_period: 1.0,
            seed: 0,
            correction: None,
            release: None,
            pegs: Vec::new(),
            knot: None,
            pattern: Pattern::Circle { radius: 0.09 },
            rod: Rod {
                gravito_bending_length: 0.032,
                radius: 0.0016,
                length: 0.885,
                density: 1000.0,
                edges: 80,
            },
        }
    }

    #[test]
    fn poses_lie_at_steps_and_end_with_the_pattern() {
        let path = GripperPath::new(&deployment(), 0.4, 30.0, Some(0.005)).unwrap();
        for (time, _) in &path.laid[..path.laid.len() - 1] {
            let steps = time / 0.005;
            assert!((steps - steps.round()).abs() < 1e-6, "{time}");
        }
        let (end, laid) = *path.laid.last().unwrap();
        assert_eq!(end, 30.0);
        assert!((laid - path.length).abs() < 1e-12);
        assert!((path.length - 0.1 - 0.09 * TAU).abs() < 1e-9);
        assert!((path.start[80] - path.poses[0].position).norm() < 1e-7);
        assert!(path.largest_speed() < 0.08);
    }

    #[test]
    fn an_error_of_the_frame_moves_the_whole_path() {
        let true_path = GripperPath::new(&deployment(), 0.4, 30.0, None).unwrap();
        let given = Deployment {
            frame_shift: [0.02, -0.01],
            frame_turn: 0.3,
            ..deployment()
        };
        let moved = GripperPath::new(&given, 0.4, 30.0, None).unwrap();
        let first = true_path.curve.at(0.0).position;
        let pivot = Vector3::new(first.x, first.y, 0.0);
        let turn = rotation::from_vector(0.3 * Vector3::z());
        for (pose, other) in true_path.poses.iter().zip(&moved.poses) {
            let expected = pivot + turn * (pose.position - pivot) + Vector3::new(0.02, -0.01, 0.0);
            assert!((other.position - expected).norm() < 1e-8, "{}", pose.s);
            assert!(other.rotation.angle_to(&(turn * pose.rotation)) < 1e-6);
        }
    }
}
