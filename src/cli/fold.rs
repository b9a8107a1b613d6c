//! `rodlab fold`.

use super::common::Common;
use super::failure::Failure;
use super::folded_sheet::PaperFile;
use super::output::print;
use super::plan_fold::{crease, friction};
use super::run::{prepare, summary};
use super::values::positive_length;
use super::view::show;
use super::watchdog;
use crate::experiment::{Crease, case_set_from_text};
use crate::report::write_page;
use crate::results::PAGE;
use crate::run::RunOptions;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Outputs that the page shows at most.
const OUTPUTS: usize = 2500;
/// Time of a fold, s.
const TIME: f64 = 15.0;

/// Arguments of `rodlab fold`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab fold --paper scenarios/papers/a4.toml --crease half --simulate --open
  rodlab fold --paper scenarios/papers/us_letter.toml --crease half --algorithm optimal --feedback 5 --simulate
  rodlab fold --paper scenarios/papers/a4.toml --crease \"25 cm\" --algorithm circle --simulate --out results/circle

The sheet is planned, folded in simulation on a table of its friction, and scored: how far it slid, and how long the fold
became. The results directory is that of any run; its scenario can be taken on with `rodlab run`.")]
pub struct FoldArguments {
    /// The sheet: TOML with [folding.paper], as in scenarios/papers
    #[arg(long, value_name = "FILE")]
    paper: PathBuf,
    /// Where the edge goes: `half`, onto the opposite edge; `diagonal`, a corner of a square sheet onto the opposite one; or how far
    #[arg(long, value_name = "half|diagonal|LENGTH", value_parser = crease, default_value = "half")]
    crease: Crease,
    /// Fold in simulation
    #[arg(long, required = true)]
    simulate: bool,
    /// How the way of the gripper is planned; `held` holds the edge with as little moment as the friction needs
    #[arg(long, default_value = "held", value_parser = PossibleValuesParser::new(ALGORITHMS))]
    algorithm: String,
    /// Look after each of N parts of the way but the last, and plan the next anew
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    feedback: Option<u16>,
    /// Friction of the table [default: that in the sheet's file]
    #[arg(long, value_name = "FRICTION", value_parser = friction)]
    friction: Option<f64>,
    /// Root mean square of a trembling of the gripper in each direction
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    jitter: Option<f64>,
    /// Seed of that
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Where the results go [default: results/fold_<name of the sheet's file>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Start over and discard earlier results
    #[arg(long)]
    force: bool,
    /// Open the page in the browser
    #[arg(long)]
    open: bool,
}

/// Names of algorithms in scenario files.
const ALGORITHMS: [&str; 5] = [
    "held",
    "optimal",
    "least-friction",
    "circle",
    "step-by-step",
];

/// Folds a sheet in simulation, writes the page and prints the score.
pub fn fold(arguments: &FoldArguments, common: &Common) -> Result<(), Failure> {
    watchdog::watch(None);
    let file = PaperFile::read(&arguments.paper)?;
    let target = file.paper.target(arguments.crease);
    target.map_err(|error| Failure::Input(format!("--crease: {error}")))?;
    let Some(friction) = arguments.friction.or(file.paper.friction) else {
        let message =
            "the friction of the table is needed: --friction, or `folding.paper.friction`";
        return Err(Failure::Input(message.into()));
    };
    let stem = arguments.paper.file_stem().unwrap_or_default();
    let name = format!("fold_{}", stem.to_string_lossy());
    let text = arguments.scenario(&file.title, friction)?;
    let cases = case_set_from_text(&name, &text, Path::new(""))?;
    let prepared = prepare(&cases)?;
    let directory = arguments.out.clone();
    let directory = directory.unwrap_or_else(|| Path::new("results").join(&name));
    let options = RunOptions {
        force: arguments.force,
        progress: !common.quiet,
        ..RunOptions::new(directory)
    };
    let outcome = crate::run::run(&prepared, &options)?;
    let page = outcome.directory.join(PAGE);
    write_page(&outcome.directory, &page, OUTPUTS, &|_, _| {})?;
    print(&summary(&outcome))?;
    print(&format!("{:<24}{}\n", "page", page.display()))?;
    if arguments.open { show(&page) } else { Ok(()) }
}

impl FoldArguments {
    /// The scenario of this fold.
    fn scenario(&self, title: &str, friction: f64) -> Result<String, Failure> {
        let paper = std::path::absolute(&self.paper);
        let paper = paper.map_err(|error| Failure::System(error.to_string()))?;
        let quoted = |text: &str| toml::Value::from(text).to_string();
        let crease = match self.crease {
            Crease::Half => quoted("half"),
            Crease::Diagonal => quoted("diagonal"),
            Crease::At(target) => format!("{target:?}"),
        };
        let mut text = format!(
            "extends = {}\nexperiment = \"folding\"\ntitle = {}\n\n[folding]\ncrease = {crease}\nalgorithm = {}\nseed = {}\n",
            quoted(&paper.to_string_lossy()),
            quoted(title),
            quoted(&self.algorithm),
            self.seed
        );
        // Writing to a string cannot fail.
        if let Some(parts) = self.feedback {
            let _ = writeln!(text, "feedback = {{ parts = {parts} }}");
        }
        if let Some(jitter) = self.jitter {
            let _ = writeln!(text, "jitter = {jitter:?}");
        }
        let _ = write!(
            text,
            "\n[contact]\nfriction = {friction:?}\ndistance_tolerance = \"20 µm\"\nslip_tolerance = \"0.02 mm/s\"\n\n\
             [time]\nstep = \"5 ms\"\nend = {TIME:?}\n\n[output]\ninterval = \"0.1 s\"\n"
        );
        Ok(text)
    }
}
