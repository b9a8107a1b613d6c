//! Tests of the run loop with a test double in place of the mechanics.

mod faults;
mod pendulum;

use super::advance::Advance;
use super::*;
use crate::run::{Mode, OutputPlan};
use crate::test_support::{quiet, run_of_scene};
use pendulum::Pendulum;
use proptest::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::{ContactPair, Proximity};
use rodlab_engine::mechanics::dynamics::{Energies, Simulation, SimulationError, StepReport};
use rodlab_engine::mechanics::scene::{RodDescription, Scene, Start, Stiffness};
use rodlab_engine::mechanics::statics::{PathPlan, PathPoint, Tracer};
use rodlab_files::results::{
    CaseStatus, Frame, MANIFEST, Manifest, NODE_FORCES, NODES, SCENARIO, SERIES, SUMMARY, TIMINGS,
    VTK_COLLECTION,
};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

fn prepared(mode: Mode) -> PreparedRun {
    let stiffness = Stiffness {
        stretching: 1.0,
        bending: [1.0; 2],
        twisting: 1.0,
    };
    let nodes = vec![Vector3::zeros(), Vector3::x()];
    let rod = RodDescription {
        rotational_inertia_per_length: 1.0,
        ..RodDescription::uniform("pendulum", nodes, stiffness, 0.5, 1.0)
    };
    let scene = Scene {
        rods: vec![rod],
        ..Scene::default()
    };
    PreparedRun {
        title: "Driven pendulum".into(),
        output: OutputPlan {
            interval: 0.1,
            nodes: true,
            forces: true,
            contacts: false,
            vtk: true,
        },
        ..run_of_scene("pendulum", scene, mode, 0.1)
    }
}

const DYNAMIC: Mode = Mode::Dynamic {
    end: 1.0,
    settles: false,
};

fn go_on(directory: &Path) -> Result<RunOutcome, RunError> {
    run_simulation(
        &mut Pendulum::new(),
        &prepared(DYNAMIC),
        &quiet(directory),
        &|| None,
    )
}

/// A request to stop that comes after a number of steps.
fn after_steps(steps: usize) -> impl Fn() -> Option<StopRequest> + Sync {
    let asked = AtomicUsize::new(0);
    move || (asked.fetch_add(1, Relaxed) >= steps).then_some(StopRequest::Interrupt)
}

fn interrupt(directory: &Path, steps: usize) -> RunError {
    let (prepared, options) = (prepared(DYNAMIC), quiet(directory));
    run_simulation(
        &mut Pendulum::new(),
        &prepared,
        &options,
        &after_steps(steps),
    )
    .unwrap_err()
}

fn same_bytes(a: &Path, b: &Path) {
    for name in [
        SERIES,
        NODES,
        NODE_FORCES,
        SUMMARY,
        SCENARIO,
        VTK_COLLECTION,
        "vtk/rods_000007.vtp",
    ] {
        assert_eq!(
            fs::read(a.join(name)).unwrap(),
            fs::read(b.join(name)).unwrap(),
            "{name}"
        );
    }
}

fn status(directory: &Path) -> CaseStatus {
    Manifest::read(directory).unwrap().unwrap().cases[MAIN_CASE].status
}

fn uninterrupted() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    go_on(directory.path()).unwrap();
    directory
}

