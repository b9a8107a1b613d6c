//! A real ROS 1 master and an actionlib action server, which the test installs and starts on
//! Debian as root.

use super::{
    PROMPTLY, STREAM, assert_failed, assert_followed, assert_moved_without_a_stop, interrupt,
    lines_of, log, rename_joint, rodlab, said, set_horizon, start_stream, two_joints,
    wait_for_event, wait_for_motion,
};
use crate::parts::{have, succeeds};
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Master and arm; stopped when dropped.
struct Robot {
    folder: TempDir,
    master: Child,
    arm: Child,
    /// Output of the arm.
    lines: Receiver<String>,
    port: u16,
}

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/ros1")
}

/// Whether ROS 1 is installed.
pub(super) fn is_installed() -> bool {
    let files = [
        "/usr/bin/rosmaster",
        "/usr/lib/genpy/genmsg_py.py",
        "/usr/share/std_msgs/msg/Header.msg",
        "/usr/share/trajectory_msgs/msg/JointTrajectory.msg",
    ];
    files.iter().all(|file| Path::new(file).exists())
        && Command::new("/usr/bin/python3")
            .args(["-c", "import actionlib, diagnostic_msgs, rospy"])
            .output()
            .is_ok_and(|output| output.status.success())
}

impl Robot {
    fn start() -> Option<Self> {
        Self::with_fault("none")
    }

