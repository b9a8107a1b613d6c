//! Plans a joint trajectory within all limits from a path of an arm's hand in the cell.

use super::resolved::Cell;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rodlab_files::input::numbers;
use rodlab_robot::{
    JointTrajectory, Obstruction, PathFailure, PathProblem, Pose, SAMPLE, TimingError, Utilisation,
    parametrise, parts, place, read_table, subdivide, utilisation,
};
use rodlab_robot::{TableError, pose};
use serde::Serialize;
use std::path::Path;
use std::str::FromStr;

/// Spacing of the points of a joint path, m; a tenth of it in rad.
pub(super) const STEP: f64 = 1e-3;

/// Where to place a path in the cell.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// The path is turned about the z axis of its own frame, rad, and then moved by x, y, z, m.
    At([f64; 4]),
    /// The place at which the arm stays farthest from singularities; z = 0 of the path is the top of the table.
    Auto,
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        match numbers(text).as_deref() {
            Some(numbers) if numbers.iter().any(|number| !number.is_finite()) => {
                Err("finite numbers are needed".into())
            }
            Some([x, y, z]) => Ok(Self::At([*x, *y, *z, 0.0])),
            Some([x, y, z, turn]) => Ok(Self::At([*x, *y, *z, turn.to_radians()])),
            _ => Err("`auto` or x,y,z or x,y,z,degrees is needed".into()),
        }
    }
}

impl Place {
    /// The pose of the frame of the path in the cell, if it is given.
    pub fn pose(self) -> Option<Pose> {
        let Self::At([x, y, z, turn]) = self else {
            return None;
        };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        Some(Pose::from_parts(Translation3::new(x, y, z), turn))
    }
}

/// Request for a plan.
#[derive(Clone, Debug)]
pub struct PlanRequest {
    /// Index of the arm.
    pub arm: usize,
    /// Poses of the hand; the first column of times is not needed.
    pub path: Vec<Pose>,
    /// Place of the path.
    pub place: Place,
    /// Least distance to anything else, m.
    pub margin: f64,
    /// Greatest speed of the hand, m/s; its greatest angular velocity is ten times that number,
    /// rad/s.
    pub speed: f64,
    /// Points per second: a divisor of 1000.
    pub rate: u32,
}

/// A trajectory with its numbers.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The joint trajectory.
    pub trajectory: JointTrajectory,
    /// Numbers of the plan.
    pub report: PlanReport,
}

/// Numbers of a plan.
#[derive(Clone, Debug, Default, Serialize)]
pub struct PlanReport {
    /// Points of the joint path, 1 mm apart at most.
    pub path_points: usize,
    /// Length of the path, m (a rotation by 1 rad counts as 0.1 m).
    pub length_m: f64,
    /// Duration of the motion.
    pub duration_s: f64,
    /// Points of the trajectory.
    pub points: usize,
    /// Position of the frame of the path in the cell.
    pub place_position: [f64; 3],
    /// Quaternion of the frame: w, x, y, z.
    pub place_quaternion: [f64; 4],
    /// Largest step of a joint between points of the path, rad or m.
    pub largest_jump: f64,
    /// Least distance to anything else, m; 0.2 means 0.2 or more.
    pub least_clearance_m: f64,
    /// Smallest singular value of the Jacobian.
    pub least_distance_to_singularity: f64,
    /// Least distance of a joint from an end of its range, rad or m; `null` if no joint has an
    /// end.
    pub least_distance_to_limits: Option<f64>,
    /// Largest velocity, acceleration and jerk at 1 kHz, as fractions of the limits.
    pub velocity_used: f64,
    /// See `velocity_used`.
    pub acceleration_used: f64,
    /// See `velocity_used`.
    pub jerk_used: f64,
}

/// Reason why planning failed.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// Invalid request.
    #[error("{0}")]
    Input(String),
    /// The path cannot be followed.
    #[error("{0}")]
    Path(String),
    /// No motion along the path keeps the limits.
    #[error("{0}")]
    Timing(#[from] TimingError),
}

impl Cell {
    /// Returns the index of the arm whose name was given by a flag. The name may be omitted if the
    /// cell has only one arm.
    ///
    /// # Errors
    /// The arm does not exist, or the flag is required.
    pub fn arm_named(
        &self,
        flag: &str,
        name: Option<&str>,
        file: &Path,
    ) -> Result<usize, PlanError> {
        let names: Vec<&str> = self.arms.iter().map(|arm| arm.name.as_str()).collect();
        let index = match name {
            None if names.len() == 1 => Some(0),
            None => None,
            Some(name) => names.iter().position(|known| *known == name),
        };
        index.ok_or_else(|| {
            let what = match name {
                Some(name) => format!("{flag}: there is no arm {name:?}"),
                None => format!("{flag} is required to select an arm"),
            };
            PlanError::Input(format!(
                "{what}; arms of {}: {}",
                file.display(),
                names.join(", ")
            ))
        })
    }
}

/// Reads poses of a hand: the columns `x_m`, `y_m`, `z_m`, `qw`, `qx`, `qy`, `qz` of a table; other columns are ignored.
///
/// # Errors
/// A column is missing, a number is invalid or the length of a quaternion differs from one by more than a thousandth.
pub fn read_poses(path: &Path) -> Result<Vec<Pose>, TableError> {
    let table = read_table(path)?;
    let fault = |line: u64, message: String| TableError {
        path: path.to_owned(),
        line: Some(line),
        message,
    };
    let mut columns = [0; 7];
    for (slot, name) in columns
        .iter_mut()
        .zip(["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"])
    {
        *slot = table
            .header
            .iter()
            .position(|header| header == name)
            .ok_or_else(|| fault(1, format!("column `{name}` is missing")))?;
    }
    if table.rows.is_empty() {
        return Err(fault(1, "there are no poses".into()));
    }
    let poses = table.rows.iter().zip(&table.lines).map(|(row, line)| {
        let [x, y, z, qw, qx, qy, qz] = columns.map(|column| row[column]);
        let length = (qw * qw + qx * qx + qy * qy + qz * qz).sqrt();
        if (length - 1.0).abs() > 1e-3 {
            return Err(fault(
                *line,
                format!("the quaternion has length {length:.6} instead of 1"),
            ));
        }
        pose([x, y, z], [qw, qx, qy, qz]).ok_or_else(|| fault(*line, "no pose".into()))
    });
    poses.collect()
}

