//! `rodlab tie` in the virtual cell: two arms with their drivers and a camera, against the real
//! server in its own process.

use crate::virtual_cell::{Served, gantry, said, serve_file};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn scenarios(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenarios")
        .join(name)
}

fn two_gantries() -> String {
    fs::read_to_string(scenarios("cells/two_gantries.toml")).unwrap()
}

/// Serves both gantries with the rod of the thesis.
fn serve(arguments: &[&str]) -> Served {
    let rod = scenarios("rods/thick_pink_vps.toml");
    let rod = ["--rod", rod.to_str().unwrap()];
    serve_file(&two_gantries(), &[&rod, arguments].concat(), "")
}

/// Arguments to tie a trefoil, with all results in a folder.
fn task(passes: &str, folder: &str) -> Vec<String> {
    let pattern = scenarios("patterns/trefoil.svg");
    let rod = scenarios("rods/thick_pink_vps.toml");
    [
        "tie",
        "--pattern",
        pattern.to_str().unwrap(),
        "--rod",
        rod.to_str().unwrap(),
        "--cell",
        "client.toml",
        "--approach-speed",
        "0.5",
        "--knot",
        passes,
        "--out",
        folder,
    ]
    .map(str::to_owned)
    .into()
}

fn tie(served: &Served, passes: &str) -> Output {
    let task = task(passes, "tied");
    served.run(&task.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The record of a finished task.
fn record(output: &Output) -> Value {
    assert!(output.status.success(), "{}", said(output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "finished", "{record}");
    record
}

#[test]
fn a_trefoil_is_tied_by_two_arms_and_seen() {
    let rod = fs::read_to_string(scenarios("rods/thick_pink_vps.toml")).unwrap();
    let task = ["tie", "--pattern", "trefoil", "--rod", "rod.toml"];
    let more = ["--knot", "over,under,over", "--approach-speed", "0.5"];
    let task = [&task[..], &more, &["--out", "tied"]].concat();
    let (record, folder) = crate::virtual_cell::alone("rod.toml", &rod, &task);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap_or_default();
    let score = &record["score"];
    assert_eq!(score["seen"]["determinant"], 3, "{record}");
    assert_eq!(score["seen"], score["drawn"], "{record}");
    assert_eq!(score["tied"], true, "{record}");
    assert_eq!(score["crossings"].as_array().unwrap().len(), 3, "{record}");
    for name in [
        "plan/trajectory.csv",
        "plan/lift_1.csv",
        "joints.csv",
        "cell.html",
        "approach/state.csv",
        "laying/commanded.csv",
        "tying/01_leading/state.csv",
        "tying/02_lifting/trajectory.csv",
        "tying/03_end/events.csv",
        "rod.csv",
        "report.md",
    ] {
        assert!(!read(&format!("tied/{name}")).is_empty(), "{name}");
    }
    for name in ["picture.png", "overlay.png"] {
        let picture = folder.path().join("tied").join(name);
        assert!(picture.is_file(), "{name}");
    }
    let joints = read("tied/joints.csv");
    let header = joints.lines().next().unwrap();
    assert!(
        header.contains("left.x_m") && header.contains("right.x_m"),
        "{header}"
    );
    // Both arms moved in one motion.
    let state = read("tied/tying/01_leading/state.csv");
    assert!(state.contains(",left,") && state.contains(",right,"));
    assert!(read("tied/report.md").contains("tied as drawn"));
}

/// Arguments to tie a reef knot in two rods, with all results in a folder.
fn reef(folder: &str) -> Vec<String> {
    let mut arguments = task("over,over,under,over,over,under", folder);
    arguments[2] = scenarios("patterns/reef.svg").to_str().unwrap().to_owned();
    let rod = scenarios("rods/green_vps.toml");
    let more = ["--stroke", "1", "--second-stroke", "2", "--second-rod"];
    arguments.extend(more.map(str::to_owned));
    arguments.push(rod.to_str().unwrap().to_owned());
    arguments
}

#[test]
fn a_reef_knot_is_tied_in_two_rods_and_seen() {
    let rod = scenarios("rods/green_vps.toml");
    let served = serve(&["--rate", "50", "--second-rod", rod.to_str().unwrap()]);
    let arguments = reef("tied");
    let output = served.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    let record = record(&output);
    let score = &record["score"];
    assert_eq!(score["seen"]["determinant"], 9, "{record}");
    assert_eq!(score["seen"]["signature"], 0, "{record}");
    assert_eq!(score["tied"], true, "{record}");
    assert_eq!(score["crossings"].as_array().unwrap().len(), 6, "{record}");
    for name in [
        "laying_1/state.csv",
        "parting_1/state.csv",
        "approach_2/state.csv",
        "laying_2/state.csv",
        "tying/05_taking/state.csv",
        "tying/07_lifting/state.csv",
        "rod_1.csv",
        "rod_2.csv",
    ] {
        assert!(!served.read(&format!("tied/{name}")).is_empty(), "{name}");
    }
}

#[test]
fn a_rod_that_passes_over_all_strands_is_not_tied() {
    let served = serve(&["--rate", "50"]);
    let record = record(&tie(&served, "over,over,over"));
    let score = &record["score"];
    assert_eq!(score["tied"], false, "{record}");
    assert_eq!(score["seen"]["determinant"], 1, "{record}");
    assert_eq!(score["drawn"]["determinant"], 1, "{record}");
}

#[test]
fn a_rod_that_slips_out_of_the_gripper_is_not_tied() {
    // The rod slips while its end is led.
    let served = serve(&["--rate", "50", "--fault", "slip-grasp@65s"]);
    let record = record(&tie(&served, "over,under,over"));
    assert_ne!(record["score"]["tied"], true, "{record}");
}

#[test]
fn two_arms_that_are_interrupted_while_both_move_hold() {
    let served = serve(&["--rate", "50"]);
    let arguments = task("over,under,over", "tied");
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut task = served
        .command(&arguments)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begin = Instant::now();
    let events = "tied/tying/01_leading/events.csv";
    while !served.read(events).contains("started") {
        assert!(begin.elapsed() < Duration::from_secs(300));
        std::thread::sleep(Duration::from_millis(5));
    }
    let told = Command::new("kill")
        .args(["-INT", &task.id().to_string()])
        .status();
    assert!(told.unwrap().success());
    assert_eq!(task.wait().unwrap().code(), Some(130));
    stand(&served);
    let events = served.read(events);
    assert!(
        events.contains("left holds") && events.contains("right holds"),
        "{events}"
    );
    asks_for_a_look(&served);
    // Each arm has its own mark, too.
    let alone = [
        "deploy",
        "--pattern",
        "line:0.2",
        "--rod",
        "rod.toml",
        "--arm",
        "right",
    ];
    let more = ["--cell", "client.toml", "--out", "again"];
    served.asks_for_a_look_before(&[&alone[..], &more].concat());
}

/// Checks that both arms are at rest half a second from now.
fn stand(served: &Served) {
    std::thread::sleep(Duration::from_millis(500));
    assert!(served.stands("/left/joint_states") && served.stands("/right/joint_states"));
}

fn asks_for_a_look(served: &Served) {
    let again = task("over,under,over", "again");
    served.asks_for_a_look_before(&again.iter().map(String::as_str).collect::<Vec<_>>());
}

#[test]
fn a_link_that_drops_ends_a_task_of_two_arms() {
    let served = serve(&["--rate", "50", "--fault", "drop-link@20s"]);
    let output = tie(&served, "over,under,over");
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("connection"), "{}", said(&output));
    let manifest: Value = serde_json::from_str(&served.read("tied/manifest.json")).unwrap();
    assert_eq!(manifest["status"], "failed");
    assert!(served.read("tied/report.md").contains("failed"));
    stand(&served);
    asks_for_a_look(&served);
}

/// Result of a task in a cell without a server.
fn alone(
    cell: &str,
    change: impl Fn(&mut Vec<String>),
) -> (Option<i32>, String, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("client.toml"), cell).unwrap();
    let mut arguments = task("over,under,over", "shown");
    change(&mut arguments);
    arguments.push("--yes".into());
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    command.env("XDG_STATE_HOME", folder.path().join("state"));
    let output = command
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    (output.status.code(), said(&output), folder)
}

#[test]
fn impossible_knots_are_rejected_before_anything_moves() {
    let cell = two_gantries();
    let refused = |cell: &str, words: &str, change: &dyn Fn(&mut Vec<String>)| {
        let (code, said, folder) = alone(cell, change);
        assert_eq!(code, Some(2), "{words}: {said}");
        assert!(said.contains(words), "{words}: {said}");
        assert!(!folder.path().join("shown/approach").exists(), "{words}");
    };
    let with = |from: &'static str, to: &'static str| {
        move |arguments: &mut Vec<String>| {
            for argument in arguments.iter_mut().filter(|known| *known == from) {
                to.clone_into(argument);
            }
        }
    };
    let and = |more: &'static [&'static str]| {
        move |arguments: &mut Vec<String>| {
            arguments.extend(more.iter().map(|&word| word.to_owned()))
        }
    };
    let three = "over,under,over";
    refused(
        &cell,
        "crossings of the pattern: 3",
        &with(three, "over,under"),
    );
    refused(
        &cell,
        "which the rod of 0.84 m covers",
        &with(three, "under,under,over"),
    );
    refused(
        &cell,
        "there is no arm \"middle\"",
        &and(&["--arm", "middle"]),
    );
    refused(
        &cell,
        "another arm must lift",
        &and(&["--arm", "left", "--second-arm", "left"]),
    );
    refused(
        &cell,
        "off the table or outside the picture",
        &and(&["--place", "0.2,0,0"]),
    );
    refused(&gantry(), "takes two arms", &|_| {});
    let without = |from: &str, to: &str| {
        let begin = cell.find(from).unwrap();
        let end = begin + cell[begin..].find(to).unwrap();
        format!("{}{}", &cell[..begin], &cell[end..])
    };
    refused(
        &without("[camera]", "[streaming]"),
        "a [camera] with a `source`",
        &|_| {},
    );
    refused(
        &cell.replace("[arms.gripper]", "[arms.nothing]"),
        "gripper",
        &|_| {},
    );
}

