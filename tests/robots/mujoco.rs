//! A rod laid in a cell that shares no code with rodlab: MuJoCo with a real ROS 1 master. The test
//! installs and starts both on Debian as root.

use super::{interrupt, lines_of, rodlab, ros1, said};
use crate::parts::{have, in_build, succeeds};
use serde_json::Value;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::Receiver;
use std::time::Duration;
use tempfile::TempDir;

/// A cable that can be simulated fast enough, and the rod that `deploy` assumes: L_gb = (E r²/(8 ρ
/// g))^(1/3).
const CABLE: [&str; 4] = ["--length", "0.5", "--nodes", "26"];
const ROD: &str =
    "[deployment.rod]\ngravito_bending_length = \"4 cm\"\nradius = \"3 mm\"\nlength = \"0.5 m\"\n";

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Folder in which MuJoCo is installed for the tests.
fn packages() -> PathBuf {
    in_build("mujoco")
}

fn is_installed() -> bool {
    ros1::is_installed()
        && succeeds(
            Command::new("/usr/bin/python3")
                .args(["-c", "import mujoco; mujoco.GLContext(8, 8).free()"])
                .env("PYTHONPATH", packages())
                .env("MUJOCO_GL", "osmesa"),
        )
}

/// The cell; stopped when dropped, together with its master.
struct Cell {
    folder: TempDir,
    process: Child,
    /// Output of the cell.
    lines: Receiver<String>,
}

impl Cell {
    fn start() -> Option<Self> {
        let install = || {
            let script = repository().join("scripts/install-mujoco");
            succeeds(Command::new(script).arg(packages()))
        };
        let purpose = "to lay a rod in a cell that shares no code with rodlab";
        if !have("MuJoCo", purpose, is_installed, install) {
            return None;
        }
        let free = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = free.local_addr().unwrap().port().to_string();
        drop(free);
        let folder = tempfile::tempdir().unwrap();
        let mut process = Command::new(repository().join("scripts/mujoco-cell"))
            .arg(repository().join("scripts/mujoco_cell/sawyer.csv"))
            .args(["--port", &port, "--rate", "4", "--packages"])
            .arg(packages())
            .args(CABLE)
            // The files of the killed process are removed with the folder.
            .env("TMPDIR", folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let lines = lines_of(&mut process);
        let cell = repository().join("scenarios/cells/mujoco.toml");
        let cell = fs::read_to_string(cell).unwrap().replace("11311", &port);
        fs::write(folder.path().join("cell.toml"), cell).unwrap();
        fs::write(folder.path().join("rod.toml"), ROD).unwrap();
        let cell = Self {
            folder,
            process,
            lines,
        };
        assert!(cell.says().starts_with("ready"));
        Some(cell)
    }

    fn says(&self) -> String {
        self.lines
            .recv_timeout(Duration::from_secs(60))
            .expect("a word of the cell")
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join("laid").join(name)).unwrap_or_default()
    }
}

impl Drop for Cell {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The last position of each joint in a log of positions.
fn last_positions(log: &str) -> Vec<(String, f64)> {
    let rows: Vec<Vec<&str>> = log
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let joints = (0..7).map(|joint| format!("right_j{joint}"));
    let last = |joint: String| {
        let row = rows.iter().rev().find(|row| row[2] == joint);
        let position = row.expect("a joint of the log")[3].parse().unwrap();
        (joint, position)
    };
    joints.map(last).collect()
}

#[test]
fn a_rod_is_laid_seen_and_scored_in_mujoco() {
    let Some(cell) = Cell::start() else { return };
    let output = rodlab(
        cell.folder.path(),
        &[
            "deploy",
            "--pattern",
            "line:0.35",
            "--rod",
            "rod.toml",
            "--cell",
            "cell.toml",
            "--yes",
            "--speed",
            "0.04",
            "--hand-speed",
            "0.06",
            "--approach-speed",
            "1",
            "--out",
            "laid",
        ],
    );
    assert!(output.status.success(), "{}", said(&output));
    let mut words = Vec::new();
    while words.last().is_none_or(|last| last != "right: lets go") {
        words.push(cell.says());
    }
    let order = ["is there", "holds the cable", "is there", "lets go"];
    let done = words.iter().filter(|line| !line.contains("follows"));
    let done: Vec<&str> = done
        .filter_map(|line| line.strip_prefix("right: "))
        .collect();
    assert_eq!(done, order);
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "finished");
    // The arm has reached its commanded position.
    let [told, came] =
        ["commanded", "state"].map(|log| last_positions(&cell.read(&format!("laying/{log}.csv"))));
    for ((joint, told), (_, came)) in told.iter().zip(&came) {
        assert!((told - came).abs() < 0.02, "{joint}: {told} {came}");
    }
    assert_ne!(told, last_positions(&cell.read("approach/state.csv")));
    // The camera has detected the cable, and the cable lies along the line. A pixel is 0.9 mm, and
    // the falling rest of the cable pulls at the laid part.
    let picture = cell.folder.path().join("laid/picture.png");
    assert_eq!(image::image_dimensions(picture).unwrap(), (1280, 960));
    let error = |name: &str| record["score"][name]["mean_m"].as_f64().unwrap();
    assert!(error("by_arc_length") < 8e-3, "{record}");
    assert!(error("by_nearest_point") < 1e-3, "{record}");
    for name in ["rod.csv", "score.svg", "retreat/state.csv", "report.md"] {
        assert!(!cell.read(name).is_empty(), "{name}");
    }
}

#[test]
fn an_interruption_stops_the_arm_in_mujoco() {
    let Some(cell) = Cell::start() else { return };
    let mut child = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["deploy", "--pattern", "line:0.35", "--rod", "rod.toml"])
        .args(["--cell", "cell.toml", "--yes", "--out", "laid"])
        .env("XDG_STATE_HOME", cell.folder.path())
        .current_dir(cell.folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !cell.says().contains("follows") {}
    interrupt(&child);
    while cell.says() != "right: stopped" {}
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(cell.read("report.md").contains("interrupted"));
}
