//! Sheets that are folded (thesis 4.6): seven scenarios by several algorithms, in trials that differ by the jitter of the gripper.

use super::cases::{Case, Run, prepared};
use rodlab_lab::experiment::FoldingOutcome;
use rodlab_lab::run::PreparedRun;

/// A sheet and its crease.
#[derive(Debug)]
pub(super) struct Scenario {
    /// Its name for people.
    pub name: &'static str,
    /// The same for files.
    pub id: &'static str,
    /// How far the edge goes, m, as its key is typed.
    pub crease: &'static str,
    /// The file of the sheet.
    pub paper: &'static str,
    /// Whether a moment at the gripper keeps the sheet from sliding on a table of friction 0.12.
    pub is_held: bool,
}

const A4: &str = include_str!("../../scenarios/papers/a4.toml");
const US_LETTER: &str = include_str!("../../scenarios/papers/us_letter.toml");
const CARDBOARD: &str = include_str!("../../scenarios/papers/cardboard.toml");
const ORIGAMI: &str = include_str!("../../scenarios/papers/origami.toml");
/// The scenario in which the papers take their places.
const SCENARIO: &str = include_str!("../../scenarios/folding_a4.toml");

/// The seven scenarios of thesis sec. 4.6.3, and that of Fig. 4.10.
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
/// The one of Fig. 4.10; those before it are the thesis' seven.
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
    /// Names of those that the thesis compares.
    pub fn compared() -> impl Iterator<Item = &'static str> {
        SCENARIOS[..COMPARED].iter().map(|scenario| scenario.name)
    }

    /// The scenario with its paper in it.
    pub fn text(&self) -> String {
        let lines = SCENARIO.lines().filter(|line| !line.starts_with("extends"));
        let lines: Vec<&str> = lines.collect();
        let table = self.paper.find("[folding.paper]");
        let table = table.expect("a table of the sheet");
        format!("{}\n{}", lines.join("\n"), &self.paper[table..])
    }
}

/// Ways of folding: key of the scenario, whether it is planned anew on the way, and names for files and people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Way {
    algorithm: &'static str,
    is_closed: bool,
    /// Its name for files.
    pub id: &'static str,
    /// Its name for people.
    pub name: &'static str,
}

/// All ways, the thesis' four and that with moments.
pub(super) const WAYS: [Way; 5] = [
    way("circle", false, "circle", "circle (intuitive)"),
    way("step-by-step", false, "step-by-step", "step by step"),
    way("optimal", false, "open", "optimal, open loop"),
    way("optimal", true, "closed", "optimal, closed loop"),
    way("held", false, "held", "held by a moment"),
];

const fn way(
    algorithm: &'static str,
    is_closed: bool,
    id: &'static str,
    name: &'static str,
) -> Way {
    Way {
        algorithm,
        is_closed,
        id,
        name,
    }
}

/// Trials of each scenario by each way.
pub(super) const TRIALS: u64 = 5;
/// Time of a fold, s: `time.end` of the scenario.
const END: f64 = 15.0;
/// A few steps, s.
#[cfg(test)]
const FEW_STEPS: f64 = 0.05;

/// A sheet that is folded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Folded {
    /// Index into [`SCENARIOS`].
    pub scenario: usize,
    /// Index into [`WAYS`].
    pub way: usize,
    /// Seed of the jitter; none without any.
    pub seed: Option<u64>,
    /// Time, s; all that the scenario says where there is none.
    shortened: Option<f64>,
}

impl Folded {
    fn new(scenario: usize, way: usize, seed: Option<u64>) -> Self {
        Self {
            scenario,
            way,
            seed,
            shortened: None,
        }
    }

    /// The seven scenarios by all ways that there are; a quick look has one trial each.
    pub fn of_figure_4_11(quick: bool) -> Vec<Self> {
        let trials = if quick { 1 } else { TRIALS };
        let ways = |scenario: usize| {
            let held = SCENARIOS[scenario].is_held;
            (0..WAYS.len()).filter(move |way| held || WAYS[*way].id != "held")
        };
        let of = |scenario: usize| {
            ways(scenario).flat_map(move |way| {
                (1..=trials).map(move |seed| Self::new(scenario, way, Some(seed)))
            })
        };
        (0..COMPARED).flat_map(of).collect()
    }

    /// One scenario by all ways, without jitter.
    pub fn of_figure_4_10(_quick: bool) -> Vec<Self> {
        let ways = 0..WAYS.len();
        ways.map(|way| Self::new(COMPARED, way, None)).collect()
    }

    /// The seven scenarios by the optimal way, without jitter.
    pub fn of_table_4_1(_quick: bool) -> Vec<Self> {
        let open = WAYS.iter().position(|way| way.id == "open");
        let open = open.expect("the ways are those above");
        (0..COMPARED)
            .map(|scenario| Self::new(scenario, open, None))
            .collect()
    }

    /// The seven scenarios without jitter, held by a moment where one can, otherwise in closed loop; a quick look has the first.
    pub fn of_cell(quick: bool) -> Vec<Self> {
        let of = |scenario: usize| {
            let id = if SCENARIOS[scenario].is_held {
                "held"
            } else {
                "closed"
            };
            let way = WAYS.iter().position(|way| way.id == id);
            Self::new(scenario, way.expect("the ways are those above"), None)
        };
        (0..if quick { 1 } else { COMPARED }).map(of).collect()
    }

    /// Three papers of the thesis, folded in half by the optimal way, without jitter.
    pub fn of_figure_4_5(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_table_4_1(quick);
        runs.retain(|run| ["a4_half", "us_half", "ca_half"].contains(&SCENARIOS[run.scenario].id));
        runs
    }

    fn overrides(&self) -> Vec<String> {
        let Way {
            algorithm,
            is_closed,
            ..
        } = WAYS[self.way];
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

    /// The run, ready to start.
    pub fn prepared(&self) -> PreparedRun {
        let text = SCENARIOS[self.scenario].text();
        prepared(&self.id(), &text, &self.overrides())
    }
}

impl Case<Folded> {
    /// What came of the sheet, wherever it was left.
    pub fn outcome(&self) -> Option<FoldingOutcome> {
        FoldingOutcome::of(&self.record.outcome)
    }
}

impl Run for Folded {
    fn id(&self) -> String {
        let name = format!("fold_{}-{}", SCENARIOS[self.scenario].id, WAYS[self.way].id);
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
            None => "sheets of one trial were folded".to_owned(),
        }
    }
}
