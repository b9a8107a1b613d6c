//! The run loop with a small double in the place of the mechanics.

use super::advance::Advance;
use super::*;
use crate::cli::ExitCode;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactPair, Proximity};
use crate::mechanics::dynamics::{
    Energies, IntegrationParameters, Simulation, SimulationError, StepReport,
};
use crate::mechanics::scene::{NaturalShape, RodDescription, Scene, Start, Stiffness};
use crate::mechanics::statics::{PathPlan, PathPoint, Tracer};
use crate::results::{
    CaseStatus, Frame, MANIFEST, Manifest, NODE_FORCES, NODES, SCENARIO, SERIES, SUMMARY, TIMINGS,
    VTK_COLLECTION,
};
use crate::run::{Mode, OutputPlan};
use proptest::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A driven pendulum with steps of its own choice: any lost bit of its state grows.
#[derive(Clone, Serialize, Deserialize)]
struct Pendulum {
    time: f64,
    angle: f64,
    velocity: f64,
    fails_at: Option<f64>,
}

impl Pendulum {
    fn new() -> Self {
        Self {
            time: 0.0,
            angle: 2.0,
            velocity: 0.0,
            fails_at: None,
        }
    }
}

impl Advance for Pendulum {
    type State = Self;

    fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError> {
        if self.fails_at.is_some_and(|time| self.time >= time) {
            return Err(SimulationError::NoConvergence {
                time: self.time,
                step: 1e-9,
                residual: 1.0,
                term: "bending",
                rod: "pendulum".into(),
                node: 1,
            });
        }
        let chosen = 0.02 + 0.01 * self.angle.sin();
        let step = if self.time + chosen < until {
            chosen
        } else {
            until - self.time
        };
        self.time = if self.time + chosen < until {
            self.time + chosen
        } else {
            until
        };
        self.velocity += step * (1.5 * (2.0 / 3.0 * self.time).cos() - 9.81 * self.angle.sin());
        self.angle += step * self.velocity;
        Ok(StepReport {
            time: self.time,
            step,
            newton_iterations: 2 + (self.angle > 0.0) as usize,
            contacts: (self.angle < 0.0) as usize,
            retries: 0,
            fluid_iterations: 1,
            ..StepReport::default()
        })
    }

    fn advance_while(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        let report = self.advance(until)?;
        // A step that is stopped halfway leaves anything behind.
        Ok(goes_on().then_some(report))
    }

    fn path(&self, _: PathPlan) -> Result<Tracer, SimulationError> {
        unreachable!("a pendulum is not asked for paths")
    }

    fn next_point(&mut self, _: &mut Tracer) -> Result<Option<PathPoint>, SimulationError> {
        unreachable!("a pendulum has no path")
    }

    fn find_equilibrium(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        self.angle = 0.0;
        Ok(goes_on().then(|| StepReport {
            newton_iterations: 7,
            ..StepReport::default()
        }))
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn energies(&self) -> Energies {
        let (kinetic, gravitational) = (self.velocity.powi(2) / 2.0, -9.81 * self.angle.cos());
        Energies {
            kinetic,
            gravitational,
            ..Energies::default()
        }
    }

    fn nearest(&self) -> Option<Proximity> {
        (self.angle <= 1.0).then_some(Proximity {
            pair: ContactPair::Edges([0, 1]),
            distance: 2.0 + self.angle,
            threshold: 1.0,
        })
    }

    fn mean_gap(&self) -> Option<f64> {
        None
    }

    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    fn frame(&self, with_forces: bool) -> Frame {
        let bob = Vector3::new(self.angle.sin(), 0.0, -self.angle.cos());
        let velocities = if with_forces {
            vec![Vector3::zeros(), self.velocity * bob]
        } else {
            vec![]
        };
        Frame {
            time: self.time,
            positions: vec![Vector3::zeros(), bob],
            edge_angles: vec![self.angle, 0.0],
            velocities,
            ..Frame::default()
        }
    }

    fn simulation(&self) -> Option<&Simulation> {
        None
    }

    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        None
    }

    fn as_start(&self) -> Option<Start> {
        None
    }

    fn state(&self) -> Self {
        self.clone()
    }

    fn restore(&mut self, state: Self) -> Result<(), SimulationError> {
        *self = Self {
            fails_at: self.fails_at,
            ..state
        };
        Ok(())
    }
}

fn prepared(mode: Mode) -> PreparedRun {
    let rod = RodDescription {
        name: "pendulum".into(),
        centreline: vec![Vector3::zeros(), Vector3::x()],
        closed: false,
        end_tangents: [None; 2],
        first_director: None,
        twist: 0.0,
        natural_shape: NaturalShape::Straight,
        stiffness: Stiffness {
            stretching: 1.0,
            bending: [1.0; 2],
            twisting: 1.0,
        },
        radius: 0.5,
        mass_per_length: 1.0,
        rotational_inertia_per_length: 1.0,
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        held: false,
    };
    PreparedRun {
        name: "pendulum".into(),
        experiment: "scene".into(),
        title: "Driven pendulum".into(),
        scenario_toml: "experiment = \"scene\"\n".into(),
        scene: Scene {
            rods: vec![rod],
            ..Scene::default()
        },
        mode,
        integration: IntegrationParameters::default(),
        output: OutputPlan {
            interval: 0.1,
            nodes: true,
            forces: true,
            vtk: true,
        },
        observers: Vec::new(),
        controllers: Vec::new(),
        table: None,
        start: None,
    }
}

