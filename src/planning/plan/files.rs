//! Files of planned trajectories and patterns.

use super::deployment::{LaidPath, TimedPose, deployment_figure};
use super::pattern::{Crossing, Point};
use rodlab_files::finite::{self, NotFinite};
use serde::Serialize;
use std::fmt::Write;

/// Names of the numbers of a pose.
const COLUMNS: [&str; 8] = ["time_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"];

#[derive(Serialize)]
struct TrajectoryFile<'a> {
    pattern: &'a str,
    rod: &'a str,
    gravito_bending_length_m: f64,
    poses: Vec<PoseEntry>,
}

#[derive(Serialize)]
struct PoseEntry {
    time_s: f64,
    position_m: [f64; 3],
    quaternion: [f64; 4],
}

/// Times, positions and quaternions w, x, y, z, without negative zeros.
fn entries(poses: &[TimedPose]) -> Result<Vec<PoseEntry>, NotFinite> {
    let entries = poses
        .iter()
        .zip(1..)
        .map(|((time, place, turned), number)| {
            let [x, y, z] = <[f64; 3]>::from(*place).map(|part| part + 0.0);
            let [w, i, j, k] = [turned.w, turned.i, turned.j, turned.k].map(|part| part + 0.0);
            finite::check(&[*time, x, y, z, w, i, j, k], |index| {
                format!("`{}` of pose {number}", COLUMNS[index])
            })?;
            Ok(PoseEntry {
                time_s: *time,
                position_m: [x, y, z],
                quaternion: [w, i, j, k],
            })
        });
    entries.collect()
}

/// Columns time_s, x_m, y_m, z_m, qw, qx, qy, qz.
///
/// # Errors
/// A number is not finite.
pub fn trajectory_csv(poses: &[TimedPose]) -> Result<String, NotFinite> {
    let mut text = COLUMNS.join(",") + "\n";
    for pose in entries(poses)? {
        let (time, [x, y, z], [w, i, j, k]) = (pose.time_s, pose.position_m, pose.quaternion);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{time:.9},{x:.9},{y:.9},{z:.9},{w:.12},{i:.12},{j:.12},{k:.12}"
        );
    }
    Ok(text)
}

/// The trajectory as JSON, with its context: the pattern, the rod and its gravito-bending length,
/// m.
///
/// # Errors
/// As [`trajectory_csv`].
pub fn trajectory_json(
    poses: &[TimedPose],
    pattern: &str,
    (rod, gravito_bending_length_m): (&str, f64),
) -> Result<String, NotFinite> {
    let whole = TrajectoryFile {
        pattern,
        rod,
        gravito_bending_length_m,
        poses: entries(poses)?,
    };
    let text = serde_json::to_string_pretty(&whole);
    Ok(text.expect("names and numbers are JSON values") + "\n")
}

/// The pattern of a path with columns s_m, x_m, y_m, curvature_per_m, friction_demand, and its
/// figure, each with its file name.
pub fn path_files(
    title: &str,
    path: &LaidPath,
    demands: &[f64],
    crossings: &[Crossing],
    friction: Option<f64>,
) -> [(String, String); 2] {
    let LaidPath { points, poses, .. } = path;
    let figure = deployment_figure(title, points, poses, demands, friction, crossings);
    let mut text = String::from("s_m,x_m,y_m,curvature_per_m,friction_demand\n");
    for (point, demand) in points.iter().zip(demands) {
        let _ = writeln!(
            text,
            "{:.9},{:.9},{:.9},{:.9},{demand:.9}",
            point.s, point.position.x, point.position.y, point.curvature
        );
    }
    [
        ("pattern.csv".to_owned(), text),
        ("deployment.svg".to_owned(), figure),
    ]
}

/// Columns x_m, y_m.
pub fn drawing_csv(points: &[Point]) -> String {
    let line = |point: &Point| format!("{:.12},{:.12}\n", point.x, point.y);
    "x_m,y_m\n".to_owned() + &points.iter().map(line).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::{UnitQuaternion, Vector3};

    #[test]
    fn a_pose_that_is_not_finite_is_not_written() {
        let pose =
            |time: f64, x: f64| (time, Vector3::new(x, 0.0, 0.1), UnitQuaternion::identity());
        let written = trajectory_csv(&[pose(0.0, 0.0), pose(1.0, 0.1)]).unwrap();
        assert_eq!(written.lines().count(), 3);
        let error = trajectory_csv(&[pose(0.0, 0.0), pose(1.0, f64::NAN)]).unwrap_err();
        assert_eq!(error.to_string(), "`x_m` of pose 2 is not a finite number");
        assert!(trajectory_csv(&[pose(f64::INFINITY, 0.0)]).is_err());
    }
}
