//! `rodlab verify`.

use super::failure::Failure;
use super::output::print;
use crate::verify::{self, Check, Verdict};
use clap::Args;
use serde::Serialize;

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

/// A row of the table with its verdict.
#[derive(Serialize)]
struct Row<'a> {
    #[serde(flatten)]
    check: &'a Check,
    verdict: Verdict,
}

/// Runs the checks and prints their table.
pub fn verify(arguments: &VerifyArguments) -> Result<(), Failure> {
    let checks = verify::verify(arguments.full);
    let rows: Vec<Row> = checks
        .iter()
        .map(|check| Row {
            check,
            verdict: check.verdict(),
        })
        .collect();
    if arguments.json {
        let text = serde_json::to_string_pretty(&rows)
            .map_err(|error| Failure::System(format!("the table cannot be written: {error}")))?;
        print(&format!("{text}\n"))?;
    } else {
        print(&verify::table(&checks))?;
    }
    let failed = rows
        .iter()
        .filter(|row| row.verdict == Verdict::Fail)
        .count();
    if failed == 0 {
        Ok(())
    } else {
        Err(Failure::Checks { failed })
    }
}
