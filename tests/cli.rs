//! The program from outside: exit codes, standard output, and the files that it leaves.

use assert_cmd::Command;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A short swing of a short rod.
const SWING: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "20 ms", scheme = "implicit-euler" }
output = { interval = "5 ms" }

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

/// Another rod across the first one, which it initially overlaps.
const ACROSS: &str = r#"
[[rods]]
name = "across"
radius = "5 mm"
edges = 8
shape = { kind = "straight", start = [0.1, -0.1, 0.008], end = [0.1, 0.1, 0.008] }

[contact]
"#;

fn rodlab(directory: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    command.current_dir(directory);
    command
}

/// A directory with a scenario `swing.toml`.
fn directory(text: &str) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("swing.toml"), text).unwrap();
    directory
}

/// Runs the program; returns exit code, standard output and standard error.
fn outcome(directory: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let output = rodlab(directory.path()).args(arguments).output().unwrap();
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

fn file_names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_reports_its_results_directory_and_is_not_repeated() {
    let directory = directory(SWING);
    let (code, stdout, stderr) = outcome(&directory, &["run", "swing.toml"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.starts_with("finished\n"), "{stdout}");
    assert!(stdout.contains("results/swing\n"), "{stdout}");
    assert!(stdout.contains("20\n"), "{stdout}");
    let results = directory.path().join("results/swing");
    for name in [
        "manifest.json",
        "scenario.toml",
        "series.csv",
        "nodes.csv",
        "summary.csv",
    ] {
        assert!(results.join(name).is_file(), "{name}");
    }
    let series = fs::read(results.join("series.csv")).unwrap();
    let (code, stdout, _) = outcome(&directory, &["run", "swing.toml"]);
    assert_eq!(code, 0);
    assert!(stdout.starts_with("already finished"), "{stdout}");
    let (code, stdout, _) = outcome(
        &directory,
        &["run", "swing.toml", "--force", "--threads", "2"],
    );
    assert_eq!(code, 0);
    assert!(stdout.starts_with("finished\n"), "{stdout}");
    assert_eq!(fs::read(results.join("series.csv")).unwrap(), series);
}

#[test]
fn the_scenario_in_the_results_gives_the_same_results() {
    let directory = directory(SWING);
    assert_eq!(
        outcome(&directory, &["run", "swing.toml", "--out", "first"]).0,
        0
    );
    let (code, _, stderr) = outcome(
        &directory,
        &["run", "first/scenario.toml", "--out", "second"],
    );
    assert_eq!((code, stderr.as_str()), (0, ""));
    let read = |name: &str| fs::read(directory.path().join(name)).unwrap();
    assert_eq!(read("first/nodes.csv"), read("second/nodes.csv"));
    assert_eq!(read("first/series.csv"), read("second/series.csv"));
}

#[test]
fn results_of_another_scenario_are_refused() {
    let directory = directory(SWING);
    assert_eq!(outcome(&directory, &["run", "swing.toml"]).0, 0);
    let before = fs::read(directory.path().join("results/swing/nodes.csv")).unwrap();
    let thicker = ["run", "swing.toml", "--set", "rods.rope.radius=6 mm"];
    let (code, stdout, stderr) = outcome(&directory, &thicker);
    assert_eq!((code, stdout.as_str()), (2, ""));
    assert!(stderr.contains("another scenario"), "{stderr}");
    let key = "\n  rods.rope.radius: 0.005, now 0.006\n";
    assert!(stderr.contains(key), "{stderr}");
    let after = fs::read(directory.path().join("results/swing/nodes.csv")).unwrap();
    assert_eq!(before, after);
}

#[test]
fn a_new_title_or_fewer_files_need_no_force() {
    let directory = directory(SWING);
    let run = |set: &str| outcome(&directory, &["run", "swing.toml", "--set", set]);
    assert_eq!(run("output.vtk=true").0, 0);
    for set in ["title=Swinging", "output.vtk=false"] {
        let (code, stdout, stderr) = run(set);
        assert_eq!(code, 0, "{stderr}");
        assert!(stdout.starts_with("already finished"), "{stdout}");
    }
    // Missing outputs cannot be added to a finished run.
    let (code, _, stderr) = run("output.forces=true");
    assert_eq!(code, 2);
    assert!(
        stderr.contains("output.forces: false, now true"),
        "{stderr}"
    );
}

const HANG: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
rods = [{ name = "rope", radius = "5 mm", edges = 12, shape = { kind = "straight", start = [0, 0, 0], end = [0.3, 0, 0] } }]
clamps = [{ rod = "rope", at = "start" }, { rod = "rope", at = "end", hold = "position" }]
loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
time = { mode = "static" }
"#;

const RELEASE: &str = r#"
extends = "hang.toml"
clamps = [{ rod = "rope", at = "start" }]
start = { from = "results/hang" }
time = { mode = "dynamic", end = "50 ms", step = "1 ms" }
output = { interval = "10 ms" }
"#;

#[test]
fn a_run_starts_from_the_end_of_another() {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in [("hang", HANG), ("release", RELEASE)] {
        fs::write(directory.path().join(format!("{name}.toml")), text).unwrap();
    }
    let (code, _, stderr) = outcome(&directory, &["run", "release.toml"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("results/hang"), "{stderr}");
    for name in ["hang.toml", "release.toml"] {
        let (code, _, stderr) = outcome(&directory, &["run", name]);
        assert_eq!((code, stderr.as_str()), (0, ""));
    }
    let rows = |place: &str| -> Vec<Vec<String>> {
        let nodes = directory.path().join(place).join("nodes.csv");
        let mut reader = csv::Reader::from_path(nodes).unwrap();
        let rows = reader.records().map(|row| row.unwrap());
        rows.map(|row| row.iter().map(str::to_owned).collect())
            .collect()
    };
    let (hung, released) = (rows("results/hang"), rows("results/release"));
    for (before, after) in hung.iter().zip(&released) {
        assert_eq!(before[3..6], after[3..6]);
    }
    let height = |row: &[String]| row[5].parse::<f64>().unwrap();
    assert!(height(&released[released.len() - 1]) < height(&hung[12]) - 5e-3);
    // The rod, clamped again at both ends, is at rest.
    let (code, _, stderr) = outcome(
        &directory,
        &[
            "run",
            "hang.toml",
            "--set",
            "start.from=results/hang",
            "--out",
            "results/again",
        ],
    );
    assert_eq!((code, stderr.as_str()), (0, ""));
    for (before, after) in hung.iter().zip(&rows("results/again")) {
        for axis in 3..6 {
            let [before, after] = [before, after].map(|row| row[axis].parse::<f64>().unwrap());
            assert!((before - after).abs() < 1e-9, "{before} {after}");
        }
    }
    // The scenario in the results can be run again, even if the first run was moved or removed.
    fs::remove_dir_all(directory.path().join("results/hang")).unwrap();
    let again = ["run", "results/release/scenario.toml", "--out", "copy"];
    assert_eq!(outcome(&directory, &again).0, 0);
    assert_eq!(rows("copy"), released);
    let start = directory.path().join("results/release/start_state.csv");
    let text = fs::read_to_string(&start).unwrap();
    fs::write(&start, text.replacen("rope,5,", "rope,5,0", 1)).unwrap();
    let (code, _, stderr) = outcome(&directory, &again);
    assert_eq!(code, 2);
    assert!(stderr.contains("its hash is"), "{stderr}");
    // A start from results with different rods is rejected.
    let (code, _, stderr) = outcome(
        &directory,
        &[
            "check",
            "release.toml",
            "--set",
            "start.from=results/release",
            "--set",
            "rods.rope.edges=13",
        ],
    );
    assert_eq!(code, 2);
    assert!(
        stderr.contains("`rope` of 13 nodes; needed: `rope` of 14 nodes"),
        "{stderr}"
    );
}

#[test]
fn bad_scenarios_exit_with_2_and_leave_nothing_behind() {
    for (from, to, place, words) in [
        (
            "radius = \"5 mm\"",
            "raduis = 1",
            "swing.toml:9:1",
            "did you mean `radius`?",
        ),
        (
            "radius = \"5 mm\"",
            "radius = -1",
            "swing.toml:9:10",
            "allowed: greater than 0",
        ),
        (
            "radius = \"5 mm\"",
            "radius = nan",
            "swing.toml:9:10",
            "not a finite number",
        ),
        (
            "radius = \"5 mm\"\n",
            "",
            "swing.toml:7:1",
            "missing key `radius`",
        ),
        (
            "edges = 8",
            "edges = \"8\"",
            "swing.toml:10:9",
            "expected a whole number",
        ),
        ("edges = 8", "edges = 0", "swing.toml:10:9", "allowed: 1 to"),
        (
            "step = \"1 ms\"",
            "step = 0",
            "swing.toml:4:17",
            "allowed: greater than 0",
        ),
        (
            "rod = \"rope\"",
            "rod = \"roap\"",
            "swing.toml:14:7",
            "did you mean `rope`?",
        ),
        (
            "at = \"start\"",
            "at = 9",
            "swing.toml:15:6",
            "allowed: 0 to 8",
        ),
        ("[[loads]]", "[[loads", "swing.toml", "not TOML"),
    ] {
        let directory = directory(&SWING.replacen(from, to, 1));
        for arguments in [["run", "swing.toml"], ["check", "swing.toml"]] {
            let (code, stdout, stderr) = outcome(&directory, &arguments);
            assert_eq!((code, stdout.as_str()), (2, ""), "{to}: {stderr}");
            // The renderer of messages may insert line breaks.
            let stderr = stderr.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(stderr.contains(place), "{place} in {stderr}");
            assert!(stderr.contains(words), "{words} in {stderr}");
        }
        assert_eq!(file_names(directory.path()), ["swing.toml"]);
    }
}

#[test]
fn rods_that_start_inside_each_other_are_refused() {
    let directory = directory(&format!("{SWING}{ACROSS}"));
    for arguments in [["run", "swing.toml"], ["check", "swing.toml"]] {
        let (code, stdout, stderr) = outcome(&directory, &arguments);
        assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
        assert!(
            stderr.contains("across") && stderr.contains("rope"),
            "{stderr}"
        );
    }
    assert_eq!(file_names(directory.path()), ["swing.toml"]);
}

#[test]
fn places_that_cannot_be_written_are_refused() {
    let directory = directory(SWING);
    fs::write(directory.path().join("taken"), "a file").unwrap();
    let (code, _, stderr) = outcome(&directory, &["run", "swing.toml", "--out", "taken"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("taken"), "{stderr}");
    fs::create_dir(directory.path().join("photographs")).unwrap();
    fs::write(directory.path().join("photographs/cat.png"), "meow").unwrap();
    let (code, _, stderr) = outcome(&directory, &["run", "swing.toml", "--out", "photographs"]);
    assert_eq!(code, 2, "{stderr}");
    assert_eq!(
        file_names(&directory.path().join("photographs")),
        ["cat.png"]
    );
}

#[test]
fn a_time_limit_ends_with_5_and_the_same_command_continues() {
    let directory = directory(SWING);
    let long = ["run", "swing.toml", "--set", "time.end=20", "--out", "long"];
    let limited: Vec<&str> = long.iter().copied().chain(["--timeout", "1 ms"]).collect();
    let (code, stdout, stderr) = outcome(&directory, &limited);
    assert_eq!((code, stdout.as_str()), (5, ""), "{stderr}");
    assert!(stderr.contains("time limit"), "{stderr}");
    let (code, stdout, stderr) = outcome(&directory, &long);
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.starts_with("finished, continued from"), "{stdout}");
    let whole = [
        "run",
        "swing.toml",
        "--set",
        "time.end=20",
        "--out",
        "whole",
    ];
    assert_eq!(outcome(&directory, &whole).0, 0);
    for name in ["nodes.csv", "series.csv"] {
        let read = |place: &str| fs::read(directory.path().join(place).join(name)).unwrap();
        assert_eq!(read("long"), read("whole"), "{name}");
    }
}

#[test]
fn a_dry_run_prints_the_resolved_scenario_and_writes_nothing() {
    let directory = directory(SWING);
    let (code, stdout, _) = outcome(&directory, &["run", "swing.toml", "--dry-run"]);
    assert_eq!(code, 0);
    assert!(stdout.contains("youngs_modulus = 1000000.0"), "{stdout}");
    assert_eq!(file_names(directory.path()), ["swing.toml"]);
}

#[test]
fn check_reads_all_files_and_prints_json() {
    let directory = directory(SWING);
    fs::write(directory.path().join("bad.toml"), "experiment = 3").unwrap();
    let (code, stdout, stderr) = outcome(
        &directory,
        &["check", "bad.toml", "swing.toml", "none.toml"],
    );
    assert_eq!(code, 2);
    assert!(stdout.contains("swing.toml: valid"), "{stdout}");
    assert!(
        stderr.contains("bad.toml:1:14") && stderr.contains("none.toml"),
        "{stderr}"
    );
    let (code, stdout, _) = outcome(&directory, &["check", "swing.toml", "--json"]);
    assert_eq!(code, 0);
    let numbers: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(numbers["rods"][0]["nodes"], 9);
    // A short run is tried completely.
    assert_eq!(numbers["cost"]["part"], 1.0);
    assert!(numbers["cost"]["processor_time"].is_number());
}

#[test]
fn templates_run_as_they_stand() {
    let directory = directory(SWING);
    for experiment in ["scene", "flagella"] {
        let (code, template, _) = outcome(&directory, &["init", experiment]);
        assert_eq!(code, 0);
        fs::write(directory.path().join("template.toml"), template).unwrap();
        let short = [
            "run",
            "template.toml",
            "--set",
            "time.end=2 ms",
            "--set",
            "output.interval=1 ms",
            "--force",
        ];
        let (code, _, stderr) = outcome(&directory, &short);
        assert_eq!((code, stderr.as_str()), (0, ""), "{experiment}");
    }
}

#[test]
fn arguments_are_checked() {
    let directory = directory(SWING);
    for arguments in [
        &["run"][..],
        &["rnu", "swing.toml"],
        &["run", "swing.toml", "--threads", "0"],
        &["run", "swing.toml", "--timeout", "3 m"],
        &["run", "swing.toml", "--set", "time"],
        &["init", "knot"],
        &["explain", "kontakt"],
    ] {
        let (code, stdout, stderr) = outcome(&directory, arguments);
        assert_eq!((code, stdout.as_str()), (2, ""), "{arguments:?}: {stderr}");
        assert!(!stderr.is_empty());
    }
    assert_eq!(file_names(directory.path()), ["swing.toml"]);
}

#[test]
fn schema_explanations_and_completions_are_printed() {
    let directory = directory(SWING);
    let (code, stdout, _) = outcome(&directory, &["schema"]);
    assert_eq!(code, 0);
    let schema: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!(schema["properties"]["rods"].is_object());
    assert_eq!(schema["additionalProperties"], false);
    let (code, stdout, _) = outcome(&directory, &["explain", "rods.radius"]);
    assert_eq!(code, 0);
    assert!(stdout.contains("radius"), "{stdout}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (code, stdout, _) = outcome(&directory, &["completions", shell]);
        assert_eq!(code, 0);
        assert!(stdout.contains("rodlab"), "{stdout}");
    }
    let (code, _, _) = outcome(&directory, &["man", "pages"]);
    assert_eq!(code, 0);
    for page in ["rodlab.1", "rodlab-run.1", "rodlab-plan-deployment.1"] {
        assert!(
            directory.path().join("pages").join(page).is_file(),
            "{page}"
        );
    }
}

#[test]
fn shells_complete_presets_files_topics_pages_and_keys() {
    let directory = directory(SWING);
    for (words, expected) in [
        (&["run", "flagella_q"][..], "flagella_quick"),
        (&["run", "sw"], "swing.toml"),
        (&["deploy", "--rod", "green"], "green_vps"),
        (&["deploy", "--pattern", "tref"], "trefoil"),
        (&["guide", "exit"], "exit-codes"),
        (&["reproduce", "tab2"], "tab2.1"),
        (&["explain", "time.st"], "time.step"),
        (&["explain", "series.csv"], "series.csv"),
        (&["explain", "nodes.theta"], "nodes.theta_rad"),
        (&["presets", "show", "flagella_q"], "flagella_quick"),
        (&["init", "rod", "--like", "green"], "green_vps"),
        (&["run", "swing.toml", "--set", "time.st"], "time.step="),
        (&["run", "swing.toml", "--vary", "time.st"], "time.step="),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .env("COMPLETE", "bash")
            .env("_CLAP_COMPLETE_INDEX", words.len().to_string())
            .env("_CLAP_COMPLETE_COMP_TYPE", "9")
            .env("_CLAP_COMPLETE_SPACE", "false")
            .env("IFS", "\n")
            .args(["--", "rodlab"])
            .args(words)
            .current_dir(directory.path())
            .output()
            .unwrap();
        let offered = String::from_utf8(output.stdout).unwrap();
        assert!(
            offered.lines().any(|line| line == expected),
            "{words:?}: {offered}"
        );
    }
}

#[test]
fn figures_are_drawn_from_results() {
    let directory = directory(SWING);
    assert_eq!(outcome(&directory, &["run", "swing.toml"]).0, 0);
    let (code, stdout, stderr) = outcome(&directory, &["plot", "results/swing"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.lines().count() >= 1);
    for path in stdout.lines() {
        assert!(directory.path().join(path).is_file(), "{path}");
    }
    assert_ne!(outcome(&directory, &["plot", "nowhere"]).0, 0);
}

#[test]
fn the_log_speaks_json() {
    let directory = directory(SWING);
    let (code, _, stderr) = outcome(&directory, &["run", "swing.toml", "--log", "json", "-v"]);
    assert_eq!(code, 0);
    for line in stderr.lines() {
        let entry: serde_json::Value = serde_json::from_str(line).unwrap();
        assert!(entry["level"].is_string(), "{line}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_or_closed_standard_error_changes_no_exit_code() {
    let directory = directory(SWING);
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    let closed = || std::io::pipe().unwrap().1;
    let code = |arguments: &[&str], stderr: std::process::Stdio| {
        let status = std::process::Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(directory.path())
            .args(arguments)
            .stdout(std::process::Stdio::null())
            .stderr(stderr)
            .status();
        status.unwrap().code()
    };
    for arguments in [
        &["check", "none.toml"][..],
        &["plot", "."],
        &["run", "-vv", "none.toml"],
    ] {
        assert_eq!(code(arguments, full().into()), Some(2), "{arguments:?}");
        assert_eq!(code(arguments, closed().into()), Some(2), "{arguments:?}");
    }
    let limited = [
        "run",
        "-vv",
        "swing.toml",
        "--set",
        "time.end=4000",
        "--timeout",
        "0.3",
    ];
    assert_eq!(code(&limited, full().into()), Some(5));
    assert_eq!(code(&limited, closed().into()), Some(5));
}

#[test]
fn ten_thousand_threads_are_refused_before_they_start() {
    let directory = directory(SWING);
    for option in ["--threads", "--jobs"] {
        let (code, _, stderr) = outcome(&directory, &["run", "swing.toml", option, "10000"]);
        assert_eq!(code, 2, "{stderr}");
        assert!(
            stderr.contains(&format!("{option} 10000 is out of range")),
            "{stderr}"
        );
    }
}

#[test]
#[cfg(target_os = "linux")]
fn endless_inputs_are_refused() {
    let clamp = "at = \"start\"\n";
    let endless = format!("{clamp}follow = \"/dev/zero\"\n");
    let directory = directory(&SWING.replace(clamp, &endless));
    for scenario in ["/dev/zero", "swing.toml"] {
        let (code, _, stderr) = outcome(&directory, &["check", scenario]);
        assert_eq!(code, 2, "{stderr}");
        let words = stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("regular files"), "{stderr}");
    }
}

#[test]
fn a_run_prints_its_outcome_as_json() {
    let directory = directory(SWING);
    let json = |arguments: &[&str]| -> serde_json::Value {
        let (code, stdout, stderr) = outcome(&directory, arguments);
        assert_eq!(code, 0, "{stderr}");
        serde_json::from_str(&stdout).unwrap_or_else(|error| panic!("{error}: {stdout}"))
    };
    let once = json(&["run", "swing.toml", "--json"]);
    assert_eq!(
        (&once["status"], &once["already_finished"]),
        (&"finished".into(), &false.into())
    );
    assert_eq!(once["outcome"]["simulated_time"], 0.02);
    let again = json(&["run", "swing.toml", "--json"]);
    assert_eq!(again["already_finished"], true);
    assert_eq!(again["outcome"], once["outcome"]);
    let sweep = json(&[
        "run",
        "swing.toml",
        "--json",
        "--vary",
        "rods.rope.edges=4,6",
        "--out",
        "s",
    ]);
    assert_eq!(sweep["cases"]["finished"], 2);
}

#[test]
fn an_unclosed_bracket_is_one_fault_on_its_line() {
    let directory = directory(&SWING.replace("start = [0, 0, 0], end", "start = [0, 0, 0, end"));
    let (code, _, stderr) = outcome(&directory, &["check", "swing.toml"]);
    assert_eq!(code, 2);
    assert_eq!(stderr.matches("not TOML").count(), 1, "{stderr}");
    assert!(stderr.contains("swing.toml:11:"), "{stderr}");
    assert!(stderr.contains("is not closed"), "{stderr}");
}

#[test]
fn presets_replace_missing_files() {
    let folder = tempfile::tempdir().unwrap();
    let cache = tempfile::tempdir().unwrap();
    let outcome = |arguments: &[&str]| {
        let mut command = rodlab(folder.path());
        command.env("XDG_CACHE_HOME", cache.path());
        let output = command.args(arguments).output().unwrap();
        let [stdout, stderr] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        (output.status.code().unwrap(), stdout, stderr)
    };
    let short = ["--set", "time.end=0.01"];
    // A folder with the name of a preset may contain results.
    std::fs::create_dir(folder.path().join("flagella_quick")).unwrap();
    // This preset extends another preset.
    let (code, _, stderr) = outcome(&[&["run", "flagella_quick"], &short[..]].concat());
    assert_eq!((code, stderr.contains("preset")), (0, false), "{stderr}");
    assert!(
        folder
            .path()
            .join("results/flagella_quick/manifest.json")
            .is_file()
    );
    let (code, _, stderr) = outcome(&[&["run", "scenarios/flagella_m2.toml"], &short[..]].concat());
    assert_eq!(
        (code, stderr.contains("using the preset `flagella_m2`")),
        (0, true),
        "{stderr}"
    );
    let (code, stdout, _) = outcome(&["check", "gantry", "net"]);
    assert_eq!(code, 0, "{stdout}");
    let (code, _, stderr) = outcome(&["run", "flagela_quick"]);
    assert_eq!(
        (code, stderr.contains("preset is `flagella_quick`")),
        (2, true),
        "{stderr}"
    );
    let plan = [
        "plan",
        "deployment",
        "--pattern",
        "U",
        "--rod",
        "rope",
        "--out",
        "plan",
    ];
    let (code, _, stderr) = outcome(&plan);
    assert_eq!(code, 0, "{stderr}");

    let (code, list, _) = outcome(&["presets", "rod"]);
    assert_eq!(
        (code, list.contains("Green VPS"), list.contains("gantry")),
        (0, true, false)
    );
    let (_, shown, _) = outcome(&["presets", "show", "rope"]);
    let (_, begun, _) = outcome(&["init", "rod", "--like", "rope"]);
    assert!(shown.contains("title = \"Rope\"") && shown == begun);
    // A preset that extends another one is written in full.
    let (code, whole, stderr) = outcome(&["init", "flagella", "--like", "flagella_m2"]);
    assert_eq!((code, whole.contains("extends =")), (0, false), "{stderr}");
    std::fs::write(folder.path().join("whole.toml"), whole).unwrap();
    let (code, _, stderr) = outcome(&["check", "whole.toml"]);
    assert_eq!(code, 0, "{stderr}");
    let refused: [(&[&str], &str); 3] = [
        (&["presets", "show", "trefoil"], "--kind: scenario, pattern"),
        (
            &["init", "scene", "--like", "trefoil"],
            "rodlab init knot-tightening --like trefoil",
        ),
        (
            &["init", "scene", "--like", "flagella_m2"],
            "rodlab init flagella --like flagella_m2",
        ),
    ];
    for (arguments, reason) in refused {
        let (code, _, stderr) = outcome(arguments);
        assert_eq!((code, stderr.contains(reason)), (2, true), "{stderr}");
    }
}
