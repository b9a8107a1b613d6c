//! Named columns of numbers in CSV files that scenarios refer to.

use std::path::Path;

/// Reads three columns of a CSV file, named in its header line with or without the suffix `_m`; other columns are
/// passed over. Lines that begin with `#` are comments. Returns each row with the number of its line.
///
/// # Errors
/// A message that names the file and the line.
pub fn read_columns(path: &Path, names: [&str; 3]) -> Result<Vec<(u64, [f64; 3])>, String> {
    let place = path.display();
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|error| format!("{place} cannot be read: {error}"))?;
    let headers = reader
        .headers()
        .map_err(|error| format!("{place}: {error}"))?
        .clone();
    let column = |name: &str| {
        headers
            .iter()
            .position(|header| header == name || header.strip_suffix("_m") == Some(name))
            .ok_or_else(|| {
                let [a, b, c] = names;
                format!(
                    "{place}, line 1: no column `{name}`; the header must name {a}, {b} and {c}"
                )
            })
    };
    let columns = [column(names[0])?, column(names[1])?, column(names[2])?];
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
        let mut row = [0.0; 3];
        for (component, column) in row.iter_mut().zip(columns) {
            let field = &record[column];
            *component = field
                .parse()
                .ok()
                .filter(|number: &f64| number.is_finite())
                .ok_or_else(|| format!("{place}, line {line}: {field:?} is not a finite number"))?;
        }
        rows.push((line, row));
    }
    Ok(rows)
}
