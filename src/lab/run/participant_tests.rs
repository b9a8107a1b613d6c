//! Observers and controllers in real runs: their additions to the results, and bit-for-bit
//! restarts.

use super::*;
use crate::test_support::{quiet, run_of_scene};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{
    Grasp, IntegrationParameters, Scheme, Simulation, SimulationError, StepSize,
};
use rodlab_engine::mechanics::scene::{
    Clamp, Inertia, Load, LoadKind, Motion, NaturalShape, RodDescription, Scene, Stiffness,
};
use rodlab_files::results::{Ending, NODES, NamedValues, SERIES, SUMMARY, SeriesRow, Table, Value};
use serde::{Deserialize, Serialize};
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Nodes of the rod.
const NODES_OF_ROD: usize = 13;
/// The grasped node, and the index of its clamp. The clamp of the scene has index 0.
const GRASPED: usize = 9;

/// Grasps a node, lifts, turns and releases it. Meanwhile a wind pushes the free end; at last
/// gravity is halved.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Gripper {
    clamp: Option<usize>,
    released: bool,
}

const TAKES_HOLD: f64 = 0.1;
const LETS_GO: f64 = 0.3;

impl Controller for Gripper {
    fn name(&self) -> &str {
        "gripper"
    }

    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError> {
        let time = simulation.time();
        if time >= TAKES_HOLD && self.clamp.is_none() {
            let whole = Grasp {
                position: true,
                frame: true,
            };
            let clamp = simulation.grasp(GRASPED, whole)?;
            let motion = Motion {
                translation: vec![(TAKES_HOLD, Vector3::zeros()), (0.25, Vector3::z() * 0.02)],
                axis: Some(Vector3::x()),
                angle: vec![(TAKES_HOLD, 0.0), (0.2, 0.3)],
                ..Motion::default()
            };
            simulation.move_clamp(clamp, motion);
            let mut forces = vec![Vector3::zeros(); NODES_OF_ROD];
            forces[NODES_OF_ROD - 1] = Vector3::y() * 1e-3;
            simulation.set_external_forces(&forces, &[0.0; NODES_OF_ROD]);
            self.clamp = Some(clamp);
        }
        if time >= LETS_GO && !self.released {
            simulation.release(self.clamp.expect("it took hold before"))?;
            simulation.set_load_factor(0, 0.5)?;
            self.released = true;
        }
        Ok(())
    }

    fn next_time(&self) -> f64 {
        match (self.clamp, self.released) {
            (None, _) => TAKES_HOLD,
            (Some(_), false) => LETS_GO,
            _ => f64::INFINITY,
        }
    }
}

/// Records the lowest height of a node.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Lowest {
    lowest: f64,
    samples: u64,
    /// Height below which the run ends, m.
    ends_below: f64,
    /// Height below which the run fails, m.
    fails_below: f64,
}

impl Lowest {
    const FREE: Self = Self {
        lowest: 0.0,
        samples: 0,
        ends_below: f64::NEG_INFINITY,
        fails_below: f64::NEG_INFINITY,
    };
}

impl Observer for Lowest {
    fn name(&self) -> &str {
        "lowest"
    }

    fn columns(&self) -> Vec<String> {
        vec!["tip_z_m".into(), "samples".into()]
    }

    fn is_due(&self, time: f64) -> bool {
        time >= 0.037 * (self.samples + 1) as f64
    }

    fn sample(&mut self, sample: &Sample<'_>) -> Finding {
        self.samples += 1;
        let height = sample.simulation.positions()[NODES_OF_ROD - 1].z;
        self.lowest = self.lowest.min(height);
        if height < self.ends_below {
            let (word, sentence) = ("low".to_owned(), "the tip is low".to_owned());
            return Finding::End(Ending { word, sentence });
        }
        Finding::GoOn
    }

    fn measure(&mut self, sample: &Sample<'_>, _: &SeriesRow) -> (Vec<Value>, Finding) {
        let height = sample.simulation.positions()[NODES_OF_ROD - 1].z;
        let finding = if height < self.fails_below {
            Finding::Fail("the tip hit the floor".into())
        } else {
            Finding::GoOn
        };
        (vec![height.into(), self.samples.into()], finding)
    }

