//! Resolves the poses of a gripper that a clamp follows: from a CSV file or from the scenario
//! itself.

use super::columns::read_columns;
use crate::scenario::resolved::Pose;
use crate::scenario::section::{FINITE, NON_NEGATIVE, Section};
use crate::scenario::typed;
use std::path::Path;

/// Largest deviation of the norm of a quaternion from 1. This tolerance allows rounding to two
/// digits, but not components in other units or in another order.
const UNIT_TOLERANCE: f64 = 0.02;

/// Resolves the poses that a clamp or an obstacle follows; empty if it follows none.
pub fn poses(
    section: &Section<'_>,
    follow: &Option<String>,
    typed: &Option<Vec<typed::Pose>>,
) -> Vec<Pose> {
    match (follow, typed) {
        (None, None) => Vec::new(),
        (Some(_), Some(_)) => {
            section.fault("poses", "give `follow` or `poses`, not both");
            Vec::new()
        }
        (Some(file), None) => read(&section.path_of("follow", file)).unwrap_or_else(|message| {
            section.fault("follow", message);
            Vec::new()
        }),
        (None, Some(typed)) => listed(section, typed),
    }
}

fn listed(section: &Section<'_>, typed: &[typed::Pose]) -> Vec<Pose> {
    if typed.is_empty() {
        section.fault("poses", "a gripper needs at least one pose");
    }
    let mut poses: Vec<Pose> = Vec::new();
    for (corner, (time, position, quaternion)) in section.elements("poses", typed) {
        let time = corner.number("0", time, NON_NEGATIVE);
        if let Some((before, ..)) = poses.last()
            && time <= *before
        {
            corner.fault("0", late(time, *before));
        }
        let position = corner.components("1", position);
        let numbers = corner.below("2");
        let quaternion =
            std::array::from_fn(|k| numbers.number(&k.to_string(), &quaternion[k], FINITE));
        let unit = unit(quaternion).unwrap_or_else(|message| {
            corner.fault("2", message);
            quaternion
        });
        poses.push((time, position, unit));
    }
    poses
}

/// Reads a CSV file of poses. A header line names the columns time, x, y, z, qw, qx, qy and qz
/// (with or without units, as in `time_s`); other columns are ignored. Each further row is a pose.
/// Lines that begin with `#` are comments.
fn read(path: &Path) -> Result<Vec<Pose>, String> {
    let place = path.display();
    let rows = read_columns(path, ["time", "x", "y", "z", "qw", "qx", "qy", "qz"])?;
    let mut poses: Vec<Pose> = Vec::with_capacity(rows.len());
    for (line, [time, x, y, z, qw, qx, qy, qz]) in rows {
        let fault = |message| format!("{place}, line {line}: {message}");
        if time < 0.0 {
            return Err(fault(format!("time {time:?} s is before 0")));
        }
        if let Some((before, ..)) = poses.last()
            && time <= *before
        {
            return Err(fault(late(time, *before)));
        }
        poses.push((time, [x, y, z], unit([qw, qx, qy, qz]).map_err(fault)?));
    }
    if poses.is_empty() {
        return Err(format!(
            "{place} has no rows; a gripper needs at least one pose"
        ));
    }
    Ok(poses)
}

fn late(time: f64, before: f64) -> String {
    format!("time {time:?} s is not after {before:?} s; times must increase")
}

/// Normalises a quaternion that is nearly a unit quaternion. If it is one already, up to
/// round-off, it is unchanged, so that resolved scenarios read back to themselves. Faulty numbers,
/// which were reported, are also unchanged.
fn unit(quaternion: [f64; 4]) -> Result<[f64; 4], String> {
    let norm = quaternion
        .iter()
        .map(|part| part * part)
        .sum::<f64>()
        .sqrt();
    if norm.is_nan() || (norm - 1.0).abs() < 4.0 * f64::EPSILON {
        return Ok(quaternion);
    }
    if (norm - 1.0).abs() > UNIT_TOLERANCE {
        return Err(format!(
            "the quaternion qw, qx, qy, qz = {quaternion:?} has the norm {norm:.4}; allowed: unit quaternions"
        ));
    }
    Ok(quaternion.map(|part| part / norm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn read_text(text: &str) -> Result<Vec<Pose>, String> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let name = file.path().display().to_string();
        read(file.path()).map_err(|message| message.replace(&name, "poses.csv"))
    }

    #[test]
    fn columns_are_found_by_name_and_quaternions_made_unit() {
        let text =
            "qw,qx,qy,qz,time_s,x_m,y_m,z_m,note\n1,0,0,0,0,1,2,3,7\n0.71,0.71,0,0,1.5,4,5,6,8\n";
        let poses = read_text(text).unwrap();
        assert_eq!(poses[0], (0.0, [1.0, 2.0, 3.0], [1.0, 0.0, 0.0, 0.0]));
        let half = 0.5_f64.sqrt();
        assert_eq!((poses[1].0, poses[1].1), (1.5, [4.0, 5.0, 6.0]));
        assert!((poses[1].2[0] - half).abs() < 1e-15 && (poses[1].2[1] - half).abs() < 1e-15);
    }

    #[test]
    fn faults_name_file_line_and_what_is_allowed() {
        let fault = |rows: &str| read_text(&format!("time,x,y,z,qw,qx,qy,qz\n{rows}")).unwrap_err();
        insta::assert_snapshot!(fault(""), @"poses.csv has no rows; a gripper needs at least one pose");
        insta::assert_snapshot!(fault("-1,0,0,0,1,0,0,0\n"), @"poses.csv, line 2: time -1.0 s is before 0");
        insta::assert_snapshot!(fault("1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"), @"poses.csv, line 3: time 1.0 s is not after 1.0 s; times must increase");
        insta::assert_snapshot!(fault("0,0,0,0,1,1,0,0\n"), @"poses.csv, line 2: the quaternion qw, qx, qy, qz = [1.0, 1.0, 0.0, 0.0] has the norm 1.4142; allowed: unit quaternions");
        insta::assert_snapshot!(read_text("time,x,y,z\n0,0,0,0\n").unwrap_err(), @"poses.csv, line 1: no column `qw`; the header must name time, x, y, z, qw, qx, qy and qz");
    }
}
