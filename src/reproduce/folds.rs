//! Folded sheets (thesis 4.6): seven scenarios with several algorithms, in trials with different
//! jitter of the gripper.

use super::cases::{Case, Run, prepared_table, table_of};
use rodlab_lab::experiment::FoldingOutcome;
use rodlab_lab::run::PreparedRun;
use toml::Table;

/// A sheet and its crease.
#[derive(Debug)]
pub(super) struct Scenario {
    /// Display name.
    pub name: &'static str,
    /// Name for files.
    pub id: &'static str,
    /// Displacement of the edge, m, as the text of its key.
    pub crease: &'static str,
    /// The file of the sheet.
    pub paper: &'static str,
    /// Whether a moment at the gripper prevents sliding on a table of friction 0.12.
    pub is_held: bool,
}

const A4: &str = include_str!("../../scenarios/papers/a4.toml");
const US_LETTER: &str = include_str!("../../scenarios/papers/us_letter.toml");
const CARDBOARD: &str = include_str!("../../scenarios/papers/cardboard.toml");
const ORIGAMI: &str = include_str!("../../scenarios/papers/origami.toml");
/// The scenario into which the papers are inserted.
const SCENARIO: &str = include_str!("../../scenarios/folding_a4.toml");

/// The seven scenarios of thesis sec. 4.6.3, and the scenario of Fig. 4.10.
pub(super) const SCENARIOS: [Scenario; 8] = [
    scenario("A4, C = 0.25 m", "a4_25", "0.25", A4, true),
    scenario("A4, half", "a4_half", "half", A4, true),
    scenario("US letter, C = 0.20 m", "us_20", "0.20", US_LETTER, false),
    scenario("US letter, half", "us_half", "half", US_LETTER, true),
    scenario("cardboard, C = 0.20 m", "ca_20", "0.20", CARDBOARD, false),
    scenario("cardboard, half", "ca_half", "half", CARDBOARD, false),
    scenario(
        "origami, diagonal",
        "or_diagonal",
        "diagonal-strip",
        ORIGAMI,
        true,
    ),
    scenario("US letter, C = 0.27 m", "us_27", "0.27", US_LETTER, true),
];
/// Index of the scenario of Fig. 4.10, which follows the seven compared ones.
const COMPARED: usize = 7;

const fn scenario(
    name: &'static str,
    id: &'static str,
    crease: &'static str,
    paper: &'static str,
    is_held: bool,
) -> Scenario {
    Scenario {
        name,
        id,
        crease,
        paper,
        is_held,
    }
}

impl Scenario {
    /// Names of the scenarios that the thesis compares.
    pub fn compared() -> impl Iterator<Item = &'static str> {
        SCENARIOS[..COMPARED].iter().map(|scenario| scenario.name)
    }

    /// The scenario with its paper.
    pub fn table(&self) -> Table {
        let mut scenario = table_of(SCENARIO);
        scenario.remove("extends");
        let paper = table_of(self.paper)["folding"]["paper"].clone();
        let folding = scenario["folding"].as_table_mut();
        folding
            .expect("a table of the fold")
            .insert("paper".into(), paper);
        scenario
    }
}

/// Methods of folding: key of the scenario, whether it replans during the fold, and names for files
/// and display.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Method {
    algorithm: &'static str,
    is_closed: bool,
    /// Name for files.
    pub id: &'static str,
    /// Display name.
    pub name: &'static str,
}

/// All methods: four of the thesis and one with moments.
pub(super) const METHODS: [Method; 5] = [
    method("circle", false, "circle", "circle (intuitive)"),
    method("step-by-step", false, "step-by-step", "step by step"),
    method("optimal", false, "open", "optimal, open loop"),
    method("optimal", true, "closed", "optimal, closed loop"),
    method("held", false, "held", "held by a moment"),
];

const fn method(
    algorithm: &'static str,
    is_closed: bool,
    id: &'static str,
    name: &'static str,
) -> Method {
    Method {
        algorithm,
        is_closed,
        id,
        name,
    }
}

/// Number of trials of each scenario with each method.
pub(super) const TRIALS: u64 = 5;
/// Duration of a fold, s: `time.end` of the scenario.
const END: f64 = 15.0;
/// Duration of a few steps, s.
#[cfg(test)]
const FEW_STEPS: f64 = 0.05;

