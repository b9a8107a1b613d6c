//! Errors of figures.

use crate::experiment::FigureError;
use crate::scenario::{ScenarioError, did_you_mean};
use rodlab_files::results::ResultsError;
use std::path::PathBuf;

/// Reason why a figure is not drawn.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The directory holds no results.
    #[error("`{}` is not a results directory: it has no manifest.json; give the directory that `rodlab run` prints", .0.display())]
    NotResults(PathBuf),
    /// No table has all requested columns.
    #[error("there is no column `{column}`{}; columns: {}", hint(.column, .known), .known.join(", "))]
    UnknownColumn {
        /// The column as typed.
        column: String,
        /// The existing columns.
        known: Vec<String>,
    },
    /// A column holds words where numbers are needed.
    #[error(
        "column `{0}` holds no numbers, but an axis needs numbers; words can only be a --group"
    )]
    NoNumbers(String),
    /// The columns are in different tables.
    #[error(
        "`{first}` is a column of {first_table} and `{second}` of {second_table}; a figure takes --x and --y from one of them"
    )]
    DifferentTables {
        /// A column.
        first: String,
        /// The file that contains it.
        first_table: &'static str,
        /// Another column.
        second: String,
        /// The file that contains the other column.
        second_table: &'static str,
    },
    /// The scenario of the results could not be read.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl From<FigureError> for PlotError {
    fn from(error: FigureError) -> Self {
        match error {
            FigureError::Scenario(error) => Self::Scenario(error),
            FigureError::Results(error) => Self::Results(error),
        }
    }
}

fn hint(column: &str, known: &[String]) -> String {
    let hint = did_you_mean(column, known.iter().map(String::as_str));
    hint.map_or_else(String::new, |hint| format!("; {hint}"))
}
