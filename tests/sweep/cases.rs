//! Which cases there are, and that the tables do not depend on how they were run.

use super::{CASES, SWINGS, assert_same, directory, manifest, succeed, tables, undisturbed};
use std::path::Path;

#[test]
fn the_tables_do_not_depend_on_who_ran_the_cases_in_which_order() {
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
fn values_are_given_on_the_command_line_too() {
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
