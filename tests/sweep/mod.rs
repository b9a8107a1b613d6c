//! Sweeps from outside: the files on the disk, which interruptions and faults must not change.

mod cases;
mod faults;
mod interruption;
mod search;

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use tempfile::TempDir;

/// Swings of a rope that are long enough to be killed.
const SWINGS: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "0.5 s", scheme = "implicit-euler" }
output = { interval = "10 ms" }

[[rods]]
name = "rope"
radius = "5 mm"
edges = 8
shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }

[[clamps]]
rod = "rope"
at = "start"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[sweep]
rods.rope.radius = ["3 mm", "4 mm", "5 mm"]
material.density = { from = 800.0, to = 1200.0, count = 4 }
"#;

/// Number of cases.
const CASES: usize = 12;

fn directory(text: &str) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("swings.toml"), text).unwrap();
    directory
}

fn rodlab(directory: &TempDir, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    command.current_dir(directory.path()).args(arguments);
    command
}

/// Runs the program; returns exit code, standard output and standard error.
fn outcome(directory: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let output = rodlab(directory, arguments).output().unwrap();
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

fn succeed(directory: &TempDir, arguments: &[&str]) -> String {
    let (code, stdout, stderr) = outcome(directory, arguments);
    assert_eq!(code, 0, "{arguments:?}: {stdout}{stderr}");
    stdout
}

/// Starts a run in the background.
fn begin(directory: &TempDir, arguments: &[&str]) -> std::process::Child {
    std::process::Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(directory.path())
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Results that must not depend on how they were computed: the summary, and the tables of each
/// case.
fn tables(results: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = vec![PathBuf::from("summary.csv"), PathBuf::from("scenario.toml")];
    for case in fs::read_dir(results.join("cases")).unwrap() {
        let case = Path::new("cases").join(case.unwrap().file_name());
        for name in ["series.csv", "nodes.csv", "summary.csv", "scenario.toml"] {
            files.push(case.join(name));
        }
    }
    let read = |file: PathBuf| {
        let bytes =
            fs::read(results.join(&file)).unwrap_or_else(|error| panic!("{file:?}: {error}"));
        (file, bytes)
    };
    files.into_iter().map(read).collect()
}

/// The tables of an uninterrupted run.
fn undisturbed(directory: &TempDir) -> BTreeMap<PathBuf, Vec<u8>> {
    succeed(
        directory,
        &["run", "swings.toml", "--out", "undisturbed", "--jobs", "1"],
    );
    tables(&directory.path().join("undisturbed"))
}

fn assert_same(found: &BTreeMap<PathBuf, Vec<u8>>, expected: &BTreeMap<PathBuf, Vec<u8>>) {
    assert!(found.keys().eq(expected.keys()));
    for (file, bytes) in expected {
        assert!(found[file] == *bytes, "{} differs", file.display());
    }
}

fn manifest(results: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(results.join("manifest.json")).unwrap()).unwrap()
}
