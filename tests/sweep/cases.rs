//! The list of cases, and the independence of the tables from the order and the processes of the
//! runs.

use super::{
    CASES, SWINGS, assert_same, directory, manifest, outcome, succeed, tables, undisturbed,
};
use std::fs;
use std::path::Path;

#[test]
fn tables_do_not_depend_on_the_order_or_the_processes_of_cases() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let summary = String::from_utf8(expected[Path::new("summary.csv")].clone()).unwrap();
    let mut lines = summary.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("case,rods.rope.radius,material.density,status,")
    );
    assert!(
        lines
            .next()
            .unwrap()
            .contains(",0.003,800.0,finished,0.5,500,")
    );
    assert_eq!(lines.count(), CASES - 1);

    succeed(
        &directory,
        &[
            "run",
            "swings.toml",
            "--out",
            "at_once",
            "--jobs",
            "3",
            "--threads",
            "3",
        ],
    );
    assert_same(&tables(&directory.path().join("at_once")), &expected);

    for shard in ["3/3", "1/3", "2/3"] {
        succeed(
            &directory,
            &["run", "swings.toml", "--out", "shares", "--shard", shard],
        );
    }
    assert_same(&tables(&directory.path().join("shares")), &expected);

    succeed(
        &directory,
        &["run", "undisturbed/scenario.toml", "--out", "again"],
    );
    assert_same(&tables(&directory.path().join("again")), &expected);

    let cases = manifest(&directory.path().join("again"))["cases"].clone();
    let cases = cases.as_object().unwrap();
    assert_eq!(cases.len(), CASES);
    assert!(cases.values().all(|case| case["status"] == "finished"));
    let again = succeed(&directory, &["run", "swings.toml", "--out", "again"]);
    assert!(again.starts_with("12 of 12 cases finished"), "{again}");
}

#[test]
fn values_can_be_given_on_the_command_line() {
    let directory = directory(SWINGS.split("[sweep]").next().unwrap());
    let vary = [
        "run",
        "swings.toml",
        "--vary",
        "rods.rope.radius=3mm:5mm:1mm",
        "--vary",
        "rods.rope.edges=4,8",
    ];
    let listed: Vec<&str> = vary.iter().copied().chain(["--dry-run"]).collect();
    let list = succeed(&directory, &listed);
    assert!(
        list.contains("rods.rope.radius = 3.0 mm  rods.rope.edges = 8"),
        "{list}"
    );
    assert!(list.contains("6 cases"), "{list}");
    assert!(!directory.path().join("results").exists());
    let short: Vec<&str> = vary
        .iter()
        .copied()
        .chain(["--set", "time.end=2 ms"])
        .collect();
    assert!(succeed(&directory, &short).starts_with("6 of 6 cases finished"));
}

const CURVES: &str = r#"
experiment = "scene"
material = { youngs_modulus = "2 MPa", poissons_ratio = 0.5, density = 1100.0 }
time = { step = "5 ms", end = "20 ms" }

[[rods]]
name = "a"
radius = "2 mm"
edges = 10
shape = { kind = "points", file = "c1.csv" }

[[clamps]]
rod = "a"
at = "start"
follow = "poses.csv"
"#;

#[test]
fn a_sweep_detects_a_changed_input_file() {
    let directory = directory(CURVES);
    let write = |name: &str, text: &str| fs::write(directory.path().join(name), text).unwrap();
    let curve = |y: f64| format!("x,y,z\n0,0,0\n0.05,{y},0\n0.1,0,0\n");
    let poses = |z: f64| format!("time,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.1,0,0,{z},1,0,0,0\n");
    write("c1.csv", &curve(0.01));
    write("c2.csv", &curve(0.02));
    write("poses.csv", &poses(0.01));
    let sweep = [
        "run",
        "swings.toml",
        "--vary",
        "rods.a.shape.file=c1.csv,c2.csv",
        "--out",
        "o",
    ];
    let refused = || {
        let (code, _, stderr) = outcome(&directory, &sweep);
        assert_eq!(code, 2, "{stderr}");
        assert!(stderr.contains("another scenario"), "{stderr}");
    };
    succeed(&directory, &sweep);
    assert!(succeed(&directory, &sweep).contains("2 of 2 cases finished"));

    // The scenario in the results of the sweep can be run from any folder.
    succeed(&directory, &["run", "o/scenario.toml", "--out", "again"]);
    let read = |path: &str| fs::read(directory.path().join(path)).unwrap();
    assert_eq!(read("o/summary.csv"), read("again/summary.csv"));
    succeed(&directory, &["gather", "o"]);

    write("c2.csv", &curve(-0.02));
    refused();
    write("c2.csv", &curve(0.02));
    write("poses.csv", &poses(0.05));
    refused();
    write("poses.csv", &poses(0.01));
    succeed(&directory, &sweep);
}

#[test]
fn cases_with_ids_of_earlier_versions_are_not_run_again() {
    let directory = directory(SWINGS);
    let shorter = ["run", "swings.toml", "--set", "time.end=2 ms", "--out", "o"];
    succeed(&directory, &shorter);
    let cases = directory.path().join("o/cases");
    for entry in fs::read_dir(&cases).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        fs::rename(cases.join(&name), cases.join(&name[..name.len() - 8])).unwrap();
    }
    let id = |folder: std::io::Result<fs::DirEntry>| folder.unwrap().path();
    let folder = fs::read_dir(&cases).unwrap().map(id).next().unwrap();
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    succeed(&directory, &shorter);
    assert_eq!(fs::read_dir(&cases).unwrap().count(), CASES);
    let kept = fs::read_dir(&cases).unwrap().map(id);
    assert!(
        kept.into_iter()
            .any(|folder| folder.join("notes.txt").exists())
    );
}
