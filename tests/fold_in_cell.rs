//! `rodlab fold` in the virtual cell: with drivers and camera, against the real server in its own
//! process.

use crate::virtual_cell::{Served, gantry, said, serve_cell};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A sheet with few edges.
const PAPER: &str = "[folding.paper]\nlength = \"297 mm\"\nwidth = \"210 mm\"\ngravito_bending_length = \"4.8 cm\"\nfriction = 0.12\nedges = 80\n";

/// The sheet with still fewer edges, for folds whose accuracy is not checked.
fn coarse() -> String {
    PAPER.replace("edges = 80", "edges = 40")
}

fn serve(arguments: &[&str]) -> Served {
    serve_sheet(PAPER, arguments)
}

fn serve_sheet(sheet: &str, arguments: &[&str]) -> Served {
    let folder = tempfile::tempdir().unwrap();
    let paper = folder.path().join("paper.toml");
    fs::write(&paper, sheet).unwrap();
    let paper = paper.to_str().unwrap();
    let served = serve_cell(&[&["--paper", paper], arguments].concat(), "");
    fs::copy(paper, served.folder.path().join("paper.toml")).unwrap();
    served
}

/// Folds the sheet, with further arguments; results are in `folded`.
fn fold(served: &Served, arguments: &[&str]) -> Output {
    let usual = ["fold", "--paper", "paper.toml", "--cell", "client.toml"];
    served.run(&[&usual, arguments, &["--out", "folded"]].concat())
}

fn manifest(served: &Served) -> Value {
    serde_json::from_str(&served.read("folded/manifest.json")).unwrap()
}

#[test]
fn a_sheet_is_folded_in_half_seen_and_scored() {
    let served = serve(&["--rate", "50", "--place", "-0.1,0.03,10"]);
    let output = fold(&served, &[]);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "finished");
    let place = |index: usize| record["sheet_place"][index].as_f64().unwrap();
    assert!(
        (place(0) + 0.1).abs() < 5e-4 && (place(1) - 0.03).abs() < 5e-4,
        "{record}"
    );
    assert!((place(2) - 10.0).abs() < 0.2, "{record}");
    let score = |name: &str| record["score"][name].as_f64().unwrap();
    // The sheet slides by 0.07 mm in plain simulation; the camera resolves 0.3 mm. While the client
    // looks and plans, the sheet must not creep, however long it takes.
    assert!(score("largest_sliding_m") < 4e-4, "{record}");
    // At the end the edge covers the free end, so that the camera cannot measure the fold length.
    assert!(score("last_seen_sliding_m").abs() < 1e-3, "{record}");
    assert!(record["score"]["fold_length_error_m"].is_null(), "{record}");
    let report = served.read("folded/report.md");
    assert!(report.contains("| the fold | not seen |"), "{report}");
    for name in [
        "joints.csv",
        "cell.html",
        "looks.csv",
        "report.md",
        "approach/state.csv",
        "reaching/commanded.csv",
        "folding_1/trajectory.csv",
        "folding_5/events.csv",
        "rising/state.csv",
    ] {
        assert!(!served.read(&format!("folded/{name}")).is_empty(), "{name}");
    }
    for name in ["look_0.png", "overlay_0.png", "look_5.png", "left.png"] {
        let picture = served.folder.path().join("folded").join(name);
        assert!(picture.is_file(), "{name}");
    }
}

#[test]
fn without_a_cell_file_the_sheet_is_folded_in_a_cell_of_the_process() {
    let task = ["fold", "--paper", "paper.toml", "--place", "-0.1,0.03,0,10"];
    let task = [&task[..], &["--out", "folded"]].concat();
    let (record, folder) = crate::virtual_cell::alone("paper.toml", &coarse(), &task);
    assert_eq!(record["status"], "finished");
    let place = |index: usize| record["sheet_place"][index].as_f64().unwrap();
    assert!(
        (place(0) + 0.1).abs() < 5e-4 && (place(2) - 10.0).abs() < 0.2,
        "{record}"
    );
    assert!(folder.path().join("folded/left.png").is_file());
}

#[test]
fn sliding_of_a_sheet_is_measured_and_its_fold_is_corrected() {
    let error = |feedback: &[&str]| {
        let served = serve(&["--rate", "50"]);
        let output = fold(&served, &[&["--algorithm", "optimal"], feedback].concat());
        assert!(output.status.success(), "{}", said(&output));
        let record: Value = serde_json::from_slice(&output.stdout).unwrap();
        let score = |name: &str| record["score"][name].as_f64().unwrap();
        assert!(score("largest_sliding_m") > 5e-3, "{record}");
        // If the edge covers the free end, the last measurement is used.
        (score("edge_m") - record["target_m"].as_f64().unwrap() - score("last_seen_sliding_m"))
            .abs()
    };
    let open = error(&[]);
    let closed = error(&["--feedback", "5"]);
    assert!(open > 5e-3 && closed < 1.5e-3, "{open} {closed}");
}

