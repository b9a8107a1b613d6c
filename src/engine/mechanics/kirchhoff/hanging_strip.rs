//! A strip held horizontally at one end that hangs down under its weight.

use super::cantilever::{Cantilever, CantileverLoad};
use thiserror::Error;

/// Relative accuracy of the length found for a drop.
const ACCURACY: f64 = 1e-11;
const ITERATIONS: usize = 60;

/// A strip with a freely hanging length ℓ, in gravito-bending lengths (thesis Fig. 4.9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HangingStrip {
    /// Free length ℓ in gravito-bending lengths.
    pub length: f64,
    /// Drop of the free end as a fraction ε of the free length.
    pub drop: f64,
    /// Horizontal distance of the free end as a fraction of the free length.
    pub reach: f64,
    /// dℓ/dε.
    pub length_by_drop: f64,
}

/// Reason why a strip cannot be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StripError {
    /// The drop is not below the length, or is too near to either limit.
    #[error(
        "the drop is {drop} of the length; allowed: between {} and {} of the length",
        HangingStrip::DROPS[0],
        HangingStrip::DROPS[1]
    )]
    Drop {
        /// Drop over length.
        drop: f64,
    },
    /// The strip is too short to bend, or too long to be distinguished from a vertical one.
    #[error(
        "the length is {length} gravito-bending lengths: it must be between {} and {}",
        HangingStrip::LENGTHS[0],
        HangingStrip::LENGTHS[1]
    )]
    Length {
        /// Length over gravito-bending length.
        length: f64,
    },
}

impl HangingStrip {
    /// Range of drops that can be evaluated, as fractions of the length.
    pub(crate) const DROPS: [f64; 2] = [1e-6, 0.95];
    /// Lengths for which the drop is found, in gravito-bending lengths.
    pub(crate) const LENGTHS: [f64; 2] = [0.02, 7.0];

    /// The strip of a given free length, in gravito-bending lengths.
    ///
    /// The strip is a heavy cantilever of γ = w ℓ³/EI = ℓ³/2, since EI/w = 2 L_gb³.
    ///
    /// # Errors
    /// The length is outside of `Self::LENGTHS`.
    pub fn of_length(length: f64) -> Result<Self, StripError> {
        let [least, largest] = Self::LENGTHS;
        if !(least..=largest).contains(&length) {
            return Err(StripError::Length { length });
        }
        let [reach, drop] = tip(length);
        // Central difference; with round-off of 1e-12 in the drop a smaller step would not be more accurate.
        let step = 1e-4 * length;
        let slope = (tip(length + step)[1] - tip(length - step)[1]) / (2.0 * step);
        Ok(Self {
            length,
            drop,
            reach,
            length_by_drop: 1.0 / slope,
        })
    }

    /// The strip with a drop that is a given fraction of its length, by the secant method.
    ///
    /// # Errors
    /// The drop is outside of `Self::DROPS`.
    pub fn of_drop(drop: f64) -> Result<Self, StripError> {
        let [least, largest] = Self::DROPS;
        if !(least..=largest).contains(&drop) {
            return Err(StripError::Drop { drop });
        }
        // As a function of γ, ε/(1 − ε) is smooth and nearly linear: it begins as γ/8 (linear
        // theory).
        let excess = |gamma: f64| {
            let found = tip(libm::cbrt(2.0 * gamma))[1];
            found / (1.0 - found) - drop / (1.0 - drop)
        };
        let mut before = 8.0 * drop;
        let mut excess_before = excess(before);
        let mut gamma = 8.0 * drop / (1.0 - drop);
        for _ in 0..ITERATIONS {
            let excess_now = excess(gamma);
            if (gamma - before).abs() <= ACCURACY * gamma || excess_now == excess_before {
                break;
            }
            let next = gamma - excess_now * (gamma - before) / (excess_now - excess_before);
            (before, excess_before) = (gamma, excess_now);
            gamma = next.clamp(0.1 * gamma, 10.0 * gamma);
        }
        Self::of_length(libm::cbrt(2.0 * gamma))
    }
}

/// Position of the free end, across and down, as fractions of the length.
fn tip(length: f64) -> [f64; 2] {
    Cantilever::new(CantileverLoad::OwnWeight(0.5 * length.powi(3))).position(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::test_support::{assert_close, reference_rows};

    #[test]
    fn drop_and_length_are_inverse() {
        for drop in [1e-5, 0.01, 0.3, 0.6, 0.95] {
            let strip = HangingStrip::of_drop(drop).unwrap();
            assert!((strip.drop / drop - 1.0).abs() < 1e-6, "{drop}: {strip:?}");
            assert!((strip.drop - drop).abs() < 1e-9, "{drop}: {strip:?}");
        }
        // ε = γ/8 = ℓ³/16 for small drops.
        let strip = HangingStrip::of_drop(1e-4).unwrap();
        let slope = 16.0 / (3.0 * strip.length.powi(2));
        assert!((strip.length_by_drop / slope - 1.0).abs() < 1e-5);
    }

    #[test]
    fn drops_and_lengths_without_meaning_are_refused() {
        for drop in [0.0, 0.96, f64::NAN] {
            assert!(HangingStrip::of_drop(drop).is_err());
        }
        for length in [0.0, 50.0, f64::NAN] {
            assert!(HangingStrip::of_length(length).is_err());
        }
    }

    #[test]
    fn lengths_agree_with_the_reference() {
        let Some(rows) = reference_rows("lengths/hanging_plate_epsilon.csv") else {
            return;
        };
        let mut count = 0;
        for row in rows.iter().filter(|row| row[0] < 1.0).step_by(4) {
            let strip = HangingStrip::of_drop(row[0]).unwrap();
            assert_close(strip.length, row[1], 1e-8);
            assert!((strip.reach - row[3]).abs() < 1e-8, "{row:?} {strip:?}");
            count += 1;
        }
        assert!(count > 5);
    }
}
