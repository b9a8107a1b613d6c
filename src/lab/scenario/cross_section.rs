//! Areas, second moments and stiffnesses of cross-sections.
//!
//! **Convention.** EI₁ resists bending about the first material director m₁ (the axis of
//! rotation), so it belongs to the second moment I₁ = ∫ y² dA, where y is measured along the
//! second director m₂. The roles are exchanged for EI₂. A rectangle has its `width` along m₁ and
//! its `thickness` along m₂: I₁ = width · thickness³/12.

use super::resolved::{CrossSection, Material, Stiffness};
use std::f64::consts::PI;

/// Number of terms of Saint-Venant's series: the next term would change a square's J by a relative
/// error below 1e-10.
const SERIES_TERMS: usize = 100;

impl CrossSection {
    /// Area A in m², for a rod of the given radius in m.
    pub fn area(&self, radius: f64) -> f64 {
        match self {
            Self::Circle => PI * radius.powi(2),
            Self::Tube { wall } => PI * (radius.powi(2) - (radius - wall).powi(2)),
            Self::Rectangle { width, thickness } => width * thickness,
        }
    }

    /// Second moments I₁ and I₂ in m⁴ for bending about the first and the second material director.
    pub fn second_moments(&self, radius: f64) -> [f64; 2] {
        match self {
            Self::Circle => [PI * radius.powi(4) / 4.0; 2],
            Self::Tube { wall } => [PI * (radius.powi(4) - (radius - wall).powi(4)) / 4.0; 2],
            Self::Rectangle { width, thickness } => [
                width * thickness.powi(3) / 12.0,
                thickness * width.powi(3) / 12.0,
            ],
        }
    }

    /// Saint-Venant's torsion constant J in m⁴: the polar moment for a circle or tube; for a rectangle with sides a ≥ b
    /// (Timoshenko and Goodier 1970, art. 109)
    ///
    /// J = a b³/3 · (1 − 192 b/(π⁵ a) Σ tanh(nπa/2b)/n⁵), n = 1, 3, 5, ...
    pub fn torsion_constant(&self, radius: f64) -> f64 {
        match self {
            Self::Circle => PI * radius.powi(4) / 2.0,
            Self::Tube { wall } => PI * (radius.powi(4) - (radius - wall).powi(4)) / 2.0,
            Self::Rectangle { width, thickness } => {
                let (long, short) = (width.max(*thickness), width.min(*thickness));
                let series: f64 = (0..SERIES_TERMS)
                    .rev()
                    .map(|term| {
                        let n = (2 * term + 1) as f64;
                        libm::tanh(n * PI * long / (2.0 * short)) / n.powi(5)
                    })
                    .sum();
                long * short.powi(3) / 3.0 * (1.0 - 192.0 * short / (PI.powi(5) * long) * series)
            }
        }
    }

    /// Stiffness of a rod of the given radius in m and material: EA, EI₁, EI₂ and GJ, G = E/2(1 + ν).
    pub fn stiffness(&self, radius: f64, material: &Material) -> Stiffness {
        let youngs_modulus = material.youngs_modulus;
        let shear_modulus = youngs_modulus / (2.0 * (1.0 + material.poissons_ratio));
        let [second_moment_1, second_moment_2] = self.second_moments(radius);
        Stiffness {
            stretching: youngs_modulus * self.area(radius),
            bending_1: youngs_modulus * second_moment_1,
            bending_2: youngs_modulus * second_moment_2,
            twisting: shear_modulus * self.torsion_constant(radius),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_has_the_textbook_moments() {
        let circle = CrossSection::Circle;
        let [first, second] = circle.second_moments(2.0);
        assert_eq!(circle.area(2.0), 4.0 * PI);
        assert_eq!(first, second);
        // The polar moment is the sum of both second moments; for a circle it equals the torsion
        // constant.
        assert_eq!(circle.torsion_constant(2.0), first + second);
    }

    #[test]
    fn torsion_of_rectangles_agrees_with_timoshenkos_table() {
        // Coefficients k₁ = J/(a b³) of Timoshenko and Goodier 1970, table in art. 109.
        for (ratio, coefficient) in [
            (1.0, 0.1406),
            (1.5, 0.196),
            (2.0, 0.229),
            (4.0, 0.281),
            (10.0, 0.312),
        ] {
            let torsion = CrossSection::Rectangle {
                width: 3.0,
                thickness: 3.0 * ratio,
            }
            .torsion_constant(f64::NAN);
            let got = torsion / (3.0 * ratio * 27.0);
            assert!((got - coefficient).abs() < 6e-4, "{ratio}: {got}");
        }
    }

    #[test]
    fn a_flat_strip_bends_easily_about_its_width() {
        let strip = CrossSection::Rectangle {
            width: 4.0,
            thickness: 1.0,
        };
        let material = Material {
            youngs_modulus: 3.0,
            poissons_ratio: 0.5,
            density: 1.0,
            viscosity: 0.0,
            relaxing_modulus: 0.0,
            relaxation_time: 0.0,
            yield_stress: 0.0,
            tangent_modulus: 0.0,
        };
        let stiffness = strip.stiffness(f64::NAN, &material);
        assert_eq!(stiffness.stretching, 12.0);
        assert_eq!(stiffness.bending_1, 1.0);
        assert_eq!(stiffness.bending_2, 16.0);
        assert!(stiffness.twisting < stiffness.bending_1 * 4.0 / 3.0);
    }
}
