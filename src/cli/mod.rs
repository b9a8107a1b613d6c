//! The command line: one file per subcommand, each of which parses, calls the library and prints.
//!
//! Standard output carries results, standard error progress, logs and faults. The exit codes are a
//! promise to scripts; `Failure::exit_code` holds them:
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

mod arguments;
mod check;
mod common;
mod completions;
mod explain;
mod failure;
mod gather;
mod guide;
mod init;
mod logging;
mod markdown;
mod measure;
mod measure_knot;
mod output;
mod plot;
mod reproduce;
mod run;
mod schema;
mod solve;
mod solve_knot;
mod status;
mod submit;
mod sweep;
mod values;
mod verify;
mod view;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use failure::Failure;
use std::process::ExitCode;

/// Runs the program and returns its exit code.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match dispatch(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.report(arguments.common.colours_stderr());
            ExitCode::from(failure.exit_code())
        }
    }
}

fn dispatch(arguments: &Arguments) -> Result<(), Failure> {
    logging::start(&arguments.common);
    arguments.common.start_threads()?;
    // A thread of the pool shares work out without waking another one first and waiting for it.
    rayon::scope(|_| run_command(arguments))
}

fn run_command(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        Command::Run(command) => run::run(command, &arguments.common),
        Command::Check(command) => check::check(command, &arguments.common),
        Command::Init(command) => init::init(command),
        Command::Schema => schema::schema(),
        Command::Explain(command) => explain::explain(command),
        Command::Guide(command) => guide::guide(command, &arguments.common),
        Command::Solve(command) => solve::solve(command),
        Command::Measure(command) => measure::measure(command),
        Command::Verify(command) => verify::verify(command),
        Command::Reproduce(command) => reproduce::reproduce(command, &arguments.common),
        Command::Plot(command) => plot::plot(command),
        Command::View(command) => view::view(command, &arguments.common),
        Command::Submit(command) => submit::submit(command),
        Command::Status(command) => status::status(command),
        Command::Gather(command) => gather::gather(command),
        Command::Completions(command) => completions::completions(command, Arguments::command()),
    }
}
