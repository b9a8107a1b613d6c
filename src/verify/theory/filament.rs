//! Buckling of a straight filament along the direction in which a flow compresses it.
//!
//! A filament of length L lies along x in the planar flow U = ε (−x, y). With the local drag ξ_∥,
//! ξ_⊥ per length and velocity, its tension is T = −ξ_∥ ε (L²/4 − x²)/2. A small deflection y obeys
//!
//! ```text
//! ξ_⊥ y_t = ξ_⊥ ε (y + x y') + T y'' − B y'''',    y'' = y''' = 0 at both ends:
//! ```
//!
//! the term T' y' and the difference of the coefficients along the inclined filament add to
//! ξ_⊥ ε x y'. With ξ = x/L, r = ξ_∥/ξ_⊥ and η = ξ_∥ ε L⁴/B, modes grow as exp(λ ε t), where
//!
//! ```text
//! λ y = y + ξ y' − r (1/4 − ξ²) y''/2 − (r/η) y''''.
//! ```
//!
//! Translation (λ = 1) and rotation (λ = 2) grow always. Symmetric polynomials in 2ξ, by Galerkin's
//! method, give the mode that buckles: the fastest symmetric one except translation. For r = 1/2
//! it buckles at η = 76.6, the value of Young and Shelley (2007, Phys. Rev. Lett. 99, 058303).

use nalgebra::DMatrix;

/// Number of symmetric polynomials.
const POLYNOMIALS: usize = 8;

/// Growth rate λ of the symmetric mode that buckles.
pub fn buckling_growth(eta: f64, ratio: f64) -> f64 {
    let mut mass = DMatrix::zeros(POLYNOMIALS, POLYNOMIALS);
    let mut rate = mass.clone();
    // ∫ t^m over (−1, 1) for even m.
    let integral = |power: f64| 2.0 / (power + 1.0);
    for row in 0..POLYNOMIALS {
        for column in 0..POLYNOMIALS {
            let (i, j) = (2.0 * row as f64, 2.0 * column as f64);
            mass[(row, column)] = integral(i + j);
            let mut entry = (1.0 + j) * integral(i + j);
            if column > 0 {
                let second = j * (j - 1.0);
                entry -= 0.5 * ratio * second * (integral(i + j - 2.0) - integral(i + j));
                if row > 0 {
                    let both = second * i * (i - 1.0);
                    entry -= 16.0 * ratio / eta * both * integral(i + j - 4.0);
                }
            }
            rate[(row, column)] = entry;
        }
    }
    let modes = mass
        .lu()
        .solve(&rate)
        .expect("the polynomials are independent");
    let mut rates: Vec<f64> = modes
        .complex_eigenvalues()
        .iter()
        .map(|rate| rate.re)
        .collect();
    let from_translation = |rate: &f64| (rate - 1.0).abs();
    rates.sort_by(|a, b| from_translation(a).total_cmp(&from_translation(b)));
    rates[1..].iter().copied().fold(f64::MIN, f64::max)
}

/// η at which the filament begins to buckle.
pub fn buckling_load(ratio: f64) -> f64 {
    let (mut low, mut high) = (1.0, 1e3);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if buckling_growth(middle, ratio) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_grow_without_stiffness() {
        // The operator is then triangular in the powers of 2ξ.
        let highest = 2.0 * (POLYNOMIALS - 1) as f64;
        let fastest = highest + 1.0 + 0.25 * highest * (highest - 1.0);
        let found = buckling_growth(1e12, 0.5);
        assert!((found / fastest - 1.0).abs() < 1e-5, "{found} {fastest}");
    }

    #[test]
    fn a_filament_buckles_above_its_load() {
        let load = buckling_load(0.5);
        // Powers are nearly dependent, which costs half of the digits.
        let growth = buckling_growth(load, 0.5);
        assert!(growth.abs() < 1e-6, "{growth}");
        assert!(buckling_growth(0.9 * load, 0.5) < 0.0);
        assert!(buckling_growth(1.1 * load, 0.5) > 0.0);
        // With ξ_∥ = 4πμ/c, Young and Shelley (2007) give 8πμ ε L⁴/(c B) = 153.2 for ξ_⊥ = 2 ξ_∥.
        assert!((2.0 * load - 153.2).abs() < 0.05, "{load}");
    }
}
