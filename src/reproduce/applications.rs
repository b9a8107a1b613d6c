//! Applications of deployment in the thesis: cables placed in clips (5.5.5) and knots tied on the
//! table (5.5.6). Each has ten trials with different jitter of the grippers.

use super::cases::{Case, Run, prepared_table, table_of, value};
use rodlab_lab::experiment::DeploymentOutcome;
use rodlab_lab::run::PreparedRun;
use rodlab_planning::plan::pattern::{chosen_stroke, read_svg};
use toml::{Table, Value, toml};

/// A task of thesis Tab. 5.4.
#[derive(Debug)]
pub(super) struct Task {
    /// Name in the thesis.
    pub name: &'static str,
    /// Name for files.
    pub id: &'static str,
    /// Successes in ten trials of the thesis, for the intuitive and for the optimal scheme.
    pub measured: [usize; 2],
    /// Simulated time, s: `time.end` of its scenario.
    end: f64,
    scenario: &'static str,
    rod: &'static str,
    pattern: &'static str,
}

/// The tasks.
pub(super) const TASKS: [Task; 4] = [
    Task {
        name: "\"S\" cable placement",
        id: "cable_S",
        measured: [0, 9],
        end: 33.0,
        scenario: include_str!("../../scenarios/cable_placement_s.toml"),
        rod: include_str!("../../scenarios/rods/cable.toml"),
        pattern: include_str!("../../scenarios/patterns/cable_S.svg"),
    },
    Task {
        name: "\"U\" cable placement",
        id: "cable_U",
        measured: [0, 9],
        end: 33.0,
        scenario: include_str!("../../scenarios/cable_placement_u.toml"),
        rod: include_str!("../../scenarios/rods/cable.toml"),
        pattern: include_str!("../../scenarios/patterns/cable_U.svg"),
    },
    Task {
        name: "Trefoil knot",
        id: "trefoil",
        measured: [0, 9],
        end: 52.0,
        scenario: include_str!("../../scenarios/tied_trefoil.toml"),
        rod: include_str!("../../scenarios/rods/thick_pink_vps.toml"),
        pattern: include_str!("../../scenarios/patterns/trefoil.svg"),
    },
    Task {
        name: "Reef knot",
        id: "reef",
        measured: [0, 7],
        end: 104.0,
        scenario: include_str!("../../scenarios/tied_reef.toml"),
        rod: include_str!("../../scenarios/rods/thick_pink_vps.toml"),
        pattern: include_str!("../../scenarios/patterns/reef.svg"),
    },
];

/// Number of trials of each task with each scheme.
pub(super) const TRIALS: u64 = 10;
/// Duration of a few steps, s.
#[cfg(test)]
const FEW_STEPS: f64 = 0.05;

/// A trial of a task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Application {
    /// Index into [`TASKS`].
    pub task: usize,
    /// Whether the rod is laid with the optimal grasps instead of the intuitive scheme.
    pub is_optimal: bool,
    /// Seed of the jitter.
    pub seed: u64,
    /// Shortened simulated time, s; `None` for that of the scenario.
    shortened: Option<f64>,
}

impl Application {
    /// Ten trials of each task with each scheme; a quick version has one trial.
    pub fn of_table_5_4(quick: bool) -> Vec<Self> {
        let trials = if quick { 1 } else { TRIALS };
        let trial = |task: usize, is_optimal: bool| {
            (1..=trials).map(move |seed| Self {
                task,
                is_optimal,
                seed,
                shortened: None,
            })
        };
        let tasks = 0..TASKS.len();
        let both = |task| {
            [false, true]
                .into_iter()
                .flat_map(move |is| trial(task, is))
        };
        tasks.flat_map(both).collect()
    }

    /// The trials in the virtual cell; knots only with the optimal scheme.
    pub fn of_table_5_4_in_cell(quick: bool) -> Vec<Self> {
        let mut trials = Self::of_table_5_4(quick);
        trials.retain(|trial| {
            trial.is_optimal || TASKS[trial.task].scenario.contains("[deployment.clips]")
        });
        trials
    }

