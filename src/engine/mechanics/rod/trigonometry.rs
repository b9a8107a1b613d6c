//! Sine, cosine and the angle of a plane vector, without branches so that loops over lanes
//! vectorise.
//!
//! Polynomials from interpolation at Chebyshev nodes, with an error of 2·10⁻¹⁷ before rounding;
//! results to about one unit in the last place.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Largest angle that is not reduced first, rad: its number of quarter turns has at most 20 bits.
const LARGEST_ANGLE: f64 = 1e6;
/// π/2 in three parts, the first two of 33 bits, so that their products with a number of quarter turns are exact.
const QUARTER_TURN: [f64; 3] = [
    1.5707963267341256,
    6.077100506303966e-11,
    2.0222662487959506e-21,
];
/// Adding and subtracting this constant rounds a number to an integer; the lowest bits of the sum
/// hold the integer.
const ROUNDING: f64 = 1.5 * (1u64 << 52) as f64;
/// (sin √z/√z − 1)/z for z ≤ (π/4)².
const SINE: [f64; 6] = [
    -0.16666666666666666,
    0.008333333333330948,
    -0.00019841269836756774,
    2.7557316101617874e-6,
    -2.505113165023518e-8,
    1.5918115263265974e-10,
];
/// (cos √z − 1 + z/2)/z² for z ≤ (π/4)².
const COSINE: [f64; 6] = [
    0.041666666666666664,
    -0.0013888888888887398,
    2.480158729876456e-5,
    -2.7557317271145144e-7,
    2.087614614655861e-9,
    -1.1382623647474604e-11,
];
/// (arctan √z/√z − 1)/z for z ≤ tan²(π/8).
const ARC_TANGENT: [f64; 12] = [
    -0.3333333333333333,
    0.19999999999999804,
    -0.14285714285659779,
    0.11111111105150588,
    -0.09090908753259112,
    0.07692296368042296,
    -0.0666642476020052,
    0.05878927554473807,
    -0.05230443640686948,
    0.045515447340221615,
    -0.03456931506332609,
    0.016284375050043393,
];
/// tan(π/8) = √2 − 1.
const TANGENT_OF_EIGHTH: f64 = std::f64::consts::SQRT_2 - 1.0;

/// An argument for [`sine_cosine`]: the angle (rad) itself, or, if large, the angle without its
/// whole turns.
#[inline(always)]
pub(super) fn within_reach(angle: f64) -> f64 {
    if is_within_reach(angle) {
        angle
    } else {
        angle % TAU
    }
}

/// Whether [`sine_cosine`] takes an angle (rad) without reduction.
#[inline(always)]
pub(super) fn is_within_reach(angle: f64) -> bool {
    angle.abs() < LARGEST_ANGLE
}

/// Sine and cosine of an angle, rad, of at most 10⁶.
#[inline(always)]
pub(super) fn sine_cosine(angle: f64) -> (f64, f64) {
    let shifted = angle * FRAC_2_PI + ROUNDING;
    let quarters = shifted - ROUNDING;
    let [first, second, third] = QUARTER_TURN;
    let rest = ((angle - quarters * first) - quarters * second) - quarters * third;
    let z = rest * rest;
    let sine = rest + rest * z * polynomial(&SINE, z);
    let cosine = 1.0 - (0.5 * z - z * z * polynomial(&COSINE, z));
    let quadrant = shifted.to_bits() & 3;
    let (along, across) = if quadrant & 1 == 0 {
        (cosine, sine)
    } else {
        (sine, cosine)
    };
    // Quadrants 2 and 3 change the sign of the sine, 1 and 2 that of the cosine.
    let across = f64::from_bits(across.to_bits() ^ (quadrant >> 1) << 63);
    let along = f64::from_bits(along.to_bits() ^ ((quadrant + 1) >> 1 & 1) << 63);
    (across, along)
}