const DYNAMIC: Mode = Mode::Dynamic { end: 1.0 };

fn quiet(directory: &Path) -> RunOptions {
    RunOptions {
        progress: false,
        ..RunOptions::new(directory)
    }
}

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
    let rows: Vec<crate::results::SeriesRow> = reader.deserialize().map(Result::unwrap).collect();
    let times: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    assert_eq!(
        times,
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    );
    let steps: u64 = rows.iter().map(|row| row.steps).sum();
    let mut reader = csv::Reader::from_path(directory.path().join(SUMMARY)).unwrap();
    let summary: crate::results::SummaryRow = reader.deserialize().next().unwrap().unwrap();
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
                    prop_assert_eq!(error.exit_code(), 130);
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
    // A later run got further and died without a word, in the middle of a row.
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
fn the_time_limit_and_checkpoints_at_every_step_change_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let options = quiet(directory.path());
    let late = || Some(StopRequest::TimeLimit);
    let error =
        run_simulation(&mut Pendulum::new(), &prepared(DYNAMIC), &options, &late).unwrap_err();
    assert_eq!(error.exit_code(), 5);
    assert_eq!(status(directory.path()), CaseStatus::TimeLimit);
    let options = RunOptions {
        checkpoint_every: Duration::ZERO,
        ..quiet(directory.path())
    };
    run_simulation(&mut Pendulum::new(), &prepared(DYNAMIC), &options, &|| None).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

/// A pendulum whose steps take long.
#[derive(Clone)]
struct Slow(Pendulum);

impl Advance for Slow {
    type State = Pendulum;

    fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError> {
        self.0.advance(until)
    }

    fn advance_while(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        std::thread::sleep(Duration::from_millis(60));
        self.0.advance_while(until, goes_on)
    }

    fn path(&self, plan: PathPlan) -> Result<Tracer, SimulationError> {
        self.0.path(plan)
    }

    fn next_point(&mut self, path: &mut Tracer) -> Result<Option<PathPoint>, SimulationError> {
        self.0.next_point(path)
    }

    fn find_equilibrium(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        self.0.find_equilibrium(goes_on)
    }

    fn time(&self) -> f64 {
        self.0.time()
    }

    fn energies(&self) -> Energies {
        self.0.energies()
    }

    fn mean_gap(&self) -> Option<f64> {
        self.0.mean_gap()
    }

    fn remarks(&self) -> Vec<String> {
        self.0.remarks()
    }

    fn nearest(&self) -> Option<Proximity> {
        self.0.nearest()
    }

    fn frame(&self, with_forces: bool) -> Frame {
        self.0.frame(with_forces)
    }

    fn simulation(&self) -> Option<&Simulation> {
        None
    }

    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        None
    }

    fn as_start(&self) -> Option<Start> {
        None
    }

    fn state(&self) -> Pendulum {
        self.0.state()
    }

    fn restore(&mut self, state: Pendulum) -> Result<(), SimulationError> {
        self.0.restore(state)
    }
}

#[test]
fn a_step_that_takes_long_is_stopped_halfway_without_a_trace() {
    let directory = tempfile::tempdir().unwrap();
    // Asked before each step, and in its middle.
    for asked in [1, 3, 6] {
        let (prepared, options) = (prepared(DYNAMIC), quiet(directory.path()));
        let mut slow = Slow(Pendulum::new());
        let error =
            run_simulation(&mut slow, &prepared, &options, &after_steps(asked)).unwrap_err();
        assert_eq!(error.exit_code(), 130);
    }
    go_on(directory.path()).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn no_convergence_leaves_a_checkpoint_and_exit_code_3() {
    let directory = tempfile::tempdir().unwrap();
    let mut failing = Pendulum {
        fails_at: Some(0.55),
        ..Pendulum::new()
    };
    let options = quiet(directory.path());
    let error = run_simulation(&mut failing, &prepared(DYNAMIC), &options, &|| None).unwrap_err();
    assert_eq!(error.exit_code(), 3);
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
    assert_eq!(error.exit_code(), 1);
    assert!(error.to_string().contains(NODES), "{error}");
    assert_eq!(status(directory.path()), CaseStatus::Failed);
    fs::remove_file(&nodes).unwrap();
    go_on(directory.path()).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

/// Deletes a file, then another way to spoil it, both in the place of the whole.
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
fn missing_and_garbled_files_are_noticed_when_a_run_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    interrupt(directory.path(), 20);
    for name in GROWING {
        spoilt(&directory.path().join(name), |what| {
            let error = go_on(directory.path()).unwrap_err();
            assert_eq!(error.exit_code(), 1);
            assert!(error.to_string().contains(what), "{name}: {error}");
        });
    }
    go_on(directory.path()).unwrap();
    same_bytes(directory.path(), uninterrupted().path());
}

#[test]
fn missing_and_garbled_files_are_noticed_before_a_run_is_said_finished() {
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
