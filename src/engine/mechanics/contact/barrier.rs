//! The barrier of incremental potential contact (thesis Eq. 2.1; Li et al. 2020, "Incremental potential
//! contact", Eq. 6).
//!
//! With the surface gap g = Δ − 2h̄ in units of h̄, the mean radius of the two surfaces, as in Eq. 2.15,
//!
//! E = −k ((g − δ)/h̄)² ln(g/δ) for 0 < g < δ, and zero beyond.
//!
//! Eq. 2.1 prints Δ/(2h + δ) in the logarithm, which stays finite at contact; in the intended
//! form, used here, energy and force grow without bound as the surfaces meet. At g = δ the energy
//! vanishes like (δ − g)³, so it is twice continuously differentiable. With w = δ/g − 1,
//!
//! N = k δ/h̄² w/(1 + w) (w + 2 ln(1 + w)), dN/dg = −k/h̄² (w² + 4w + 2 ln(1 + w)).
//!
//! The force alone separates the surfaces; [`step_bound`](super::step_bound) prevents a Newton
//! step from jumping over the barrier.

use super::normal_response::NormalResponse;

/// Force N h̄²/(k δ) in the middle of the barrier, x = 1/2: (1 + 2 ln 2)/2.
const FORCE_IN_THE_MIDDLE: f64 = 0.5 + std::f64::consts::LN_2;

/// Maximum number of iterations for the gap of a force.
const GAP_ITERATIONS: usize = 5;
/// Change of the logarithm of w after which its square is below rounding error.
const GAP_CHANGE: f64 = 1e-9;

/// The barrier at a surface gap `gap` (m) between bodies of mean radius h̄ = `scale` (m), for the stiffness
/// k = `stiffness` (J) and the distance tolerance δ = `tolerance` (m).
///
/// Surfaces that touch or overlap have an infinite energy and force.
pub(super) fn normal_response(
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
    let nearness = (tolerance - gap) / gap;
    let logarithm = libm::log1p(nearness);
    let depth = (tolerance - gap) / scale;
    let unit = stiffness / (scale * scale);
    NormalResponse {
        energy: stiffness * depth * depth * logarithm,
        force: unit * (tolerance - gap) * (nearness + 2.0 * logarithm),
        force_slope: -unit * (nearness * (nearness + 4.0) + 2.0 * logarithm),
    }
}

/// The surface gap (m) at which [`normal_response`] gives `force` (N), positive.
pub(super) fn gap_of_force(force: f64, scale: f64, tolerance: f64, stiffness: f64) -> f64 {
    // N = 3w² for small forces, w for large ones.
    let relative = force * scale * scale / (stiffness * tolerance);
    let mut nearness = if relative > 1.0 {
        relative
    } else {
        (relative / 3.0).sqrt()
    };
    // Newton's method in log N and log w, whose slope lies between 1 and 2: four iterations reach
    // rounding error.
    for _ in 0..GAP_ITERATIONS {
        let sum = nearness + 2.0 * libm::log1p(nearness);
        let found = nearness / (1.0 + nearness) * sum;
        let slope = (1.0 + nearness * (nearness + 3.0) / sum) / (1.0 + nearness);
        let change = libm::log(relative / found) / slope;
        nearness *= libm::exp(change);
        if change.abs() < GAP_CHANGE {
            break;
        }
    }
    tolerance / (1.0 + nearness)
}

/// The stiffness k (J) at which a unit force (N) between bodies of mean radius h̄ = `scale` (m) is balanced in the
/// middle of the barrier.
///
/// A softer barrier carries its loads close to contact, where it is steep; a stiffer one carries
/// them far out, where it is shallow and its curvature changes most from step to step. Newton's
/// method converges best in the middle.
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
                    let found = normal_response(gap, radius, tolerance, 3.0);
                    assert!((found.energy - value).abs() < 1e-12 * value);
                    assert!((found.force + slope).abs() < 1e-12 * slope.abs());
                    assert!((found.force_slope + curvature).abs() < 1e-12 * curvature);
                }
            }
        }
    }

    #[test]
    fn the_gap_of_a_force_has_that_force() {
        let stiffness = stiffness_per_force(1e-3, 1e-5);
        for exponent in -80..=80 {
            let force = 10f64.powf(0.1 * f64::from(exponent));
            let gap = gap_of_force(force, 1e-3, 1e-5, stiffness);
            let found = normal_response(gap, 1e-3, 1e-5, stiffness).force;
            assert!((found / force - 1.0).abs() < 1e-10, "{force:e} {found:e}");
        }
    }

    #[test]
    fn energy_force_and_slope_join_the_free_space_continuously() {
        let at = |fraction: f64| normal_response(fraction * 1e-5, 1e-3, 1e-5, 1.0);
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
            let found = normal_response(fraction * 1e-5, 1e-3, 1e-5, 1.0);
            let limit = 1e-5 * 1e-5 / (1e-3 * 1e-3 * fraction * 1e-5);
            assert!((found.force / limit - 1.0).abs() < 100.0 * fraction * fraction.ln().abs());
        }
    }

    #[test]
    fn the_stiffness_bears_its_force_in_the_middle() {
        for (radius, tolerance) in [(1e-3, 1e-5), (2e-2, 1e-3)] {
            let stiffness = 7.0 * stiffness_per_force(radius, tolerance);
            let found = normal_response(0.5 * tolerance, radius, tolerance, stiffness);
            assert!((found.force - 7.0).abs() < 1e-13);
        }
    }
}
