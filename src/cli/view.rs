//! `rodlab view`.

use super::common::Common;
use super::failure::Failure;
use super::output::print;
use crate::report::write_page;
use crate::results::PAGE;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;

/// Arguments of `rodlab view`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ViewArguments {
    /// The results directory of a run or a sweep, finished or still running
    pub directory: PathBuf,
    /// Where to write the page [default: view.html in the directory]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Show at most this many outputs of each case, evenly spread
    #[arg(long, value_name = "N", default_value = "2500", value_parser = clap::value_parser!(u32).range(1..))]
    pub outputs: u32,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
}

const EXAMPLES: &str = "\
Examples:
  rodlab view results/flagella_quick --open      turn, zoom and play it in the browser
  rodlab view results/sweep --out sweep.html     one file with all cases, to send to a colleague

The page needs no network and no other file. The rods can be coloured by curvature and speed, with
`forces = true` under [output] also by twist and contact force. Press ? in the page for its keys.";

/// Writes the page of a results directory and prints where it is.
pub fn view(arguments: &ViewArguments, common: &Common) -> Result<(), Failure> {
    let to = arguments.out.clone();
    let to = to.unwrap_or_else(|| arguments.directory.join(PAGE));
    let progress = if common.quiet {
        ProgressBar::hidden()
    } else {
        ProgressBar::no_length()
    };
    let style = ProgressStyle::with_template("{bar:30} {pos} of {len} cases");
    progress.set_style(style.expect("the template is in order"));
    let written = write_page(
        &arguments.directory,
        &to,
        arguments.outputs as usize,
        &|done, all| {
            progress.set_length(all as u64);
            progress.set_position(done as u64);
        },
    );
    progress.finish_and_clear();
    let written = written?;
    if written.thinned {
        tracing::warn!(
            "only {} outputs of each case are shown; --outputs takes more",
            arguments.outputs
        );
    }
    print(&format!(
        "{}\n{} {}, {:.1} MB\n",
        to.display(),
        written.cases,
        if written.cases == 1 { "case" } else { "cases" },
        written.bytes as f64 / 1e6
    ))?;
    if arguments.open {
        open::that(&to).map_err(|error| {
            Failure::System(format!(
                "no browser could be started: {error}; open {}",
                to.display()
            ))
        })?;
    }
    Ok(())
}
