//! The boundary of the stable helices from outside: the files of a run, which interruptions must
//! not change.

use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const SCENARIO: &str = r#"
experiment = "helix-stability"
[helix_stability]
edges = 48
extrapolate = true
largest_distance = 12
directions = { kind = "fibonacci", count = 700 }
section_directions = 31
"#;

fn directory(text: &str) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("helices.toml"), text).unwrap();
    directory
}

fn run(directory: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(directory.path())
        .args(["run", "helices.toml"])
        .args(arguments)
        .output()
        .unwrap();
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[test]
fn one_command_writes_boundary_comparison_sections_and_surface() {
    let directory = directory(SCENARIO);
    let (code, stdout, stderr) = run(&directory, &["--out", "boundary"]);
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.contains("793 directions"), "{stdout}");
    assert!(stdout.contains("0 without convergence"), "{stdout}");
    let out = directory.path().join("boundary");
    for figure in [
        "section_kappa_tau",
        "section_kappa_omega",
        "section_tau_omega",
    ] {
        let svg = fs::read_to_string(out.join(format!("{figure}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("theory"));
    }
    assert!(
        fs::read_to_string(out.join("view.html"))
            .unwrap()
            .contains("webgl2")
    );
    let surface = fs::read(out.join("boundary.vtp")).unwrap();
    let surface = String::from_utf8_lossy(&surface);
    assert!(surface.contains("<Polys>") && surface.contains("NumberOfPoints=\"6"));

    let mut rows = csv::Reader::from_path(out.join("boundary.csv")).unwrap();
    let headers = rows.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let [kappa, tau, outcome, critical, difference] = [
        "kappa",
        "tau",
        "outcome",
        "critical",
        "relative_difference_extrapolated",
    ]
    .map(column);
    let mut outcomes = Vec::new();
    for row in rows.records() {
        let row = row.unwrap();
        outcomes.push(row[outcome].to_owned());
        // Distances are empty if there are none, never a meaningless number.
        assert_eq!(row[critical].is_empty(), &row[outcome] == "stable");
        if !row[difference].is_empty() {
            let difference: f64 = row[difference].parse().unwrap();
            assert!(difference.abs() < 0.05, "{row:?}");
        }
        // A rod that is bent to a ring touches itself at its ends before it buckles.
        if row[kappa].parse::<f64>() == Ok(1.0) && row[tau].parse::<f64>() == Ok(0.0) {
            assert_eq!(&row[outcome], "touches_itself");
        }
    }
    assert_eq!(outcomes.len(), 793);
    for fate in ["buckles", "touches_itself", "stable"] {
        assert!(outcomes.iter().any(|found| found == fate), "{fate}");
    }
}

#[test]
fn interruptions_do_not_change_the_table() {
    let directory = directory(SCENARIO);
    assert_eq!(run(&directory, &["--out", "whole"]).0, 0);
    let mut calls = 1;
    loop {
        let limit = format!("{} ms", 100 << calls);
        let (code, stdout, stderr) = run(&directory, &["--out", "pieces", "--timeout", &limit]);
        if code == 0 {
            assert!(stdout.contains("continued from row"), "{stdout}");
            break;
        }
        assert_eq!(code, 5, "{stderr}");
        // A crash may leave half a row, and a manifest without an end.
        let place = directory.path().join("pieces");
        let mut bytes = fs::read(place.join("boundary.csv")).unwrap();
        bytes.extend(b"surface,0.1,");
        fs::write(place.join("boundary.csv"), bytes).unwrap();
        let manifest = fs::read(place.join("manifest.json")).unwrap();
        let mut manifest: serde_json::Value = serde_json::from_slice(&manifest).unwrap();
        manifest.as_object_mut().unwrap().remove("files");
        fs::write(place.join("manifest.json"), manifest.to_string()).unwrap();
        calls += 1;
        assert!(calls < 15, "each call adds rows");
    }
    assert!(calls > 2, "it was never interrupted");
    let read =
        |out: &str, name: &str| fs::read(directory.path().join(Path::new(out)).join(name)).unwrap();
    for name in [
        "boundary.csv",
        "comparison.csv",
        "boundary.vtp",
        "summary.csv",
    ] {
        assert!(read("whole", name) == read("pieces", name), "{name}");
    }
}

#[test]
fn lists_of_directions_come_from_files_and_faults_name_their_line() {
    let directory = directory(
        "experiment = \"helix-stability\"\n[helix_stability]\nedges = 40\n\
         directions = { kind = \"list\", file = \"directions.csv\" }\n",
    );
    let list = directory.path().join("directions.csv");
    fs::write(&list, "kappa,tau,omega\n1,1,-1\n0,0,0\n").unwrap();
    let (code, _, stderr) = run(&directory, &["--out", "list"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("directions.csv, line 3"), "{stderr}");
    assert!(!directory.path().join("list").exists());
    fs::write(&list, "kappa,tau,omega\n1,1,-1\n0,1,2\n").unwrap();
    let (code, stdout, stderr) = run(&directory, &["--out", "list"]);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stdout.contains("1 buckle") && stdout.contains("1 stay stable"),
        "{stdout}"
    );
}
