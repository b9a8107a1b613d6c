//! `rodlab completions`.

use super::prelude::*;
use clap::Command;
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

/// Prints a completion script for the arguments of `program`.
pub fn completions(arguments: &CompletionsArguments, mut program: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "rodlab", &mut script);
    print(&String::from_utf8_lossy(&script))
}
