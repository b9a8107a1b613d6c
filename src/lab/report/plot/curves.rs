//! Rows of a table as curves, one for each group of rows.

use crate::report::labels::Quantity;
use rodlab_files::figure::{Curve, Look};
use rodlab_files::results::Table;
use std::collections::BTreeSet;

/// Group of each row of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Grouping {
    /// Names of the groups in the order of their first rows.
    pub names: Vec<String>,
    /// Number of the group of each row.
    pub groups: Vec<usize>,
}

impl Grouping {
    /// Groups rows with equal cells in `columns`. Without columns all rows are one group.
    pub fn of(table: &Table, columns: &[&str]) -> Self {
        let cells: Vec<Vec<&str>> = columns
            .iter()
            .filter_map(|column| Some(table.column(column)?.collect()))
            .collect();
        let quantities: Vec<Quantity> = columns
            .iter()
            .map(|column| quantity(table, column))
            .collect();
        let name = |row: usize| {
            let pairs = quantities.iter().zip(&cells);
            let pairs = pairs.map(|(quantity, cells)| quantity.with_value(cells[row]));
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

/// Contents of a column of a table.
pub(super) fn quantity(table: &Table, column: &str) -> Quantity {
    let numbers = table.numbers(column).unwrap_or_default();
    Quantity::of(column, numbers.into_iter().flatten())
}

/// The numbers of a column in the unit in which it is shown.
pub(super) fn in_unit(numbers: Vec<Option<f64>>, quantity: &Quantity) -> Vec<Option<f64>> {
    let shown = |number: Option<f64>| number.map(|number| number / quantity.size);
    numbers.into_iter().map(shown).collect()
}

/// The curves of (x, y) by group, marked at the points and sorted by x. Rows without x are left
/// out.
pub(super) fn curves(x: &[Option<f64>], y: &[Option<f64>], grouping: &Grouping) -> Vec<Curve> {
    let curve = |(group, name): (usize, &String)| {
        let rows = (0..x.len()).filter(|row| grouping.groups[*row] == group);
        let mut points: Vec<(f64, Option<f64>)> =
            rows.filter_map(|row| Some((x[row]?, y[row]))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve::new(name.clone(), points).looking(Look::Marked)
    };
    grouping.names.iter().enumerate().map(curve).collect()
}

/// Number of distinct cells of a column; empty cells are not counted.
pub(super) fn value_count(table: &Table, column: &str) -> usize {
    let cells = table.column(column).into_iter().flatten();
    let unlike: BTreeSet<&str> = cells.filter(|cell| !cell.is_empty()).collect();
    unlike.len()
}

/// Whether a column holds more than one distinct value.
pub(super) fn varies(table: &Table, column: &str) -> bool {
    value_count(table, column) > 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_curve_come_in_the_order_of_x_and_gaps_stay() {
        let grouping = Grouping {
            names: vec!["a".into(), "b".into()],
            groups: vec![0, 1, 0, 0],
        };
        let x = [Some(3.0), Some(1.0), Some(2.0), None];
        let y = [Some(9.0), Some(1.0), None, Some(7.0)];
        let curves = curves(&x, &y, &grouping);
        assert_eq!(curves[0].points, [(2.0, None), (3.0, Some(9.0))]);
        assert_eq!(curves[1].points, [(1.0, Some(1.0))]);
    }
}
