//! Branch of a path of equilibria to which each output of a run belongs.

use rodlab_files::results::{BRANCH, ResultsError, read_branches};
use std::path::Path;

/// Quantity along the axis of a path of equilibria in place of time.
pub(super) const PARAMETER: &str = "Path parameter";

/// The number of the branch of each output, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Branches(Vec<usize>);

impl Branches {
    /// The branches of a run; `None` if no path was followed.
    pub fn read(directory: &Path) -> Result<Option<Self>, ResultsError> {
        if !directory.join(BRANCH).exists() {
            return Ok(None);
        }
        let rows = read_branches(directory)?;
        Ok(Some(Self(rows.iter().map(|row| row.branch).collect())))
    }

    #[cfg(test)]
    pub fn of_numbers(numbers: impl Into<Vec<usize>>) -> Self {
        Self(numbers.into())
    }

    /// The branch of an output; the last known branch for an output that is being written.
    pub fn of(&self, output: usize) -> usize {
        let known = self.0.get(output).or(self.0.last());
        known.copied().unwrap_or_default()
    }

    /// Whether there are several branches.
    pub fn are_several(&self) -> bool {
        self.0.iter().any(|branch| *branch != self.0[0])
    }

    /// Points of a curve, one per output, broken between branches.
    pub fn broken(&self, points: Vec<(f64, Option<f64>)>) -> Vec<(f64, Option<f64>)> {
        let mut curve = Vec::with_capacity(points.len());
        for (output, point) in points.into_iter().enumerate() {
            if output > 0 && self.of(output) != self.of(output - 1) {
                curve.push((point.0, None));
            }
            curve.push(point);
        }
        curve
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_broken_between_branches() {
        let branches = Branches(vec![0, 0, 1]);
        let points = [0.0, 6.0, 2.0].map(|x| (x, Some(x))).to_vec();
        let broken = branches.broken(points);
        let expected = [
            (0.0, Some(0.0)),
            (6.0, Some(6.0)),
            (2.0, None),
            (2.0, Some(2.0)),
        ];
        assert_eq!(broken, expected);
        assert!(branches.are_several());
        assert_eq!((branches.of(2), branches.of(9)), (1, 1));
    }
}