    /// Starts a robot whose arm has a fault of `ros1_arm.py`.
    fn with_fault(fault: &str) -> Option<Self> {
        let install = || succeeds(Command::new(script()).arg("install"));
        let purpose = "to stream joints to a real ROS master";
        if !have("ROS 1", purpose, is_installed, install) {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let made = Command::new(script())
            .arg("messages")
            .arg(folder.path())
            .output()
            .unwrap();
        assert!(made.status.success(), "{}", said(&made));
        let port = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let start = |what: &str| {
            Command::new(script())
                .arg(what)
                .arg(folder.path())
                .arg(port.to_string())
                .env("ARM_FAULT", fault)
                .stdout(Stdio::piped())
                .stderr(Stdio::null())
                .spawn()
                .unwrap()
        };
        let master = start("master");
        let mut arm = start("arm");
        let lines = lines_of(&mut arm);
        let robot = Self {
            folder,
            master,
            arm,
            lines,
            port,
        };
        // The server reports that it waits for the master.
        while robot.says(60) != "ready" {}
        let driver = format!(
            "kind = \"ros1\"\nmaster = \"http://127.0.0.1:{port}\"\n\
             action = \"/robot/limb/right/follow_joint_trajectory\"\njoint_states = \"/robot/joint_states\""
        );
        two_joints(robot.folder.path(), &driver, 500, 5.0);
        Some(robot)
    }

    fn says(&self, seconds: u64) -> String {
        self.lines
            .recv_timeout(Duration::from_secs(seconds))
            .expect("a word of the arm")
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        for process in [&mut self.arm, &mut self.master] {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

#[test]
fn five_hundred_points_are_followed_by_an_actionlib_server() {
    let Some(robot) = Robot::start() else { return };
    let begin = Instant::now();
    let output = rodlab(robot.folder.path(), &STREAM);
    assert!(output.status.success(), "{}", said(&output));
    assert!(begin.elapsed() > Duration::from_secs(5));
    assert_followed(&robot.says(1), 500);
    assert!(log(robot.folder.path(), "state.csv").lines().count() > 500);
}

#[test]
fn a_monitor_of_ros_reads_the_diagnostics_of_a_motion() {
    let Some(robot) = Robot::start() else { return };
    let path = robot.folder.path().join("cell.toml");
    let cell = fs::read_to_string(&path).unwrap();
    let topic = format!("ros1://127.0.0.1:{}/diagnostics", robot.port);
    let streaming = format!("[streaming]\ndiagnostics = \"{topic}\"");
    fs::write(&path, cell.replace("[streaming]", &streaming)).unwrap();
    let output = rodlab(robot.folder.path(), &STREAM);
    assert!(output.status.success(), "{}", said(&output));
    let lines: Vec<String> = std::iter::from_fn(|| Some(robot.says(5)))
        .take_while(|line| !line.starts_with("rodlab: task, level 0: finished"))
        .collect();
    let moving = lines
        .iter()
        .filter(|line| line.starts_with("rodlab: task, level 0: ") && line.contains("of 5.0 s"));
    assert!(moving.count() > 2, "{lines:#?}");
    let joints = "rodlab: right, level 0: joints as reported (joints in rad or m: ";
    assert!(
        lines.iter().any(|line| line.starts_with(joints)),
        "{lines:#?}"
    );
}

/// `roslaunch` finds the package in the folder, and starts the program as a node.
#[test]
fn a_launch_file_starts_a_motion() {
    let Some(robot) = Robot::start() else { return };
    let folder = robot.folder.path();
    let program = Path::new(env!("CARGO_BIN_EXE_rodlab")).parent().unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let output = Command::new("/usr/bin/roslaunch")
        .args(["rodlab_cell", "stream.launch"])
        .arg(format!("cell:={}", folder.join("cell.toml").display()))
        .arg(format!(
            "trajectory:={}",
            folder.join("joints.csv").display()
        ))
        .arg(format!("options:=--out {}", folder.join("log").display()))
        .env("PATH", format!("{}:{path}", program.display()))
        .env(
            "ROS_PACKAGE_PATH",
            Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/ros"),
        )
        .env("ROS_MASTER_URI", format!("http://127.0.0.1:{}", robot.port))
        .envs([("ROS_IP", "127.0.0.1"), ("ROS_HOSTNAME", "127.0.0.1")])
        .env("ROS_HOME", folder.join("home"))
        .output()
        .unwrap();
    assert_followed(&robot.says(5), 500);
    assert!(
        log(folder, "events.csv").contains("finished"),
        "{}",
        said(&output)
    );
}

#[test]
fn an_interruption_preempts_the_goal_before_its_end() {
    let Some(robot) = Robot::start() else { return };
    let child = start_stream(robot.folder.path());
    wait_for_motion(robot.folder.path());
    let begin = Instant::now();
    interrupt(&child);
    assert_eq!(robot.says(5), "preempted");
    assert!(begin.elapsed() < PROMPTLY, "{:?}", begin.elapsed());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(log(robot.folder.path(), "events.csv").contains("right holds"));
}

/// The arm itself still moves, since it has the goal.
#[test]
fn an_arm_comes_to_rest_within_the_horizon_when_the_program_is_killed() {
    let Some(robot) = Robot::start() else { return };
    set_horizon(robot.folder.path(), "2 s");
    let mut child = start_stream(robot.folder.path());
    wait_for_event(robot.folder.path(), "\"started\"", 20);
    // The motion takes 5 s.
    std::thread::sleep(Duration::from_millis(1600));
    child.kill().unwrap();
    let begin = Instant::now();
    child.wait().unwrap();
    // Each piece replaces the one before.
    let mut said = robot.says(5);
    let mut replaced = 0;
    while said == "preempted" {
        replaced += 1;
        said = robot.says(5);
    }
    assert!(replaced > 1);
    assert!(
        begin.elapsed() < Duration::from_secs(3), // the whole motion would take another 3.4 s
        "{:?}",
        begin.elapsed()
    );
    let end: Vec<f64> = said
        .split(' ')
        .skip(3)
        .map(|word| word.parse().unwrap())
        .collect();
    assert!((0.1..0.9).contains(&end[0]), "{said}");
    assert!((end[1] + 0.5 * end[0]).abs() < 1e-6, "on the path: {said}");
}

#[test]
fn the_pieces_of_a_motion_join_without_a_stop() {
    let Some(robot) = Robot::start() else { return };
    set_horizon(robot.folder.path(), "2 s");
    let output = rodlab(robot.folder.path(), &STREAM);
    assert!(output.status.success(), "{}", said(&output));
    assert_moved_without_a_stop(robot.folder.path(), 5.0);
}

/// The server reports success while the arm stands still, or confirms a cancellation while the arm
/// keeps moving.
#[test]
fn false_reports_of_a_server_are_detected_from_the_joints() {
    let Some(robot) = Robot::with_fault("false-end") else {
        return;
    };
    let output = rodlab(robot.folder.path(), &STREAM);
    assert_failed(&output, "its controller has reported the end");
    drop(robot);
    let Some(robot) = Robot::with_fault("false-cancel") else {
        return;
    };
    let child = start_stream(robot.folder.path());
    wait_for_motion(robot.folder.path());
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    assert_failed(&output, "still moves: watch the arm");
}

/// Adds safety signals and a limit of the efforts to the cell.
fn set_safety(robot: &Robot) {
    let path = robot.folder.path().join("cell.toml");
    let cell = fs::read_to_string(&path).unwrap();
    let cell = cell.replace("velocity = 2.0\n", "velocity = 2.0\neffort = 40\n");
    let place = format!("ros1://127.0.0.1:{}", robot.port);
    let signals = format!(
        r#"
[[safety.signals]]
name = "button"
topic = "{place}/emergency_stop"
message = "std_msgs/Bool"
stop_at = true

[[safety.signals]]
name = "wrist"
topic = "{place}/wrist/wrench"
message = "geometry_msgs/WrenchStamped"
force = "20 N"

[[safety.signals]]
name = "heartbeat"
topic = "{place}/heartbeat"
message = "std_msgs/Empty"
silence = "500 ms"
"#
    );
    fs::write(path, cell + &signals).unwrap();
}

#[test]
fn safety_signals_and_efforts_forbid_and_end_motions() {
    let faults = [
        (
            "pressed",
            "`button` is true; allowed: false. Nothing was moved",
        ),
        ("emergency-stop", "`button` is true"),
        ("force", "`wrist` is 30.00 N"),
        (
            "effort",
            "right_j0 has an effort of 50.00 N m; allowed: 40 N m",
        ),
        ("silent", "`heartbeat` is silent for"),
    ];
    for (fault, expected) in faults {
        let Some(robot) = Robot::with_fault(fault) else {
            return;
        };
        set_safety(&robot);
        let output = rodlab(robot.folder.path(), &STREAM);
        assert_failed(&output, expected);
        let signals = log(robot.folder.path(), "signals.csv");
        assert!(
            signals.contains("\"wrist\",\"2.00 N, 0.000 N m\""),
            "{signals}"
        );
        if fault != "pressed" {
            assert_eq!(robot.says(5), "preempted");
            eprintln!("{fault}: stopped {}", robot.says(5));
        }
        let moved = log(robot.folder.path(), "state.csv").lines().count() > 100;
        assert_eq!(moved, fault != "pressed", "{fault}");
    }
}

/// The motion takes 5 s; the speed falls to 40 % after about one second.
#[test]
fn a_signal_sets_the_speed_of_a_motion() {
    let Some(robot) = Robot::with_fault("slow") else {
        return;
    };
    let path = robot.folder.path().join("cell.toml");
    let cell = fs::read_to_string(&path).unwrap();
    let place = format!("ros1://127.0.0.1:{}", robot.port);
    let signal = format!(
        r#"
[[safety.signals]]
name = "slider"
topic = "{place}/speed_scaling"
message = "std_msgs/Float64"
full_speed = 100
"#
    );
    fs::write(path, cell + &signal).unwrap();
    let output = rodlab(robot.folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("`streaming.horizon` is needed"),
        "{}",
        said(&output)
    );
    set_horizon(robot.folder.path(), "2 s");
    let output = rodlab(robot.folder.path(), &STREAM);
    assert!(output.status.success(), "{}", said(&output));
    let events = log(robot.folder.path(), "events.csv");
    assert!(events.contains("speed 40 % of the planned one"), "{events}");
    let time = |event: &str| -> f64 {
        let line = events.lines().find(|line| line.contains(event)).unwrap();
        line.split(',').next().unwrap().parse().unwrap()
    };
    let took = time("finished") - time("started");
    assert!(took > 7.0, "{took}: {events}");
    let signals = log(robot.folder.path(), "signals.csv");
    assert!(signals.contains("\"slider\",\"40\""), "{signals}");
}

/// A signal without messages forbids motions if it must not be silent.
#[test]
fn a_heartbeat_that_never_comes_forbids_motions() {
    let Some(robot) = Robot::start() else { return };
    set_safety(&robot);
    let path = robot.folder.path().join("cell.toml");
    let cell = fs::read_to_string(&path).unwrap();
    fs::write(&path, cell.replace("/heartbeat", "/pulse")).unwrap();
    let output = rodlab(robot.folder.path(), &STREAM);
    assert_failed(&output, "no message on /pulse in 3 s");
}

#[test]
fn unknown_joints_are_reported() {
    let Some(robot) = Robot::start() else { return };
    rename_joint(robot.folder.path());
    let output = rodlab(robot.folder.path(), &STREAM);
    assert_failed(&output, "unknown joints; compare");
}

#[test]
fn a_killed_server_and_a_killed_master_end_the_stream_before_the_motion_ends() {
    for master in [false, true] {
        let Some(mut robot) = Robot::start() else {
            return;
        };
        let child = start_stream(robot.folder.path());
        wait_for_motion(robot.folder.path());
        let begin = Instant::now();
        if master {
            robot.master.kill()
        } else {
            robot.arm.kill()
        }
        .unwrap();
        let fault = wait_for_event(robot.folder.path(), "right: ", 5);
        assert!(begin.elapsed() < PROMPTLY, "{:?}: {fault}", begin.elapsed());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        let expected = if master {
            "no longer answers"
        } else {
            "no report of its joints"
        };
        assert!(said(&output).contains(expected), "{}", said(&output));
        if master {
            // The arm still runs, and was commanded to hold.
            assert_eq!(robot.says(2), "preempted");
        }
    }
}

#[test]
fn a_rod_before_a_camera_of_ros_1_is_traced() {
    let Some(robot) = Robot::start() else { return };
    for topic in ["camera/image_raw", "camera/image_raw/compressed"] {
        let place = format!("ros1://127.0.0.1:{}/{topic}", robot.port);
        let output = rodlab(robot.folder.path(), &["trace", &place, "--json"]);
        assert!(output.status.success(), "{}", said(&output));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            (&found["width"], &found["height"]),
            (&320.into(), &240.into())
        );
        let length = found["strands"][0]["length_px"].as_f64().unwrap();
        assert!((length - 200.0).abs() < 10.0, "{topic}: {found}");
    }
    let place = format!("ros1://127.0.0.1:{}/camera/none", robot.port);
    let output = rodlab(robot.folder.path(), &["trace", &place]);
    assert_failed(&output, "is the camera started");
    let output = rodlab(robot.folder.path(), &["trace", "ros1://none"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
}

#[test]
fn without_a_master_nothing_is_moved_and_the_message_says_what_to_start() {
    let folder = tempfile::tempdir().unwrap();
    let driver = "kind = \"ros1\"\nmaster = \"http://127.0.0.1:1\"\naction = \"/arm\"\njoint_states = \"/joint_states\"";
    two_joints(folder.path(), driver, 500, 1.0);
    let output = rodlab(folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("is it started"), "{}", said(&output));
}
