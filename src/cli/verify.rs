//! `rodlab verify`.

use super::prelude::*;
use crate::verify::{self, Check, GroupResult, Verdict};

/// Arguments of `rodlab verify`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab verify
  rodlab verify --markdown > results/reproduced/verify.md

Every row compares the engine with theory: expected value, value found, error, verdict. Exit code 4
if a check fails.")]
pub struct VerifyArguments {
    /// Run the slow checks as well
    #[arg(long)]
    pub full: bool,
    /// Print the rows as JSON
    #[arg(long, conflicts_with = "markdown")]
    pub json: bool,
    /// Print a page in Markdown, a table per group
    #[arg(long)]
    pub markdown: bool,
}

/// A row of the table, with its verdict.
#[derive(Serialize)]
struct Row<'a> {
    #[serde(flatten)]
    check: &'a Check,
    verdict: Verdict,
}

/// Runs the checks and prints their table.
pub fn verify(arguments: &VerifyArguments) -> Result<(), Failure> {
    let groups = verify::verify(arguments.full);
    let checks = all_checks(&groups);
    let rows: Vec<Row> = checks
        .iter()
        .map(|check| Row {
            check,
            verdict: check.verdict(),
        })
        .collect();
    if arguments.markdown {
        print(&verify::markdown(&groups))?;
    } else if arguments.json {
        print_json(&rows)?;
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
        Err(Failure::Other {
            exit_code: 4,
            message: format!("{failed} physics checks failed"),
        })
    }
}

fn all_checks(groups: &[GroupResult]) -> Vec<Check> {
    groups
        .iter()
        .flat_map(|group| group.checks.iter().cloned())
        .collect()
}
