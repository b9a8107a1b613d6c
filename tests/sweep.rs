//! Sweeps from outside: what is left on the disk, and that nothing that happens on the way shows in the end.

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Swings of a rope: long enough to be killed on the way.
const SWINGS: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "0.5 s" }
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

/// Number of its cases.
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

/// A run that is at work.
fn begin(directory: &TempDir, arguments: &[&str]) -> std::process::Child {
    std::process::Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(directory.path())
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// What must not depend on how the results came about: the summary, and the tables of each case.
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
#[cfg(unix)]
fn killed_at_any_moment_the_same_command_ends_with_the_same_bytes() {
    let directory = directory(SWINGS);
    let start = Instant::now();
    let expected = undisturbed(&directory);
    let whole = start.elapsed();
    let run = ["run", "swings.toml", "--out", "killed", "--jobs", "2"];
    for part in 0..10 {
        let mut child = begin(&directory, &run);
        // Later and later moments, each at another stage of a case.
        std::thread::sleep(whole * (2 * part + 1) / 60);
        child.kill().unwrap();
        child.wait().unwrap();
    }
    succeed(&directory, &run);
    assert_same(&tables(&directory.path().join("killed")), &expected);
    let claims = directory.path().join("killed/claims");
    assert_eq!(fs::read_dir(claims).unwrap().count(), 0);
}

#[test]
#[cfg(unix)]
fn two_processes_share_a_sweep_and_one_takes_over_from_the_other() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "shared", "--jobs", "1"];
    let mut first = begin(&directory, &run);
    let mut second = begin(&directory, &run);
    let cases = directory.path().join("shared/cases");
    while fs::read_dir(&cases).map_or(0, Iterator::count) < 3 {
        std::thread::sleep(Duration::from_millis(1));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(second.wait().unwrap().success());
    assert_same(&tables(&directory.path().join("shared")), &expected);
}

#[test]
fn a_time_limit_stops_the_sweep_and_the_same_command_continues() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "pieces", "--jobs", "2"];
    let limited: Vec<&str> = run.iter().copied().chain(["--timeout", "20 ms"]).collect();
    let pieces = (1..1000)
        .find(|_| {
            let (code, _, stderr) = outcome(&directory, &limited);
            assert!(code == 0 || code == 5, "{stderr}");
            code == 0
        })
        .expect("the sweep comes to its end");
    assert!(pieces > 1, "the sweep was never stopped");
    assert_same(&tables(&directory.path().join("pieces")), &expected);
}

#[test]
fn a_damaged_checkpoint_is_reported_and_its_case_starts_again() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "damaged", "--jobs", "1"];
    let checkpoints = || -> Vec<PathBuf> {
        let cases = fs::read_dir(directory.path().join("damaged/cases")).unwrap();
        cases
            .flat_map(|case| fs::read_dir(case.unwrap().path()).unwrap())
            .map(|file| file.unwrap().path())
            .filter(|file| {
                file.file_name()
                    .unwrap()
                    .to_string_lossy()
                    .starts_with("checkpoint")
            })
            .collect()
    };
    let stopped = (1..100).find(|part| {
        let timeout = format!("{} ms", 3 * part);
        let limited: Vec<&str> = run.iter().copied().chain(["--timeout", &timeout]).collect();
        outcome(&directory, &limited);
        !checkpoints().is_empty()
    });
    assert!(stopped.is_some(), "no case was stopped on the way");
    for checkpoint in checkpoints() {
        let mut bytes = fs::read(&checkpoint).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(checkpoint, bytes).unwrap();
    }
    let (code, _, stderr) = outcome(&directory, &run);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stderr.contains("checksum") && stderr.contains("starting again"),
        "{stderr}"
    );
    assert_same(&tables(&directory.path().join("damaged")), &expected);
}

/// A case that cannot converge: it may neither iterate nor make its steps smaller.
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

    // The same command leaves it alone; on request it is tried again.
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
fn a_case_that_shows_itself_impossible_late_is_recorded() {
    // Each value is possible, and one combination is not: two ropes inside each other.
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
    assert!(stdout.contains("with an impossible scenario"), "{stdout}");
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
            "rods.rope.radius = { from = 0.001, to = 0.002, count = 10000000 }\nmaterial.density = { from = 1e3, to = 2e3, count = 100 }",
            "1000000000 cases",
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

/// Ropes that hang from a clamp: the stiffer, the less energy is in their bending.
const HANGING: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }

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
"#;

fn column(table: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let place = reader
        .headers()
        .unwrap()
        .iter()
        .position(|header| header == name)
        .unwrap();
    reader
        .records()
        .map(|row| row.unwrap()[place].parse().unwrap())
        .collect()
}

