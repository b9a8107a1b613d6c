//! The outcome of a case that a search reads: a column of its summary, or the last value of one of
//! its series.

use super::SweepError;
use rodlab_files::finite;
use rodlab_files::results::{ResultsError, SERIES, SUMMARY};
use std::path::{Path, PathBuf};

/// Reads the objective of the finished case in a directory; `None` if the outcome is empty or not
/// a number.
///
/// # Errors
/// [`SweepError::UnknownObjective`], [`SweepError::Results`].
pub(super) fn objective(directory: &Path, column: &str) -> Result<Option<f64>, SweepError> {
    let mut known = Vec::new();
    for name in [SUMMARY, SERIES] {
        let (headers, last) = last_row(&directory.join(name))?;
        if let Some(place) = headers.iter().position(|header| header == column) {
            return Ok(last.get(place).and_then(finite::number));
        }
        known.extend(headers.iter().map(str::to_owned));
    }
    Err(SweepError::UnknownObjective {
        column: column.to_owned(),
        known: known.join(", "),
    })
}

fn last_row(path: &Path) -> Result<(csv::StringRecord, csv::StringRecord), ResultsError> {
    let damaged = |reason: String| ResultsError::Damaged {
        path: PathBuf::from(path),
        reason,
    };
    let mut reader = csv::Reader::from_path(path).map_err(|error| damaged(error.to_string()))?;
    let headers = reader
        .headers()
        .map_err(|error| damaged(error.to_string()))?
        .clone();
    let mut last = csv::StringRecord::new();
    for record in reader.records() {
        last = record.map_err(|error| damaged(error.to_string()))?;
    }
    Ok((headers, last))
}
