//! `rodlab deploy` in the virtual cell.

use super::{DEPLOY, ROD, Served, again, alone, gantry, said, serve};
use serde_json::Value;
use std::fs;
use std::process::{Command, Stdio};

#[test]
fn a_rod_is_laid_along_a_line_seen_and_scored() {
    let served = serve(&["--rate", "50"], "");
    let output = served.deploy();
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "finished");
    let error = |name: &str| record["score"][name]["mean_m"].as_f64().unwrap();
    // A pixel of the camera is 0.7 mm.
    assert!(error("by_nearest_point") < 1e-3, "{record}");
    assert!(error("by_arc_length") < 3e-3, "{record}");
    for name in [
        "plan/trajectory.csv",
        "plan/landing.toml",
        "joints.csv",
        "cell.html",
        "approach/state.csv",
        "laying/commanded.csv",
        "laying/state.csv",
        "rod.csv",
        "score.svg",
        "report.md",
        "manifest.json",
    ] {
        assert!(!served.read(&format!("laid/{name}")).is_empty(), "{name}");
    }
    for name in ["picture.png", "overlay.png"] {
        assert!(
            served.folder.path().join("laid").join(name).is_file(),
            "{name}"
        );
    }
    assert!(served.read("laid/report.md").contains("finished"));
    is_replayed(&served, &record);
    // A second task starts from the current joints of the arm, and rejects the directory of the
    // first.
    let refused = served.deploy();
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
}

