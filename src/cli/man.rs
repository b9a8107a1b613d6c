//! `rodlab man`.

use super::prelude::*;
use clap::Command;

/// Arguments of `rodlab man`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab man ~/.local/share/man/man1        then: man rodlab, man rodlab-run")]
pub struct ManArguments {
    /// Directory for rodlab.1 and a page for each subcommand
    #[arg(value_name = "DIR")]
    directory: PathBuf,
}

/// Writes the manual pages of `program`.
pub fn man(arguments: &ManArguments, program: Command) -> Result<(), Failure> {
    let directory = &arguments.directory;
    make_directory(directory)?;
    clap_mangen::generate_to(program, directory).map_err(|error| {
        Failure::System(format!(
            "{} cannot be written: {error}",
            directory.display()
        ))
    })
}
