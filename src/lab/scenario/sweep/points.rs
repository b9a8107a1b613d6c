//! Points of a sweep from a CSV file.

use super::axis::{Axis, SweptKey};
use crate::scenario::document::Node;
use crate::scenario::input_file::{self, LARGEST_TEXT};
use crate::scenario::overrides::parse_value;
use crate::scenario::source::Span;
use std::path::Path;

/// Reads a header line of dotted keys and a row per point. Lines that begin with `#` are comments.
/// Values are read as in `--set`. Messages refer to the position `span`.
///
/// # Errors
/// A message with the file, and with the line of a faulty row.
pub fn read(path: &Path, span: &Span) -> Result<Axis, String> {
    let place = path.display();
    let bytes = input_file::read(path, LARGEST_TEXT)?;
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(bytes.as_slice());
    let headers = reader
        .headers()
        .map_err(|error| format!("{place}: {error}"))?;
    let keys: Vec<SweptKey> = headers
        .iter()
        .map(|key| SweptKey {
            key: key.to_owned(),
            span: span.clone(),
        })
        .collect();
    if let Some(empty) = keys.iter().position(|key| key.key.is_empty()) {
        return Err(format!("{place}, line 1: column {} has no key", empty + 1));
    }
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| format!("{place}: {error}"))?;
        let value = |text: &str| Node {
            span: span.clone(),
            ..parse_value(span.source, 0, text)
        };
        points.push(record.iter().map(value).collect());
    }
    if points.is_empty() {
        return Err(format!("{place} has no rows; give at least one point"));
    }
    Ok(Axis { keys, points })
}
