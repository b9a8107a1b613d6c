//! Helical rods explored by an arm and a chuck: the commands for a real cell, run against the
//! virtual one.

use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A server that ends with the test. `client.toml` in its folder is the cell file for clients.
struct Served {
    child: Child,
    folder: tempfile::TempDir,
}

impl Drop for Served {
    fn drop(&mut self) {
        // The server may already have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn scenarios(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenarios")
        .join(name)
}

fn serve(arguments: &[&str]) -> Served {
    let folder = tempfile::tempdir().unwrap();
    let cell = fs::read_to_string(scenarios("cells/helix_gantry.toml")).unwrap();
    let wire = scenarios("rods/nitinol_wire.toml");
    fs::copy(wire, folder.path().join("wire.toml")).unwrap();
    fs::write(folder.path().join("cell.toml"), &cell).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["cell", "serve", "--cell", "cell.toml", "--rod", "wire.toml"])
        .args(["--listen", "127.0.0.1:0", "--rate", "50"])
        .args(arguments)
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut said = BufReader::new(child.stdout.take().unwrap());
    said.read_line(&mut line).unwrap();
    let address = line
        .trim()
        .strip_prefix("listening on ")
        .expect("an address");
    // On a busy machine the server may be silent for longer than an arm.
    let client = cell
        .replace("127.0.0.1:9090", address)
        .replace("[streaming]", "[streaming]\nwatchdog = \"2 s\"");
    fs::write(folder.path().join("client.toml"), client).unwrap();
    Served { child, folder }
}

impl Served {
    fn explore(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command
            .args([
                "explore",
                "--rod",
                "wire.toml",
                "--cell",
                "client.toml",
                "--yes",
                "--out",
                "out",
            ])
            .args(arguments)
            .current_dir(self.folder.path());
        command
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.folder.path().join(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join(name)).unwrap_or_default()
    }
}

fn said(output: &Output) -> String {
    let [stdout, stderr] =
        [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
    format!("{stdout}{stderr}")
}

/// The numbers of a column of a table.
fn column(table: &str, name: &str) -> Vec<f64> {
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let index = header
        .iter()
        .position(|known| *known == name)
        .expect("the column");
    let cell = |line: &str| line.split(',').nth(index).unwrap().parse().unwrap();
    lines.map(cell).collect()
}

/// Two directions that lose stability early.
const TWO: &str = "kappa,tau,omega\n1,1,-1\n0.3,0.6,-1\n";

#[test]
fn a_killed_exploration_resumes_at_its_direction_and_agrees_with_theory() {
    let served = serve(&[]);
    served.write("two.csv", TWO);
    let arguments = ["--directions", "two.csv"];
    let mut first = served
        .explore(&arguments)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begin = Instant::now();
    while served.read("out/exploration.csv").lines().count() < 2 {
        assert!(
            begin.elapsed() < Duration::from_secs(240),
            "no direction was explored"
        );
        assert!(first.try_wait().unwrap().is_none(), "it ended early");
        std::thread::sleep(Duration::from_millis(20));
    }
    // Kill the process during the second ray, as kill -9 does.
    std::thread::sleep(Duration::from_millis(700));
    first.kill().unwrap();
    first.wait().unwrap();
    let before = served.read("out/exploration.csv");
    assert_eq!(before.lines().count(), 2, "{before}");
    let output = served.explore(&arguments).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let after = served.read("out/exploration.csv");
    assert!(
        after.starts_with(&before) && after.lines().count() == 3,
        "{before}{after}"
    );
    for difference in column(&after, "relative_difference") {
        assert!(difference.abs() < 0.03, "{after}");
    }
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (summary["directions"].as_u64(), summary["buckled"].as_u64()),
        (Some(2), Some(2))
    );
    let manifest: Value = serde_json::from_str(&served.read("out/manifest.json")).unwrap();
    assert_eq!(manifest["status"], "finished");
    for name in [
        "report.md",
        "cell.html",
        "found.svg",
        "directions/0001/looks.csv",
        "motion/state.csv",
    ] {
        assert!(!served.read(&format!("out/{name}")).is_empty(), "{name}");
    }
    assert!(
        served
            .folder
            .path()
            .join("out/directions/0002/lost.png")
            .is_file()
    );
    // A finished exploration is not repeated, and another exploration needs another directory.
    let again = served.explore(&arguments).output().unwrap();
    assert!(again.status.success(), "{}", said(&again));
    assert_eq!(served.read("out/exploration.csv"), after);
    let other = served.explore(&["--section", "3"]).output().unwrap();
    assert_eq!(other.status.code(), Some(2), "{}", said(&other));
    assert!(
        said(&other).contains("another exploration"),
        "{}",
        said(&other)
    );
}

