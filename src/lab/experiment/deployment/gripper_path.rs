//! The path of a gripper that lays a rod, with its prescribed errors. The path is computed before
//! the run.

use super::keys::Deployment;
use super::planned::{PathError, Planned};
use crate::experiment::prepare::Jitter;
use rodlab_engine::mechanics::scene::Motion;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use rodlab_planning::plan::deployment::{
    DeployedRod, Feasibility, GripperPose, MOST_POSES, checked_points, hanging_rod, laid_after,
    times, trajectory,
};
use rodlab_planning::plan::pattern::{Pattern, PatternPoint, Point};
use rodlab_planning::plan::tying::GripperPoses;
use std::f64::consts::TAU;

/// Distance between adjacent poses along the pattern, m.
const POSE_SPACING: f64 = 3e-3;
/// Distance between the poses from which times are computed, m.
const TIMING_SPACING: f64 = 12e-3;
/// Poses per period of the fastest jitter.
const POSES_PER_PERIOD: f64 = 10.0;
/// Time in which a waiting rod is brought to the start of its laying, s. The rod is moved over its
/// first point, hangs until it no longer swings, and is lowered.
pub const BRINGING: f64 = 10.0;
const HANGING: [f64; 2] = [4.0, 2.0];
/// Distance of the waiting place behind the start of the pattern, clear of the rod that is laid
/// first, m.
const WAITING_BEHIND: f64 = 0.25;
/// Height of the rod's free end over the table while waiting, and over its first point, in
/// gravito-bending lengths.
const WAITING_ABOVE: f64 = 2.0;
const HANGING_ABOVE: f64 = 0.1;

/// Laying of one rod: pattern, poses and times.
pub struct GripperPath {
    /// Length of the pattern with its lead-in, m.
    pub length: f64,
    /// The pattern.
    pub curve: Pattern,
    /// Friction demand of the pattern.
    pub feasibility: Feasibility,
    /// Times (s) of the poses, and the length laid by then, m.
    pub laid: Vec<(f64, f64)>,
    /// Points of the pattern at these times, as the planner assumes them.
    pub points: Vec<PatternPoint>,
    /// The poses as planned.
    pub planned: Vec<GripperPose>,
    /// Displacement (m) and rotation (rad) of the gripper relative to them.
    pub jitter: Vec<(Vector3, Vector3)>,
    /// The poses with errors.
    pub poses: Vec<GripperPose>,
    /// Model that the planner assumes.
    pub seen: Planned,
    /// The rod at the start, m.
    pub start: Vec<Vector3>,
    /// The poses of a waiting rod from the start to the first pose of the laying, with errors;
    /// empty if the rod does not wait.
    pub brought: GripperPoses,
    /// The poses with errors after the laying, if the gripper then leads the end of the rod on.
    pub led: GripperPoses,
}

/// A path without times, since its speed is not chosen yet.
pub struct UnpacedPath<'a> {
    deployment: &'a Deployment,
    curve: Pattern,
    feasibility: Feasibility,
    planned: Planned,
    coarse: Vec<GripperPose>,
    passed: Vec<f64>,
}

impl<'a> UnpacedPath<'a> {
    /// The path of a deployment of one rod on a table with a `friction`. `pivot` is the first
    /// point of the first pattern, m.
    ///
    /// # Errors
    /// The pattern cannot be laid.
    pub fn new(
        deployment: &'a Deployment,
        friction: f64,
        pivot: Option<Point>,
    ) -> Result<Self, PathError> {
        let rod = deployment.rod.deployed();
        let curve = deployment.laid_pattern()?;
        refuse_many(curve.length() / POSE_SPACING)?;
        let checked = checked_points(&curve, POSE_SPACING, &rod)?;
        let pivot = pivot.unwrap_or_else(|| curve.at(0.0).position);
        let planned = Planned::new(deployment, pivot);
        let coarse = trajectory(
            &planned.seen(curve.sampled(TIMING_SPACING)),
            &planned.rod,
            deployment.scheme.into(),
            deployment.solver.into(),
        )?;
        let passed = times(&coarse, 1.0);
        let feasibility = Feasibility::of(&checked, &rod, Some(friction), &coarse);
        Ok(Self {
            deployment,
            curve,
            feasibility,
            planned,
            coarse,
            passed,
        })
    }