#[test]
fn a_bisection_ends_within_its_tolerance_and_repeats_nothing() {
    let search = "[sweep]\nrods.rope.edges = [6, 8]\n[sweep.search]\nmethod = \"bisect\"\n\
                  parameter = \"material.youngs_modulus\"\nobjective = \"bending_energy_j\"\ntarget = 3e-3\n\
                  from = \"1 MPa\"\nto = \"10 MPa\"\ntolerance = \"0.1 MPa\"\n";
    let directory = directory(&format!("{HANGING}{search}"));
    let stdout = succeed(&directory, &["run", "swings.toml"]);
    let results = directory.path().join("results/swings");
    let table = results.join("search.csv");
    assert_eq!(column(&table, "rods.rope.edges"), [6.0, 8.0]);
    let [low, found, high] =
        ["from", "material.youngs_modulus", "to"].map(|name| column(&table, name));
    fs::write(directory.path().join("single.toml"), HANGING).unwrap();
    for (place, edges) in [6, 8].into_iter().enumerate() {
        assert!(low[place] < found[place] && found[place] < high[place]);
        assert!(high[place] - low[place] <= 0.1e6);
        // The energy passes the target between the ends of the last interval.
        let energy = |modulus: f64| {
            let modulus = format!("material.youngs_modulus={modulus}");
            let edges = format!("rods.rope.edges={edges}");
            let single = [
                "run",
                "single.toml",
                "--force",
                "--set",
                &modulus,
                "--set",
                &edges,
            ];
            succeed(&directory, &single);
            column(
                &directory.path().join("results/single/series.csv"),
                "bending_energy_j",
            )[0]
        };
        assert!(energy(low[place]) > 3e-3 && energy(high[place]) < 3e-3);
    }
    let summary = fs::read(results.join("summary.csv")).unwrap();
    assert_eq!(succeed(&directory, &["run", "swings.toml"]), stdout);
    assert_eq!(fs::read(results.join("summary.csv")).unwrap(), summary);
}

#[test]
fn a_golden_section_finds_the_least_outcome_inside_the_interval() {
    // The rope lies along x: nothing bends it where nothing pulls along z.
    let search = "[sweep.search]\nmethod = \"golden\"\nparameter = \"loads.0.acceleration.2\"\n\
                  objective = \"bending_energy_j\"\nfrom = -4.0\nto = 6.0\ntolerance = 0.01\n";
    let directory = directory(&format!("{HANGING}{search}"));
    succeed(&directory, &["run", "swings.toml"]);
    let table = directory.path().join("results/swings/search.csv");
    let found = column(&table, "loads.0.acceleration.2")[0];
    assert!(found.abs() < 0.01, "{found}");
}

#[test]
fn searches_that_cannot_end_say_why() {
    let search = |objective: &str, target: &str| {
        format!(
            "{HANGING}[sweep.search]\nmethod = \"bisect\"\nparameter = \"material.density\"\n\
             objective = \"{objective}\"\ntarget = {target}\nfrom = 900.0\nto = 1000.0\ntolerance = 1.0\n"
        )
    };
    let directory = directory(&search("bending_energy_j", "1e6"));
    let (code, stdout, _) = outcome(&directory, &["run", "swings.toml"]);
    assert_eq!(code, 3);
    assert!(
        stdout.contains("does not pass 1000000 between the ends"),
        "{stdout}"
    );
    fs::write(
        directory.path().join("swings.toml"),
        search("bending", "0.0"),
    )
    .unwrap();
    let (code, _, stderr) = outcome(&directory, &["run", "swings.toml", "--force"]);
    assert_eq!(code, 2);
    assert!(
        stderr.contains("no column `bending`") && stderr.contains("bending_energy_j"),
        "{stderr}"
    );
}

/// A small file system in memory, gone when dropped; `None` where this user may not mount one.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn mount(size: &str) -> Option<Self> {
        let place = tempfile::tempdir().unwrap();
        let mounted = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"])
            .arg(place.path())
            .stderr(Stdio::null())
            .status();
        mounted
            .is_ok_and(|status| status.success())
            .then_some(Self(place))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let unmounted = std::process::Command::new("umount")
            .arg(self.0.path())
            .status();
        assert!(unmounted.is_ok_and(|status| status.success()));
    }
}

#[test]
fn a_full_disk_ends_the_sweep_with_1_and_with_room_the_same_command_completes_it() {
    let Some(disk) = SmallDisk::mount("400k") else {
        eprintln!("SKIPPED: a full disk needs a small file system, and only root can mount one");
        return;
    };
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let out = disk.0.path().join("results");
    let run = [
        "run",
        "swings.toml",
        "--jobs",
        "1",
        "--out",
        out.to_str().unwrap(),
    ];
    // Somebody else's file, to be removed later.
    let ballast = disk.0.path().join("ballast");
    fs::write(&ballast, vec![1; 200 << 10]).unwrap();
    let (code, _, stderr) = outcome(&directory, &run);
    assert_eq!(code, 1, "{stderr}");
    assert!(stderr.contains("No space left on device"), "{stderr}");
    // Every case that was finished is whole.
    let mut finished = 0;
    for case in fs::read_dir(out.join("cases")).unwrap() {
        let case = case.unwrap().path();
        if case.join("manifest.json").exists()
            && manifest(&case)["cases"]["main"]["status"] == "finished"
        {
            let name = Path::new("cases")
                .join(case.file_name().unwrap())
                .join("series.csv");
            assert!(fs::read(case.join("series.csv")).unwrap() == expected[&name]);
            finished += 1;
        }
    }
    assert!(finished > 0, "the disk was full too early to show anything");
    fs::remove_file(ballast).unwrap();
    let grown = std::process::Command::new("mount")
        .args(["-o", "remount,size=20m"])
        .arg(disk.0.path())
        .status();
    assert!(grown.unwrap().success());
    succeed(&directory, &run);
    assert_same(&tables(&out), &expected);
}