/// The log shows the motions of the arm, and the picture has the same score again.
fn is_replayed(served: &Served, record: &Value) {
    let output = served.run(&["replay", "laid", "--json"]);
    assert!(output.status.success(), "{}", said(&output));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mean = |score: &Value| score["by_arc_length"]["mean_m"].as_f64().unwrap();
    // The pattern is stored with 0.1 µm.
    assert!(
        (mean(&answer["rods"][0]["score"]) - mean(&record["score"])).abs() < 2e-7,
        "{answer}"
    );
    assert_eq!(answer["rods"][0]["recorded_score"], record["score"]);
    let motions = answer["motions"].as_array().unwrap();
    let names: Vec<_> = motions
        .iter()
        .map(|motion| motion["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["approach", "laying", "retreat"]);
    let planned = record["motion"]["duration_s"].as_f64().unwrap();
    let laying = motions[1]["duration_s"].as_f64().unwrap();
    assert!(
        (planned..planned + 2.0).contains(&laying),
        "{laying} {planned}"
    );
    for motion in motions {
        assert_eq!(motion["ending"], "finished");
        // The arm is late, but on its path.
        let off = |name: &str| motion[name].as_f64().unwrap();
        assert!(
            off("hand_off_m") < 1e-4 && off("slides_off_m") > 1e-5,
            "{motion}"
        );
    }
    assert!(
        served
            .read("laid/replay.html")
            .contains("planned path laying")
    );
    // One file is enough.
    let made = served.run(&["export", "laid", "--format", "mcap", "--out", "laid.mcap"]);
    assert!(made.status.success(), "{}", said(&made));
    let output = served.run(&["replay", "laid.mcap", "--json"]);
    assert!(output.status.success(), "{}", said(&output));
    let recorded: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(recorded["page"], "laid.html");
    assert_eq!(recorded["motions"], answer["motions"]);
    assert_eq!(recorded["rods"], answer["rods"]);
    let other = served.run(&["replay", "laid", "--cell", "six_joints"]);
    assert_eq!(other.status.code(), Some(2), "{}", said(&other));
    assert!(
        said(&other).contains("no report of an arm of the cell"),
        "{}",
        said(&other)
    );
    let empty = served.run(&["replay", ".", "--cell", "client.toml", "--out", "all.html"]);
    assert!(
        empty.status.success(),
        "folders of motions are found: {}",
        said(&empty)
    );
}

#[test]
fn faults_of_the_cell_end_a_deployment_with_exit_code_1_and_a_whole_log() {
    // The allowed delay of an arm grows with the rate of its clock, so that a slower clock shows a
    // frozen joint earlier.
    for (fault, words, rate) in [
        ("drop-link@9s", "connection", "10"),
        ("freeze-joint@9s", "from its trajectory", "3"),
        ("drop-link@0s", "connection", "10"),
    ] {
        let served = serve(&["--rate", rate, "--fault", fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
        assert_eq!(manifest["status"], "failed", "{fault}");
        assert!(
            manifest["error"].as_str().unwrap().contains(words),
            "{fault}"
        );
        assert!(served.read("laid/report.md").contains("failed"), "{fault}");
        let events =
            ["approach", "laying"].map(|part| served.read(&format!("laid/{part}/events.csv")));
        assert!(events.concat().contains(words), "{fault}: {events:?}");
    }
}

#[test]
fn a_rod_that_is_longer_than_its_pattern_is_laid_to_its_end() {
    let served = serve(&["--rate", "50"], "");
    let mut arguments = DEPLOY;
    arguments[2] = "line:0.12";
    let output = served.run(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = |name: &str| record["score"][name]["largest_m"].as_f64().unwrap();
    assert!(
        error("by_arc_length") < 3e-3 && error("by_nearest_point") < 1.5e-3,
        "{record}"
    );
    // All of the 30 cm is laid except 2.5 gravito-bending lengths.
    let pattern = served.read("laid/plan/pattern.csv");
    let last = pattern.lines().last().unwrap().split(',').next().unwrap();
    assert_eq!(last, "0.225000000");
}

#[test]
fn a_rod_with_a_wrong_visible_length_is_not_scored() {
    let served = serve(&["--rate", "50"], "");
    // The cell supplies rods of 30 cm.
    let longer = ROD.replace("30 cm", "32 cm");
    fs::write(served.folder.path().join("longer.toml"), longer).unwrap();
    let mut arguments = DEPLOY;
    arguments[4] = "longer.toml";
    let output = served.run(&arguments);
    assert_eq!(output.status.code(), Some(4), "{}", said(&output));
    assert!(output.stdout.is_empty() && said(&output).contains("not seen whole"));
    let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
    assert_eq!(manifest["status"], "not-seen-whole", "{manifest}");
    assert_eq!(manifest["score"], Value::Null, "{manifest}");
    let lengths = &manifest["seen_length"];
    assert_eq!(lengths["rod_m"], 0.32, "{manifest}");
    let seen = lengths["seen_m"].as_f64().unwrap();
    assert!((seen - 0.3).abs() < 3e-3, "{manifest}");
    let report = served.read("laid/report.md");
    assert!(report.contains("320.0 mm"), "{report}");
    // The arm has done its work, so that the next task may start.
    let next = served.run(&again());
    assert!(next.status.success(), "{}", said(&next));
}

#[test]
fn the_path_of_a_rod_is_replanned_from_pictures() {
    // The limits below are seven to ten times the jitter, since its phase at the start of the
    // motion is not fixed. That at the grasp displaces the rod in the hand, by up to four times.
    let jitter = ["--jitter", "0.3 mm", "--seed", "3"];
    let served = serve(&[&["--rate", "50"], &jitter[..]].concat(), "");
    let mut arguments = DEPLOY.to_vec();
    arguments.push("--correct");
    let output = served.run(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = record["score"]["by_nearest_point"]["largest_m"]
        .as_f64()
        .unwrap();
    assert!(error < 3e-3, "{record}");
    let looks = served.read("laid/corrections.csv");
    let mut rows = looks.lines();
    assert_eq!(
        rows.next().unwrap(),
        "laid_m,seen_m,x_m,y_m,angle_rad,gravito_bending_length_m,processor_time_s"
    );
    let seen: Vec<Vec<f64>> = rows
        .filter_map(|row| row.split(',').map(|text| text.parse().ok()).collect())
        .collect();
    assert!(seen.len() >= 4, "{looks}");
    for row in &seen {
        // Pictures are ignored within half a gravito-bending length of the gripper's place. The
        // line is along x.
        assert!(
            (row[0] - row[1] - 0.015).abs() < 1e-4 && (row[1] - row[2]).abs() < 2e-3,
            "{looks}"
        );
        assert!(row[3].abs() < 3e-3 && row[4].abs() < 0.1, "{looks}");
    }
}

#[test]
fn a_dry_run_shows_the_plan_and_moves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    // No server listens on this port.
    let cell = gantry().replace(":9090", ":1");
    fs::write(folder.path().join("cell.toml"), cell).unwrap();
    let deploy = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command.args([
            "deploy",
            "--rod",
            "rod.toml",
            "--cell",
            "cell.toml",
            "--yes",
        ]);
        command
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let output = deploy(&["--pattern", "line:0.2", "--dry-run", "--out", "shown"]);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "planned");
    for name in [
        "plan/deployment.svg",
        "joints.csv",
        "cell.html",
        "report.md",
        "manifest.json",
    ] {
        assert!(folder.path().join("shown").join(name).is_file(), "{name}");
    }
    assert!(!folder.path().join("shown/approach").exists());
    // Without a server, nothing moves, and the message says so.
    let output = deploy(&[
        "--pattern",
        "line:0.2",
        "--out",
        "alone",
        "--place",
        "0,0,0",
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let far = deploy(&["--pattern", "line:0.2", "--out", "far", "--place", "3,0,0"]);
    assert_eq!(far.status.code(), Some(3), "{}", said(&far));
}

/// A T whose stem is drawn from the bar down: its rod begins at the other end, since the start would
/// lie on the first rod.
#[test]
fn rods_are_laid_along_the_strokes_of_a_drawing() {
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"120mm\" height=\"120mm\" viewBox=\"0 0 120 120\" fill=\"none\" \
                   stroke=\"black\"><path d=\"M0,10 L120,10\"/><path d=\"M60,10 L60,110\"/></svg>";
    let task = [
        "deploy",
        "--pattern",
        "t.svg",
        "--rod",
        "green_vps",
        "--out",
        "laid",
    ];
    let (record, folder) = alone("t.svg", drawing, &task);
    assert_eq!(record["status"], "finished");
    let strokes = record["strokes"].as_array().unwrap();
    let numbers = |path: [&str; 2]| -> Vec<f64> {
        let of = |stroke: &Value| stroke[path[0]][path[1]].as_f64().unwrap();
        strokes.iter().map(of).collect()
    };
    // A straight stroke has no lead-in; 2.5 gravito-bending lengths of 3.2 cm hang at the end.
    let seen = numbers(["seen_length", "rod_m"]);
    assert!(
        (seen[0] - 0.2).abs() < 1e-3 && (seen[1] - 0.18).abs() < 1e-3,
        "{record}"
    );
    assert_eq!(
        strokes[1]["cut_length_m"],
        strokes[1]["seen_length"]["rod_m"]
    );
    let near = strokes
        .iter()
        .map(|stroke| &stroke["score"]["by_nearest_point"]["mean_m"]);
    let near: Vec<f64> = near.map(|mean| mean.as_f64().unwrap()).collect();
    assert!(near.iter().all(|mean| *mean < 1e-3), "{near:?}");
    let pattern = fs::read_to_string(folder.path().join("laid/stroke-2/pattern.csv")).unwrap();
    let y =
        |line: Option<&str>| -> f64 { line.unwrap().split(',').nth(1).unwrap().parse().unwrap() };
    assert!(
        (y(pattern.lines().nth(1)) - 0.01).abs() < 1e-3,
        "the stem begins below: {pattern}"
    );
    for name in [
        "picture.png",
        "cell.html",
        "joints.csv",
        "stroke-1/laying/state.csv",
        "stroke-2/score.svg",
    ] {
        assert!(folder.path().join("laid").join(name).is_file(), "{name}");
    }
    let replayed = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["replay", "laid", "--json"])
        .env("XDG_CACHE_HOME", folder.path())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let answer: Value = serde_json::from_slice(&replayed.stdout).unwrap();
    assert_eq!(answer["motions"].as_array().unwrap().len(), 5);
    for (rod, stroke) in answer["rods"].as_array().unwrap().iter().zip(strokes) {
        assert_eq!(rod["recorded_score"], stroke["score"]);
        assert!(rod["score"].is_object(), "{answer}");
    }
}

#[test]
fn without_a_cell_file_the_rod_is_laid_in_a_cell_of_the_process() {
    let task = ["deploy", "--pattern", "line:0.15", "--rod", "rod.toml"];
    let (record, folder) = alone("rod.toml", ROD, &[&task[..], &["--out", "laid"]].concat());
    assert_eq!(record["status"], "finished");
    let mean = record["score"]["by_arc_length"]["mean_m"].as_f64().unwrap();
    assert!(mean < 2e-3, "{mean}");
    for name in ["picture.png", "score.svg", "report.md", "cell.html"] {
        assert!(folder.path().join("laid").join(name).is_file(), "{name}");
    }
    let page = fs::read_to_string(folder.path().join("laid/report.html")).unwrap();
    assert!(page.contains("src=\"data:image/png;base64,"), "{page}");
}

#[test]
fn the_rod_is_that_of_the_cell_file() {
    let folder = tempfile::tempdir().unwrap();
    let cell = gantry() + "\n[rod]\nfile = \"mine.toml\"\n";
    fs::write(folder.path().join("cell.toml"), cell).unwrap();
    let deploy = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command.args(["deploy", "--pattern", "line:0.15", "--cell", "cell.toml"]);
        command.args(["--dry-run", "--out", "shown"]);
        command.current_dir(folder.path()).output().unwrap()
    };
    let output = deploy();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("does not exist"),
        "{}",
        said(&output)
    );
    fs::write(folder.path().join("mine.toml"), ROD).unwrap();
    let output = deploy();
    assert!(output.status.success(), "{}", said(&output));
    assert!(
        said(&output).contains("mine.toml of the cell"),
        "{}",
        said(&output)
    );
}

#[test]
fn an_arm_moves_only_after_a_confirmation() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    fs::write(folder.path().join("cell.toml"), gantry()).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["deploy", "--pattern", "line:0.2", "--rod", "rod.toml"])
        .args(["--cell", "cell.toml", "--out", "laid"])
        .stdin(Stdio::null())
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("--yes is required"),
        "{}",
        said(&output)
    );
    assert!(!folder.path().join("laid").exists());
}
