//! Repeatable random numbers for disturbances and checks: SplitMix64 (Steele, Lea & Flood 2014). Evenly spread points: [`sobol`].
//!
//! Published tables and figures use these draws, so the generator must never change; generators of
//! libraries may change.

mod sobol;

pub use sobol::{MOST_DIMENSIONS, MOST_POINTS, sobol, sobol_coordinate};

/// Increment of the state between two numbers.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// The first number of the stream of a seed; each of its bits depends on every bit of the seed.
pub(crate) fn scrambled(seed: u64) -> u64 {
    let z = seed.wrapping_add(STEP);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Uniform random numbers in [0, 1), the same for the same seed on every machine.
pub fn uniform_numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        let bits = scrambled(state);
        state = state.wrapping_add(STEP);
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published generator gives these for the seed 1234567.
    #[test]
    fn the_stream_is_that_of_the_published_generator() {
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973];
        assert_eq!(expected[0], scrambled(1_234_567));
        assert_eq!(expected[1], scrambled(1_234_567u64.wrapping_add(STEP)));
    }

    #[test]
    fn numbers_are_uniform_and_repeat() {
        let draw = |seed| {
            let mut number = uniform_numbers(seed);
            (0..10_000).map(|_| number()).collect::<Vec<f64>>()
        };
        let numbers = draw(7);
        assert_eq!(numbers, draw(7));
        assert_ne!(numbers, draw(8));
        assert!(numbers.iter().all(|number| (0.0..1.0).contains(number)));
        let mean = |power: i32| numbers.iter().map(|x| x.powi(power)).sum::<f64>() / 1e4;
        // Standard deviations of the means: 0.0029 and 0.0030.
        assert!((mean(1) - 0.5).abs() < 0.01 && (mean(2) - 1.0 / 3.0).abs() < 0.01);
    }
}
