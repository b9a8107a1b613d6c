//! `rodlab view`.

use super::prelude::*;
use indicatif::ProgressBar;
use rodlab_files::results::PAGE;
use rodlab_lab::report::write_page;
use rodlab_robot::JointTrajectory;
use rodlab_workcell::cell::Cell;

/// Arguments of `rodlab view`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ViewArguments {
    /// The results directory of a run or a sweep, finished or still running; or a cell file (.toml)
    pub directory: PathBuf,
    /// Joint trajectory of the arms, for a cell file
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Output file [default: view.html in the directory]
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
  rodlab view cell.toml --trajectory joints.csv  a robot cell, its links as capsules

The page needs no network and no other file. The rods can be coloured by curvature and speed, with
`forces = true` under [output] also by twist and contact force. Press ? in the page for its keys.";

/// Writes the page of a results directory and prints its path.
pub fn view(arguments: &ViewArguments, common: &Common) -> Result<(), Failure> {
    let ending = arguments.directory.extension();
    if ending.is_some_and(|ending| ending == "toml") {
        return view_cell(arguments);
    }
    if arguments.trajectory.is_some() {
        return Err(Failure::Input("--trajectory belongs to a cell file".into()));
    }
    let to = arguments.out.clone();
    let to = to.unwrap_or_else(|| arguments.directory.join(PAGE));
    let bar = ProgressBar::no_length();
    let progress = common.progress(bar, "{bar:30} {pos} of {len} cases");
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
            "only {} outputs of each case are shown; --outputs shows more",
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
    if arguments.open { show(&to) } else { Ok(()) }
}

/// Writes the page of a robot cell, by default in the folder of its file.
fn view_cell(arguments: &ViewArguments) -> Result<(), Failure> {
    let cell = Cell::read(&arguments.directory)?;
    let trajectory = arguments.trajectory.as_deref().map(JointTrajectory::read);
    let trajectory = trajectory.transpose().or_input()?;
    let page = cell.page(trajectory.as_ref(), arguments.outputs as usize, &[]);
    let to = arguments.out.clone();
    let to = to.unwrap_or_else(|| arguments.directory.with_extension("html"));
    write_file(&to, page.as_bytes())?;
    print(&format!("{}\n", to.display()))?;
    if arguments.open { show(&to) } else { Ok(()) }
}

/// Opens a page in the browser.
pub(super) fn show(page: &Path) -> Result<(), Failure> {
    open::that(page).map_err(|error| {
        Failure::System(format!(
            "no browser could be started: {error}; open {}",
            page.display()
        ))
    })
}
