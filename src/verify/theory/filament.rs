//! Buckling of a straight filament that a flow compresses: at rest in an extension, and while it
//! turns in a shear.
//!
//! # Extension
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
//!
//! # Shear
//! A straight filament with its middle at rest in the shear U = γ Y e_X has the angle φ from the
//! direction of the flow. With S = sin φ, C = cos φ, and the unit vectors p = (C, S) along it and
//! n = (−S, C) across it, it turns by φ' = −γ S², that is cot φ = cot φ₀ + γ t. A point r = s p +
//! y n of the filament, slightly deflected by y(s, t), moves at r_t = (s φ' + y_t) n − y φ' p, and
//! U = γ (s S + y C) (C p − S n) there. Relative to the fluid it has the velocity
//!
//! ```text
//! w = r_t − U = (y_t + γ S C y) n − (γ S C s + γ (C² − S²) y) p.
//! ```
//!
//! The forces per length balance: ξ_∥ (w·t) t + ξ_⊥ (w·N) N = (T t)_s − B r_ssss with the tangent
//! t = p + y' n and the normal N = n − y' p. To order zero along p, −ξ_∥ γ S C s = T', hence T = ξ_∥
//! γ S C (L²/4 − s²)/2. To order one along n, w·N = y_t + γ S C (y + s y'), and the term −ξ_∥ γ S C
//! s y' of the drag along the filament equals T' y', which leaves
//!
//! ```text
//! ξ_⊥ (y_t + γ S C (y + s y')) = T y'' − B y''''.
//! ```
//!
//! The forces of order one along p change the tension by order one and the deflection by order two.
//! This is the equation of the extension with the rate ε(t) = −γ S C, which compresses while the
//! filament turns from φ = π to π/2 (Becker and Shelley 2001, Phys. Rev. Lett. 87, 198301). With
//! c = cot φ, −S C = −c/(1 + c²) and γ dt = dc. With η = ξ_∥ γ L⁴/B, the deflection obeys
//!
//! ```text
//! dy/dc = −c/(1 + c²) (y + ξ y' − r (1/4 − ξ²) y''/2) − (r/η) y''''.
//! ```

use nalgebra::{DMatrix, DVector};

/// Number of symmetric polynomials.
const POLYNOMIALS: usize = 8;

/// Number of steps in which cot φ of a turning filament changes by one.
const STEPS: usize = 100;

/// The equation for symmetric polynomials in 2ξ, by Galerkin's method: the mass of the polynomials,
/// and the terms of the flow and of the bending stiffness.
struct Operators {
    mass: DMatrix<f64>,
    flow: DMatrix<f64>,
    bending: DMatrix<f64>,
}

impl Operators {
    fn new(eta: f64, ratio: f64) -> Self {
        let zeros = || DMatrix::zeros(POLYNOMIALS, POLYNOMIALS);
        let (mut mass, mut flow, mut bending) = (zeros(), zeros(), zeros());
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
                        bending[(row, column)] = 16.0 * ratio / eta * both * integral(i + j - 4.0);
                    }
                }
                flow[(row, column)] = entry;
            }
        }
        Self {
            mass,
            flow,
            bending,
        }
    }
}

/// Growth rate λ of the symmetric mode that buckles.
pub fn buckling_growth(eta: f64, ratio: f64) -> f64 {
    let Operators {
        mass,
        flow,
        bending,
    } = Operators::new(eta, ratio);
    let rate = flow - bending;
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
    zero(|eta| buckling_growth(eta, ratio))
}

/// Root of a function of η that increases.
fn zero(function: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (1.0, 1e3);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if function(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// Logarithm of the factor by which the bend of a filament, the deflection of its middle from its
/// chord, grows while the filament turns in a shear between the two later values of cot φ; at the
/// first it is a circular arc.
pub fn growth_while_turning(eta: f64, ratio: f64, cotangents: [i32; 3]) -> f64 {
    let Operators {
        mass,
        flow,
        bending,
    } = Operators::new(eta, ratio);
    let step = 1.0 / STEPS as f64;
    // A diagonally implicit method of second order that damps the fast modes of the arc.
    let part = 1.0 - 0.5_f64.sqrt();
    let rate_at = |cotangent: f64| {
        let compression = -cotangent / (1.0 + cotangent * cotangent);
        &flow * compression - &bending
    };
    let mut powers = DVector::zeros(POLYNOMIALS);
    powers[1] = 1.0;
    let [mut bend, mut earlier] = [1.0; 2];
    for leg in cotangents.windows(2) {
        earlier = bend;
        for number in 0..(leg[1] - leg[0]) as usize * STEPS {
            let at = f64::from(leg[0]) + number as f64 * step;
            let slope = |from: &DVector<f64>, cotangent: f64| {
                let rate = rate_at(cotangent);
                (&mass - &rate * (part * step))
                    .lu()
                    .solve(&(rate * from))
                    .expect("the step is short")
            };
            let first = slope(&powers, at + part * step);
            let second = slope(&(&powers + &first * ((1.0 - part) * step)), at + step);
            powers += (first * (1.0 - part) + second * part) * step;
        }
        bend = powers.rows(1, POLYNOMIALS - 1).sum();
    }
    libm::log(bend / earlier)
}

/// η at which the bend of a filament that turns through these values of cot φ is the same at the
/// last two.
pub fn load_while_turning(ratio: f64, cotangents: [i32; 3]) -> f64 {
    zero(|eta| growth_while_turning(eta, ratio, cotangents))
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

    #[test]
    fn bends_without_stiffness_deform_with_the_fluid() {
        // Without tension (r → 0) and stiffness, a power ξ^j grows as sin φ to the power 1 + j.
        let found = growth_while_turning(1e12, 1e-12, [-2, -1, 0]);
        let exact = 3.0 * 0.5 * libm::log(2.0);
        assert!((found - exact).abs() < 1e-4, "{found} {exact}");
    }

    #[test]
    fn a_filament_that_turns_needs_more_than_twice_the_load_of_an_extension() {
        // The shear compresses by half its rate at the most.
        let load = load_while_turning(0.5, [-4, -3, 0]);
        assert!(load > 2.0 * buckling_load(0.5), "{load}");
        assert!(growth_while_turning(0.9 * load, 0.5, [-4, -3, 0]) < -0.01);
    }

    #[test]
    fn a_stiff_filament_relaxes_in_the_first_mode_of_a_free_beam() {
        // Far from φ = π/2 the shear neither compresses nor stretches it.
        let found = growth_while_turning(250.0, 0.5, [-1_000_003, -1_000_001, -1_000_000]);
        let exact = -500.563_901_740_4 * 0.5 / 250.0;
        assert!((found / exact - 1.0).abs() < 1e-4, "{found} {exact}");
    }
}