/// Angle of a plane vector in (−π, π], from multiples of its sine and cosine; zero for the zero
/// vector.
#[inline(always)]
pub(super) fn angle_of(sine: f64, cosine: f64) -> f64 {
    let (height, width) = (sine.abs(), cosine.abs());
    let is_steep = height > width;
    let (small, large) = if is_steep {
        (width, height)
    } else {
        (height, width)
    };
    let beyond_eighth = small > TANGENT_OF_EIGHTH * large;
    let (numerator, denominator, start) = if beyond_eighth {
        (small - large, small + large, FRAC_PI_4)
    } else {
        (small, large, 0.0)
    };
    let tangent = numerator / denominator.max(f64::MIN_POSITIVE);
    let z = tangent * tangent;
    let angle = start + (tangent + tangent * z * polynomial(&ARC_TANGENT, z));
    let angle = if is_steep { FRAC_PI_2 - angle } else { angle };
    let angle = if cosine < 0.0 { PI - angle } else { angle };
    angle.copysign(sine)
}

/// A polynomial in z with an even number of coefficients. Even and odd powers are summed
/// separately: two short chains of operations instead of a long one.
#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f64; N], z: f64) -> f64 {
    let square = z * z;
    let (mut even, mut odd) = (coefficients[N - 2], coefficients[N - 1]);
    for k in (0..N / 2 - 1).rev() {
        even = coefficients[2 * k] + square * even;
        odd = coefficients[2 * k + 1] + square * odd;
    }
    even + z * odd
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angles over all quadrants and decades, including multiples of π/4.
    fn angles() -> impl Iterator<Item = f64> {
        let decades = (-12..6).flat_map(|exponent| {
            (0..500).map(move |k| 10f64.powi(exponent) * (1.0 + 0.018 * f64::from(k)))
        });
        let eighths = (0..4000).map(|k| FRAC_PI_4 * f64::from(k));
        let positive = decades
            .chain(eighths)
            .filter(|angle| *angle < LARGEST_ANGLE);
        positive.flat_map(|angle| [angle, -angle])
    }

    #[test]
    fn sines_and_cosines_are_those_of_libm() {
        for angle in angles() {
            let (sine, cosine) = sine_cosine(angle);
            let (expected_sine, expected_cosine) = libm::sincos(angle);
            assert!(
                (sine - expected_sine).abs() < 2.5e-16,
                "sin {angle}: {sine}"
            );
            assert!(
                (cosine - expected_cosine).abs() < 2.5e-16,
                "cos {angle}: {cosine}"
            );
        }
    }

    #[test]
    fn small_sines_and_arcs_are_right_to_the_last_places() {
        for angle in angles().filter(|angle| angle.abs() < FRAC_PI_4) {
            let (sine, _) = sine_cosine(angle);
            assert!((sine - libm::sin(angle)).abs() <= 3e-16 * angle.abs());
            let back = angle_of(libm::sin(angle), libm::cos(angle));
            assert!(
                (back - angle).abs() <= 4e-16 * angle.abs(),
                "{angle}: {back}"
            );
        }
    }

    #[test]
    fn angles_are_those_of_libm_whatever_the_length() {
        for angle in angles() {
            for length in [1e-150, 1.0, 3e100] {
                let (sine, cosine) = (length * libm::sin(angle), length * libm::cos(angle));
                let (found, expected) = (angle_of(sine, cosine), libm::atan2(sine, cosine));
                let error = (found - expected).abs();
                assert!(error <= 4.5e-16, "{angle}: {found} {expected}");
            }
        }
        for (sine, cosine) in [
            (0.0, 1.0),
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, -1.0),
            (-0.0, -1.0),
        ] {
            assert_eq!(angle_of(sine, cosine), libm::atan2(sine, cosine));
        }
        assert_eq!(angle_of(0.0, 0.0), 0.0);
    }

    #[test]
    fn large_angles_lose_whole_turns_only() {
        for turns in [2e5, 1e7, 1e9] {
            let angle = 0.7 + TAU * turns;
            let (sine, cosine) = sine_cosine(within_reach(angle));
            let (expected_sine, expected_cosine) = libm::sincos(angle);
            // The angle itself is accurate only to its last place.
            let bound = f64::EPSILON * angle;
            assert!(
                (sine - expected_sine).abs() < bound && (cosine - expected_cosine).abs() < bound
            );
        }
    }
}
