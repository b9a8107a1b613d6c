//! The robot commands from outside, with all real programs that can run on this machine.

mod kinematics;
mod mujoco;
mod ros1;
#[cfg(feature = "ros2")]
mod ros2;
mod rosbridge;
mod stepper;
mod together;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Streams the joints of [`two_joints`] and writes a log.
const STREAM: [&str; 6] = [
    "stream",
    "joints.csv",
    "--cell",
    "cell.toml",
    "--out",
    "log",
];

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

/// Checks that a motion failed, with a message.
fn assert_failed(output: &Output, words: &str) {
    assert_eq!(output.status.code(), Some(1), "{}", said(output));
    assert!(said(output).contains(words), "{}", said(output));
}

/// Sets the horizon, so that the motion of a folder is sent in pieces.
fn set_horizon(folder: &Path, horizon: &str) {
    let path = folder.join("cell.toml");
    let cell = fs::read_to_string(&path).unwrap();
    let streaming = format!("[streaming]\nhorizon = \"{horizon}\"");
    fs::write(path, cell.replace("[streaming]", &streaming)).unwrap();
}

/// Checks in the log that the first joint moved from 0 to 1 rad without a stop: during the motion
/// of [`two_joints`] over `seconds`, its speed is always at least half of the planned one.
fn assert_moved_without_a_stop(folder: &Path, seconds: f64) {
    let state = log(folder, "state.csv");
    let rows = state.lines().skip(1).filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let is_first = cells[2] == "right_j0";
        is_first.then(|| [cells[0].parse().unwrap(), cells[3].parse().unwrap()])
    });
    let rows: Vec<[f64; 2]> = rows.collect();
    let start = rows.iter().rfind(|row| row[1] == 0.0).unwrap()[0];
    let at = |time: f64| rows.iter().rfind(|row| row[0] <= start + time).unwrap()[1];
    // The speed is measured over a time that is long compared with the jitter of a busy machine.
    let window = 0.3;
    for k in 20..70 {
        let time = 0.01 * f64::from(k) * seconds;
        let should = rise(time + window, seconds) - rise(time, seconds);
        let moved = at(time + window) - at(time);
        assert!(
            moved > 0.5 * should,
            "{moved} of {should} rad after {time} s"
        );
    }
}

/// Starts [`STREAM`] in a folder.
fn start_stream(folder: &Path) -> Child {
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(STREAM)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// A file of the log of a stream; empty if it does not exist yet.
fn log(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join("log").join(name)).unwrap_or_default()
}

/// Waits until the log contains a text.
fn wait_for_event(folder: &Path, words: &str, seconds: u64) -> String {
    let begin = Instant::now();
    loop {
        let events = log(folder, "events.csv");
        if let Some(line) = events.lines().find(|line| line.contains(words)) {
            return line.to_owned();
        }
        let waited = begin.elapsed();
        assert!(
            waited < Duration::from_secs(seconds),
            "no {words:?} in {events:?}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Waits until an arm is in motion.
fn wait_for_motion(folder: &Path) {
    wait_for_event(folder, "\"started\"", 20);
    std::thread::sleep(Duration::from_millis(700));
}

/// Longest time until a motion of 5 s is stopped, while the machine is busy with other tests. In
/// simulated time (`motions_with_random_faults…` of the stream) the limits are those of the
/// program.
const PROMPTLY: Duration = Duration::from_millis(2500);

/// Ctrl-C.
fn interrupt(child: &Child) {
    signal(child, "INT");
}

/// Sends a signal.
fn signal(child: &Child, name: &str) {
    let kill = Command::new("kill")
        .args([&format!("-{name}"), &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
}

/// Output of a process that was started with a pipe, line by line.
fn lines_of(child: &mut Child) -> Receiver<String> {
    let output = BufReader::new(child.stdout.take().unwrap());
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        for line in output.lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    lines
}

/// Checks the report of an arm on a motion that it followed, such as "followed 500 231 1.0 -0.5":
/// points of the goal, reports, and final joint positions.
fn assert_followed(said: &str, points: usize) {
    let words: Vec<&str> = said.split(' ').collect();
    assert_eq!(words[..2], ["followed", &points.to_string()]);
    assert!(words[2].parse::<u32>().unwrap() > 100, "{said}");
    let end: Vec<f64> = words[3..]
        .iter()
        .map(|word| word.parse().unwrap())
        .collect();
    assert_eq!(end, [1.0, -0.5]);
}

/// Gives a joint of the cell and of the trajectory a name that does not exist in any arm.
fn rename_joint(folder: &Path) {
    for name in ["cell.toml", "joints.csv"] {
        let path = folder.join(name);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(path, text.replace("right_j1", "right_k1")).unwrap();
    }
}

/// A smooth unit step over a time: rest, motion, rest.
fn rise(time: f64, seconds: f64) -> f64 {
    let part = (time / seconds).clamp(0.0, 1.0);
    part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part)
}

/// A table of columns with given displacements over `seconds`, with a number of points.
fn table(folder: &Path, name: &str, columns: &[(&str, f64)], points: usize, seconds: f64) {
    let headers: Vec<&str> = columns.iter().map(|(header, _)| *header).collect();
    let mut text = format!("time_s,{}\n", headers.join(","));
    for k in 0..points {
        let time = seconds * k as f64 / (points - 1) as f64;
        let cells = columns
            .iter()
            .map(|(_, by)| (by * rise(time, seconds)).to_string());
        text.push_str(&format!("{time},{}\n", cells.collect::<Vec<_>>().join(",")));
    }
    fs::write(folder.join(name), text).unwrap();
}

/// A cell with one arm of two joints and a driver, and a smooth trajectory of these joints over
/// `seconds` with a number of points.
fn two_joints(folder: &Path, driver: &str, points: usize, seconds: f64) {
    let cell = format!(
        r#"[streaming]
watchdog = "1500 ms"
tracking_tolerance = 0.5

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
    fs::write(folder.join("cell.toml"), cell).unwrap();
    let columns = [("right.right_j0_rad", 1.0), ("right.right_j1_rad", -0.5)];
    table(folder, "joints.csv", &columns, points, seconds);
}

/// A motion is slow until it was finished once; another motion is slow again.
#[test]
fn the_first_run_of_a_motion_is_slow() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let driver = "kind = \"file\"\npath = \"sent.csv\"";
    two_joints(folder, driver, 40, 1.5);
    let cell = folder.join("cell.toml");
    let typed = fs::read_to_string(&cell).unwrap();
    fs::write(&cell, format!("[safety]\nfirst_run = 0.5\n\n{typed}")).unwrap();
    let speed = |name: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .args(["stream", "joints.csv", "--cell", "cell.toml", "--out", name])
            .env("XDG_STATE_HOME", folder.join("state"))
            .current_dir(folder)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", said(&output));
        let manifest = fs::read_to_string(folder.join(name).join("manifest.json")).unwrap();
        let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
        let speed = manifest["speed"].as_f64().unwrap();
        assert!((manifest["duration_s"].as_f64().unwrap() - 1.5 / speed).abs() < 1e-6);
        speed
    };
    assert_eq!(speed("first"), 0.5);
    assert_eq!(speed("second"), 1.0);
    table(
        folder,
        "joints.csv",
        &[("right.right_j0_rad", 0.9), ("right.right_j1_rad", 0.0)],
        40,
        1.5,
    );
    assert_eq!(speed("other"), 0.5);
}