    /// The first point of the pattern, m.
    pub fn first_point(&self) -> Point {
        self.curve.at(0.0).position
    }

    /// Duration of the path at a speed of 1 m/s, s.
    pub fn duration(&self) -> f64 {
        self.passed.last().copied().unwrap_or(0.0)
    }

    /// The path between two times, s. With a fixed `step`, s, the times of poses are multiples of
    /// it. A rod that is laid later waits until the first time.
    ///
    /// # Errors
    /// The pattern cannot be laid.
    pub fn paced(
        self,
        [begin, end]: [f64; 2],
        step: Option<f64>,
    ) -> Result<GripperPath, PathError> {
        let deployment = self.deployment;
        let scheme = deployment.scheme.into();
        let length = self.curve.length();
        let time = end - begin;
        let spacing = deployment.pose_spacing(time, length);
        let spacing = step.map_or(spacing, |step| {
            // A ratio just below a whole number counts as that number.
            step * (spacing / step + 1e-9).floor().max(1.0)
        });
        refuse_many(end / spacing)?;
        let count = (time / spacing - 1e-6).ceil().max(1.0) as usize;
        let laid: Vec<(f64, f64)> = (0..=count)
            .map(|index| (spacing * index as f64).min(time))
            .map(|at| {
                let passed = at / time * self.duration();
                (begin + at, laid_after(&self.coarse, &self.passed, passed))
            })
            .collect();
        let mut points: Vec<PatternPoint> = laid.iter().map(|&(_, s)| self.curve.at(s)).collect();
        // Makes the angles continuous.
        for index in 1..points.len() {
            let turns = (points[index - 1].angle - points[index].angle) / TAU;
            points[index].angle += TAU * turns.round();
        }
        let planned = self.planned;
        let seen = planned.seen(points);
        let poses = trajectory(&seen, &planned.rod, scheme, deployment.solver.into())?;
        let mut start = hanging_rod(&seen[0], &planned.rod, scheme, deployment.rod.edges)?;
        let jitter = deployment.trembling();
        let mut brought = GripperPoses::new();
        if begin > 0.0 {
            let ways = brought_from(&seen[0], &planned.rod, &poses[0].position);
            for node in &mut start {
                *node += ways[0];
            }
            let count = (begin / spacing).ceil().max(1.0) as usize;
            brought.extend((0..count).map(|index| {
                let time = (spacing * index as f64).min(begin);
                let (way, turn) = jitter.at(time);
                let left = begin - time;
                let coming = smooth((left - HANGING[0]) / (BRINGING - HANGING[0]));
                let hanging = smooth(left / HANGING[1]);
                let away = coming * (ways[0] - ways[1]) + hanging * ways[1];
                let place = poses[0].position + away + way;
                (time, place, rotation::from_vector(turn) * poses[0].rotation)
            }));
        }
        let jitter: Vec<_> = laid.iter().map(|(time, _)| jitter.at(*time)).collect();
        let disturbed = poses.iter().zip(&jitter).map(|(pose, jitter)| GripperPose {
            position: pose.position + jitter.0,
            rotation: rotation::from_vector(jitter.1) * pose.rotation,
            ..pose.clone()
        });
        Ok(GripperPath {
            length,
            curve: self.curve,
            feasibility: self.feasibility,
            laid,
            points: seen,
            poses: disturbed.collect(),
            planned: poses,
            jitter,
            seen: planned,
            start,
            brought,
            led: GripperPoses::new(),
        })
    }
}

fn refuse_many(count: f64) -> Result<(), PathError> {
    if count > MOST_POSES {
        Err(PathError::TooManyPoses(count))
    } else {
        Ok(())
    }
}

