//! Detects coordinates in a mirrored frame, such as pixels with y pointing down.

use super::data::{AXES, Datum, Measured};
use super::error::IdentifyError;
use super::problem::Problem;

/// Correlation of measured and predicted coordinates below which an axis is mirrored.
const MIRRORED: f64 = -0.9;
/// Minimum number of points in a file for the check.
const FEWEST: usize = 4;
/// Spread of an axis, relative to the widest one, below which it has no direction. For a few
/// points, noise out of the plane of a shape often has a chance correlation.
const THIN: f64 = 0.03;

/// A line of a file, the measured and the predicted coordinate, m.
type Pair = (usize, f64, f64);

/// Rejects files with a mirrored axis: measured coordinates fall where the predictions at the
/// start rise.
pub fn check(problem: &Problem<'_>, predicted: &[f64]) -> Result<(), IdentifyError> {
    let mut first = 0;
    for file in problem.experiments.iter().flat_map(|one| &one.files) {
        let predicted = &predicted[first..first + file.data.len()];
        first += file.data.len();
        let all = [0, 1, 2].map(|axis| -> Vec<Pair> {
            let is_of_axis = |datum: &Datum| matches!(&datum.measured, Measured::Coordinate { axis: other, .. } if *other == axis);
            (file.data.iter().zip(predicted))
                .filter(|(datum, _)| is_of_axis(datum))
                .map(|(datum, predicted)| (datum.line, datum.value, *predicted))
                .collect()
        });
        let widest = all.each_ref().map(|pairs| moments(pairs));
        let widest = widest.iter().fold([0.0_f64; 2], |widest, of| {
            [0, 1].map(|k| widest[k].max(of.squares[k]))
        });
        for (pairs, name) in all.iter().zip(AXES) {
            if pairs.len() >= FEWEST && moments(pairs).correlation(widest) < MIRRORED {
                let gap = |pair: &&Pair| (pair.1 - pair.2).abs();
                let worst = pairs
                    .iter()
                    .max_by(|one, other| gap(one).total_cmp(&gap(other)));
                let (line, measured, predicted) = *worst.unwrap_or(&pairs[0]);
                return Err(IdentifyError::Row {
                    file: file.path.clone(),
                    line,
                    message: format!(
                        "the axis {name} is mirrored: measured {measured} m, predicted {predicted:.4} m at the start \
                         values; measured values decrease where predicted ones increase; allowed: coordinates in the \
                         right-handed frame of the scenario (pixels \
                         count downwards)"
                    ),
                });
            }
        }
    }
    Ok(())
}

/// Mean squares of two columns about their means, m², and the mean product.
struct Moments {
    squares: [f64; 2],
    product: f64,
}

fn moments(pairs: &[Pair]) -> Moments {
    let count = (pairs.len() as f64).max(1.0);
    let means = [
        pairs.iter().map(|pair| pair.1).sum::<f64>() / count,
        pairs.iter().map(|pair| pair.2).sum::<f64>() / count,
    ];
    let (mut product, mut squares) = (0.0, [0.0, 0.0]);
    for (_, measured, predicted) in pairs {
        let apart = [measured - means[0], predicted - means[1]];
        product += apart[0] * apart[1] / count;
        squares[0] += apart[0] * apart[0] / count;
        squares[1] += apart[1] * apart[1] / count;
    }
    Moments { squares, product }
}

impl Moments {
    /// Correlation of the columns; zero if one of them is thin beside the widest axis.
    fn correlation(&self, widest: [f64; 2]) -> f64 {
        let is_thin = |k: usize| self.squares[k] <= THIN * THIN * widest[k];
        if is_thin(0) || is_thin(1) {
            0.0
        } else {
            self.product / (self.squares[0] * self.squares[1]).sqrt()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_with_nothing_but_noise_is_not_mirrored() {
        let pairs = |by: f64| -> Vec<Pair> {
            let numbers = (0..5).map(f64::from);
            numbers.map(|k| (0, -by * k, by * k)).collect()
        };
        let widest = moments(&pairs(0.05)).squares;
        let of = |by: f64| moments(&pairs(by)).correlation(widest);
        assert!(of(0.05) < MIRRORED && of(0.01) < MIRRORED);
        assert_eq!(of(0.001), 0.0);
        assert_eq!(of(0.0), 0.0);
    }
}
