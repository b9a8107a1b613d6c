//! Detects coordinates in a mirrored frame, such as pixels with y pointing down.

use super::data::{AXES, Datum, Measured};
use super::error::IdentifyError;
use super::problem::Problem;

/// Correlation of measured and predicted coordinates below which an axis is mirrored.
const MIRRORED: f64 = -0.9;
/// Minimum number of points in a file for the check.
const FEWEST: usize = 4;

/// Rejects files with a mirrored axis: measured coordinates fall where the predictions at the
/// start rise.
pub fn check(problem: &Problem<'_>, predicted: &[f64]) -> Result<(), IdentifyError> {
    let mut first = 0;
    for file in problem.experiments.iter().flat_map(|one| &one.files) {
        let predicted = &predicted[first..first + file.data.len()];
        first += file.data.len();
        for (axis, name) in AXES.iter().enumerate() {
            let is_of_axis = |datum: &Datum| matches!(&datum.measured, Measured::Coordinate { axis: other, .. } if *other == axis);
            let pairs: Vec<(usize, f64, f64)> = (file.data.iter().zip(predicted))
                .filter(|(datum, _)| is_of_axis(datum))
                .map(|(datum, predicted)| (datum.line, datum.value, *predicted))
                .collect();
            if pairs.len() >= FEWEST && correlation(&pairs) < MIRRORED {
                let gap = |pair: &&(usize, f64, f64)| (pair.1 - pair.2).abs();
                let worst = pairs
                    .iter()
                    .max_by(|one, other| gap(one).total_cmp(&gap(other)));
                let (line, measured, predicted) = *worst.unwrap_or(&pairs[0]);
                return Err(IdentifyError::Row {
                    file: file.path.clone(),
                    line,
                    message: format!(
                        "the axis {name} is mirrored: measured {measured} m where the scenario at \
                         its start has {predicted:.4} m, and decreasing where it increases; \
                         allowed: coordinates in the right-handed frame of the scenario (pixels \
                         count downwards)"
                    ),
                });
            }
        }
    }
    Ok(())
}

/// Correlation of two columns.
fn correlation(pairs: &[(usize, f64, f64)]) -> f64 {
    let count = pairs.len() as f64;
    let means = [
        pairs.iter().map(|pair| pair.1).sum::<f64>() / count,
        pairs.iter().map(|pair| pair.2).sum::<f64>() / count,
    ];
    let (mut product, mut squares) = (0.0, [0.0, 0.0]);
    for (_, measured, predicted) in pairs {
        let apart = [measured - means[0], predicted - means[1]];
        product += apart[0] * apart[1];
        squares[0] += apart[0] * apart[0];
        squares[1] += apart[1] * apart[1];
    }
    let size = (squares[0] * squares[1]).sqrt();
    // Predictions that differ only by round-off, such as those of a rod in a plane, have no
    // direction.
    if size > 0.0 && squares[1] > 1e-12 * squares[0] {
        product / size
    } else {
        0.0
    }
}
