//! Faults during a run: steps without a solution, full disks, corrupt or missing files.

use super::*;

#[test]
fn damaged_checkpoints_fall_back_to_the_older_one_and_then_to_the_start() {
    let directory = tempfile::tempdir().unwrap();
    interrupt(directory.path(), 10);
    interrupt(directory.path(), 10);
    let newest = directory.path().join("checkpoint.1");
    fs::write(&newest, &fs::read(&newest).unwrap()[1..]).unwrap();
    let outcome = interrupt(directory.path(), 0);
    assert!(
        matches!(outcome, RunError::Interrupted { reached: Reached::Time(time), .. } if time > 0.0 && time < 0.35)
    );
    for slot in ["checkpoint.0", "checkpoint.1"] {
        fs::write(directory.path().join(slot), "rubbish").unwrap();
    }
    let outcome = go_on(directory.path()).unwrap();
    assert_eq!(outcome.status, RunStatus::Finished);
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn no_convergence_leaves_a_checkpoint_and_exit_code_3() {
    let directory = tempfile::tempdir().unwrap();
    let mut failing = Pendulum::new();
    failing.fails_at = Some(0.55);
    let options = quiet(directory.path());
    let error = run_simulation(&mut failing, &prepared(DYNAMIC), &options, &|| None).unwrap_err();
    assert!(matches!(
        &error,
        RunError::Simulation {
            source: SimulationError::NoConvergence { .. },
            ..
        }
    ));
    let message = error.to_string();
    assert!(
        message.contains("bending") && message.contains("results up to there"),
        "{message}"
    );
    assert_eq!(status(directory.path()), CaseStatus::NoConvergence);
    let outcome = go_on(directory.path()).unwrap();
    assert!(
        matches!(outcome.status, RunStatus::Resumed { from } if from >= Reached::Time(0.55)),
        "{outcome:?}"
    );
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_ends_the_run_with_exit_code_1_and_can_be_resumed() {
    let directory = tempfile::tempdir().unwrap();
    interrupt(directory.path(), 0);
    let nodes = directory.path().join(NODES);
    fs::remove_file(&nodes).unwrap();
    std::os::unix::fs::symlink("/dev/full", &nodes).unwrap();
    for slot in ["checkpoint.0", "checkpoint.1"] {
        let _ = fs::remove_file(directory.path().join(slot));
    }
    let error = go_on(directory.path()).unwrap_err();
    assert!(matches!(error, RunError::Results(_)), "{error}");
    assert!(error.to_string().contains(NODES), "{error}");
    assert_eq!(status(directory.path()), CaseStatus::Failed);
    fs::remove_file(&nodes).unwrap();
    go_on(directory.path()).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

/// Corrupts a file in two ways, deletes it and then flips a bit, and calls `check` each time.
/// Restores the file at the end.
fn spoilt(path: &Path, check: impl Fn(&str)) {
    let whole = fs::read(path).unwrap();
    fs::remove_file(path).unwrap();
    check("is missing");
    let mut garbled = whole.clone();
    let middle = garbled.len() / 2;
    garbled[middle] ^= 1;
    fs::write(path, garbled).unwrap();
    check("does not hold what was written");
    fs::write(path, whole).unwrap();
}

const GROWING: [&str; 4] = [SERIES, NODES, NODE_FORCES, "vtk/rods_000002.vtp"];

#[test]
fn missing_and_garbled_files_are_detected_when_a_run_resumes() {
    let directory = tempfile::tempdir().unwrap();
    interrupt(directory.path(), 20);
    for name in GROWING {
        spoilt(&directory.path().join(name), |what| {
            let error = go_on(directory.path()).unwrap_err();
            assert!(matches!(error, RunError::Results(_)), "{error}");
            assert!(error.to_string().contains(what), "{name}: {error}");
        });
    }
    go_on(directory.path()).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn missing_and_garbled_files_are_detected_before_a_run_counts_as_finished() {
    let directory = uninterrupted();
    for name in GROWING {
        spoilt(&directory.path().join(name), |what| {
            let error = go_on(directory.path()).unwrap_err();
            assert!(error.to_string().contains(what), "{name}: {error}");
            assert!(error.to_string().contains("--force"), "{error}");
        });
    }
    let outcome = go_on(directory.path()).unwrap();
    assert_eq!(outcome.status, RunStatus::AlreadyFinished);
}

#[test]
fn series_deleted_during_a_run_are_not_called_finished() {
    let directory = tempfile::tempdir().unwrap();
    let asked = AtomicUsize::new(0);
    let delete = || {
        if asked.fetch_add(1, Relaxed) == 20 {
            fs::remove_file(directory.path().join(SERIES)).unwrap();
        }
        None
    };
    let (prepared, options) = (prepared(DYNAMIC), quiet(directory.path()));
    let error = run_simulation(&mut Pendulum::new(), &prepared, &options, &delete).unwrap_err();
    assert!(
        error.to_string().contains("series.csv` was removed"),
        "{error}"
    );
    assert_eq!(status(directory.path()), CaseStatus::Failed);
    assert_eq!(go_on(directory.path()).unwrap().status, RunStatus::Finished);
}
