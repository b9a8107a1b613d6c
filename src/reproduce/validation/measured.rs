//! Quantities read from the results of runs.

use super::benchmark::BenchmarkRun;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::results::{NodePositions, read_series_as};
use std::collections::HashMap;

/// Columns of `series.csv` at all outputs; NaN where a cell is empty or no number.
pub(super) fn series<const N: usize>(
    case: &Case<BenchmarkRun>,
    columns: [&str; N],
) -> Result<Vec<[f64; N]>> {
    let rows: Vec<HashMap<String, String>> = read_series_as(&case.directory)?;
    let number = |row: &HashMap<String, String>, column: &str| {
        let cell = row.get(column).and_then(|cell| cell.parse().ok());
        cell.unwrap_or(f64::NAN)
    };
    let rows = rows.iter().map(|row| columns.map(|name| number(row, name)));
    Ok(rows.collect())
}

/// The times at which a quantity changes its sign, by linear interpolation between outputs.
pub(super) fn crossings(points: &[[f64; 2]]) -> Vec<f64> {
    let pairs = points
        .windows(2)
        .filter(|pair| pair[0][1] * pair[1][1] < 0.0);
    let crossing = |pair: &[[f64; 2]]| {
        let [[before, high], [after, low]] = [pair[0], pair[1]];
        before + (after - before) * high / (high - low)
    };
    pairs.map(crossing).collect()
}

/// The mean of a column over the outputs after a time.
pub(super) fn mean_after(case: &Case<BenchmarkRun>, column: &str, after: f64) -> Result<f64> {
    let rows = series(case, ["time_s", column])?;
    let settled = rows.iter().filter(|[time, _]| *time > after);
    Ok(mean(settled.map(|[_, value]| *value)).unwrap_or(f64::NAN))
}

/// The frequency, in rad/s, of the amplitude of a mode over all outputs, from its changes of sign.
/// The mode has a weight for each node.
pub(super) fn frequency(
    outputs: &[NodePositions],
    mode: &[f64],
    of: impl Fn(&Vector3) -> f64,
) -> f64 {
    let amplitudes: Vec<[f64; 2]> = outputs
        .iter()
        .map(|output| {
            let parts = output.positions.iter().zip(mode);
            [output.time, parts.map(|(x, weight)| of(x) * weight).sum()]
        })
        .collect();
    let times = crossings(&amplitudes);
    match times[..] {
        [first, .., last] => std::f64::consts::PI * (times.len() - 1) as f64 / (last - first),
        _ => f64::NAN,
    }
}
