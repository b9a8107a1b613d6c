//! Stop requests during long work without checks: steps of enormous systems, and work between two
//! runs.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The distance of nodes is much smaller than the regularisation length, so that the fluid is
/// ill-conditioned. Its preconditioner takes minutes, during which time limits and signals used to
/// be ignored.
const NODES: &str = "rod.nodes=4000";
/// Time within which the program must end, however busy the machine is; far shorter than the step.
const SOON: Duration = Duration::from_secs(40);

fn rodlab(directory: &Path, arguments: &[&str]) -> Child {
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/flagella_base.toml");
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(directory)
        .args(["--quiet", "--threads", "1"])
        .args([arguments[0], scenario, "--set", NODES])
        .args(&arguments[1..])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Waits for the end of the program, which must come soon; returns the exit code and the output.
fn end_of(mut program: Child) -> (Option<i32>, String) {
    let start = Instant::now();
    while program.try_wait().unwrap().is_none() {
        if start.elapsed() > SOON {
            program.kill().unwrap();
            panic!("it does not end");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let output = program.wait_with_output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(text).unwrap())
}

fn terminate(program: &Child) {
    let kill = Command::new("kill")
        .args(["-TERM", &program.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
}

#[test]
fn time_limits_and_signals_end_a_step_that_takes_minutes() {
    let directory = tempfile::tempdir().unwrap();
    let run = ["run", "--out", "limited", "--timeout", "1 s"];
    let (code, text) = end_of(rodlab(directory.path(), &run));
    assert_eq!(code, Some(5), "{text}");
    assert!(text.contains("the same command"), "{text}");

    let program = rodlab(directory.path(), &["run", "--out", "interrupted"]);
    let manifest = directory.path().join("interrupted/manifest.json");
    while !manifest.exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    // Wait until the first step has started.
    std::thread::sleep(Duration::from_secs(1));
    terminate(&program);
    let (code, text) = end_of(program);
    assert_eq!(code, Some(130), "{text}");
}

#[test]
fn check_ends_a_trial_whose_first_step_takes_minutes() {
    let directory = tempfile::tempdir().unwrap();
    let (code, text) = end_of(rodlab(directory.path(), &["check"]));
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("of a trial"), "{text}");
}

/// A signal between the end of the first run and the next run used to be ignored, so that the work
/// continued for minutes.
#[test]
fn a_signal_between_two_runs_ends_a_reproduction() {
    let directory = tempfile::tempdir().unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(directory.path())
        .args(["reproduce", "tab5.3", "--quick"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let said = BufReader::new(program.stderr.take().unwrap());
    let mut lines = said.lines();
    let line = lines.next().unwrap().unwrap();
    assert!(line.contains("finished"), "{line}");
    terminate(&program);
    assert_eq!(end_of(program).0, Some(130));
}
