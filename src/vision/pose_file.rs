//! Poses in CSV files, in the format of trajectories.

use super::VisionError;
use super::input::read_text;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use rodlab_files::input::{Column, Table};
use std::path::Path;

const COLUMNS: [&str; 7] = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"];

/// Reads poses from a CSV file, see [`Table`], with columns `x_m,y_m,z_m,qw,qx,qy,qz`; other
/// columns are ignored.
///
/// # Errors
/// The file cannot be read, lacks a column, or a row is not a pose.
pub fn read_poses(path: &Path) -> Result<Vec<Isometry3<f64>>, VisionError> {
    let text = read_text(path)?;
    parse_poses(&text).map_err(|reason| VisionError::Malformed {
        path: path.into(),
        reason,
    })
}

fn parse_poses(text: &str) -> Result<Vec<Isometry3<f64>>, String> {
    let table = Table::new(text)?;
    let mut columns = [Column {
        index: 0,
        unit: 1.0,
    }; 7];
    for (place, column) in columns.iter_mut().enumerate() {
        let wanted = COLUMNS[place];
        let found = table.column(wanted.trim_end_matches("_m"), place);
        *column = found.ok_or_else(|| format!("it has no column {wanted}"))?;
    }
    table
        .rows()
        .map(|(line, values)| {
            let mut pose = [0.0; 7];
            for (k, column) in columns.into_iter().enumerate() {
                pose[k] = table.value(&values, column).ok_or_else(|| {
                    let text = values.get(column.index).map_or("", String::as_str);
                    format!(
                        "line {line}: {} is \"{text}\", expected a number",
                        COLUMNS[k]
                    )
                })?;
            }
            let [x, y, z, qw, qx, qy, qz] = pose;
            let quaternion = Quaternion::new(qw, qx, qy, qz);
            if !((quaternion.norm() - 1.0).abs() < 1e-3) {
                let norm = quaternion.norm();
                return Err(format!(
                    "line {line}: the quaternion has norm {norm:.4}, expected 1"
                ));
            }
            let turn = UnitQuaternion::from_quaternion(quaternion);
            Ok(Isometry3::from_parts(Translation3::new(x, y, z), turn))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_read_by_the_names_of_their_columns() {
        let text = "time_s,qw,qx,qy,qz,x_m,y_m,z_m\n0,0,1,0,0,1,2,3\n\n1,1,0,0,0,4,5,6\n";
        let poses = parse_poses(text).expect("poses");
        assert_eq!(poses.len(), 2);
        assert_eq!(poses[1].translation.vector.z, 6.0);
        assert!((poses[0].rotation.angle() - std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn wrong_rows_are_named() {
        let header = "x_m,y_m,z_m,qw,qx,qy,qz\n";
        let error = parse_poses(&format!("{header}1,2,3,1,1,0,0\n")).expect_err("no unit");
        assert!(
            error.contains("line 2") && error.contains("norm"),
            "{error}"
        );
        let error = parse_poses(&format!("{header}1,2,3,1,0,0\n")).expect_err("too short");
        assert!(error.contains("qz"), "{error}");
        let error = parse_poses("x_m,y_m\n").expect_err("no columns");
        assert!(error.contains("z_m"), "{error}");
    }
}
