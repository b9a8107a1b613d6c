//! The contact potential of the implicit contact model (thesis Eqs. 2.2, 2.15, 2.16).
//!
//! With lengths in units of h̄, the mean radius of the two surfaces, and the stiffness K₁ = 15 h̄/δ,
//!
//! E = k [ln(1 + exp(K₁(2 − Δ/h̄)))/K₁]².
//!
//! For surfaces of equal radius h̄ = h, this is Eq. 2.15. Otherwise the threshold 2h̄ is h_i +
//! h_j; at a plane h̄ = h, and the gap replaces Δ − 2h.
//!
//! Eq. 2.15 prints the square (2 − Δ̄)² below 2 − δ̄, to keep the exponential from overflowing,
//! and zero above 2 + δ̄. Here the logarithm is used on the whole line, in a form that does not
//! overflow. This makes the energy smooth for Newton's method. At the lower joint the two differ by
//! 2e⁻¹⁵/15 = 4e-8 of the energy and e⁻¹⁵ = 3e-7 of the force, and at the upper one by the jump to
//! zero, 2e-13 of the energy at touch. The potential ends at [`REACH`], where the force has fallen
//! below rounding error.

use super::normal_response::NormalResponse;

/// Distance between the surfaces, in units of δ, beyond which there is no force.
///
/// The force falls like exp(−30 gap/δ). At δ, where Eq. 2.15 cuts it off, it is 1e-8 of the force
/// for which the adaptive stiffness (s = 1e5, δ = h/100) is designed, which for a tight Newton
/// tolerance is still a jump; at 1.5 δ it is 4e-15 of that force.
const REACH: f64 = 1.5;

/// Slope of the energy curve: K₁ δ/h̄ (Eq. 2.16).
const SLOPE: f64 = 15.0;

/// Maximum number of iterations for the gap of a force.
const GAP_ITERATIONS: usize = 5;
/// Change of the exponent after which its square is below rounding error.
const GAP_CHANGE: f64 = 1e-9;

/// The potential at a surface gap Δ − 2h̄ (m) between bodies of mean radius h̄ = `scale` (m), for the
/// contact stiffness k = `stiffness` (J) and the distance tolerance δ = `tolerance` (m).
pub(super) fn normal_response(
    gap: f64,
    scale: f64,
    tolerance: f64,
    stiffness: f64,
) -> NormalResponse {
    let rate = SLOPE / tolerance;
    let exponent = -rate * gap;
    // ln(1 + eᵗ) and its derivative, the logistic function, both computed from the decaying
    // exponential.
    let decay = libm::exp(-exponent.abs());
    let softplus = exponent.max(0.0) + libm::log1p(decay);
    let logistic = if exponent > 0.0 { 1.0 } else { decay } / (1.0 + decay);
    let logistic_slope = decay / ((1.0 + decay) * (1.0 + decay));

    let energy_scale = stiffness / (rate * scale).powi(2);
    NormalResponse {
        energy: energy_scale * softplus * softplus,
        force: energy_scale * rate * 2.0 * softplus * logistic,
        force_slope: -energy_scale
            * rate
            * rate
            * 2.0
            * (logistic * logistic + softplus * logistic_slope),
    }
}

/// The surface gap (m) at which [`normal_response`] gives `force` (N), positive.
pub(super) fn gap_of_force(force: f64, scale: f64, tolerance: f64, stiffness: f64) -> f64 {
    let rate = SLOPE / tolerance;
    // N = 2 a ln(1 + eᵗ)/(1 + e⁻ᵗ): e²ᵗ for small forces, t for large ones.
    let relative = force * rate * scale * scale / (2.0 * stiffness);
    let logarithm = libm::log(relative);
    let mut exponent = if relative > 1.0 {
        relative
    } else {
        0.5 * logarithm
    };
    // Newton's method on the logarithm of N, which is nearly linear for small forces and concave: four
    // iterations reach rounding error from either start.
    for _ in 0..GAP_ITERATIONS {
        let decay = libm::exp(-exponent.abs());
        let softplus = exponent.max(0.0) + libm::log1p(decay);
        let logistic = if exponent > 0.0 { 1.0 } else { decay } / (1.0 + decay);
        let slope = logistic / softplus + 1.0 - logistic;
        let change = (logarithm - libm::log(softplus * logistic)) / slope;
        exponent += change;
        if change.abs() < GAP_CHANGE {
            break;
        }
    }
    -exponent / rate
}

/// Largest surface gap at which there is a force, for the distance tolerance δ, m.
pub(super) fn reach(tolerance: f64) -> f64 {
    REACH * tolerance
}

