//! Action servers of ROS 2 with Cyclone DDS (from pip) and Fast DDS (from Debian), which are built
//! and run on this machine only.

use super::{
    PROMPTLY, STREAM, assert_failed, assert_followed, assert_moved_without_a_stop, interrupt,
    lines_of, log, rename_joint, rodlab, said, set_horizon, start_stream, two_joints,
    wait_for_event, wait_for_motion,
};
use crate::parts::{have, python_with, succeeds};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A running arm; stopped when dropped.
struct Robot {
    folder: TempDir,
    arm: Child,
    /// Output of the arm.
    lines: Receiver<String>,
    driver: String,
}

/// A short rod, which the gantry lays along a line of 8 cm.
const ROD: &str =
    "[deployment.rod]\ngravito_bending_length = \"2 cm\"\nradius = \"2 mm\"\nlength = \"14 cm\"\n";

/// The picture of the gantry's camera when this rod lies along a line whose middle is the middle
/// of the table. The scale is 2200/1.6 pixels per metre; x points to the right.
fn lying_rod() -> image::RgbImage {
    let scale = 2200.0 / 1.6;
    image::RgbImage::from_fn(1280, 960, |u, v| {
        let [x, y] =
            [(u, 639.5), (v, 479.5)].map(|(pixel, centre)| (f64::from(pixel) - centre) / scale);
        let beyond = [y.abs() - 0.002, -0.04 - x, x - 0.1];
        let away = beyond.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let share = (0.5 - scale * away).clamp(0.0, 1.0);
        let mixed = |rod: f64| (24.0 + share * (rod - 24.0)) as u8;
        image::Rgb([mixed(230.0), mixed(90.0), mixed(140.0)])
    })
}

/// The middlewaresas named in cell files.
const MIDDLEWARES: [&str; 2] = ["cyclone-dds", "fast-dds"];
const PURPOSE: &str = "to stream joints to an action server of ROS 2";

fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The command that starts an arm.
fn arm(middleware: &str) -> Option<Command> {
    if middleware == "cyclone-dds" {
        let mut command = Command::new(python_with("cyclonedds", "cyclonedds==11.0.1", PURPOSE)?);
        command.arg(source("tests/robots/cyclone_dds_arm.py"));
        return Some(command);
    }
    static BUILT: OnceLock<Option<PathBuf>> = OnceLock::new();
    let built = BUILT.get_or_init(|| {
        let is_there = || {
            Path::new("/usr/include/fastdds").exists()
                && succeeds(Command::new("g++").arg("--version"))
        };
        let install = || succeeds(&mut Command::new(source("scripts/install-fast-dds")));
        if !have("Fast DDS", PURPOSE, is_there, install) {
            return None;
        }
        let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fast_dds_arm");
        let output = Command::new("g++")
            .args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-o"])
            .args([&program, &source("tests/robots/fast_dds_arm.cpp")])
            .arg("-lfastrtps")
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", said(&output));
        Some(program)
    });
    built.as_ref().map(Command::new)
}

