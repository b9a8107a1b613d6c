//! Rows of a table as curves, a curve for each group of rows.

use crate::figure::Curve;
use crate::results::Table;

/// Which group each row of a table belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Grouping {
    /// Names of the groups in the order of their first rows.
    pub names: Vec<String>,
    /// Number of the group of each row.
    pub groups: Vec<usize>,
}

impl Grouping {
    /// Rows with the same cells in `columns` are a group; without columns all rows are one.
    pub fn of(table: &Table, columns: &[&str]) -> Self {
        let cells: Vec<Vec<&str>> = columns
            .iter()
            .filter_map(|column| Some(table.column(column)?.collect()))
            .collect();
        let name = |row: usize| {
            let pairs = columns.iter().zip(&cells);
            let pairs = pairs.map(|(column, cells)| format!("{column} = {}", cells[row]));
            pairs.collect::<Vec<_>>().join(", ")
        };
        let mut names: Vec<String> = Vec::new();
        let groups = (0..table.len())
            .map(|row| {
                let name = name(row);
                names
                    .iter()
                    .position(|known| *known == name)
                    .unwrap_or_else(|| {
                        names.push(name);
                        names.len() - 1
                    })
            })
            .collect();
        Self { names, groups }
    }
}

/// The curves of (x, y) by group, points in the order of x; rows without x are left out.
pub(super) fn curves(x: &[Option<f64>], y: &[Option<f64>], grouping: &Grouping) -> Vec<Curve> {
    let curve = |(group, name): (usize, &String)| {
        let rows = (0..x.len()).filter(|row| grouping.groups[*row] == group);
        let mut points: Vec<(f64, Option<f64>)> =
            rows.filter_map(|row| Some((x[row]?, y[row]))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve {
            name: name.clone(),
            points,
        }
    };
    grouping.names.iter().enumerate().map(curve).collect()
}

/// Whether a column holds more than one value.
pub(super) fn varies(table: &Table, column: &str) -> bool {
    let mut cells = table
        .column(column)
        .into_iter()
        .flatten()
        .filter(|cell| !cell.is_empty());
    let first = cells.next();
    cells.any(|cell| Some(cell) != first)
}