#[test]
fn a_dry_run_shows_the_plan_of_two_rods() {
    let (code, said, folder) = alone(&two_gantries(), |arguments| {
        *arguments = reef("shown");
        arguments.push("--dry-run".into());
    });
    assert_eq!(code, Some(0), "{said}");
    let manifest = fs::read_to_string(folder.path().join("shown/manifest.json")).unwrap();
    let record: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(record["drawn"]["determinant"], 9);
    assert_eq!(record["lifts"], 2);
    // Six crossings of two rods; with these orders at three of them there is no knot.
    let (code, said, _) = alone(&two_gantries(), |arguments| {
        *arguments = reef("shown");
        arguments[10] = "over,over,over".into();
    });
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("crossings of the rods: 6"), "{said}");
}

#[test]
fn a_dry_run_shows_both_arms_and_moves_nothing() {
    let (code, said, folder) = alone(&two_gantries(), |arguments| {
        arguments.push("--dry-run".into())
    });
    assert_eq!(code, Some(0), "{said}");
    let shown = folder.path().join("shown");
    let manifest = fs::read_to_string(shown.join("manifest.json")).unwrap();
    let record: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(record["status"], "planned");
    assert_eq!(record["arms"], serde_json::json!(["left", "right"]));
    assert_eq!(record["lifts"], 1);
    assert_eq!(record["drawn"]["determinant"], 3);
    for name in [
        "joints.csv",
        "cell.html",
        "report.md",
        "plan/deployment.svg",
    ] {
        assert!(shown.join(name).is_file(), "{name}");
    }
    assert!(!shown.join("approach").exists());
}
