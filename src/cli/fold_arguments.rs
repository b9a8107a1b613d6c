//! Arguments of `rodlab fold`.

use super::plan_fold::crease;
use super::prelude::*;
use clap::builder::PossibleValuesParser;
use rodlab_lab::experiment::{AlgorithmName, Crease, PaperFile};
use rodlab_workcell::cell::Place;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab fold --paper a4                                in a virtual cell
  rodlab fold --paper a4 --cell cell.toml --feedback 5
  rodlab fold --paper a4 --crease half --simulate --open
  rodlab fold --paper us_letter --crease half --algorithm optimal --feedback 5 --simulate
  rodlab fold --paper a4 --crease \"25 cm\" --algorithm circle --simulate --out results/circle",
    "\
In a cell the camera locates the sheet; the arm takes its edge and folds it in parts. After each
part the camera measures how far the sheet has slid, and with --feedback the next part is replanned.
The fold is scored from the pictures, then the gripper opens. With --dry-run nothing moves:
look at its page first. All results are in one directory: manifest.json, report.md, report.html,
joints.csv, cell.html, looks.csv, the pictures, and a folder with commanded.csv, state.csv and
events.csv for each motion. Exit code 1: a step failed; the message and report.md give the reason.
`rodlab cell serve --paper FILE` starts a cell for trying --cell.

With --simulate the sheet is folded in plain simulation, without an arm; the results directory is
that of any run, and `rodlab run` accepts its scenario."
);

/// Arguments of `rodlab fold`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct FoldArguments {
    /// Sheet file: TOML with [folding.paper], as in scenarios/papers
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Paper), add = presets(PresetKind::Paper))]
    pub paper: PathBuf,
    /// Target of the edge: `half`, `diagonal-strip`, or the distance by which it moves
    ///
    /// `half`: onto the opposite edge. `diagonal-strip`: fold a corner of a square sheet onto the
    /// opposite corner; plan and simulation assume a strip of uniform width.
    #[arg(long, value_name = "TARGET", value_parser = crease, default_value = "half")]
    pub crease: Crease,
    /// Algorithm that plans the path of the gripper
    ///
    /// `held` applies the smallest moment at which friction holds the sheet.
    #[arg(long, default_value = "held", value_parser = PossibleValuesParser::new(ALGORITHMS.map(|(name, _)| name)))]
    pub algorithm: String,
    /// Fold in N parts and replan each from the measured slide of the sheet; at most 20 in a cell
    ///
    /// The first part follows the plan.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub feedback: Option<u16>,
    /// Friction of the table [default: that of the sheet file]
    #[arg(long, value_name = "FRICTION", value_parser = friction)]
    pub friction: Option<f64>,
    /// Name of the arm; optional if the cell has only one
    #[arg(long, value_name = "NAME")]
    pub arm: Option<String>,
    /// Expected place of the middle of the edge: x,y,z in metres, direction across the sheet in
    /// degrees
    ///
    /// The direction is an angle about z in the cell. The camera then locates the sheet more
    /// exactly; of its possible directions the nearest is used. By default the sheet is expected in
    /// the middle of the table, along x.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "X,Y,Z[,TURN]",
        allow_hyphen_values = true
    )]
    pub place: Option<Place>,
    /// Largest speed of the hand while it folds, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.05, value_parser = positive)]
    pub hand_speed: f64,
    /// Largest speed of the hand as it approaches the sheet, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    pub approach_speed: f64,
    /// Least distance to anything else, m
    #[arg(long, hide_short_help = true, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    pub margin: f64,
    /// Colour of the paper, as in `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    pub colour: String,
    /// Plan everything and write the page, but move nothing
    #[arg(long, conflicts_with = "simulate")]
    pub dry_run: bool,
    /// The arm and its gripper were inspected after a task that did not finish
    #[arg(long, hide_short_help = true, conflicts_with = "simulate")]
    pub checked: bool,
    /// Fold in plain simulation, without a cell
    #[arg(long)]
    pub simulate: bool,
    /// Root mean square of the noise of the gripper pose in each direction
    #[arg(long, hide_short_help = true, value_name = "LENGTH", value_parser = positive_length, requires = "simulate")]
    pub jitter: Option<f64>,
    /// Seed of the noise
    #[arg(
        long,
        hide_short_help = true,
        value_name = "N",
        default_value_t = 0,
        requires = "simulate"
    )]
    pub seed: u32,
    /// Directory for the results [default: results/fold-TIME, with --simulate results/fold_SHEET]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Start over and discard earlier results
    #[arg(long, requires = "simulate")]
    pub force: bool,
    /// Open the page in the browser
    #[arg(long, requires = "simulate")]
    pub open: bool,
}

/// Names of algorithms in scenario files.
const ALGORITHMS: [(&str, AlgorithmName); 5] = [
    ("held", AlgorithmName::Held),
    ("optimal", AlgorithmName::Optimal),
    ("least-friction", AlgorithmName::LeastFriction),
    ("circle", AlgorithmName::Circle),
    ("step-by-step", AlgorithmName::StepByStep),
];

/// The requested sheet.
pub struct AskedSheet {
    /// Contents of the sheet file.
    pub file: PaperFile,
    /// Distance by which the edge moves, m.
    pub target: f64,
    /// Friction of the table.
    pub friction: f64,
}

impl FoldArguments {
    /// The selected algorithm.
    pub fn algorithm(&self) -> AlgorithmName {
        let named = ALGORITHMS.iter().find(|(name, _)| *name == self.algorithm);
        named.map_or(AlgorithmName::Held, |(_, algorithm)| *algorithm)
    }

    /// Reads the sheet and its target.
    pub fn sheet(&self) -> Result<AskedSheet, Failure> {
        let file = PaperFile::read(&self.paper)?;
        let target = file.paper.target(self.crease).at("--crease")?;
        if self.feedback.is_some() && !self.algorithm().can_replan() {
            let message = "--feedback: this algorithm cannot replan; use `held`, `optimal` or `least-friction`";
            return Err(Failure::Input(message.into()));
        }
        let friction = self.friction.or(file.paper.friction);
        let needed =
            "the friction of the table is missing: give --friction or `folding.paper.friction`";
        Ok(AskedSheet {
            friction: friction.ok_or_else(|| Failure::Input(needed.into()))?,
            file,
            target,
        })
    }
}