/// A domain and a name for an arm that no other test uses. Other processes may use the domain, but
/// not the name.
fn address() -> (u32, String) {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let (process, next) = (std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
    ((process + next) % 100 + 1, format!("arm_{process}_{next}"))
}

fn driver(domain: u32, name: &str, middleware: &str) -> String {
    format!(
        "kind = \"ros2\"\ndomain = {domain}\nmiddleware = \"{middleware}\"\ninterface = \"127.0.0.1\"\n\
         action = \"/{name}/follow_joint_trajectory\"\njoint_states = \"/{name}/joint_states\""
    )
}

impl Robot {
    fn start(middleware: &str) -> Option<Self> {
        Self::with_fault(middleware, "none")
    }

    /// Starts a robot whose arm has a fault of `cyclone_dds_arm.py`.
    fn with_fault(middleware: &str, fault: &str) -> Option<Self> {
        let (domain, name) = address();
        let mut arm = arm(middleware)?
            .args([&domain.to_string(), &name])
            .env("ARM_FAULT", fault)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = lines_of(&mut arm);
        let robot = Self {
            folder: tempfile::tempdir().unwrap(),
            arm,
            lines,
            driver: driver(domain, &name, middleware),
        };
        assert_eq!(robot.says(60), "ready");
        robot.trajectory(500, 5.0);
        Some(robot)
    }

    /// The gantry with a gripper, and a camera that shows a rod of [`ROD`] along a line. The cell
    /// file is that of the repository with ROS 2 drivers.
    fn with_gripper_and_camera() -> Option<Self> {
        let python = python_with("cyclonedds", "cyclonedds==11.0.1", PURPOSE)?;
        let (domain, name) = address();
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("seen.png");
        lying_rod().save(&picture).unwrap();
        fs::write(folder.path().join("rod.toml"), ROD).unwrap();
        let driver = driver(domain, &name, "cyclone-dds");
        let gantry = fs::read_to_string(source("scenarios/cells/gantry.toml")).unwrap();
        let bridged = "kind = \"rosbridge\"\naddress = \"127.0.0.1:9090\"\n\
                       action = \"/gantry/follow_joint_trajectory\"\njoint_states = \"/joint_states\"";
        assert!(gantry.contains(bridged));
        let camera = format!("ros2://{domain}@127.0.0.1/{name}/camera/image_raw/compressed");
        let cell = gantry
            .replace(bridged, &driver)
            .replace("rosbridge://127.0.0.1:9090/camera/image_raw", &camera)
            .replace("\"/gantry/gripper\"", &format!("\"/{name}/gripper\""))
            .replace("[streaming]", "[streaming]\nwatchdog = \"2 s\"");
        fs::write(folder.path().join("cell.toml"), cell).unwrap();
        let mut arm = Command::new(python)
            .arg(source("tests/robots/cyclone_dds_cell.py"))
            .args([&domain.to_string(), &name])
            .arg(&picture)
            .arg("0.002")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = lines_of(&mut arm);
        let robot = Self {
            folder,
            arm,
            lines,
            driver,
        };
        assert_eq!(robot.says(60), "ready");
        Some(robot)
    }

    fn trajectory(&self, points: usize, seconds: f64) {
        two_joints(self.folder.path(), &self.driver, points, seconds);
    }

    fn says(&self, seconds: u64) -> String {
        self.lines
            .recv_timeout(Duration::from_secs(seconds))
            .expect("a word of the arm")
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        let _ = self.arm.kill();
        let _ = self.arm.wait();
    }
}

/// Runs a check with an arm for each middleware, in parallel.
fn with_each(check: impl Fn(Robot) + Sync) {
    std::thread::scope(|scope| {
        for middleware in MIDDLEWARES {
            let check = &check;
            scope.spawn(move || Robot::start(middleware).map(check));
        }
    });
}

#[test]
fn five_hundred_points_are_followed_to_the_end() {
    with_each(|robot| {
        let begin = Instant::now();
        let output = rodlab(robot.folder.path(), &STREAM);
        assert!(output.status.success(), "{}", said(&output));
        assert!(begin.elapsed() > Duration::from_secs(5));
        assert_followed(&robot.says(1), 500);
        assert!(log(robot.folder.path(), "state.csv").lines().count() > 500);
    });
}

#[test]
fn the_pieces_of_a_motion_join_without_a_stop() {
    with_each(|robot| {
        robot.trajectory(400, 4.0);
        set_horizon(robot.folder.path(), "2 s");
        let output = rodlab(robot.folder.path(), &STREAM);
        assert!(output.status.success(), "{}", said(&output));
        assert!(robot.says(1).starts_with("followed"));
        assert_moved_without_a_stop(robot.folder.path(), 4.0);
    });
}

/// The goal is larger than a datagram. A request with a leading identifier must not be damaged
/// where it is divided.
#[test]
fn a_goal_of_many_datagrams_arrives_whole() {
    with_each(|robot| {
        robot.trajectory(3000, 3.0);
        let output = rodlab(robot.folder.path(), &STREAM);
        assert!(output.status.success(), "{}", said(&output));
        assert_followed(&robot.says(1), 3000);
    });
}

#[test]
fn an_interruption_cancels_the_goal_before_its_end() {
    for middleware in MIDDLEWARES {
        let Some(robot) = Robot::start(middleware) else {
            continue;
        };
        let child = start_stream(robot.folder.path());
        wait_for_motion(robot.folder.path());
        let begin = Instant::now();
        interrupt(&child);
        assert_eq!(robot.says(5), "cancelled");
        assert!(begin.elapsed() < PROMPTLY, "{:?}", begin.elapsed());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        assert!(log(robot.folder.path(), "events.csv").contains("right holds"));
    }
}

/// The server reports success while the arm stands still, confirms a cancellation while the arm
/// keeps moving, or sends reports endlessly.
#[test]
fn faulty_servers_are_detected_from_the_joints() {
    for (fault, words) in [
        ("false-end", "its controller has reported the end"),
        ("false-cancel", "still moves: watch the arm"),
        ("flood", "joints do not move"),
    ] {
        let Some(robot) = Robot::with_fault("cyclone-dds", fault) else {
            return;
        };
        let child = start_stream(robot.folder.path());
        if fault == "false-cancel" {
            wait_for_motion(robot.folder.path());
            interrupt(&child);
        }
        let output = child.wait_with_output().unwrap();
        assert_failed(&output, words);
    }
}

#[test]
fn a_rejected_goal_is_reported_with_what_to_compare() {
    for middleware in MIDDLEWARES {
        let Some(robot) = Robot::start(middleware) else {
            continue;
        };
        rename_joint(robot.folder.path());
        let output = rodlab(robot.folder.path(), &STREAM);
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        let said = said(&output);
        assert!(
            said.contains("rejected the goal") && said.contains("compare the names of the joints"),
            "{said}"
        );
    }
}

#[test]
fn a_killed_server_ends_the_stream_before_the_motion_ends() {
    for middleware in MIDDLEWARES {
        let Some(mut robot) = Robot::start(middleware) else {
            continue;
        };
        let child = start_stream(robot.folder.path());
        wait_for_motion(robot.folder.path());
        let begin = Instant::now();
        robot.arm.kill().unwrap();
        let fault = wait_for_event(robot.folder.path(), "right: ", 5);
        assert!(begin.elapsed() < PROMPTLY, "{:?}: {fault}", begin.elapsed());
        let output = child.wait_with_output().unwrap();
        assert_failed(&output, "no report of its joints");
    }
}

#[test]
fn the_message_suggests_the_other_middleware() {
    for middleware in MIDDLEWARES {
        let Some(robot) = Robot::start(middleware) else {
            continue;
        };
        let path = robot.folder.path().join("cell.toml");
        let text = fs::read_to_string(&path).unwrap();
        let other = if middleware == MIDDLEWARES[0] {
            MIDDLEWARES[1]
        } else {
            MIDDLEWARES[0]
        };
        fs::write(path, text.replace(middleware, other)).unwrap();
        let output = rodlab(robot.folder.path(), &STREAM);
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(
            said(&output).contains(&format!("`middleware = \"{other}\"`")),
            "{}",
            said(&output)
        );
    }
}

#[test]
fn without_a_server_nothing_is_moved_and_the_message_says_what_to_start() {
    let folder = tempfile::tempdir().unwrap();
    let (domain, name) = address();
    two_joints(folder.path(), &driver(domain, &name, "fast-dds"), 500, 1.0);
    let output = rodlab(folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("ROS_DOMAIN_ID"), "{}", said(&output));
}

#[test]
fn a_rod_is_laid_gripped_seen_and_scored_over_cyclone_dds() {
    let Some(robot) = Robot::with_gripper_and_camera() else {
        return;
    };
    let folder = robot.folder.path();
    let arguments = "deploy --pattern line:0.08 --rod rod.toml --cell cell.toml --yes --out laid --hand-speed 0.1 --approach-speed 0.4";
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .env("XDG_STATE_HOME", folder.join("state"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let record: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "finished", "{record}");
    let lengths = &record["seen_length"];
    assert!(
        (lengths["seen_m"].as_f64().unwrap() - 0.14).abs() < 2e-3,
        "{record}"
    );
    let events: Vec<String> = robot.lines.try_iter().collect();
    let kinds: Vec<&str> = events
        .iter()
        .map(|line| line.split(' ').next().unwrap())
        .collect();
    // Goals: move to the rod, close, lay along the pattern, open, move home.
    assert_eq!(
        kinds,
        ["followed", "gripper", "followed", "gripper", "followed"],
        "{events:?}"
    );
    assert_eq!(
        [&events[1], &events[3]],
        ["gripper stalled 0.0 10.0", "gripper moved 0.04 10.0"]
    );
}
