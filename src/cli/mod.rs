//! The command line. Each subcommand has one file, which parses its arguments, calls the library
//! and prints.
//!
//! Results are written to standard output; progress, logs and errors to standard error. The exit
//! codes are a stable interface for scripts; the file `exit_code` defines them:
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | a case failed, or a file could not be read or written |
//! | 2 | bad input |
//! | 3 | no convergence |
//! | 4 | a physics check failed |
//! | 5 | time limit reached, resumable |
//! | 130 | interrupted, with a checkpoint written |

mod answers;
mod arguments;
mod calibrate;
mod candidates;
mod cell;
mod check;
mod chosen_cell;
mod chosen_rod;
mod common;
mod completions;
mod crash;
mod dataset;
mod demonstrations;
mod deploy;
mod design;
mod drawn_pattern;
mod evaluate;
mod exit_code;
mod expand;
mod explain;
mod explore;
mod export;
mod failure;
mod figure_arguments;
mod file_size;
mod fold;
mod fold_arguments;
mod fold_in_cell;
mod fold_simulation;
mod gather;
mod guide;
mod helix_file;
mod help;
mod identify;
mod identify_held;
mod in_cell;
mod init;
mod interruption;
mod laid_strokes;
mod laying;
mod live_page;
mod log_directory;
mod logging;
mod man;
mod markdown;
mod measure;
mod measure_knot;
mod measure_markers;
mod measure_rod;
mod measure_sheet;
mod middle_line;
mod movie;
mod output;
mod overview;
mod pattern_source;
mod picture_source;
mod place;
mod plan;
mod plan_deployment;
mod plan_fold;
mod plan_grippers;
mod plot;
mod prelude;
mod preset_file;
mod presets;
mod replay;
mod reproduce;
mod run;
mod run_watch;
mod safety_signals;
mod samples;
mod schema;
mod score;
mod sensitivity;
mod sensitivity_fields;
mod site;
mod solve;
mod solve_arm;
mod solve_fold;
mod solve_grasp;
mod solve_knot;
mod standard_error;
mod status;
mod status_line;
mod stream;
mod submit;
mod sweep;
mod terminal;
mod tie;
mod trace;
mod trace_answer;
mod train;
mod values;
mod verify;
mod view;
mod watchdog;

use arguments::{Arguments, Command};
use clap::{CommandFactory, FromArgMatches};
use clap_complete::CompleteEnv;
pub use demonstrations::Demonstrations;
use exit_code::ExitCode;
use failure::Failure;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_lab::run::RunError;
use rodlab_lab::sensitivity::SensitivityError;
use std::ffi::OsString;
use std::process;

/// Runs the program and returns its exit code.
pub fn main() -> process::ExitCode {
    // If a shell requests completions of a command line, answer it and exit.
    CompleteEnv::with_factory(Arguments::command).complete();
    crash::announce_panics();
    file_size::report_as_errors();
    process::ExitCode::from(run(std::env::args_os()))
}

/// Runs the program with its arguments and returns its exit code. The first argument is the name
/// of the program.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match parse(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // If the stream is closed, nothing can be reported.
            let _ = error.print();
            return error.exit_code() as u8;
        }
    };
    logging::start(&arguments.common);
    crash::guarded(|| match dispatch(&arguments) {
        Ok(()) => 0,
        Err(failure) => {
            failure.report(arguments.common.colours_stderr());
            failure.exit_code()
        }
    })
}

/// The demonstrations that the arguments request; `None` for any other command, and for arguments
/// that [`run()`] rejects. The first argument is the name of the program.
pub fn demonstrations(arguments: impl IntoIterator<Item = OsString>) -> Option<Demonstrations> {
    let arguments = parse(arguments).ok()?;
    match &arguments.command {
        Command::Dataset(command) => command.demonstrations(&arguments.common).ok()?,
        _ => None,
    }
}

/// The exit code for a run that ended early.
pub fn exit_code_of_run(error: &RunError) -> u8 {
    error.exit_code()
}

/// The exit code for an error of a simulation.
pub fn exit_code_of_simulation(error: &SimulationError) -> u8 {
    error.exit_code()
}

/// The exit code and the message of a failed differentiation.
pub fn failure_of_sensitivity(error: SensitivityError) -> (u8, String) {
    let failure = Failure::from(error);
    (failure.exit_code(), failure.in_words(false))
}

/// Result of a command that another program has called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The exit code, 0 for success.
    pub exit_code: u8,
    /// Standard output.
    pub output: String,
    /// Message of the failure, if the command failed.
    pub error: String,
}