impl Cell {
    /// Plans the motion of one arm along a path of its hand, the other arms at rest.
    ///
    /// # Errors
    /// The path cannot be followed: the message gives the first such point, the reason, and the
    /// nearest reachable pose.
    pub fn plan(&self, request: &PlanRequest) -> Result<Plan, PlanError> {
        let arm = &self.arms[request.arm];
        if request.rate == 0 || 1000 % request.rate != 0 {
            return Err(PlanError::Input(format!(
                "{} points per second; allowed: divisors of 1000, as 100, 250, 500, 1000",
                request.rate
            )));
        }
        let surroundings = self.surroundings();
        let homes = surroundings.homes();
        let clearance = |joints: &[f64]| {
            let mut postures = homes.clone();
            postures[request.arm] = joints.to_vec();
            surroundings.clearance(&postures, Some(request.arm))
        };
        let problem = PathProblem {
            chain: &arm.chain,
            from: &arm.home,
            clearance: &clearance,
            margin: request.margin,
        };
        let frame = self.frame(request, &problem)?;
        let to_base = arm.base.inverse() * frame;
        let poses: Vec<Pose> = request.path.iter().map(|pose| to_base * pose).collect();
        let points = subdivide(&poses, STEP);
        let path = problem.solve(&points).map_err(|failure| {
            PlanError::Path(self.in_words(request, &failure, points[failure.point].given))
        })?;
        let way: Vec<f64> = points.iter().map(|point| point.way).collect();
        let limits = arm.limits();
        let motion = parametrise(
            &path.joints,
            &way,
            &limits,
            self.safety.planned(request.speed),
        )?;
        let used: Utilisation = utilisation(&motion.samples, &limits);
        let trajectory = self.sampled(request.arm, request.rate, &motion.samples);
        let (place_position, place_quaternion) = parts(&frame);
        let to_limits = path.least_distance_to_limits;
        let report = PlanReport {
            path_points: points.len(),
            length_m: way[way.len() - 1],
            duration_s: trajectory.duration(),
            points: trajectory.points.len(),
            place_position,
            place_quaternion,
            largest_jump: path.largest_jump,
            least_clearance_m: path.least_clearance,
            least_distance_to_singularity: path.least_distance_to_singularity,
            least_distance_to_limits: to_limits.is_finite().then_some(to_limits),
            velocity_used: used.velocity,
            acceleration_used: used.acceleration,
            jerk_used: used.jerk,
        };
        Ok(Plan { trajectory, report })
    }

    /// Pose of the path's frame in the cell.
    fn frame(&self, request: &PlanRequest, problem: &PathProblem<'_>) -> Result<Pose, PlanError> {
        let arm = &self.arms[request.arm];
        if let Some(pose) = request.place.pose() {
            return Ok(pose);
        }
        let table = self.table.ok_or_else(|| {
            PlanError::Input("`auto` needs a [table], which the cell does not have".into())
        })?;
        let top = arm.base.inverse() * table.top;
        let sides = [table.size[0], table.size[1]];
        let found = place(problem, &request.path, &top, sides, STEP).map_err(|failure| {
            PlanError::Path(match failure {
                None => format!(
                    "nowhere on the table can arm {} reach all of the path",
                    arm.name
                ),
                Some(failure) => format!(
                    "nowhere on the table can arm {} follow the path; where it comes nearest to it: {}",
                    arm.name,
                    failure.reason.in_words()
                ),
            })
        })?;
        Ok(arm.base * found.pose)
    }

    fn in_words(&self, request: &PlanRequest, failure: &PathFailure, given: usize) -> String {
        let arm = &self.arms[request.arm];
        let frame_of_hand = request.place.pose().unwrap_or_default();
        let nearest = frame_of_hand.inverse() * arm.base * failure.nearest;
        let ([x, y, z], [qw, qx, qy, qz]) = parts(&nearest);
        let what_next = match failure.reason {
            Obstruction::OutOfReach => "the nearest pose that can be reached",
            Obstruction::Collision | Obstruction::Jump => "the last pose before it",
        };
        format!(
            "arm {}: the path cannot be followed beyond its pose {} (line {} of the table): {}; {what_next} is \
             {x:.6},{y:.6},{z:.6},{qw:.6},{qx:.6},{qy:.6},{qz:.6}; --place auto looks for a better place",
            arm.name,
            given + 1,
            given + 2,
            failure.reason.in_words()
        )
    }

    /// Reduces samples to `rate` points per second. If the last sample is not a multiple of the
    /// step, the trajectory ends with one more step at rest.
    pub(super) fn sampled(&self, arm: usize, rate: u32, samples: &[Vec<f64>]) -> JointTrajectory {
        let arm = &self.arms[arm];
        let last = samples.len() - 1;
        let stride = (1000 / rate) as usize;
        let count = last.div_ceil(stride);
        JointTrajectory {
            columns: arm.columns().collect(),
            times: (0..=count).map(|k| (k * stride) as f64 * SAMPLE).collect(),
            points: (0..=count)
                .map(|k| samples[(k * stride).min(last)].clone())
                .collect(),
        }
    }
}
