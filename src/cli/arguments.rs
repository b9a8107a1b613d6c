//! The arguments of the program and those common to all subcommands.

use super::failure::Failure;
use super::{
    calibrate, check, completions, explain, gather, guide, init, measure, plan, plot, reproduce,
    run, score, solve, status, stream, submit, trace, verify, view,
};
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use std::io::IsTerminal;

/// A laboratory for slender elastic rods: bending, twist, contact, friction, viscous fluid.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Options that every subcommand has.
    #[command(flatten)]
    pub common: Common,
}

const EXAMPLES: &str = "\
Examples:
  rodlab run scenarios/flagella_quick.toml       run a scenario; results/flagella_quick/ holds the results
  rodlab run beam.toml --set rods.beam.radius=\"7 mm\" --out results/thick
  rodlab check beam.toml                         find mistakes; print stiffnesses and other derived numbers
  rodlab init scene > my_scene.toml              begin a scenario of your own
  rodlab explain rods.natural_curvature          one key of scenario files in words
  rodlab guide getting-started                   the guide, a page per topic

Exit codes: 0 done, 1 failed, 2 bad input, 3 no convergence, 4 a physics check failed,
5 time limit reached (run again to continue), 130 interrupted (run again to continue).";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario, or continue an interrupted run of it
    Run(run::RunArguments),
    /// Validate scenarios and print derived numbers
    Check(check::CheckArguments),
    /// Write a commented scenario template to standard output
    Init(init::InitArguments),
    /// Print the JSON Schema of scenario files, for completion in editors
    Schema,
    /// Explain a key of scenario files, or a file or column of results
    Explain(explain::ExplainArguments),
    /// Read the guide: a page per topic
    Guide(guide::GuideArguments),
    /// Solve a problem exactly; the answer is JSON on standard output
    Solve(solve::SolveArguments),
    /// Measure a gravito-bending length from the shape of a rod or strip, or identify the knot of a curve
    Measure(measure::MeasureArguments),
    /// Compare the engine with theory, check by check
    Verify(verify::VerifyArguments),
    /// Reproduce a table or figure of the thesis
    Reproduce(reproduce::ReproduceArguments),
    /// Plan a trajectory: joint positions along poses of a hand
    Plan(plan::PlanArguments),
    /// Draw the figures of a results directory
    Plot(plot::PlotArguments),
    /// Write an interactive 3-D page of a results directory
    View(view::ViewArguments),
    /// Stream a joint trajectory to the arms and axes of a cell
    Stream(stream::StreamArguments),
    /// Run a sweep as a Slurm job array
    Submit(submit::SubmitArguments),
    /// Show the status of a sweep's cases and of the Slurm tasks that run them
    Status(status::StatusArguments),
    /// Collect the cases of a sweep into its tables and figures
    Gather(gather::GatherArguments),
    /// Find the centrelines of rods in an image
    Trace(trace::TraceArguments),
    /// Compare a deployed curve with its pattern
    Score(score::ScoreArguments),
    /// Calibrate a camera, its pose or its mount
    Calibrate(calibrate::CalibrateArguments),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArguments),
}

/// Options that every subcommand has.
#[derive(Debug, Args)]
pub struct Common {
    /// Threads to use; results do not depend on their number [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Log more: once for what is done, twice for time steps, three times for Newton iterations
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
    /// Log errors only, and show no progress
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Format of the log on standard error
    #[arg(long, global = true, value_name = "FORMAT", default_value = "text")]
    pub log: LogFormat,
    /// When to use colours
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub color: Color,
}

/// Formats of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// Lines for people.
    Text,
    /// One JSON object per line.
    Json,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Color {
    /// On a terminal, unless the environment sets `NO_COLOR`.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

impl Common {
    /// Whether text on standard error is coloured.
    pub fn colours_stderr(&self) -> bool {
        self.colours(std::io::stderr().is_terminal())
    }

    /// Whether text on standard output is styled.
    pub fn styles_stdout(&self) -> bool {
        self.colours(std::io::stdout().is_terminal())
    }

    fn colours(&self, is_terminal: bool) -> bool {
        match self.color {
            Color::Always => true,
            Color::Never => false,
            Color::Auto => {
                is_terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
            }
        }
    }

    /// Sets the number of threads.
    ///
    /// # Errors
    /// The system could not start them.
    pub fn start_threads(&self) -> Result<(), Failure> {
        let Some(threads) = self.threads else {
            return Ok(());
        };
        refuse_too_many_threads("--threads", threads)?;
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads))
            .build_global()
            .map_err(|error| Failure::System(format!("cannot start {threads} threads: {error}")))
    }
}

/// Threads, for each processor, beyond which they only wait for each other.
const THREADS_OF_A_PROCESSOR: usize = 16;

/// Refuses numbers of threads that take longer to start than any work would.
///
/// # Errors
/// [`Failure::Input`] names the option and the largest number.
pub fn refuse_too_many_threads(option: &str, threads: u16) -> Result<(), Failure> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (THREADS_OF_A_PROCESSOR * processors).max(64);
    if usize::from(threads) > most {
        return Err(Failure::Input(format!(
            "{option} {threads} is out of range; allowed on this machine of {processors} processors: 1 to {most}"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        Arguments::command().debug_assert();
    }
}