/// Waiting place of the gripper of a rod, and the place from which it lowers the rod, relative to
/// its first laying place, m. At both places the rod hangs straight.
fn brought_from(first: &PatternPoint, rod: &DeployedRod, place: &Vector3) -> [Vector3; 2] {
    let (sine, cosine) = libm::sincos(first.angle);
    let behind = -WAITING_BEHIND * Vector3::new(cosine, sine, 0.0);
    let over = |height: f64| {
        let top = rod.radius + rod.length + height * rod.gravito_bending_length;
        first.position.push(top) - place
    };
    [over(WAITING_ABOVE) + behind, over(HANGING_ABOVE)]
}

/// Smooth step: increases from 0 to 1 between 0 and 1, with zero slope at both ends.
fn smooth(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

impl GripperPath {
    /// Time at which the rod is laid, s.
    pub fn laid_by(&self) -> f64 {
        self.laid.last().map_or(0.0, |(time, _)| *time)
    }

    /// Time at which the gripper has finished, s.
    pub fn end(&self) -> f64 {
        self.led.last().map_or(self.laid_by(), |pose| pose.0)
    }

    /// Direction of the rod at the gripper at the start.
    pub fn first_direction(&self) -> Vector3 {
        self.first().1 * Vector3::x()
    }

    /// The first pose of all.
    fn first(&self) -> (Vector3, UnitQuaternion) {
        let brought = self.brought.first().map(|pose| (pose.1, pose.2));
        brought.unwrap_or((self.poses[0].position, self.poses[0].rotation))
    }

    /// All poses of the gripper with errors.
    pub fn followed(&self) -> GripperPoses {
        let laying = self.laid.iter().zip(&self.poses);
        let laying = laying.map(|((time, _), pose)| (*time, pose.position, pose.rotation));
        let before = self.brought.iter().copied();
        // The first of these poses is the last pose of the laying.
        let after = self.led.iter().skip(1).copied();
        before.chain(laying).chain(after).collect()
    }

    /// The motion of the rod's end with the gripper.
    pub fn motion(&self) -> Motion {
        let (place, turn) = self.first();
        let timed = self.followed();
        let timed = || timed.iter();
        Motion {
            translation: timed()
                .map(|(time, position, _)| (*time, position - place))
                .collect(),
            orientation: timed()
                .map(|(time, _, rotation)| (*time, rotation * turn.inverse()))
                .collect(),
            pivot: Some(place),
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
    /// The jitter of its gripper.
    pub fn trembling(&self) -> Jitter {
        let rms = [self.jitter, self.jitter_angle];
        Jitter::new(rms, self.jitter_period, self.seed)
    }

    /// Time between poses that resolves pattern and jitter, s.
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
            second: None,
        }
    }

    fn path(deployment: &Deployment, times: [f64; 2], step: Option<f64>) -> GripperPath {
        let unpaced = UnpacedPath::new(deployment, 0.4, None).unwrap();
        unpaced.paced(times, step).unwrap()
    }

    #[test]
    fn a_rod_that_is_laid_later_waits_behind_its_start() {
        let path = path(&deployment(), [20.0, 50.0], Some(0.005));
        assert_eq!(path.laid[0], (20.0, 0.0));
        let [first, last] = [&path.brought[0], &path.brought[path.brought.len() - 1]];
        assert_eq!(first.0, 0.0);
        let away = first.1 - path.poses[0].position;
        assert!(away.xy().norm() > WAITING_BEHIND && away.z > 0.0);
        assert!(path.start.iter().all(|node| node.z > 0.0016));
        assert!((path.start[80] - first.1).norm() < 1e-7);
        // It arrives slowly.
        assert!(last.0 < 20.0 && (last.1 - path.poses[0].position).norm() < 1e-3);
        let motion = path.motion();
        assert_eq!(
            motion.translation.len(),
            path.brought.len() + path.poses.len()
        );
        assert!(
            motion
                .translation
                .windows(2)
                .all(|pair| pair[0].0 < pair[1].0)
        );
    }

    #[test]
    fn poses_lie_at_steps_and_end_with_the_pattern() {
        let path = path(&deployment(), [0.0, 30.0], Some(0.005));
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
        let true_path = path(&deployment(), [0.0, 30.0], None);
        let given = Deployment {
            frame_shift: [0.02, -0.01],
            frame_turn: 0.3,
            ..deployment()
        };
        let moved = path(&given, [0.0, 30.0], None);
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
