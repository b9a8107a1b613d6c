//! `rodlab completions`.

use super::prelude::*;
use clap_complete::env::Shells;

/// Arguments of `rodlab completions`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  echo 'source <(rodlab completions bash)' >> ~/.bashrc
  rodlab completions fish > ~/.config/fish/completions/rodlab.fish

The script calls the program for presets, topics, pages and keys. Print it again after an update.")]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(Shells::builtins().names()))]
    shell: String,
}

/// Prints a completion script.
pub fn completions(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let shells = Shells::builtins();
    let completer = shells.completer(&arguments.shell).expect("one of them");
    let mut script = Vec::new();
    completer
        .write_registration("COMPLETE", "rodlab", "rodlab", "rodlab", &mut script)
        .map_err(Failure::system)?;
    print(&String::from_utf8_lossy(&script))
}