#[cfg(test)]
mod tests {
    use super::super::test_support::Dual;
    use super::*;
    use crate::mechanics::test_support::assert_close_in;
    use num_dual::second_derivative;

    /// The logarithmic branch of Eq. 2.15 as printed.
    fn printed_energy<D: Dual>(distance: D, radius: f64, tolerance: f64, stiffness: f64) -> D {
        let k1 = 15.0 * radius / tolerance;
        let scaled = (-distance / radius + 2.0) * k1;
        let softplus = if scaled.re() > 0.0 {
            ((-scaled).exp() + 1.0).ln() + scaled
        } else {
            (scaled.exp() + 1.0).ln()
        };
        (softplus / k1).powi(2) * stiffness
    }

    #[test]
    fn force_and_slope_are_the_derivatives_of_the_printed_energy() {
        for radius in [1e-4, 1e-3, 1e-2, 1e-1] {
            for relative_tolerance in [1e-3, 1e-2, 1e-1] {
                let tolerance = relative_tolerance * radius;
                for step in -20..=6 {
                    let gap = 0.1 * f64::from(step) * tolerance;
                    let (energy, slope, curvature) = second_derivative(
                        |distance| printed_energy(distance, radius, tolerance, 3.0),
                        2.0 * radius + gap,
                    );
                    let found = normal_response(gap, radius, tolerance, 3.0);
                    assert!((found.energy - energy).abs() < 1e-8 * energy);
                    assert!((found.force + slope).abs() < 1e-8 * slope.abs());
                    assert!((found.force_slope + curvature).abs() < 1e-6 * curvature);
                }
            }
        }
    }

    #[test]
    fn the_gap_of_a_force_has_that_force() {
        for exponent in -60..=12 {
            let (radius, tolerance, stiffness) = (1e-3, 1e-5, 40.0);
            let force = 10f64.powf(0.25 * f64::from(exponent));
            let gap = gap_of_force(force, radius, tolerance, stiffness);
            let found = normal_response(gap, radius, tolerance, stiffness).force;
            assert_close_in(gap, found, force, 1e-10);
        }
    }

    #[test]
    fn deep_penetration_and_wide_gaps_stay_finite() {
        let deep = normal_response(-2e-3, 1e-3, 1e-7, 1.0);
        assert!((deep.energy - 4.0).abs() < 1e-12, "(2 − Δ̄)² at Δ = 0");
        assert!((deep.force - 4e3).abs() < 1e-9);
        let wide = normal_response(1.0, 1e-3, 1e-7, 1.0);
        assert_eq!((wide.energy, wide.force), (0.0, 0.0));
    }

    #[test]
    fn rods_rest_four_micrometres_apart_at_the_adaptive_stiffness() {
        // One newton, s = 1e5, h = 1 mm, δ = 1e-5 m: the released code settles at 2.00402 mm.
        let gap_of_balance = |force: f64| {
            let (mut near, mut far) = (0.0, 1e-5);
            for _ in 0..60 {
                let middle = 0.5 * (near + far);
                if normal_response(middle, 1e-3, 1e-5, 1e5).force > force {
                    near = middle;
                } else {
                    far = middle;
                }
            }
            near
        };
        assert!((gap_of_balance(1.0) - 3.93e-6).abs() < 0.02e-6);
        assert!((gap_of_balance(0.76) - 4.02e-6).abs() < 0.02e-6);
    }

    #[test]
    fn energies_of_the_reference_table() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../..",
            "/../shared/reference/contact/contact_energy_values.csv"
        );
        let Ok(table) = std::fs::read_to_string(path) else {
            println!("skipped: {path} is absent");
            return;
        };
        let mut rows = 0;
        for line in table.lines().filter(|line| !line.starts_with(['#', 'h'])) {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let (radius, tolerance, distance) = (row[0], row[1], row[2]);
            // The table is in metres: no scaling by the radius.
            let found = normal_response(distance - 2.0 * radius, 1.0, tolerance, 1.0);
            // The printed square against the logarithm, see the module documentation.
            let [energy, force] = if distance < 2.0 * radius - tolerance {
                [5e-8, 4e-7]
            } else {
                [1e-10, 1e-10]
            };
            assert!((found.energy - row[3]).abs() < energy * row[3], "{line}");
            assert!(
                (found.force + row[4]).abs() < force * row[4].abs(),
                "{line}"
            );
            rows += 1;
        }
        assert_eq!(rows, 20);
    }
}
