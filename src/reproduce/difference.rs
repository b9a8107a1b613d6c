//! The normalised difference ē of two runs (thesis Eq. 2.28).

use super::bundling::Bundling;
use super::prelude::*;
use super::table;
use rodlab_files::results::{NodePositions, ResultsError, RodRecord, read_nodes};

/// Height of the figure relative to the size of its letters.
const HEIGHT: f64 = 24.0;

/// Difference of two runs at a time, which is a row of CSV files.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Difference {
    pub time_s: f64,
    /// ē: mean distance of the nodes divided by the radius h.
    pub mean_difference_radii: f64,
}

/// Positions of all nodes of a run at its output times.
///
/// # Errors
/// [`ResultsError`] if `nodes.csv` cannot be read.
pub(super) fn nodes_of(case: &Case<Bundling>) -> Result<Vec<NodePositions>, ResultsError> {
    let count = |rod: &RodRecord| rod.nodes;
    read_nodes(&case.directory, case.manifest.rods.iter().map(count).sum())
}

/// ē at the output times that both runs reached, which are the same multiples of the interval. The
/// radius is in m.
pub(super) fn differences(
    first: &[NodePositions],
    second: &[NodePositions],
    radius: f64,
) -> Vec<Difference> {
    let pairs = first
        .iter()
        .zip(second)
        .take_while(|(a, b)| a.time == b.time);
    pairs
        .map(|(a, b)| {
            let distances = a.positions.iter().zip(&b.positions);
            let sum: f64 = distances.map(|(x, y)| (x - y).norm()).sum();
            Difference {
                time_s: a.time,
                mean_difference_radii: sum / (a.positions.len() as f64 * radius),
            }
        })
        .collect()
}

/// ē over time as a curve of a plot.
pub(super) fn curve(name: String, differences: &[Difference]) -> Curve {
    table::curve(name, differences, |row| {
        (row.time_s, row.mean_difference_radii)
    })
}

/// Adds a figure of such curves over time, with ē on a logarithmic axis.
pub(super) fn figure(page: &mut Page, name: &str, caption: &str, curves: Vec<Curve>) -> Result<()> {
    let plot = plot("ē in radii", curves);
    let style = PlotStyle {
        vertical: vec![AxisScale::Logarithmic],
        height: HEIGHT,
        ..PlotStyle::default()
    };
    let figure = styled_line_plots([plot], "Time in s", style);
    Ok(page.figure(&PageFigure::new(name, caption, figure))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn differences_are_means_in_radii_while_both_runs_last() {
        let output = |time: f64, shift: f64| NodePositions {
            time,
            positions: vec![Vector3::zeros(), Vector3::new(0.0, shift, 0.0)],
        };
        let first = [output(0.0, 0.0), output(0.5, 3e-3), output(1.0, 0.0)];
        let second = [output(0.0, 0.0), output(0.5, -1e-3), output(0.9, 0.0)];
        let rows = differences(&first, &second, 1e-3);
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0].mean_difference_radii, 0.0);
        assert!((rows[1].mean_difference_radii - 2.0).abs() < 1e-15);
    }
}
