//! A first guess of the force densities from those of earlier steps.

use super::flow::Flow;
use super::gmres::{add_multiple, dot, scale};

/// Number of earlier solutions kept. For evenly spaced steps, combinations of three include the
/// quadratic extrapolation.
pub(super) const KEPT: usize = 3;

/// Least share of a previous solution's image that must be independent of the newer ones' images.
/// A smaller share is round-off, as after a repeated step.
const INDEPENDENCE: f64 = 1e-9;

/// The last solutions of A f = b and the scratch to combine them.
///
/// The guess is the combination with the smallest residual for the present A and b (Fischer 1998). Unlike
/// an extrapolation in time it needs no step sizes and is never worse than starting from zero.
pub(super) struct InitialGuess {
    /// Newest first; zero until there are solutions.
    previous: [Vec<f64>; KEPT],
    combinations: [Vec<f64>; KEPT],
    images: [Vec<f64>; KEPT],
}

impl InitialGuess {
    /// No solution so far.
    pub(crate) fn new(unknowns: usize) -> Self {
        let zero = || std::array::from_fn(|_| vec![0.0; unknowns]);
        Self {
            previous: zero(),
            combinations: zero(),
            images: zero(),
        }
    }

    /// The solutions kept, newest first.
    pub(crate) fn previous(&self) -> &[Vec<f64>; KEPT] {
        &self.previous
    }

    /// Replaces the solutions kept.
    pub(crate) fn restore(&mut self, previous: [Vec<f64>; KEPT]) {
        self.previous = previous;
    }

    /// Adds the newest solution and discards the oldest.
    pub(crate) fn remember(&mut self, solution: &[f64]) {
        self.previous.rotate_right(1);
        self.previous[0].copy_from_slice(solution);
    }

    /// Replaces the newest solution by a better one of the same step.
    pub(crate) fn replace_newest(&mut self, solution: &[f64]) {
        self.previous[0].copy_from_slice(solution);
    }

    /// Sets `solution` to the guess and subtracts its image from `residual`, which holds b.
    pub(crate) fn start(
        &mut self,
        operator: &mut Flow,
        residual: &mut [f64],
        solution: &mut [f64],
    ) {
        for (combination, previous) in self.combinations.iter_mut().zip(&self.previous) {
            combination.copy_from_slice(previous);
        }
        operator.multiply_three(&self.combinations, &mut self.images);
        solution.fill(0.0);
        for k in 0..KEPT {
            let (images, rest) = self.images.split_at_mut(k);
            let (combinations, newer) = self.combinations.split_at_mut(k);
            let (image, combination) = (&mut rest[0], &mut newer[0]);
            let length = dot(image, image).sqrt();
            for (other, other_combination) in images.iter().zip(&*combinations) {
                let part = dot(other, image);
                add_multiple(-part, other, image);
                add_multiple(-part, other_combination, combination);
            }
            let independent = dot(image, image).sqrt();
            // This also excludes zero vectors.
            if independent <= INDEPENDENCE * length {
                image.fill(0.0);
                combination.fill(0.0);
                continue;
            }
            scale(1.0 / independent, image);
            scale(1.0 / independent, combination);
            let coordinate = dot(image, residual);
            add_multiple(-coordinate, image, residual);
            add_multiple(coordinate, combination, solution);
        }
    }
}