/// A fold in a cell with a fault must end with exit code 1, a complete log and an arm at rest. The
/// next task must require an inspection.
fn ends_early(fault: &str, words: &str) {
    // The arm moves to the sheet for 4 s, and then folds for 24 s.
    let fault = format!("{fault}@12s");
    let served = serve_sheet(&coarse(), &["--rate", "50", "--fault", &fault]);
    let speeds = ["--approach-speed", "1", "--hand-speed", "0.03"];
    let output = fold(&served, &[&speeds[..], &["--feedback", "4"]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(served.stands_soon());
    let manifest = manifest(&served);
    assert_eq!(manifest["status"], "failed");
    let error = manifest["error"].as_str().unwrap();
    assert!(error.starts_with("folding: "), "{error}");
    assert!(error.contains(words), "{error}");
    assert!(said(&output).contains(words), "{}", said(&output));
    assert!(served.read("folded/report.md").contains("failed"));
    let events = served.read("folded/folding_1/events.csv");
    assert!(events.contains("started"), "{events}");
    let again = ["fold", "--paper", "paper.toml", "--cell", "client.toml"];
    served.asks_for_a_look_before(&[&again[..], &["--out", "again"]].concat());
}

#[test]
fn a_sheet_that_slips_out_of_the_gripper_ends_a_fold() {
    ends_early("slip-grasp", "slipped out of the gripper");
}

#[test]
fn a_camera_that_is_lost_ends_a_fold() {
    ends_early("lose-camera", "is the camera started");
}

#[test]
fn a_link_that_drops_ends_a_fold() {
    ends_early("drop-link", "connection");
}

#[test]
fn a_joint_that_freezes_ends_a_fold() {
    // The frozen joint is detected by the controller at the end of the motion, or earlier by the
    // distance from its path.
    ends_early("freeze-joint", "pitch is");
}

fn refused(cell: &str, arguments: &[&str]) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cell.toml"), cell).unwrap();
    fs::write(folder.path().join("paper.toml"), PAPER).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    command.env("XDG_STATE_HOME", folder.path().join("state"));
    command.args([
        "fold",
        "--paper",
        "paper.toml",
        "--cell",
        "cell.toml",
        "--yes",
        "--out",
        "folded",
    ]);
    let output = command
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let is_untouched = !Path::new(&folder.path().join("folded")).exists();
    assert!(is_untouched, "{}", said(&output));
    (output.status.code().unwrap(), said(&output))
}

#[test]
fn impossible_folds_are_rejected_before_anything_moves() {
    let cell = gantry();
    let (code, words) = refused(&cell, &["--place", "0.5,0,0"]);
    assert_eq!(code, 2, "{words}");
    assert!(words.contains("does not lie on the table"), "{words}");
    let without = |from: &str, to: &str| {
        let begin = cell.find(from).unwrap();
        let end = begin + cell[begin..].find(to).unwrap();
        format!("{}{}", &cell[..begin], &cell[end..])
    };
    let (code, words) = refused(&without("[camera]", "[streaming]"), &[]);
    assert_eq!(code, 2, "{words}");
    assert!(
        words.contains("needs a [camera]") || words.contains("a [camera] with a `source`"),
        "{words}"
    );
    let (code, words) = refused(&cell.replace("[arms.gripper]", "[arms.nothing]"), &[]);
    assert_eq!(code, 2, "{words}");
    // A table that is larger than the reach of the arm.
    let large = cell.replace("size = [\"1.2 m\"", "size = [\"3 m\"");
    let (code, words) = refused(&large, &["--place", "0.9,0,0"]);
    assert_eq!(code, 3, "{words}");
    assert!(words.contains("cannot be followed"), "{words}");
    let (code, words) = refused(&cell, &["--algorithm", "circle", "--feedback", "5"]);
    assert_eq!(code, 2, "{words}");
    let (code, words) = refused(&cell, &["--crease", "12 cm"]);
    assert_eq!(code, 2, "{words}");
    assert!(words.contains("a fold this tight"), "{words}");
}

#[test]
fn a_dry_run_shows_the_fold_and_moves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cell.toml"), gantry()).unwrap();
    fs::write(folder.path().join("paper.toml"), PAPER).unwrap();
    let arguments = [
        "fold",
        "--paper",
        "paper.toml",
        "--cell",
        "cell.toml",
        "--dry-run",
        "--out",
        "shown",
    ];
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    let output = command
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "planned");
    let shown = folder.path().join("shown");
    for name in ["joints.csv", "cell.html", "report.md", "manifest.json"] {
        assert!(shown.join(name).is_file(), "{name}");
    }
    assert!(!shown.join("approach").exists());
}
