//! `rodlab identify --rod` and `rodlab deploy --identify` in the virtual cell.

use super::{ROD, said, serve};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// The expected rod. Its gravito-bending length is one and a half times that of the rod in the
/// cell, 3 cm.
fn expected() -> String {
    ROD.replace("3 cm", "4.5 cm")
}

/// Runs a command in a folder.
fn in_folder(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    let command = command.args(arguments).current_dir(folder);
    let command = command.env("XDG_CACHE_HOME", folder).stdin(Stdio::null());
    command.env("XDG_STATE_HOME", folder).output().unwrap()
}

fn length_in(rod: &str) -> f64 {
    let line = rod
        .lines()
        .find_map(|line| line.strip_prefix("gravito_bending_length = "));
    line.expect("a length").parse().unwrap()
}

fn record(output: &Output) -> Value {
    assert!(output.status.success(), "{}", said(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn an_arm_identifies_a_rod_that_differs_from_the_expected_one() {
    let served = serve(&["--rate", "50", "--hanging", "15 cm"], "");
    fs::write(served.folder.path().join("expected.toml"), expected()).unwrap();
    let task = ["identify", "--rod", "expected.toml", "--free", "15 cm"];
    let output = served.run(&[&task[..], &["--cell", "client.toml", "--out", "held"]].concat());
    let record = record(&output);
    assert_eq!(record["status"], "finished", "{record}");
    let found = &record["parameters"][0];
    let [value, error] = ["value", "standard_error"].map(|key| found[key].as_f64().unwrap());
    assert!((value / 0.03 - 1.0).abs() < 0.01, "{found}");
    assert!(error < 3e-4, "{found}");
    // The rod is straight.
    for key in [1, 2] {
        let curvature = record["parameters"][key]["value"].as_f64().unwrap();
        assert!(curvature.abs() < 0.3, "{record}");
    }
    let rod = served.read("held/rod.toml");
    assert!((length_in(&rod) - value).abs() < 1e-12, "{rod}");
    assert!(
        rod.contains("length = 0.3\n") && rod.contains("edges = 30"),
        "{rod}"
    );
    for name in [
        "identified.json",
        "parameters.csv",
        "residuals.csv",
        "residuals.svg",
        "report.html",
        "hold_1/state.csv",
    ] {
        assert!(!served.read(&format!("held/{name}")).is_empty(), "{name}");
    }
    for number in 1..=3 {
        for name in ["look", "overlay"] {
            let picture = format!("held/{name}_{number}.png");
            assert!(served.folder.path().join(&picture).is_file(), "{picture}");
        }
    }
}

#[test]
fn an_identified_rod_is_laid_with_its_measured_properties() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    fs::write(folder.path().join("expected.toml"), expected()).unwrap();
    let deploy = ["deploy", "--pattern", "line:0.15", "--rod", "expected.toml"];
    let identify = ["--identify", "--simulated-rod", "rod.toml", "--out", "laid"];
    let record = record(&in_folder(
        folder.path(),
        &[&deploy[..], &identify].concat(),
    ));
    assert_eq!(record["status"], "finished", "{record}");
    let rod = fs::read_to_string(folder.path().join("laid/identify/rod.toml")).unwrap();
    assert!((length_in(&rod) / 0.03 - 1.0).abs() < 0.01, "{rod}");
    let landing = fs::read_to_string(folder.path().join("laid/plan/landing.toml")).unwrap();
    assert!(
        (length_in(&landing) - length_in(&rod)).abs() < 1e-12,
        "{landing}"
    );
    let error = record["score"]["by_nearest_point"]["mean_m"].as_f64();
    assert!(error.unwrap() < 1e-3, "{record}");
}

#[test]
fn impossible_identifications_are_rejected_before_anything_moves() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    for (arguments, words) in [
        (
            "deploy --pattern line:0.15 --rod rod.toml --identify --simulate",
            "cannot be used with",
        ),
        (
            "deploy --pattern line:0.15 --rod rod.toml --identify --dry-run",
            "cannot be used with",
        ),
        (
            "identify --rod rod.toml --simulated-rod rod.toml --cell gantry",
            "cannot be used with",
        ),
        ("identify --rod rod.toml --free 40cm", "longer than the rod"),
        ("identify --rod rod.toml --free 1cm", "--free"),
        ("identify --cell gantry --yes", "has no [rod]"),
        (
            "identify elastic_pendulum --data rod.toml --fit material.density --cell gantry",
            "an arm identifies",
        ),
        ("identify", "--data"),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = in_folder(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
    }
}