    /// Name of the scheme.
    pub fn scheme(&self) -> &'static str {
        if self.is_optimal {
            "optimal"
        } else {
            "intuitive"
        }
    }

    /// The scenario of the task, with its rod and its patterns.
    fn scenario(&self) -> Table {
        let task = &TASKS[self.task];
        let mut scenario = table_of(task.scenario);
        scenario.remove("extends");
        if let Some(end) = self.shortened {
            scenario["time"]["end"] = end.into();
        }
        let deployment = scenario["deployment"].as_table_mut();
        let deployment = deployment.expect("a table of the task");
        let rod = table_of(task.rod)["deployment"]["rod"].clone();
        let seed = i64::try_from(self.seed).expect("a small number");
        let mut set = |key: &str, value: Value| deployment.insert(key.into(), value);
        set("rod", rod);
        set("scheme", self.scheme().into());
        set("seed", seed.into());
        if let Some(end) = self.shortened {
            set("pattern", toml! { kind = "line" length = 0.002 }.into());
            set("release", (0.5 * end).into());
            // The shortened scenario lays a short line, without clips, crossings or a second rod.
            deployment.retain(|key, _| !["clips", "knot", "second"].contains(&key));
            return scenario;
        }
        // The patterns are in the order of the strokes.
        let mut strokes = strokes(task.pattern).into_iter();
        let mut drawn = || strokes.next().expect("a stroke for each pattern").into();
        deployment["pattern"] = drawn();
        if let Some(second) = deployment.get_mut("second") {
            second["pattern"] = drawn();
        }
        scenario
    }
}

/// Each stroke of a built-in drawing as a pattern.
fn strokes(svg: &str) -> Vec<Table> {
    let strokes = read_svg(svg).expect("the drawings of the repository are patterns");
    let pattern = |number: usize| {
        let points = chosen_stroke(strokes.clone(), Some(number));
        let points = points.expect("a stroke for each number");
        let points: Vec<_> = points.iter().map(|point| [point.x, point.y]).collect();
        toml! { points = (value(points)) }
    };
    (1..=strokes.len()).map(pattern).collect()
}

impl Case<Application> {
    /// Outcome of the rod, also for unfinished runs.
    pub fn outcome(&self) -> Option<DeploymentOutcome> {
        DeploymentOutcome::of(&self.record.outcome)
    }

    /// Whether the trial finished, and succeeded.
    pub fn has_succeeded(&self) -> bool {
        let has_ended = self.record.outcome.simulated_time >= self.run.end() * (1.0 - 1e-9);
        let outcome = self.outcome();
        let pegs = outcome.and_then(|laid| laid.pegs);
        let knot = outcome.and_then(|laid| laid.knot);
        let is_placed = pegs.map(|pegs| pegs.are_all());
        let is_tied = knot.map(|knot| knot.is_tied());
        has_ended && is_placed.or(is_tied).unwrap_or(false)
    }
}

impl Run for Application {
    fn id(&self) -> String {
        format!("{}-{}-{}", TASKS[self.task].id, self.scheme(), self.seed)
    }

    fn prepare(&self) -> PreparedRun {
        prepared_table(&self.id(), self.scenario(), &[])
    }

    fn end(&self) -> f64 {
        self.shortened.unwrap_or(TASKS[self.task].end)
    }

    fn cost(&self) -> f64 {
        0.08 * self.end()
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            shortened: Some(FEW_STEPS),
            ..*self
        }
    }

    fn extent(&self) -> String {
        match self.shortened {
            Some(end) => format!("{end} s were simulated"),
            None => "rods of one trial were laid".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_lab::run::Mode;

    #[test]
    fn trials_take_the_time_of_their_scenarios() {
        for run in Application::of_table_5_4(true) {
            let Mode::Dynamic { end, .. } = run.prepare().mode else {
                panic!("rods are laid in time");
            };
            assert_eq!(end, run.end());
        }
    }
}