/// Calls the program with arguments, without the name of the program, and collects its output.
/// Nothing is logged.
pub fn call(arguments: impl IntoIterator<Item = OsString>) -> Answer {
    let name = OsString::from(env!("CARGO_PKG_NAME"));
    let arguments = match parse([name].into_iter().chain(arguments)) {
        Ok(arguments) => arguments,
        Err(error) if error.exit_code() == 0 => {
            return Answer {
                exit_code: 0,
                output: error.to_string(),
                error: String::new(),
            };
        }
        Err(error) => {
            return Answer {
                exit_code: error.exit_code() as u8,
                output: String::new(),
                error: error.to_string(),
            };
        }
    };
    let mut error = String::new();
    let (exit_code, output) = output::collect(|| {
        crash::guarded(|| match dispatch(&arguments) {
            Ok(()) => 0,
            Err(failure) => {
                error = failure.in_words(false);
                failure.exit_code()
            }
        })
    });
    Answer {
        exit_code,
        output,
        error,
    }
}

fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    if let Some(commit) = option_env!("RODLAB_COMMIT") {
        rodlab_files::origin::state_commit(commit);
    }
    let program = overview::with_groups(Arguments::command());
    Arguments::from_arg_matches(&program.try_get_matches_from(arguments)?)
}

fn dispatch(arguments: &Arguments) -> Result<(), Failure> {
    preset_file::log_substitutes();
    arguments.common.start_threads()?;
    // A thread of the pool can divide work without waking another thread first and waiting for it.
    rayon::scope(|_| run_command(arguments))
}

fn run_command(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        Command::Run(command) => run::run(command, &arguments.common),
        Command::Dataset(command) => dataset::dataset(command, &arguments.common),
        Command::Train(command) => train::train(command, &arguments.common),
        Command::Evaluate(command) => evaluate::evaluate(command),
        Command::Check(command) => check::check(command, &arguments.common),
        Command::Expand(command) => expand::expand(command),
        Command::Init(command) => init::init(command),
        Command::Presets(command) => presets::presets(command),
        Command::Schema => schema::schema(),
        Command::Explain(command) => explain::explain(command),
        Command::Guide(command) => guide::guide(command, &arguments.common),
        Command::Solve(command) => solve::solve(command),
        Command::Measure(command) => measure::measure(command),
        Command::Sensitivity(command) => sensitivity::sensitivity(command),
        Command::Design(command) => design::design(command),
        Command::Identify(command) => identify::identify(command, &arguments.common),
        Command::Verify(command) => verify::verify(command),
        Command::Reproduce(command) => reproduce::reproduce(command, &arguments.common),
        Command::Plan(command) => plan::plan(command),
        Command::Fold(command) => fold::fold(command, &arguments.common),
        Command::Plot(command) => plot::plot(command),
        Command::View(command) => view::view(command, &arguments.common),
        Command::Movie(command) => movie::movie(command, &arguments.common),
        Command::Export(command) => export::export(command),
        Command::Replay(command) => replay::replay(command),
        Command::Stream(command) => stream::stream(command),
        Command::Deploy(command) => deploy::deploy(command, &arguments.common),
        Command::Place(command) => command.run(&arguments.common),
        Command::Tie(command) => command.run(&arguments.common),
        Command::Explore(command) => command.run(&arguments.common),
        Command::Cell(command) => cell::cell(command),
        Command::Submit(command) => submit::submit(command),
        Command::Status(command) => status::status(command),
        Command::Gather(command) => gather::gather(command),
        Command::Trace(command) => trace::trace(command),
        Command::Score(command) => score::score(command),
        Command::Calibrate(command) => calibrate::calibrate(command),
        Command::Completions(command) => completions::completions(command),
        Command::Site(command) => site::site(command, Arguments::command()),
        Command::Man(command) => man::man(command, Arguments::command()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn of(words: &str) -> Option<Demonstrations> {
        demonstrations(words.split(' ').map(OsString::from))
    }

    #[test]
    fn demonstrations_are_asked_for_with_a_format_and_an_environment() {
        let found = of("rodlab -q dataset Folding --format lerobot --count 3 --out here");
        let wanted = Demonstrations {
            task: "Folding",
            count: 3,
            out: PathBuf::from("here"),
            format: "lerobot",
            seed: 0,
            pictures: true,
            quiet: true,
        };
        assert_eq!(found, Some(wanted));
        for words in [
            "rodlab dataset Folding",
            "rodlab dataset folding_dataset",
            "rodlab dataset folding_dataset --format npz",
            "rodlab dataset Folding --format csv",
            "rodlab dataset Folding --format npz --dry-run",
            "rodlab dataset Folding --count 3",
            "rodlab presets",
        ] {
            assert_eq!(of(words), None, "{words}");
        }
    }
}
