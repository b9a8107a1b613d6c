//! `rodlab reproduce`.

use super::candidates::artifacts;
use super::figure_arguments::FigureArguments;
use super::prelude::*;
use super::{standard_error, watchdog};
use crate::reproduce::{self, ARTIFACTS, Artifact, ReproduceOptions};
use rodlab_files::figure::Format;

/// Directory for reproduced pages.
const PUBLISHED: &str = "results/reproduced";
/// Directory for short versions of pages, which must not replace the full ones.
const QUICK: &str = "results/reproduced-quick";

/// Arguments of `rodlab reproduce`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab reproduce --list
  rodlab reproduce tab2.1 --quick            a short version, in results/reproduced-quick
  rodlab reproduce tab2.2 --jobs 4
  rodlab reproduce fig2.7 --redraw --format pdf --width 85mm --font-size 8     a journal column

Finished runs are not repeated, interrupted ones are resumed. With --jobs 1 a run has the machine to
itself and its wall times can be compared.")]
pub struct ReproduceArguments {
    /// The table or figure, as --list shows it
    #[arg(required_unless_present = "list", value_parser = artifact, add = artifacts())]
    pub artifact: Option<&'static Artifact>,
    /// List what can be reproduced and its rough cost
    #[arg(long, conflicts_with = "artifact")]
    pub list: bool,
    /// Simulate only a short time; the page is in a separate folder and states this
    #[arg(long)]
    pub quick: bool,
    /// Directory for artefacts [default: results/reproduced, with --quick results/reproduced-quick]
    ///
    /// Each artefact has a folder of its name; its runs are in the folder `cases`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of runs at a time; they share the threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: u16,
    /// Draw the figures again from the table beside the page, without any run
    #[arg(long, conflicts_with_all = ["quick", "list", "jobs"])]
    pub redraw: bool,
    /// Style of the figures
    #[command(flatten)]
    pub figures: FigureArguments,
}

impl ReproduceArguments {
    fn directory(&self) -> PathBuf {
        let usual = if self.quick { QUICK } else { PUBLISHED };
        self.out.clone().unwrap_or_else(|| usual.into())
    }
}

fn artifact(name: &str) -> Result<&'static Artifact, String> {
    let names = || -> String {
        let names: Vec<_> = ARTIFACTS.iter().map(Artifact::name).collect();
        names.join(", ")
    };
    Artifact::named(name).ok_or_else(|| format!("expected one of: {}", names()))
}

/// Produces an artefact and prints the paths of its files, or lists all.
pub fn reproduce(arguments: &ReproduceArguments, common: &Common) -> Result<(), Failure> {
    let Some(artifact) = arguments.artifact else {
        return print(&list());
    };
    let options = ReproduceOptions {
        directory: arguments.directory(),
        quick: arguments.quick,
        jobs: usize::from(arguments.jobs),
        // Since pages are published, they must not contain the path of the program on this
        // machine.
        command_line: std::iter::once("rodlab".into())
            .chain(std::env::args_os().skip(1))
            .map(|argument| argument.to_string_lossy().into_owned())
            .collect(),
        figures: arguments.figures.options(&[Format::Svg])?,
    };
    let report = |line: &str| {
        if !common.quiet {
            standard_error::report(&format!("{line}\n"));
        }
    };
    watchdog::watch(None);
    let written = if arguments.redraw {
        reproduce::redraw(artifact, &options)?
    } else {
        reproduce::reproduce(artifact, &options, &report)?
    };
    print_paths(&written)
}

/// Lists name, cost on one core and title, one line per artefact.
fn list() -> String {
    let names = ARTIFACTS.iter().map(|artifact| artifact.name().len());
    let width = names.max().unwrap_or(0);
    let line = |[name, whole, quick, title]: [&str; 4]| {
        format!("{name:<width$}{whole:>10}{quick:>9}  {title}\n")
    };
    let artifact = |artifact: &Artifact| {
        let [whole, quick] = [false, true].map(|quick| duration(artifact.cost(quick)));
        line([artifact.name(), &whole, &quick, artifact.title()])
    };
    line(["", "one core", "--quick", ""]) + &ARTIFACTS.iter().map(artifact).collect::<String>()
}

/// Rough duration as text.
fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_names_everything_that_is_accepted() {
        let list = list();
        for known in ARTIFACTS.iter() {
            assert!(list.contains(known.name()) && list.contains(known.title()));
            assert_eq!(artifact(known.name()), Ok(known));
        }
        assert!(artifact("fig9.9").unwrap_err().contains("tab2.1"));
    }

    #[test]
    fn durations_are_rough() {
        assert_eq!(
            [42.4, 600.0, 9000.0].map(duration),
            ["42 s", "10 min", "2.5 h"]
        );
    }
}
