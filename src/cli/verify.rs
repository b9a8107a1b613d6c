//! `rodlab verify`.

use clap::Args;

/// Arguments of `rodlab verify`.
#[derive(Debug, Args)]
#[command(after_help = "\
Every row compares the engine with theory: expected, got, error, verdict. Exit code 4 when one fails.")]
pub struct VerifyArguments {
    /// Run the slow checks, too
    #[arg(long)]
    pub full: bool,
    /// Print the rows as JSON
    #[arg(long)]
    pub json: bool,
}
