//! Arguments of `rodlab fold`.

use super::plan_fold::crease;
use super::prelude::*;
use clap::builder::PossibleValuesParser;
use rodlab_lab::experiment::{AlgorithmName, Crease, PaperFile};
use rodlab_workcell::cell::Place;

/// Arguments of `rodlab fold`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab fold --paper a4                                in a virtual cell
  rodlab fold --paper a4 --cell cell.toml --feedback 5
  rodlab fold --paper a4 --crease half --simulate --open
  rodlab fold --paper us_letter --crease half --algorithm optimal --feedback 5 --simulate
  rodlab fold --paper a4 --crease \"25 cm\" --algorithm circle --simulate --out results/circle

In a cell the camera looks where the sheet lies; the arm takes its edge and folds it in parts. After each the camera looks how far
the sheet has slid, and with --feedback the next is planned anew. What was seen is scored, then the gripper lets go. Nothing moves with
--dry-run: look at its page first. Everything is in one directory: manifest.json, report.md, report.html, joints.csv, cell.html,
looks.csv, the pictures, and a folder with commanded.csv, state.csv and events.csv for each motion. Exit code 1: something failed on the way;
the message and report.md say what. `rodlab cell serve --paper FILE` is a cell to try --cell with.
With --simulate the sheet is folded in plain simulation, without an arm; the results directory is that of any run, and its
scenario can be taken on with `rodlab run`.")]
pub struct FoldArguments {
    /// The sheet: TOML with [folding.paper], as in scenarios/papers
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Paper), add = presets(PresetKind::Paper))]
    pub paper: PathBuf,
    /// Where the edge goes: `half`, onto the opposite edge; `diagonal-strip`, a corner of a square sheet onto the opposite one, planned and
    /// simulated as a strip of one width; or how far
    #[arg(long, value_name = "half|diagonal-strip|LENGTH", value_parser = crease, default_value = "half")]
    pub crease: Crease,
    /// How the way of the gripper is planned; `held` holds the edge with as little moment as the friction needs
    #[arg(long, default_value = "held", value_parser = PossibleValuesParser::new(ALGORITHMS.map(|(name, _)| name)))]
    pub algorithm: String,
    /// Plan each of N parts of the way but the first anew from how far the sheet is seen to have slid; at most 20 in a cell
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub feedback: Option<u16>,
    /// Friction of the table [default: that in the sheet's file]
    #[arg(long, value_name = "FRICTION", value_parser = friction)]
    pub friction: Option<f64>,
    /// Name of the arm; not needed where the cell has only one
    #[arg(long, value_name = "NAME")]
    pub arm: Option<String>,
    /// Where the middle of the edge lies in the cell: x,y,z in metres, and the direction over the sheet, degrees about z. The
    /// camera sees it more exactly; of the directions of the sheet that it sees the nearest is taken [default: the sheet in the
    /// middle of the table, along x]
    #[arg(long, value_name = "X,Y,Z[,TURN]", allow_hyphen_values = true)]
    pub place: Option<Place>,
    /// Greatest speed of the hand while it folds, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.05, value_parser = positive)]
    pub hand_speed: f64,
    /// Greatest speed of the hand on the way to the sheet, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    pub approach_speed: f64,
    /// Least distance to anything else, m
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    pub margin: f64,
    /// Which colours are paper, as of `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    pub colour: String,
    /// Plan everything, write the page, and move nothing
    #[arg(long, conflicts_with = "simulate")]
    pub dry_run: bool,
    /// The arm, and what it holds, were looked at after a task that did not come to its end
    #[arg(long, conflicts_with = "simulate")]
    pub checked: bool,
    /// Fold in plain simulation, without a cell
    #[arg(long)]
    pub simulate: bool,
    /// Root mean square of a trembling of the gripper in each direction
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, requires = "simulate")]
    pub jitter: Option<f64>,
    /// Seed of that
    #[arg(long, value_name = "N", default_value_t = 0, requires = "simulate")]
    pub seed: u32,
    /// Where the results go [default: results/fold-TIME, with --simulate results/fold_<name of the sheet's file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Start over and discard earlier results
    #[arg(long, requires = "simulate")]
    pub force: bool,
    /// Open the page in the browser
    #[arg(long, requires = "simulate")]
    pub open: bool,
}

/// Ways of folding by their names in scenario files.
const ALGORITHMS: [(&str, AlgorithmName); 5] = [
    ("held", AlgorithmName::Held),
    ("optimal", AlgorithmName::Optimal),
    ("least-friction", AlgorithmName::LeastFriction),
    ("circle", AlgorithmName::Circle),
    ("step-by-step", AlgorithmName::StepByStep),
];

/// A sheet that is to be folded.
pub struct AskedSheet {
    /// Its file.
    pub file: PaperFile,
    /// How far its edge goes, m.
    pub target: f64,
    /// Friction of the table.
    pub friction: f64,
}

impl FoldArguments {
    /// The way of folding by its name.
    pub fn algorithm(&self) -> AlgorithmName {
        let named = ALGORITHMS.iter().find(|(name, _)| *name == self.algorithm);
        named.map_or(AlgorithmName::Held, |(_, algorithm)| *algorithm)
    }

    /// The sheet, and what is asked of it.
    pub fn sheet(&self) -> Result<AskedSheet, Failure> {
        let file = PaperFile::read(&self.paper)?;
        let target = file.paper.target(self.crease).at("--crease")?;
        if self.feedback.is_some() && !self.algorithm().is_planned_anew() {
            let message = "--feedback: this way of folding is not planned anew: use `held`, `optimal` or `least-friction`";
            return Err(Failure::Input(message.into()));
        }
        let friction = self.friction.or(file.paper.friction);
        let needed = "the friction of the table is needed: --friction, or `folding.paper.friction`";
        Ok(AskedSheet {
            friction: friction.ok_or_else(|| Failure::Input(needed.into()))?,
            file,
            target,
        })
    }
}
