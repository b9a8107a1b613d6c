//! The barrier of incremental potential contact (thesis Eq. 2.1; Li et al. 2020, "Incremental potential
//! contact", Eq. 6).
//!
//! With the surface gap g = Δ − 2h̄ in units of h̄, the mean radius of the two surfaces, as in Eq. 2.15,
//!
//! E = −k ((g − δ)/h̄)² ln(g/δ) for 0 < g < δ, and zero beyond.
//!
//! Eq. 2.1 prints Δ/(2h + δ) in the logarithm, which stays finite at contact; in the form meant, and here, energy and
//! force grow beyond all bounds as the surfaces meet. At g = δ the energy vanishes like (δ − g)³, so that it
//! is twice continuously differentiable. With x = g/δ
//!
//! N = k δ/h̄² (1 − x)(1/x − 1 − 2 ln x), dN/dg = k/h̄² (2 ln x + 4 (x − 1)/x − ((x − 1)/x)²).
//!
//! The force alone separates the surfaces; that no Newton step jumps over the barrier is the task of
//! [`step_bound`](super::step_bound).

use super::potential::NormalResponse;

/// Force N h̄²/(k δ) in the middle of the barrier, x = 1/2: (1 + 2 ln 2)/2.
const FORCE_IN_THE_MIDDLE: f64 = 0.5 + std::f64::consts::LN_2;

/// The barrier at a surface gap `gap` (m) between bodies of mean radius h̄ = `scale` (m), for the stiffness
/// k = `stiffness` (J) and the distance tolerance δ = `tolerance` (m).
///
/// Surfaces that touch or overlap have an infinite energy and force.
pub(super) fn barrier_response(
    gap: f64,
    scale: f64,
    tolerance: f64,
    stiffness: f64,
) -> NormalResponse {
    if gap >= tolerance {
        return NormalResponse {
            energy: 0.0,
            force: 0.0,
            force_slope: 0.0,
        };
    }
    if gap <= 0.0 {
        return NormalResponse {
            energy: f64::INFINITY,
            force: f64::INFINITY,
            force_slope: f64::NEG_INFINITY,
        };
    }
    let fraction = gap / tolerance;
    let missing = 1.0 - fraction;
    let logarithm = libm::log(fraction);
    let steepness = missing / fraction;
    let unit = stiffness / (scale * scale);
    NormalResponse {
        energy: -unit * tolerance * tolerance * missing * missing * logarithm,
        force: unit * tolerance * missing * (steepness - 2.0 * logarithm),
        force_slope: unit * (2.0 * logarithm - 4.0 * steepness - steepness * steepness),
    }
}

/// The stiffness k (J) at which a unit force (N) between bodies of mean radius h̄ = `scale` (m) is borne in the
/// middle of the barrier.
///
/// A softer barrier carries its loads close to contact, where it is steep; a stiffer one far out, where it
/// is shallow and its curvature changes most from step to step. Newton's method likes the middle.
pub(super) fn stiffness_per_force(scale: f64, tolerance: f64) -> f64 {
    scale * scale / (FORCE_IN_THE_MIDDLE * tolerance)
}

#[cfg(test)]
mod tests {
    use super::super::test_support::Dual;
    use super::*;
    use num_dual::second_derivative;

    fn energy<D: Dual>(gap: D, radius: f64, tolerance: f64, stiffness: f64) -> D {
        let depth = (gap - tolerance) / radius;
        -depth * depth * (gap / tolerance).ln() * stiffness
    }

    #[test]
    fn force_and_slope_are_the_derivatives_of_the_energy_over_decades() {
        for radius in [1e-4, 1e-3, 1e-2, 1e-1] {
            for relative_tolerance in [1e-3, 1e-2, 1e-1] {
                let tolerance = relative_tolerance * radius;
                for fraction in [1e-9, 1e-6, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
                    let gap = fraction * tolerance;
                    let (value, slope, curvature) =
                        second_derivative(|gap| energy(gap, radius, tolerance, 3.0), gap);
                    let found = barrier_response(gap, radius, tolerance, 3.0);
                    assert!((found.energy - value).abs() < 1e-12 * value);
                    assert!((found.force + slope).abs() < 1e-12 * slope.abs());
                    assert!((found.force_slope + curvature).abs() < 1e-12 * curvature);
                }
            }
        }
    }

    #[test]
    fn energy_force_and_slope_join_the_free_space_continuously() {
        let at = |fraction: f64| barrier_response(fraction * 1e-5, 1e-3, 1e-5, 1.0);
        let middle = at(0.5);
        for distance in [1e-3, 1e-6, 1e-9] {
            let near = at(1.0 - distance);
            assert!(near.energy > 0.0 && near.energy < 10.0 * distance.powi(3) * middle.energy);
            assert!(near.force > 0.0 && near.force < 10.0 * distance.powi(2) * middle.force);
            let slope = near.force_slope / middle.force_slope;
            assert!(slope > 0.0 && slope < 10.0 * distance);
        }
        let (outside, touching) = (at(1.0), at(0.0));
        assert_eq!(
            (outside.energy, outside.force, outside.force_slope),
            (0.0, 0.0, 0.0)
        );
        assert_eq!(
            (touching.energy, touching.force),
            (f64::INFINITY, f64::INFINITY)
        );
    }

    #[test]
    fn the_force_grows_beyond_all_bounds_towards_contact() {
        // N → k δ²/(h̄² g).
        for fraction in [1e-6, 1e-9, 1e-12] {
            let found = barrier_response(fraction * 1e-5, 1e-3, 1e-5, 1.0);
            let limit = 1e-5 * 1e-5 / (1e-3 * 1e-3 * fraction * 1e-5);
            assert!((found.force / limit - 1.0).abs() < 100.0 * fraction * fraction.ln().abs());
        }
    }

    #[test]
    fn the_stiffness_bears_its_force_in_the_middle() {
        for (radius, tolerance) in [(1e-3, 1e-5), (2e-2, 1e-3)] {
            let stiffness = 7.0 * stiffness_per_force(radius, tolerance);
            let found = barrier_response(0.5 * tolerance, radius, tolerance, stiffness);
            assert!((found.force - 7.0).abs() < 1e-13);
        }
    }
}