#[test]
fn a_run_hits_the_output_times_and_leaves_the_files_of_the_contract() {
    let directory = uninterrupted();
    let mut reader = csv::Reader::from_path(directory.path().join(SERIES)).unwrap();
    let rows: Vec<rodlab_files::results::SeriesRow> =
        reader.deserialize().map(Result::unwrap).collect();
    let times: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    assert_eq!(
        times,
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    );
    let steps: u64 = rows.iter().map(|row| row.steps).sum();
    let mut reader = csv::Reader::from_path(directory.path().join(SUMMARY)).unwrap();
    let summary: rodlab_files::results::SummaryRow = reader.deserialize().next().unwrap().unwrap();
    assert_eq!(summary.steps, steps);
    assert_eq!(summary.simulated_time_s, 1.0);
    let contact = summary.first_contact_s.unwrap();
    assert!(contact > 0.0 && summary.steps_with_contact > 0 && summary.steps_with_contact < steps);
    assert_eq!(summary.min_distance_ratio, summary.min_distance_m);
    let mut names: Vec<String> = fs::read_dir(directory.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = [
        ".lock",
        MANIFEST,
        NODE_FORCES,
        NODES,
        VTK_COLLECTION,
        SCENARIO,
        SERIES,
        SUMMARY,
        TIMINGS,
        "vtk",
    ];
    assert_eq!(names, expected);
}

#[test]
fn a_finished_run_is_left_alone_and_force_runs_it_again() {
    let directory = uninterrupted();
    let before = fs::read(directory.path().join(MANIFEST)).unwrap();
    let outcome = go_on(directory.path()).unwrap();
    assert_eq!(outcome.status, RunStatus::AlreadyFinished);
    assert_eq!(outcome.case.simulated_time, 1.0);
    assert_eq!(fs::read(directory.path().join(MANIFEST)).unwrap(), before);
    let options = RunOptions {
        force: true,
        ..quiet(directory.path())
    };
    let outcome =
        run_simulation(&mut Pendulum::new(), &prepared(DYNAMIC), &options, &|| None).unwrap();
    assert_eq!(outcome.status, RunStatus::Finished);
    assert_ne!(fs::read(directory.path().join(MANIFEST)).unwrap(), before);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn interrupted_and_continued_runs_equal_uninterrupted_ones(
        pieces in prop::collection::vec(0usize..30, 1..4)
    ) {
        let directory = tempfile::tempdir().unwrap();
        for steps in pieces {
            let (prepared, options) = (prepared(DYNAMIC), quiet(directory.path()));
            match run_simulation(&mut Pendulum::new(), &prepared, &options, &after_steps(steps)) {
                Ok(_) => break,
                Err(error) => {
                    let is_interrupted = matches!(error, RunError::Interrupted { .. });
                    prop_assert!(is_interrupted);
                    prop_assert_eq!(status(directory.path()), CaseStatus::Interrupted);
                }
            }
        }
        go_on(directory.path()).unwrap();
        same_bytes(directory.path(), uninterrupted().path());
    }
}

#[test]
fn a_killed_run_continues_from_its_last_checkpoint() {
    let directory = tempfile::tempdir().unwrap();
    interrupt(directory.path(), 20);
    // A later run got further and was killed in the middle of a row.
    for name in [SERIES, NODES] {
        let path = directory.path().join(name);
        let torn = [fs::read(&path).unwrap(), b"0.4,0.01,3,2".to_vec()].concat();
        fs::write(&path, torn).unwrap();
    }
    let outcome = go_on(directory.path()).unwrap();
    assert!(
        matches!(outcome.status, RunStatus::Resumed { from } if from > Reached::Time(0.3)),
        "{outcome:?}"
    );
    assert_eq!(
        Manifest::read(directory.path())
            .unwrap()
            .unwrap()
            .continuations,
        1
    );
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn the_time_limit_and_checkpoints_at_every_step_change_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let options = quiet(directory.path());
    let late = || Some(StopRequest::TimeLimit);
    let error =
        run_simulation(&mut Pendulum::new(), &prepared(DYNAMIC), &options, &late).unwrap_err();
    assert!(matches!(error, RunError::TimeLimit { .. }));
    assert_eq!(status(directory.path()), CaseStatus::TimeLimit);
    let options = RunOptions {
        checkpoint_every: Duration::ZERO,
        ..quiet(directory.path())
    };
    run_simulation(&mut Pendulum::new(), &prepared(DYNAMIC), &options, &|| None).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn a_step_that_takes_long_is_stopped_halfway_without_a_trace() {
    let directory = tempfile::tempdir().unwrap();
    // The callback is called before each step, and during it.
    for asked in [1, 3, 6] {
        let (prepared, options) = (prepared(DYNAMIC), quiet(directory.path()));
        let mut slow = Pendulum::new();
        slow.pause = Duration::from_millis(60);
        let error =
            run_simulation(&mut slow, &prepared, &options, &after_steps(asked)).unwrap_err();
        assert!(matches!(error, RunError::Interrupted { .. }));
    }
    go_on(directory.path()).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn a_static_run_writes_one_row_at_time_zero() {
    let directory = tempfile::tempdir().unwrap();
    let options = quiet(directory.path());
    let mut simulation = Pendulum::new();
    let outcome =
        run_simulation(&mut simulation, &prepared(Mode::Static), &options, &|| None).unwrap();
    assert_eq!(outcome.case.newton_iterations_mean(), Some(7.0));
    let series = fs::read_to_string(directory.path().join(SERIES)).unwrap();
    assert_eq!(series.lines().count(), 2);
    assert!(
        series.lines().nth(1).unwrap().starts_with("0.0,,1,7.0,"),
        "{series}"
    );
    let nodes = fs::read_to_string(directory.path().join(NODES)).unwrap();
    assert_eq!(nodes.lines().nth(2), Some("0.0,pendulum,1,0.0,0.0,-1.0,"));
}

#[test]
fn results_can_be_plotted() {
    let directory = uninterrupted();
    let figures = crate::report::plot_results(directory.path(), &Default::default()).unwrap();
    assert_eq!(figures.len(), 4);
    let rods = fs::read_to_string(&figures[0]).unwrap();
    assert!(
        ["t = 0 s", "t = 0.3 s", "t = 0.6 s", "t = 1 s"]
            .iter()
            .all(|title| rods.contains(title)),
        "{rods}"
    );
    let series = fs::read_to_string(&figures[2]).unwrap();
    assert!(
        ["kinetic", "gravitational", "Newton iterations"]
            .iter()
            .all(|word| series.contains(word))
    );
}
