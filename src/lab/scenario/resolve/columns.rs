//! Named columns of numbers in CSV files that scenarios refer to.

use super::section::LARGEST;
use crate::scenario::input_file::{self, LARGEST_TABLE};
use rodlab_files::finite;
use std::path::Path;

/// Units that may stand behind the name of a column.
const UNITS: [&str; 2] = ["_m", "_s"];

/// Reads columns of a CSV file, named in its header line with or without their unit, as in `x_m`; other columns are
/// passed over. Lines that begin with `#` are comments. Returns each row with the number of its line.
///
/// # Errors
/// A message that names the file and the line.
pub fn read_columns<const N: usize>(
    path: &Path,
    names: [&str; N],
) -> Result<Vec<(u64, [f64; N])>, String> {
    let place = path.display();
    let bytes = input_file::read(path, LARGEST_TABLE)?;
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(bytes.as_slice());
    let headers = reader
        .headers()
        .map_err(|error| format!("{place}: {error}"))?
        .clone();
    let named = |header: &str, name: &str| {
        let bare = UNITS.iter().find_map(|unit| header.strip_suffix(unit));
        header == name || bare == Some(name)
    };
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        let found = headers.iter().position(|header| named(header, name));
        *column = found.ok_or_else(|| {
            let (last, others) = names.split_last().unwrap_or((&name, &[]));
            let others = others.join(", ");
            format!("{place}, line 1: no column `{name}`; the header must name {others} and {last}")
        })?;
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| match error.kind() {
            csv::ErrorKind::UnequalLengths {
                pos,
                expected_len,
                len,
            } => format!(
                "{place}, line {}: expected {expected_len} columns, found {len}",
                pos.as_ref().map_or(0, csv::Position::line)
            ),
            _ => format!("{place}: {error}"),
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut row = [0.0; N];
        for (component, column) in row.iter_mut().zip(columns) {
            let field = &record[column];
            *component = finite::number(field)
                .ok_or_else(|| format!("{place}, line {line}: {field:?} is not a finite number"))?;
            if component.abs() > LARGEST {
                return Err(format!(
                    "{place}, line {line}: {field:?} is out of range; allowed: at most {LARGEST:e} in magnitude"
                ));
            }
        }
        rows.push((line, row));
    }
    Ok(rows)
}