#[test]
fn a_rod_that_slips_or_a_lost_camera_ends_an_exploration_with_exit_code_1() {
    for (fault, words) in [
        ("slip-grasp@20s", "straight"),
        ("lose-camera@5s", "no picture"),
    ] {
        let served = serve(&["--fault", fault]);
        served.write("two.csv", TWO);
        let output = served
            .explore(&["--directions", "two.csv"])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        let manifest: Value = serde_json::from_str(&served.read("out/manifest.json")).unwrap();
        assert_eq!(manifest["status"], "failed", "{fault}");
        assert!(served.read("out/report.md").contains(words), "{fault}");
    }
}

#[test]
fn impossible_explorations_are_rejected_before_anything_moves() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .arg("explore")
            .arg("--rod")
            .arg(scenarios("rods/nitinol_wire.toml"))
            .arg("--cell")
            .arg(scenarios("cells/helix_gantry.toml"))
            .args(["--out", "out", "--yes"])
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let write = |text: &str| fs::write(folder.path().join("list.csv"), text).unwrap();
    for (text, words) in [
        ("kappa,tau\n1,0\n", "list.csv:1: no column `omega`"),
        (
            "kappa,tau,omega\n1,0,0\n0,0,1\n",
            "list.csv:3: `kappa` is 0 ",
        ),
        ("kappa,tau,omega\n0,0,0\n", "list.csv:2"),
    ] {
        write(text);
        let output = run(&["--directions", "list.csv"]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
        assert!(!folder.path().join("out").exists());
    }
    let gantry = scenarios("cells/gantry.toml");
    let output = run(&["--section", "2", "--step", "0.1", "--precision", "0.2"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("at most --step"),
        "{}",
        said(&output)
    );
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .arg("explore")
        .arg("--rod")
        .arg(scenarios("rods/nitinol_wire.toml"))
        .arg("--cell")
        .arg(gantry)
        .args(["--section", "2", "--yes"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("has no [chuck]"),
        "{}",
        said(&output)
    );
    // Rays are planned up to the reach of the arm; nothing moves, since no arm exists.
    write("kappa,tau,omega\n1,0,0\n0.2,0.3,-1\n");
    let output = run(&["--directions", "list.csv", "--dry-run"]);
    assert!(output.status.success(), "{}", said(&output));
    let plan = fs::read_to_string(folder.path().join("out/plan.csv")).unwrap();
    let (reach, theory) = (column(&plan, "reach"), column(&plan, "theory"));
    // Before a ring closes, its ends approach each other, and with them chuck and hand.
    assert!(reach[0] < theory[0] && plan.contains("too near"), "{plan}");
    assert!(reach[1] > theory[1], "{plan}");
}

#[test]
fn without_a_cell_file_a_rod_is_explored_in_a_cell_of_the_process() {
    let list = "kappa,tau,omega\n1,1,-1\n";
    // Without --rod it is the preset.
    let task = ["explore", "--directions", "list.csv"];
    let more = ["--farthest", "1", "--no-pictures", "--out", "explored"];
    let task = [&task[..], &more].concat();
    let (summary, folder) = crate::virtual_cell::alone("list.csv", list, &task);
    assert_eq!(summary["directions"], 1, "{summary}");
    assert!(folder.path().join("explored/report.html").is_file());
}
