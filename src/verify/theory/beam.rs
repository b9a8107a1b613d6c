//! Straight rods: small vibrations and the loads at which they buckle.

use rodlab_engine::mechanics::kirchhoff::numerics::bisect;
use std::f64::consts::PI;

/// Natural wave numbers β L of a cantilever, roots of cos x cosh x = −1 (Euler–Bernoulli; e.g.
/// Timoshenko, Vibration Problems in Engineering, sec. 53). Modes are counted from 1; ω = (β L)²
/// √(EI/(ρA))/L².
pub fn cantilever_wave_number(mode: usize) -> f64 {
    // Divided by cosh x, so that high modes do not overflow.
    let middle = (mode as f64 - 0.5) * PI;
    bisect(middle - 0.5 * PI, middle + 0.5 * PI, |x| {
        libm::cos(x) + 1.0 / libm::cosh(x)
    })
}

/// Natural wave numbers β L of a free rod, roots of cos x cosh x = 1, without rigid-body modes.
pub fn free_wave_number(mode: usize) -> f64 {
    let middle = (mode as f64 + 0.5) * PI;
    bisect(middle - 0.25 * PI, middle + 0.25 * PI, |x| {
        libm::cos(x) - 1.0 / libm::cosh(x)
    })
}

/// Natural wave numbers ω L/c of torsional or axial waves in a rod held at one end: (2 n − 1) π/2,
/// with c² = G/ρ or E/ρ.
pub fn fixed_free_wave_number(mode: usize) -> f64 {
    (mode as f64 - 0.5) * PI
}

/// Angular frequency, rad/s, of a mode of a rod with clamped ends under tension (e.g. Timoshenko,
/// Vibration Problems in Engineering): EI w⁗ − T w″ = μ ω² w has the solutions w = e^{±αx},
/// e^{±iβx} with α² − β² = T/EI and μ ω² = EI α² β². Clamped ends require 2αβ (1 − cosh αL cos
/// βL) + (α² − β²) sinh αL sin βL = 0. Limits are the frequency of the string, (nπ/L) √(T/μ), and
/// that of the beam.
pub fn stretched_frequency(
    mode: usize,
    tension: f64,
    bending: f64,
    mass_per_length: f64,
    length: f64,
) -> f64 {
    let of_both = |beta: f64| libm::hypot(beta, (tension / bending).sqrt());
    // Divided by cosh αL, so that a high tension does not overflow.
    let first = mode as f64 * PI / length;
    let beta = bisect(first, first + 0.6 * PI / length, |beta| {
        let alpha = of_both(beta);
        let (sine, cosine) = libm::sincos(beta * length);
        2.0 * alpha * beta * (1.0 / libm::cosh(alpha * length) - cosine)
            + tension / bending * libm::tanh(alpha * length) * sine
    });
    of_both(beta) * beta * (bending / mass_per_length).sqrt()
}

/// Critical compression of a column with both ends clamped, P L²/EI = 4π² (Euler).
pub const CLAMPED_COLUMN: f64 = 4.0 * PI * PI;

/// Critical compression of a column with one end clamped and one free, P L²/EI = π²/4 (Euler).
pub const FREE_COLUMN: f64 = 0.25 * PI * PI;

/// Flutter load of a column that is clamped at one end and pushed at the other by a force along
/// its tangent there, P L²/EI = 20.0509 (Beck 1952). Motions with the frequency ω (in units of
/// √(EI/ρA)/L²) satisfy, with p = P L²/EI,
///
/// ```text
/// p² + 2ω² (1 + cosh λ₁ cos λ₂) + p ω sinh λ₁ sin λ₂ = 0,    λ₁,₂² = √(p²/4 + ω²) ∓ p/2
/// ```
///
/// The first two roots meet at the load for which the least value between them is zero.
pub fn beck_load() -> f64 {
    let least = |load: f64| {
        let characteristic = |frequency: f64| {
            let root = libm::hypot(0.5 * load, frequency);
            let [first, second] = [root - 0.5 * load, root + 0.5 * load].map(f64::sqrt);
            let (sine, cosine) = libm::sincos(second);
            load * load
                + 2.0 * frequency * frequency * (1.0 + libm::cosh(first) * cosine)
                + load * frequency * libm::sinh(first) * sine
        };
        // Golden-section search between the roots.
        let (mut low, mut high) = (6.0, 16.0);
        let part = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..60 {
            let [near, far] = [high - part * (high - low), low + part * (high - low)];
            if characteristic(near) < characteristic(far) {
                high = far;
            } else {
                low = near;
            }
        }
        characteristic(0.5 * (low + high))
    };
    bisect(15.0, 24.0, least)
}

/// Critical tip load of a clamped strip that bends in its stiff plane, P L²/√(EI₁ GJ) = 4.0126 (Prandtl
/// 1899): the twist angle obeys u″ + β² s² u = 0 over the distance s from the tip, u′(0) = 0, u(1) = 0.
pub fn strip_tip_load() -> f64 {
    bisect(3.0, 5.0, |load| {
        let (mut sum, mut term) = (1.0, 1.0);
        for k in 1..20 {
            let power = 4.0 * f64::from(k);
            term *= -load * load / (power * (power - 1.0));
            sum += term;
        }
        sum
    })
}

/// Critical twisting moment of a straight rod with both ends clamped and no axial force, M L/EI = 2 x with
/// x the first positive root of tan x = x (Greenhill 1883): 8.986819.
pub fn clamped_twist_moment() -> f64 {
    2.0 * bisect(PI, 1.5 * PI, |x| libm::sin(x) - x * libm::cos(x))
}

/// Critical total twist of a closed ring, in units of EI/GJ: 2π√3 (Michell 1889, Zajac 1962).
pub fn ring_twist() -> f64 {
    2.0 * PI * 3f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_satisfy_their_equations() {
        for (mode, expected) in [(1, 1.8751040687), (2, 4.6940911330), (3, 7.8547574382)] {
            let x = cantilever_wave_number(mode);
            assert!((x - expected).abs() < 1e-9);
            assert!((x.cos() * x.cosh() + 1.0).abs() < 1e-11);
        }
        let x = 0.5 * clamped_twist_moment();
        assert!((x.tan() - x).abs() < 1e-12);
        assert!((2.0 * x - 8.986819).abs() < 1e-6);
        assert!((strip_tip_load() - 4.0126).abs() < 5e-5);
    }

    #[test]
    fn stretched_rods_lie_between_beams_and_strings() {
        for mode in 1..=3 {
            let frequency =
                |tension: f64, bending: f64| stretched_frequency(mode, tension, bending, 2.0, 3.0);
            // A clamped beam has the same wave numbers as a free beam.
            let beam = (free_wave_number(mode) / 3.0).powi(2) * 0.5_f64.sqrt();
            assert!((frequency(1e-9, 1.0) / beam - 1.0).abs() < 1e-9);
            // To first order, each end shortens a stiff string by √(EI/T).
            let string = mode as f64 * PI / 3.0 * 0.5_f64.sqrt();
            let stiff = frequency(1.0, 1e-8) / string - 1.0;
            assert!((stiff / (2.0 * 1e-4 / 3.0) - 1.0).abs() < 1e-3, "{stiff}");
        }
    }
}