    fn outcomes(&self) -> NamedValues {
        NamedValues::from([("lowest_m", self.lowest.into())])
    }

    fn remarks(&self) -> Vec<String> {
        vec![format!("seen {} times", self.samples)]
    }

    fn highlights(&self, outcome: &rodlab_files::results::CaseOutcome) -> Vec<(String, String)> {
        let lowest = outcome.observed.number("lowest_m");
        vec![(
            "lowest".into(),
            format!("{:.3} m", lowest.unwrap_or(f64::NAN)),
        )]
    }
}

fn cantilever(integration: IntegrationParameters) -> PreparedRun {
    let (young, radius, density) = (1e7, 3e-3, 1000.0);
    let area = std::f64::consts::PI * radius * radius;
    let second_moment = 0.25 * area * radius * radius;
    let stiffness = Stiffness {
        stretching: young * area,
        bending: [young * second_moment; 2],
        twisting: young / 3.0 * 2.0 * second_moment,
    };
    let nodes = (0..NODES_OF_ROD)
        .map(|k| Vector3::x() * (0.3 * k as f64 / 12.0))
        .collect();
    let rod = RodDescription {
        twist: 0.4,
        natural_shape: NaturalShape::Curved {
            curvature: [0.5, 0.0],
            twist: 0.3,
        },
        rotational_inertia_per_length: 2.0 * density * second_moment,
        inertia: Inertia::Consistent,
        ..RodDescription::uniform("rod", nodes, stiffness, radius, density * area)
    };
    let scene = Scene {
        rods: vec![rod],
        clamps: vec![Clamp {
            rod: 0,
            node: 0,
            holds_position: true,
            holds_frame: true,
            motion: Motion::default(),
        }],
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: Vector3::z() * -9.81,
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    };
    PreparedRun {
        integration,
        observers: vec![Box::new(Lowest::FREE)],
        controllers: vec![Box::new(Gripper {
            clamp: None,
            released: false,
        })],
        ..run_of_scene(
            "cantilever",
            scene,
            Mode::Dynamic {
                end: 0.5,
                settles: false,
            },
            0.05,
        )
    }
}

fn schemes() -> [IntegrationParameters; 3] {
    let with = |scheme, step| IntegrationParameters {
        scheme,
        step,
        ..IntegrationParameters::default()
    };
    let auto = StepSize::Auto {
        tolerance: 1e-2,
        maximum: 0.02,
    };
    [
        with(Scheme::ImplicitEuler, StepSize::Fixed(7e-3)),
        with(Scheme::ImplicitMidpoint, StepSize::Fixed(7e-3)),
        with(Scheme::BackwardDifferences, auto),
    ]
}

#[test]
fn a_run_with_a_gripper_that_is_killed_again_and_again_ends_with_the_same_bytes() {
    for integration in schemes() {
        let prepared = cantilever(integration);
        let (whole, pieces) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let outcome = run_until(&prepared, &quiet(whole.path()), &|| None).unwrap();
        let mut interruptions = 0;
        let continued = loop {
            let steps = AtomicUsize::new(0);
            let stop = || (steps.fetch_add(1, Relaxed) == 9).then_some(StopRequest::Interrupt);
            match run_until(&prepared, &quiet(pieces.path()), &stop) {
                Ok(outcome) => break outcome,
                Err(RunError::Interrupted { .. }) => interruptions += 1,
                Err(error) => panic!("{error}"),
            }
        };
        assert!(interruptions >= 5, "{interruptions}");
        assert_eq!(continued.case.remarks, outcome.case.remarks);
        assert_eq!(continued.case, outcome.case);
        for name in [SERIES, NODES, SUMMARY] {
            let read =
                |directory: &tempfile::TempDir| fs::read(directory.path().join(name)).unwrap();
            assert!(
                read(&whole) == read(&pieces),
                "{name}, {:?}",
                integration.scheme
            );
        }
        let again = run_until(&prepared, &quiet(pieces.path()), &|| None).unwrap();
        assert_eq!(again.status, RunStatus::AlreadyFinished);
        assert_eq!(again.highlights, outcome.highlights);
        assert_eq!(again.highlights[0].0, "lowest");
    }
}

