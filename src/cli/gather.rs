//! `rodlab gather`.

use super::prelude::*;
use super::sweep::verdict;
use rodlab_files::figure::FigureOptions;
use rodlab_lab::report::plot_results;
use rodlab_lab::sweep;

/// Arguments of `rodlab gather`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab gather results/sweep

Updates summary.csv, timings.csv and manifest.json from the cases of all processes, and draws the
figures of `rodlab plot`. It may run while tasks are running.")]
pub struct GatherArguments {
    /// The results directory of a sweep
    pub directory: PathBuf,
}

/// Makes the tables and figures of a sweep from its cases.
pub fn gather(arguments: &GatherArguments) -> Result<(), Failure> {
    let outcome = sweep::gather(&arguments.directory)?;
    let figures = plot_results(&arguments.directory, &FigureOptions::default())?;
    print(&format!("{}\n", outcome.counts))?;
    print_paths(&figures)?;
    verdict(&outcome)
}
