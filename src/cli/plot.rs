//! `rodlab plot`.

use super::failure::Failure;
use super::output::print;
use crate::experiment::plot_results;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `rodlab plot`.
#[derive(Debug, Args)]
pub struct PlotArguments {
    /// The results directory, of a finished or a running run
    pub directory: PathBuf,
}

/// Draws the figures of a results directory and prints where they are.
pub fn plot(arguments: &PlotArguments) -> Result<(), Failure> {
    let written = plot_results(&arguments.directory)?;
    let lines: String = written
        .iter()
        .map(|path| format!("{}\n", path.display()))
        .collect();
    print(&lines)
}
