//! Beams of stepped and tapered sections.

use rodlab_engine::mechanics::kirchhoff::numerics::bisect;
use std::f64::consts::{FRAC_PI_2, PI};

/// A part of a stepped beam.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Length, m.
    pub length: f64,
    /// Bending stiffness, N m².
    pub bending: f64,
    /// Mass per length, kg/m.
    pub mass_per_length: f64,
}

/// Displacement of the free end of a cantilever per transverse force there, ∫ x²/EI dx over the
/// distance x from the free end, m/N. Parts count from the clamp.
pub fn stepped_compliance(parts: &[Part]) -> f64 {
    let (mut from, mut sum) = (0.0, 0.0);
    for part in parts.iter().rev() {
        let to: f64 = from + part.length;
        sum += (to.powi(3) - from.powi(3)) / (3.0 * part.bending);
        from = to;
    }
    sum
}

/// Angular frequency of a mode of a stepped cantilever, rad/s, counted from 1 (Euler–Bernoulli).
/// Parts count from the clamp.
///
/// The state (w, w′, M, V) with M = EI w″ and V = EI w‴ is continuous from part to part, where
/// w⁗ = β⁴ w, β⁴ = ρA ω²/EI. From the clamp, w = w′ = 0, two solutions start; at the free end a
/// combination of them has M = V = 0 where their determinant vanishes.
pub fn stepped_frequency(parts: &[Part], mode: usize) -> f64 {
    let length: f64 = parts.iter().map(|part| part.length).sum();
    let slowest = |part: &Part| (part.bending / part.mass_per_length).sqrt() / (length * length);
    let unit = parts.iter().map(slowest).fold(f64::INFINITY, f64::min);
    let (mut before, mut found) = (0.1 * unit, 0);
    loop {
        let after = before + 0.1 * unit;
        if determinant(parts, before) * determinant(parts, after) <= 0.0 {
            found += 1;
            if found == mode {
                return bisect(before, after, |frequency| determinant(parts, frequency));
            }
        }
        before = after;
    }
}

fn determinant(parts: &[Part], frequency: f64) -> f64 {
    let mut states = [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    for part in parts {
        states = states.map(|state| transferred(part, frequency, state));
    }
    states[0][2] * states[1][3] - states[0][3] * states[1][2]
}

/// The state (w, w′, M, V) at the end of a part.
fn transferred(part: &Part, frequency: f64, [w, slope, moment, shear]: [f64; 4]) -> [f64; 4] {
    let fourth = part.mass_per_length * frequency * frequency / part.bending;
    let beta = fourth.sqrt().sqrt();
    let (sine, cosine) = libm::sincos(beta * part.length);
    let (sinh, cosh) = (
        libm::sinh(beta * part.length),
        libm::cosh(beta * part.length),
    );
    let functions = [
        0.5 * (cosh + cosine),
        0.5 * (sinh + sine) / beta,
        0.5 * (cosh - cosine) / beta.powi(2),
        0.5 * (sinh - sine) / beta.powi(3),
    ];
    let from = [w, slope, moment / part.bending, shear / part.bending];
    let to: [f64; 4] = std::array::from_fn(|row| {
        let term = |column: usize| match column >= row {
            true => functions[column - row] * from[column],
            false => fourth * functions[4 + column - row] * from[column],
        };
        (0..4).map(term).sum()
    });
    [to[0], to[1], part.bending * to[2], part.bending * to[3]]
}

/// Displacement of the free end of a round cantilever that tapers from the radius `thick` at the
/// clamp to `thin`, per transverse force there, m/N: L³/(3 EI₀) · thick/thin with EI₀ at the clamp.
pub fn tapered_compliance(youngs_modulus: f64, length: f64, [thick, thin]: [f64; 2]) -> f64 {
    let bending = youngs_modulus * 0.25 * PI * thick.powi(4);
    length.powi(3) / (3.0 * bending) * thick / thin
}

/// Critical compression of a truncated cone that is clamped at its thick end and free at the other,
/// N (Dinnik 1929; Timoshenko and Gere 1961, sec. 2.14). With the distance x from the apex, EI = B
/// (x/a)⁴ with B at the free end x = a, the deflection y from the line of the force satisfies
///
/// ```text
/// B (x/a)⁴ y″ + P y = 0,     y = x sin(k/a − k/x),     k² = P a⁴/B
/// ```
///
/// y(a) = 0, and y′(b) = 0 at the clamp requires tan(kL/ab) = −k/b.
pub fn conical_column_load(youngs_modulus: f64, length: f64, [thick, thin]: [f64; 2]) -> f64 {
    let a = length * thin / (thick - thin);
    let b = a + length;
    let bending = youngs_modulus * 0.25 * PI * thin.powi(4);
    let angle = bisect(FRAC_PI_2, PI, |angle| {
        let k = angle * a * b / length;
        libm::sin(angle) + k / b * libm::cos(angle)
    });
    let k = angle * a * b / length;
    k * k * bending / a.powi(4)
}

#[cfg(test)]
mod tests {
    use super::super::beam::{FREE_COLUMN, cantilever_wave_number};
    use super::*;
    use rodlab_engine::mechanics::kirchhoff::numerics::runge_kutta;

    #[test]
    fn parts_that_are_alike_make_a_uniform_beam() {
        let part = |length: f64| Part {
            length,
            bending: 3.0,
            mass_per_length: 0.7,
        };
        let parts = [part(0.3), part(0.9), part(0.8)];
        for mode in 1..=3 {
            let beta = cantilever_wave_number(mode) / 2.0;
            let exact = beta * beta * (3.0f64 / 0.7).sqrt();
            assert!(
                (stepped_frequency(&parts, mode) / exact - 1.0).abs() < 1e-9,
                "{mode}"
            );
        }
        assert!((stepped_compliance(&parts) * 9.0 / 8.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_cone_that_hardly_tapers_is_a_uniform_column() {
        let radii = [1.0 + 1e-6, 1.0];
        let bending = 0.25 * PI;
        let load = conical_column_load(1.0, 10.0, radii) / bending * 100.0;
        assert!((load / FREE_COLUMN - 1.0).abs() < 1e-5, "{load}");
        let compliance = tapered_compliance(1.0, 10.0, radii) * 3.0 * bending / 1000.0;
        assert!((compliance - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_load_of_a_cone_agrees_with_its_differential_equation() {
        // y″ = −P y/EI over the distance from the free end, y = 0 there, y′ = 0 at the clamp.
        let [thick, thin] = [2.0, 1.0];
        let clamp = |load: f64| {
            let slope = |s: f64, [y, rate]: &[f64; 2]| {
                let radius = thin + (thick - thin) * s;
                [*rate, -load * y / (0.25 * PI * radius.powi(4))]
            };
            let states = runge_kutta(0.0, 1.0, [0.0, 1.0], 4000, slope);
            states[states.len() - 1][1]
        };
        let load = bisect(1.0, 30.0, clamp);
        let closed = conical_column_load(1.0, 1.0, [thick, thin]);
        assert!((closed / load - 1.0).abs() < 1e-9, "{closed} {load}");
    }
}
