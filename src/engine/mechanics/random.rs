//! Repeatable random numbers for disturbances and checks: SplitMix64 (Steele, Lea & Flood 2014).
//!
//! The draws stand behind published tables and figures, so the generator must never change, as those of libraries may.

/// Uniform random numbers in [0, 1), the same for the same seed on every machine.
pub fn uniform_numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
