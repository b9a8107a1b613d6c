//! Data to plot beside the motion: the columns of `series.csv` at the shown outputs.

use crate::report::labels::Quantity;
use rodlab_files::figure::MovieSeries;
use rodlab_files::results::{NodePositions, ResultsError, SERIES, Table};
use std::path::Path;

/// Columns that describe the progress of the run, not its results.
const EFFORT: [&str; 4] = ["time_s", "step_s", "steps", "fluid_iterations"];

/// The numeric columns that vary, at the shown outputs.
///
/// On a path of equilibria each row belongs to one output, in the same order. In a motion there
/// may be more rows than outputs, so rows are found by their time.
pub(super) fn series(
    folder: &Path,
    shown: &[(usize, NodePositions)],
    is_path: bool,
) -> Result<Vec<MovieSeries>, ResultsError> {
    let path = folder.join(SERIES);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let table = Table::read(&path)?;
    let times = table.numbers("time_s").unwrap_or_default();
    let rows: Vec<Option<usize>> = if is_path {
        let row = |(number, _): &(usize, NodePositions)| (*number < table.len()).then_some(*number);
        shown.iter().map(row).collect()
    } else {
        let mut next = 0;
        let row = |(_, output): &(usize, NodePositions)| {
            let found = times[next..]
                .iter()
                .position(|time| *time == Some(output.time))?;
            next += found;
            Some(next)
        };
        shown.iter().map(row).collect()
    };
    let columns = table.columns().iter();
    let columns = columns.filter(|column| !EFFORT.contains(&column.as_str()));
    let column = |column: &String| {
        let numbers = table.numbers(column)?;
        let values: Vec<Option<f64>> = rows.iter().map(|row| numbers[(*row)?]).collect();
        let mut known = values.iter().flatten();
        let first = known.next()?;
        if known.all(|value| value == first) {
            return None;
        }
        let quantity = Quantity::of(column, std::iter::empty());
        Some(MovieSeries {
            name: quantity.title(),
            unit: quantity.unit,
            values,
        })
    };
    Ok(columns.filter_map(column).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outputs(times: &[(usize, f64)]) -> Vec<(usize, NodePositions)> {
        let output = |&(number, time): &(usize, f64)| {
            let positions = NodePositions {
                time,
                positions: Vec::new(),
            };
            (number, positions)
        };
        times.iter().map(output).collect()
    }

    #[test]
    fn columns_that_vary_are_found_at_the_times_shown() {
        let folder = tempfile::tempdir().unwrap();
        let text = "time_s,steps,energy_j,contacts,constant_m\n\
                    0.0,1,1.0,,3\n0.5,2,2.0,4,3\n1.0,3,3.0,5,3\n1.5,4,9.0,6,3\n";
        std::fs::write(folder.path().join(SERIES), text).unwrap();
        let shown = outputs(&[(0, 0.0), (1, 1.0), (2, 1.25), (3, 1.5)]);
        let series = series(folder.path(), &shown, false).unwrap();
        let names: Vec<&str> = series.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["Energy", "Contacts"]);
        assert_eq!(series[0].unit, "J");
        assert_eq!(series[0].values, [Some(1.0), Some(3.0), None, Some(9.0)]);
        assert_eq!(series[1].values, [None, Some(5.0), None, Some(6.0)]);
    }

    #[test]
    fn equilibria_are_found_by_their_number() {
        let folder = tempfile::tempdir().unwrap();
        let text = "time_s,energy_j\n0.0,1.0\n6.0,2.0\n0.0,3.0\n6.0,4.0\n";
        std::fs::write(folder.path().join(SERIES), text).unwrap();
        let shown = outputs(&[(0, 0.0), (1, 6.0), (3, 6.0)]);
        let series = series(folder.path(), &shown, true).unwrap();
        assert_eq!(series[0].values, [Some(1.0), Some(2.0), Some(4.0)]);
    }
}
