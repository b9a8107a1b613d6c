//! Natural strains that change over time: actuated rods that bend, twist and lengthen.

use super::piecewise_linear;
use std::f64::consts::TAU;

/// A natural strain of a rod in addition to that of its shape, as a function of position and time.
/// Several actuations of a rod add up.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuation {
    /// Index of the rod.
    pub rod: usize,
    /// The strain.
    pub strain: ActuatedStrain,
    /// Start and end of the actuated part, in m of the natural length without actuation; an
    /// infinite end is the end of the rod.
    pub part: [f64; 2],
    /// Size of the strain.
    pub course: Course,
}

/// A natural strain that may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActuatedStrain {
    /// Curvature about the first material director, κb·m₁, 1/m.
    FirstCurvature,
    /// Curvature about the second material director, κb·m₂, 1/m.
    SecondCurvature,
    /// Twist, rad/m.
    Twist,
    /// Relative change of the length; 0.1 is 10 % longer.
    Length,
}

/// The course of a natural strain.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Uniform over the part, at given times in s; piecewise linear in between and constant
    /// outside them.
    Uniform(Vec<(f64, f64)>),
    /// A wave that travels along the rod.
    Wave(Wave),
    /// Values at positions along the rod, set by [`Simulation::set_actuation`]. Each value applies
    /// up to the midpoints between its position and the neighbouring ones.
    ///
    /// [`Simulation::set_actuation`]: crate::mechanics::dynamics::Simulation::set_actuation
    Given {
        /// Distances from the start of the rod in ascending order, m.
        places: Vec<f64>,
        /// The strain at each place.
        values: Vec<f64>,
    },
}

/// A f(t) sin(2π (s/λ − ν t) + φ) at the distance s from the start of the rod.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// A, in the unit of the strain.
    pub amplitude: f64,
    /// λ, m; infinite if the strain is the same along the whole rod.
    pub wavelength: f64,
    /// ν, 1/s; if negative, the wave runs towards the start of the rod.
    pub frequency: f64,
    /// φ, rad.
    pub phase: f64,
    /// f at given times in s, piecewise linear; 1 if empty.
    pub schedule: Vec<(f64, f64)>,
}

impl Course {
    /// Two functions of time. The integral of the strain over a piece is their sum, weighted by
    /// the [`Self::shares`] of the piece.
    pub(crate) fn weights(&self, time: f64) -> [f64; 2] {
        match self {
            Self::Uniform(values) => [piecewise_linear(values, time).unwrap_or(0.0), 0.0],
            Self::Wave(wave) => {
                let factor = piecewise_linear(&wave.schedule, time).unwrap_or(1.0);
                let (sine, cosine) = libm::sincos(TAU * wave.frequency * time);
                [cosine, -sine].map(|part| wave.amplitude * factor * part)
            }
            Self::Given { .. } => [1.0, 0.0],
        }
    }

    /// Share of a piece of a rod in the strain: its length, or ∫ sin(ks + φ) ds and ∫ cos(ks + φ)
    /// ds. The piece is given by the distances of its ends from the start of the rod (m).
    pub(crate) fn shares(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let length = to - from;
        match self {
            Self::Uniform(_) => [length, 0.0],
            Self::Wave(wave) => {
                let wave_number = TAU / wave.wavelength;
                let half = 0.5 * wave_number * length;
                let mean = if half == 0.0 {
                    1.0
                } else {
                    libm::sin(half) / half
                };
                let middle = 0.5 * (from + to) * wave_number + wave.phase;
                let (sine, cosine) = libm::sincos(middle);
                [sine, cosine].map(|part| length * mean * part)
            }
            Self::Given { places, values } => {
                let middle = 0.5 * (from + to);
                let next = places.partition_point(|place| *place < middle);
                let is_nearer_to_last = next == places.len()
                    || next > 0 && middle - places[next - 1] < places[next] - middle;
                let nearest = next.saturating_sub(usize::from(is_nearer_to_last));
                [length * values.get(nearest).unwrap_or(&0.0), 0.0]
            }
        }
    }

    /// Times at which its rate changes, s; the wave itself has none.
    pub(crate) fn corners(&self) -> impl Iterator<Item = f64> {
        let schedule = match self {
            Self::Uniform(values) => values.as_slice(),
            Self::Wave(wave) => &wave.schedule,
            Self::Given { .. } => &[],
        };
        schedule.iter().map(|corner| corner.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_values_hold_up_to_the_middle_between_their_places() {
        let course = Course::Given {
            places: vec![0.0, 0.1, 0.4],
            values: vec![1.0, 2.0, 3.0],
        };
        for (piece, value) in [
            ([0.0, 0.05], 1.0),
            ([0.05, 0.1], 2.0),
            ([0.1, 0.25], 2.0),
            ([0.25, 0.4], 3.0),
            ([0.4, 0.5], 3.0),
        ] {
            let length = piece[1] - piece[0];
            assert_eq!(course.shares(piece), [length * value, 0.0]);
        }
    }

    #[test]
    fn a_wave_is_summed_exactly_over_its_pieces() {
        let wave = Wave {
            amplitude: 3.0,
            wavelength: 0.7,
            frequency: 1.3,
            phase: 0.4,
            schedule: vec![(0.0, 0.0), (2.0, 1.0)],
        };
        let course = Course::Wave(wave.clone());
        let time = 1.1;
        let at = |s: f64| {
            let angle = TAU * (s / wave.wavelength - wave.frequency * time) + wave.phase;
            0.55 * wave.amplitude * angle.sin()
        };
        for [from, to] in [[0.1, 0.13], [0.0, 2.0], [0.3, 0.3]] {
            let parts = 20_000;
            let width = (to - from) / f64::from(parts);
            let middles = (0..parts).map(|k| from + (f64::from(k) + 0.5) * width);
            let expected: f64 = middles.map(|s| at(s) * width).sum();
            let [first, second] = course.shares([from, to]);
            let [one, other] = course.weights(time);
            let got = one * first + other * second;
            assert!((got - expected).abs() < 1e-8, "{got} {expected}");
        }
    }

    #[test]
    fn without_a_wavelength_all_of_the_rod_does_the_same() {
        let course = Course::Wave(Wave {
            amplitude: 2.0,
            wavelength: f64::INFINITY,
            frequency: 0.25,
            phase: 0.0,
            schedule: Vec::new(),
        });
        let [first, second] = course.shares([5.0, 5.5]);
        let [one, other] = course.weights(1.0);
        assert!((one * first + other * second + 1.0).abs() < 1e-15);
    }
}
