//! Failing cases, and rejected sweeps.

use super::{SWINGS, directory, manifest, outcome, succeed};
use std::fs;
use std::path::{Path, PathBuf};

/// A case that cannot converge, since neither iterations nor smaller steps are allowed.
const HOPELESS: &str = "[[sweep.zip]]\nsolver.maximum_iterations = [25, 1, 25]\n\
                        solver.minimum_step = [1e-9, 1e-3, 1e-9]\nrods.rope.radius = [0.003, 0.004, 0.005]\n";

#[test]
fn a_failed_case_is_recorded_and_stops_no_other() {
    let before_sweep = SWINGS.split("[sweep]").next().unwrap();
    let directory = directory(&format!("{before_sweep}{HOPELESS}"));
    let run = ["run", "swings.toml", "--jobs", "1"];
    let (code, stdout, stderr) = outcome(&directory, &run);
    assert_eq!(code, 3, "{stdout}{stderr}");
    assert!(
        stdout.starts_with("2 of 3 cases finished, 1 without convergence"),
        "{stdout}"
    );
    assert!(stderr.contains("--retry-failed"), "{stderr}");
    let results = directory.path().join("results/swings");
    let statuses = |results: &Path| -> Vec<String> {
        let mut reader = csv::Reader::from_path(results.join("summary.csv")).unwrap();
        let place = reader
            .headers()
            .unwrap()
            .iter()
            .position(|name| name == "status")
            .unwrap();
        reader
            .records()
            .map(|row| row.unwrap()[place].to_owned())
            .collect()
    };
    assert_eq!(
        statuses(&results),
        ["finished", "no-convergence", "finished"]
    );
    let cases = manifest(&results)["cases"].clone();
    let failed = cases
        .as_object()
        .unwrap()
        .values()
        .find(|case| case["status"] != "finished");
    let error = failed.unwrap()["error"].as_str().unwrap();
    assert!(error.contains("rope"), "{error}");

    // The same command does not repeat the failed case; with --retry-failed it does.
    let started = |results: &Path| -> Vec<String> {
        let mut starts: Vec<(PathBuf, String)> = fs::read_dir(results.join("cases"))
            .unwrap()
            .map(|case| {
                let path = case.unwrap().path();
                let start = manifest(&path)["start"].as_str().unwrap().to_owned();
                (path, start)
            })
            .collect();
        starts.sort();
        starts.into_iter().map(|(_, start)| start).collect()
    };
    let first = started(&results);
    assert_eq!(outcome(&directory, &run).0, 3);
    assert_eq!(started(&results), first);
    assert_eq!(
        outcome(&directory, &["run", "swings.toml", "--retry-failed"]).0,
        3
    );
    let again = started(&results);
    let changed = first.iter().zip(&again).filter(|(a, b)| a != b).count();
    assert_eq!(changed, 1);

    let (code, stdout, _) = outcome(
        &directory,
        &[
            "run",
            "swings.toml",
            "--jobs",
            "1",
            "--fail-fast",
            "--out",
            "fast",
        ],
    );
    assert_eq!(code, 3);
    assert!(
        stdout.starts_with("1 of 3 cases finished, 1 unfinished"),
        "{stdout}"
    );
    assert_eq!(
        statuses(&directory.path().join("fast")),
        ["finished", "no-convergence", "pending"]
    );
}

#[test]
fn a_case_that_fails_late_is_recorded() {
    // Each value is possible, but one combination is not: two ropes that overlap.
    let across = "[[rods]]\nname = \"across\"\nradius = \"3 mm\"\nedges = 8\n\
                  shape = { kind = \"straight\", start = [0.1, -0.1, 0.008], end = [0.1, 0.1, 0.008] }\n\
                  [contact]\nfriction = 0.1\n\
                  [sweep]\nrods.rope.radius = [0.003, 0.006]\nrods.across.radius = [0.003, 0.006]\n";
    let before_sweep = SWINGS.split("[sweep]").next().unwrap();
    let directory = directory(&format!("{before_sweep}{across}"));
    let (code, stdout, stderr) = outcome(
        &directory,
        &["run", "swings.toml", "--set", "time.end=2 ms"],
    );
    assert_eq!(code, 2, "{stderr}");
    assert!(stdout.contains("with an invalid scenario"), "{stdout}");
    assert!(
        stderr.contains("across") && stderr.contains("rope"),
        "{stderr}"
    );
}

#[test]
fn bad_sweeps_exit_with_2_and_leave_nothing_behind() {
    for (sweep, words) in [
        ("rods.rope.raduis = [1.0]", "did you mean `radius`?"),
        ("rods.rope.radius = []", "the list is empty"),
        ("rods.rope.radius = [0.001, -1.0]", "greater than 0"),
        ("rods.rope.radius = [0.001, 0.001]", "occurs twice"),
        (
            "zip = [{ rods.rope.edges = [2], rods.rope.radius = [0.1, 0.2] }]",
            "same length",
        ),
        (
            "rods.rope.radius = { from = 0.001, to = 0.002, count = 1000000 }\nmaterial.density = { from = 1e3, to = 2e3, count = 1000 }",
            "1000000000 cases",
        ),
        (
            "rods.rope.radius = [0.001]\nderivatives = { to = [\"material.density\"] }",
            "the scenario has no [[probes]]",
        ),
        (
            "derivatives = { to = [\"material.density\"] }",
            "no key varies",
        ),
        (
            "rods.rope.radius = [0.001]\nderivatives = { to = [\"material.densit\"] }",
            "unknown key",
        ),
    ] {
        let before_sweep = SWINGS.split("[sweep]").next().unwrap();
        let directory = directory(&format!("{before_sweep}[sweep]\n{sweep}"));
        let (code, stdout, stderr) = outcome(&directory, &["run", "swings.toml"]);
        assert_eq!((code, stdout.as_str()), (2, ""), "{sweep}: {stderr}");
        let stderr = stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(stderr.contains(words), "{words} in {stderr}");
        assert!(!directory.path().join("results").exists());
    }
}

#[test]
fn results_of_another_sweep_are_refused() {
    let directory = directory(SWINGS);
    succeed(
        &directory,
        &["run", "swings.toml", "--set", "time.end=2 ms"],
    );
    let (code, _, stderr) = outcome(&directory, &["run", "swings.toml"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("another scenario"), "{stderr}");
    succeed(
        &directory,
        &["run", "swings.toml", "--set", "time.end=3 ms", "--force"],
    );
}
