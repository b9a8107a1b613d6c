//! The commands of robots from outside, with the real parts that this machine can have.

mod kinematics;
mod ros1;
#[cfg(feature = "ros2")]
mod ros2;
mod rosbridge;
mod stepper;
mod together;

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder.
fn rodlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    let [stdout, stderr] =
        [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
    format!("{stdout}{stderr}")
}

/// A cell with one arm of two joints behind a driver, and the same joints as a smooth trajectory of so many points over
/// `seconds`.
fn two_joints(folder: &Path, driver: &str, points: usize, seconds: f64) {
    let cell = format!(
        r#"[streaming]
watchdog = "300 ms"
tracking_tolerance = 0.3

[[arms]]
name = "right"
velocity = 2.0
acceleration = 20.0
jerk = 400.0
joints = [
    {{ kind = "revolute", name = "right_j0", lower = -3.0, upper = 3.0 }},
    {{ kind = "revolute", name = "right_j1", position = [0.3, 0, 0], axis = [0, 1, 0], lower = -3.0, upper = 3.0 }},
]
tool = {{ position = [0.3, 0, 0] }}

[arms.driver]
{driver}
"#
    );
    std::fs::write(folder.join("cell.toml"), cell).unwrap();
    let mut table = "time_s,right.right_j0_rad,right.right_j1_rad\n".to_owned();
    for k in 0..points {
        let part = k as f64 / (points - 1) as f64;
        let rise = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
        table.push_str(&format!("{},{},{}\n", seconds * part, rise, -0.5 * rise));
    }
    std::fs::write(folder.join("joints.csv"), table).unwrap();
}
