//! The program writes identical bytes for any number of threads and after any interruption.

use assert_cmd::Command;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// A weighted rod falls across another one in a viscous fluid, with friction. All kinds of forces
/// act at once.
const SCENARIO: &str = r#"
experiment = "scene"
title = "A rod falls across another"

[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 5000.0

[[rods]]
name = "below"
radius = "2 mm"
edges = 30
shape = { kind = "straight", start = [-0.1, 0, 0], end = [0.1, 0, 0] }

[[rods]]
name = "above"
radius = "2 mm"
edges = 30
shape = { kind = "straight", start = [0.01, -0.12, 0.005], end = [0.01, 0.08, 0.005] }

[[clamps]]
rod = "below"
at = "start"

[[clamps]]
rod = "below"
at = "end"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[contact]
model = "imc"
friction = 0.3

[fluid]
model = "rss"
viscosity = 0.01

[time]
step = "1 ms"
end = "0.4 s"

[output]
interval = "10 ms"
forces = true
"#;

fn rodlab(directory: &Path, arguments: &[&str]) -> Command {
    let scenario = directory.join("falling.toml");
    if !scenario.exists() {
        fs::write(&scenario, SCENARIO).unwrap();
    }
    let mut command = Command::cargo_bin("rodlab").unwrap();
    command
        .current_dir(directory)
        .args(["run", "falling.toml"])
        .args(arguments);
    command
}

fn assert_same_results(directory: &Path, one: &str, other: &str) {
    for name in [
        "series.csv",
        "nodes.csv",
        "node_forces.csv",
        "summary.csv",
        "scenario.toml",
    ] {
        let read = |results: &str| fs::read(directory.join(results).join(name)).unwrap();
        assert!(
            read(one) == read(other),
            "{name} differs between {one} and {other}"
        );
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    for threads in ["1", "2", "3"] {
        rodlab(directory.path(), &["--threads", threads, "--out", threads])
            .assert()
            .success();
    }
    assert_same_results(directory.path(), "1", "2");
    assert_same_results(directory.path(), "1", "3");
    let summary = fs::read_to_string(directory.path().join("1/summary.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(summary.as_bytes());
    let columns = reader.headers().unwrap().clone();
    let row = reader.records().next().unwrap().unwrap();
    let place = columns
        .iter()
        .position(|column| column == "steps_with_contact")
        .unwrap();
    let steps_with_contact: usize = row[place].parse().unwrap();
    assert!(
        steps_with_contact > 100,
        "the rods must touch for this to be a test: {summary}"
    );
}

#[test]
fn a_run_stopped_by_its_time_limit_again_and_again_gives_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    rodlab(directory.path(), &["--out", "whole"])
        .assert()
        .success();
    // A busy machine may need the time of the first pieces to start the program.
    let pieces = (1..1000)
        .find(|&piece| {
            let limit = format!("{:.3}", 0.02 * 1.01f64.powi(piece));
            let mut command = rodlab(directory.path(), &["--out", "pieces", "--timeout", &limit]);
            let output = command.output().unwrap();
            let code = output.status.code().unwrap();
            assert!(
                code == 0 || code == 5,
                "{}",
                String::from_utf8_lossy(&output.stderr)
            );
            code == 0
        })
        .expect("the run comes to its end");
    assert!(pieces > 1, "the run was never stopped");
    assert_same_results(directory.path(), "whole", "pieces");
}

#[test]
#[cfg(unix)]
fn signals_leave_a_checkpoint_from_which_the_run_continues_to_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    // The run is long enough for the signal to arrive in time on a busy machine.
    let longer = ["--set", "time.end=1 s", "--out"];
    let run = |out| rodlab(directory.path(), &[&longer[..], &[out]].concat());
    run("whole").assert().success();
    for (signal, out, code) in [
        ("-INT", "interrupted", 130),
        ("-TERM", "terminated", 130),
        // Signal of a closed terminal.
        ("-HUP", "hung_up", 130),
        // Shells and wrappers often forward the same signal twice.
        ("-TERM -TERM", "terminated_twice", 130),
        // Signal of batch systems that warn about the time limit.
        ("-USR1", "warned", 5),
    ] {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(directory.path())
            .args(["run", "falling.toml"])
            .args(longer)
            .arg(out)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // A checkpoint exists once there is an output after the initial one.
        let series = directory.path().join(out).join("series.csv");
        while fs::read_to_string(&series).map_or(0, |text| text.lines().count()) < 3 {
            std::thread::sleep(Duration::from_millis(1));
        }
        let kill = |signal| format!("kill {signal} {} || true", child.id());
        let kill = signal.split(' ').map(kill).collect::<Vec<_>>().join("; ");
        let sent = std::process::Command::new("sh")
            .args(["-c", &kill])
            .status()
            .unwrap();
        assert!(sent.success());
        assert_eq!(child.wait().unwrap().code(), Some(code));
        assert!(directory.path().join(out).join("checkpoint.0").exists());
        run(out).assert().success();
        assert_same_results(directory.path(), "whole", out);
    }
}