/// A run that folds a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Folded {
    /// Index into [`SCENARIOS`].
    pub scenario: usize,
    /// Index into [`METHODS`].
    pub method: usize,
    /// Seed of the jitter; `None` without jitter.
    pub seed: Option<u64>,
    /// Shortened simulated time, s; `None` for that of the scenario.
    shortened: Option<f64>,
}

impl Folded {
    fn new(scenario: usize, method: usize, seed: Option<u64>) -> Self {
        Self {
            scenario,
            method,
            seed,
            shortened: None,
        }
    }

    /// The seven scenarios with all methods; a quick version has one trial of each.
    pub fn of_figure_4_11(quick: bool) -> Vec<Self> {
        let trials = if quick { 1 } else { TRIALS };
        let methods = |scenario: usize| {
            let held = SCENARIOS[scenario].is_held;
            (0..METHODS.len()).filter(move |method| held || METHODS[*method].id != "held")
        };
        let of = |scenario: usize| {
            methods(scenario).flat_map(move |method| {
                (1..=trials).map(move |seed| Self::new(scenario, method, Some(seed)))
            })
        };
        (0..COMPARED).flat_map(of).collect()
    }

    /// One scenario with all methods, without jitter.
    pub fn of_figure_4_10(_quick: bool) -> Vec<Self> {
        let methods = 0..METHODS.len();
        methods
            .map(|method| Self::new(COMPARED, method, None))
            .collect()
    }

    /// The seven scenarios with the optimal method, without jitter.
    pub fn of_table_4_1(_quick: bool) -> Vec<Self> {
        let open = METHODS.iter().position(|method| method.id == "open");
        let open = open.expect("the methods are those above");
        (0..COMPARED)
            .map(|scenario| Self::new(scenario, open, None))
            .collect()
    }

    /// The seven scenarios without jitter, held by a moment if possible, otherwise in closed loop;
    /// a quick version has only the first.
    pub fn of_cell(quick: bool) -> Vec<Self> {
        let of = |scenario: usize| {
            let id = if SCENARIOS[scenario].is_held {
                "held"
            } else {
                "closed"
            };
            let method = METHODS.iter().position(|method| method.id == id);
            Self::new(scenario, method.expect("the methods are those above"), None)
        };
        (0..if quick { 1 } else { COMPARED }).map(of).collect()
    }

    /// Three papers of the thesis, folded in half with the optimal method, without jitter.
    pub fn of_figure_4_5(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_table_4_1(quick);
        runs.retain(|run| ["a4_half", "us_half", "ca_half"].contains(&SCENARIOS[run.scenario].id));
        runs
    }

    fn overrides(&self) -> Vec<String> {
        let Method {
            algorithm,
            is_closed,
            ..
        } = METHODS[self.method];
        let mut overrides = vec![
            format!("folding.algorithm={algorithm}"),
            format!("folding.crease={}", SCENARIOS[self.scenario].crease),
        ];
        if is_closed {
            overrides.push("folding.feedback={ parts = 5 }".into());
        }
        if let Some(seed) = self.seed {
            overrides.push(format!("folding.seed={seed}"));
            overrides.push("folding.jitter=0.001".into());
            overrides.push("folding.jitter_angle=\"0.5 deg\"".into());
        }
        if let Some(end) = self.shortened {
            overrides.push(format!("time.end={end:?}"));
        }
        overrides
    }

    /// Prepares the run.
    pub fn prepared(&self) -> PreparedRun {
        let scenario = SCENARIOS[self.scenario].table();
        prepared_table(&self.id(), scenario, &self.overrides())
    }
}

impl Case<Folded> {
    /// Outcome of the sheet, also for unfinished runs.
    pub fn outcome(&self) -> Option<FoldingOutcome> {
        FoldingOutcome::of(&self.record.outcome)
    }
}

impl Run for Folded {
    fn id(&self) -> String {
        let name = format!(
            "fold_{}-{}",
            SCENARIOS[self.scenario].id, METHODS[self.method].id
        );
        match self.seed {
            Some(seed) => format!("{name}-{seed}"),
            None => name,
        }
    }

    fn prepare(&self) -> PreparedRun {
        self.prepared()
    }

    fn end(&self) -> f64 {
        self.shortened.unwrap_or(END)
    }

    fn cost(&self) -> f64 {
        0.12 * self.end()
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
            None => "one trial of each fold was simulated".to_owned(),
        }
    }
}
