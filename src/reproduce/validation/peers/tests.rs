//! Programs that are installed, absent or broken, with a Python that only answers.

use super::super::BENCHMARKS;
use super::super::benchmark::Row;
use super::*;
use std::collections::BTreeSet;
use std::fs;

/// The case of a force at the tip.
fn tip_force() -> &'static Benchmark {
    let mut all = BENCHMARKS.iter();
    all.find(|case| stem(case.name) == "tip-force")
        .expect("the case exists")
}

/// A finished run in a folder.
fn case(folder: &Path) -> Case<BenchmarkRun> {
    use crate::reproduce::ReproduceOptions;
    use crate::reproduce::cases::run_all;
    let options = ReproduceOptions {
        directory: folder.to_owned(),
        quick: true,
        jobs: 1,
        command_line: Vec::new(),
        figures: rodlab_files::figure::FigureOptions::default(),
    };
    let runs = tip_force().runs(true);
    run_all(&runs[..1], &options, &|_| {}).unwrap().remove(0)
}

/// Writes a Python that finds only modules of a name, and prints `output` for each script.
#[cfg(unix)]
fn fake_python(folder: &Path, module: &str, output: &str) -> OsString {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("python3");
    let text = format!(
        "#!/bin/sh\nif [ \"$1\" = -c ]; then [ \"$3\" = {module} ]; exit; fi\n\
         echo run >> '{}'\ncat <<'END'\n{output}\nEND\n",
        folder.join("runs").display()
    );
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path.into()
}

#[cfg(unix)]
#[test]
fn a_program_that_is_installed_is_run_once() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [case(folder.path())];
    let peer = peers_of("tip-force").next().unwrap();
    let line = r#"{"version": "1.2", "quantity": "deflection w/L", "value": 0.81, "time": 0.5}"#;
    let python = fake_python(folder.path(), peer.program.module, line);
    for _ in 0..2 {
        let Outcome::Rows(rows) = peer.rows(tip_force(), &cases, &python).unwrap() else {
            panic!("the run has rows");
        };
        assert_eq!(rows.len(), 1);
        assert_eq!((rows[0].version.as_str(), rows[0].edges), ("1.2", 20));
        assert!((rows[0].error + 8.5e-4).abs() < 1e-5, "{}", rows[0].error);
    }
    let runs = fs::read_to_string(folder.path().join("runs")).unwrap();
    assert_eq!(runs, "run\n");
    // What an earlier call left is shown without the program.
    let absent = OsStr::new("no-such-python");
    let outcome = peer.rows(tip_force(), &cases, absent).unwrap();
    assert!(matches!(outcome, Outcome::Rows(_)), "{outcome:?}");
}

#[cfg(unix)]
#[test]
fn a_program_that_is_absent_or_fails_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [case(folder.path())];
    for peer in peers_of("tip-force") {
        let package = peer.program.package;
        let python = fake_python(folder.path(), "another", "");
        for python in [python.as_os_str(), OsStr::new("no-such-python")] {
            let outcome = peer.rows(tip_force(), &cases, python).unwrap();
            assert_eq!(outcome, Outcome::Absent);
            let note = peer.note(&outcome);
            assert!(note.contains(&format!("`pip install {package}`")), "{note}");
        }
    }
    let peer = peers_of("tip-force").next().unwrap();
    let python = fake_python(folder.path(), peer.program.module, "not JSON");
    let outcome = peer.rows(tip_force(), &cases, &python).unwrap();
    assert_eq!(outcome, Outcome::Failed("not JSON".into()));
}

#[test]
fn scripts_and_reasons_are_those_of_cases() {
    let cases: BTreeSet<&str> = BENCHMARKS.iter().map(|case| stem(case.name)).collect();
    let mut scripts = BTreeSet::new();
    for peer in PEERS {
        assert!(cases.contains(peer.case), "{}", peer.case);
        assert!(scripts.insert(peer.script.0), "{}", peer.script.0);
        assert!(peer.script.0.starts_with(peer.case), "{}", peer.script.0);
        for (name, text) in peer.files() {
            assert!(text.starts_with("\"\"\""), "{name} has no description");
            assert!(
                text.lines().all(|line| line.chars().count() <= 110),
                "{name}"
            );
        }
    }
    for (of, ..) in LEFT_OUT {
        assert!(of.iter().all(|case| cases.contains(case)), "{of:?}");
    }
}

#[test]
fn a_better_program_is_named_with_what_is_better() {
    let own = |edges, error, time| Row {
        case: "tip-force".into(),
        quantity: "w".into(),
        edges,
        value: 1.0,
        exact: 1.0,
        error,
        order: None,
        published: None,
        published_accuracy: None,
        cpu_time_s: Some(time),
    };
    let peer = |edges, error, time| PeerRow {
        case: "tip-force".into(),
        program: "Other".into(),
        version: "1".into(),
        quantity: "w".into(),
        edges,
        value: 1.0,
        exact: 1.0,
        error,
        cpu_time_s: time,
    };
    let rows = [own(20, 4e-3, 1.0), own(40, -1e-3, 2.0)];
    assert_eq!(
        verdict(&rows, &[peer(20, 5e-3, 0.1), peer(40, 2e-3, 3.0)]),
        ""
    );
    assert_eq!(
        verdict(&rows, &[peer(40, 5e-4, 3.0)]),
        "Other is more accurate at the same number of edges: w (an error of 5.0e-4, not 1.0e-3, with 40 edges)."
    );
    assert_eq!(
        verdict(&rows, &[peer(80, -1e-3, 1.5)]),
        "Other is faster at the same error or a smaller one: w (an error of 1.0e-3 in 1.500 s, not 1.0e-3 in 2.000 s)."
    );
    let best = [peer(20, 1.0, 0.1), peer(40, 2.0, 0.2)];
    assert_eq!(best_of_peers(&rows[0], &best), [&best[1]]);
}