#[test]
fn a_grasped_node_is_where_the_gripper_is_until_it_is_let_go() {
    for integration in schemes() {
        let directory = tempfile::tempdir().unwrap();
        run_until(&cantilever(integration), &quiet(directory.path()), &|| None).unwrap();
        let nodes = rodlab_files::results::read_nodes(directory.path(), NODES_OF_ROD).unwrap();
        let height = |output: usize| nodes[output].positions[GRASPED].z;
        // Outputs every 0.05 s: it grasps at output 2, has lifted at output 5, and releases at
        // output 6.
        assert!((height(5) - height(2) - 0.02).abs() < 1e-12);
        assert_eq!(height(6), height(5));
        let moved = (7..=10).map(|output| (height(output) - height(6)).abs());
        assert!(moved.fold(0.0, f64::max) > 1e-3);
    }
}

#[test]
fn columns_and_outcomes_of_observers_are_in_the_tables() {
    let directory = tempfile::tempdir().unwrap();
    let prepared = cantilever(schemes()[0]);
    let outcome = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap();
    let series = Table::read(&directory.path().join(SERIES)).unwrap();
    let nodes = rodlab_files::results::read_nodes(directory.path(), NODES_OF_ROD).unwrap();
    let heights = nodes
        .iter()
        .map(|output| Some(output.positions[NODES_OF_ROD - 1].z));
    assert_eq!(
        series.numbers("tip_z_m").unwrap(),
        heights.collect::<Vec<_>>()
    );
    let samples = series.numbers("samples").unwrap();
    assert_eq!((samples[0], samples[10]), (Some(0.0), Some(13.0)));
    let summary = Table::read(&directory.path().join(SUMMARY)).unwrap();
    let lowest = outcome.case.observed.number("lowest_m");
    assert_eq!(summary.numbers("lowest_m").unwrap(), [lowest]);
    assert!(lowest.unwrap() < -0.01);
    assert_eq!(outcome.case.remarks, ["seen 13 times"]);
}

#[test]
fn an_observer_that_has_seen_enough_ends_the_run_with_the_next_output() {
    let directory = tempfile::tempdir().unwrap();
    let mut prepared = cantilever(schemes()[0]);
    prepared.observers = vec![Box::new(Lowest {
        ends_below: -0.01,
        ..Lowest::FREE
    })];
    let outcome = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap();
    assert_eq!(outcome.case.ending.unwrap().word, "low");
    let series = Table::read(&directory.path().join(SERIES)).unwrap();
    assert!(series.len() < 11, "{}", series.len());
    let last = series.numbers("tip_z_m").unwrap().pop().unwrap();
    assert!(last.unwrap() < -0.01);
}

#[test]
fn an_observer_whose_check_fails_ends_the_run_with_exit_code_4_after_the_row() {
    let directory = tempfile::tempdir().unwrap();
    let mut prepared = cantilever(schemes()[0]);
    prepared.observers = vec![Box::new(Lowest {
        fails_below: -0.01,
        ..Lowest::FREE
    })];
    let error = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap_err();
    assert!(matches!(
        &error,
        RunError::Simulation {
            source: SimulationError::Unphysical(_),
            ..
        }
    ));
    assert!(error.to_string().contains("hit the floor"), "{error}");
    let series = Table::read(&directory.path().join(SERIES)).unwrap();
    let heights = series.numbers("tip_z_m").unwrap();
    let low = |height: &Option<f64>| height.unwrap() < -0.01;
    assert_eq!(heights.iter().position(low), Some(heights.len() - 1));
}

#[test]
fn checkpoints_of_other_observers_are_not_used() {
    let directory = tempfile::tempdir().unwrap();
    let mut prepared = cantilever(schemes()[0]);
    let steps = AtomicUsize::new(0);
    let stop = || (steps.fetch_add(1, Relaxed) == 9).then_some(StopRequest::Interrupt);
    run_until(&prepared, &quiet(directory.path()), &stop).unwrap_err();
    prepared.controllers.clear();
    let outcome = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap();
    assert_eq!(outcome.status, RunStatus::Finished);
}
