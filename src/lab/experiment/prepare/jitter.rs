//! Random jitter of a gripper.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::random::uniform_numbers;
use std::f64::consts::TAU;

/// Number of waves in the jitter of one direction, and the ratio of the slowest period to the
/// fastest.
const WAVES: usize = 8;
const SLOWEST: f64 = 5.0;

/// Smooth random displacements and rotations: sums of waves of equal amplitude with random periods
/// and phases. The amplitudes follow from the required mean squares.
pub struct Jitter {
    amplitudes: [f64; 6],
    period: f64,
    /// Angular frequency (rad/s) and phase of each wave, by direction.
    waves: [[(f64, f64); WAVES]; 6],
}

impl Jitter {
    /// Creates a jitter from a seed. `rms` is its root mean square in each direction (m) and about
    /// each axis (rad), `period` the period of its fastest wave, s.
    pub fn new(rms: [f64; 2], period: f64, seed: u64) -> Self {
        let mut number = uniform_numbers(seed);
        let waves = std::array::from_fn(|_| {
            std::array::from_fn(|_| {
                let period = period * libm::pow(SLOWEST, number());
                (TAU / period, TAU * number())
            })
        });
        let unit = (2.0 / WAVES as f64).sqrt();
        let [way, turn] = rms.map(|rms| unit * rms);
        Self {
            amplitudes: [way, way, way, turn, turn, turn],
            period,
            waves,
        }
    }

    /// Displacement (m) and rotation (rad) at a time; both start at zero.
    pub fn at(&self, time: f64) -> (Vector3, Vector3) {
        if self.amplitudes == [0.0; 6] {
            return (Vector3::zeros(), Vector3::zeros());
        }
        let begun = (time / self.period).min(1.0);
        let begun = begun * begun * (3.0 - 2.0 * begun);
        let values: [f64; 6] = std::array::from_fn(|direction| {
            let waves = self.waves[direction].iter();
            let sum: f64 = waves
                .map(|(rate, phase)| libm::sin(rate * time + phase))
                .sum();
            begun * self.amplitudes[direction] * sum
        });
        let [x, y, z, a, b, c] = values;
        (Vector3::new(x, y, z), Vector3::new(a, b, c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_has_its_mean_square_and_repeats() {
        let of_seed = |seed| Jitter::new([1e-3, 0.01], 1.0, seed);
        let jitter = of_seed(7);
        let mut squares = [0.0; 6];
        let count = 200_000;
        for index in 0..count {
            let (way, turn) = jitter.at(10.0 + 0.05 * f64::from(index));
            for axis in 0..3 {
                squares[axis] += (way[axis] / 1e-3).powi(2) / f64::from(count);
                squares[axis + 3] += (turn[axis] / 0.01).powi(2) / f64::from(count);
            }
        }
        for square in squares {
            assert!((square - 1.0).abs() < 0.02, "{squares:?}");
        }
        assert_eq!(jitter.at(0.0), (Vector3::zeros(), Vector3::zeros()));
        let again = of_seed(7);
        assert_eq!(again.at(3.3), jitter.at(3.3));
        let other = of_seed(8);
        assert_ne!(other.at(3.3), jitter.at(3.3));
    }
}
