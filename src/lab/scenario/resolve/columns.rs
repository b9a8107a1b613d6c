//! Named columns of numbers in CSV files that scenarios refer to.

use crate::scenario::input_file::{self, LARGEST_TABLE};
use crate::scenario::section::LARGEST;
use rodlab_files::input::{Column, Table};
use std::path::Path;

/// Reads columns of a CSV file, see [`Table`]. The header line names the columns with or without
/// their unit, as in `x_m` or `x_mm`; without a header the first columns are read. Other columns
/// are ignored. Returns each row in SI units with the number of its line.
///
/// # Errors
/// A message that names the file and the line.
pub fn read_columns<const N: usize>(
    path: &Path,
    names: [&str; N],
) -> Result<Vec<(u64, [f64; N])>, String> {
    let place = path.display();
    let bytes = input_file::read(path, LARGEST_TABLE)?;
    let text = std::str::from_utf8(&bytes).map_err(|_| format!("{place} is not UTF-8 text"))?;
    let table = Table::new(text).map_err(|error| format!("{place}: {error}"))?;
    let mut columns = [Column {
        index: 0,
        unit: 1.0,
    }; N];
    for (index, (column, name)) in columns.iter_mut().zip(names).enumerate() {
        *column = table.column(name, index).ok_or_else(|| {
            let (last, others) = names.split_last().unwrap_or((&name, &[]));
            let others = others.join(", ");
            format!("{place}, line 1: no column `{name}`; the header must name {others} and {last}")
        })?;
    }
    let mut rows = Vec::new();
    for (line, fields) in table.rows() {
        let at = |error: String| format!("{place}, line {line}: {error}");
        table.check_length(&fields).map_err(at)?;
        let mut row = [0.0; N];
        for (component, column) in row.iter_mut().zip(columns) {
            let field = &fields[column.index];
            *component = table
                .value(&fields, column)
                .ok_or_else(|| at(format!("{field:?} is not a finite number")))?;
            if component.abs() > LARGEST {
                return Err(at(format!(
                    "{field:?} is out of range; allowed: at most {LARGEST:e} in magnitude"
                )));
            }
        }
        rows.push((line as u64, row));
    }
    Ok(rows)
}
