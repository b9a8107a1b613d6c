//! `rodlab completions`.

use super::arguments::Arguments;
use super::failure::Failure;
use super::output::print;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

/// Arguments of `rodlab completions`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab completions bash > ~/.local/share/bash-completion/completions/rodlab")]
pub struct CompletionsArguments {
    /// The shell
    pub shell: Shell,
}

/// Prints a completion script.
pub fn completions(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut Arguments::command(),
        "rodlab",
        &mut script,
    );
    print(&String::from_utf8_lossy(&script))
}
