//! Bending by the turning angle, for naturally straight rods.
//!
//! The curvature binormal κb of two edges that turn by φ has the length 2 tan(φ/2), which is too
//! large by φ³/12. A straight rod bent by loads turns by its curvature times its length, so that
//! the angle itself is the right strain. A factor λ converts |κb| to the angle, exact up to
//! φ⁷/840. The factor needs neither a root nor a division, and the energy still grows without bound
//! at a fold, φ = π. With c = cos²(φ/2) and q = |κb|² = 4/c − 4, which is the sum of two squares in
//! the frame of each edge,
//!
//! ```text
//! E = Σⱼ [EI₂ (λκ¹ʲ)² + EI₁ (λκ²ʲ)²] / 4l̄
//! λ = (8 + 9c − 2c²)/15,   dλ/dq = −c² (9 − 4c)/60,   d²λ/dq² = c³ (3 − 2c)/40
//! ```
//!
//! (The angle is less accurate for rods with a large natural curvature. A polygon of the right
//! length around such an arc turns by 2 tan(φ/2) if its edges touch the arc, which is the strain
//! κb.)
//!
//! **Derivatives** with respect to the components of κb, whose derivatives with respect to the
//! unknowns are in [`super::vertex`]. With the moments Q and the stiffness K for λκ, for the two
//! components in the frame of an edge,
//!
//! ```text
//! ∂E/∂κ = λ Q + 2λ' (Q·κ) κ
//! ∂²E/∂κ² = λ² K + 2λ' Q·κ + u⊗κ + κ⊗u,   u = 2λ' (λ Kκ + Q) + (2λ'² κ·Kκ + 2λ'' Q·κ) κ
//! ```

use super::vertex::{Moments, VertexStiffness, VertexStrains};
use serde::{Deserialize, Serialize};

/// Measure of the bending at a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BendingStrain {
    /// Twice the tangent of half the angle: the curvature binormal.
    #[default]
    Tangent,
    /// The angle.
    Angle,
}

/// Ratio of the turning angle to the length of the curvature binormal, and its derivatives with
/// respect to the square of that length.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleRatio {
    value: f64,
    first: f64,
    second: f64,
}

impl AngleRatio {
    /// The ratio for edges with the squared cosine c of half their turning angle. With `share` 0
    /// the strain is the tangent, and the ratio is 1.
    #[inline(always)]
    pub(super) fn of(c: f64, share: f64) -> Self {
        Self {
            value: 1.0 + share * ((9.0 * c - 2.0 * c * c - 7.0) * (1.0 / 15.0)),
            first: share * (c * c * (4.0 * c - 9.0) * (1.0 / 60.0)),
            second: share * (c * c * c * (3.0 - 2.0 * c) * (1.0 / 40.0)),
        }
    }

    /// λκ.
    #[inline(always)]
    pub(super) fn turning(&self, strains: &VertexStrains) -> VertexStrains {
        let [k0, k1, k2, k3] = strains.curvature;
        let value = self.value;
        VertexStrains {
            curvature: [value * k0, value * k1, value * k2, value * k3],
            twist: strains.twist,
        }
    }

    /// Change of λκ with κ.
    pub(super) fn turning_along(&self, kappa: &[f64; 4], change: &[f64; 4]) -> [f64; 4] {
        let of_square = 2.0 * (kappa[0] * change[0] + kappa[1] * change[1]);
        std::array::from_fn(|k| self.value * change[k] + self.first * of_square * kappa[k])
    }

    /// Moments with respect to κ, from those with respect to λκ.
    #[inline(always)]
    pub(super) fn over_components(&self, moments: &Moments, kappa: &[f64; 4]) -> Moments {
        // Written out: with loops over the two edges, those over lanes do not vectorise.
        let q = &moments.bending;
        let twice = 2.0 * self.first;
        let before = twice * (q[0] * kappa[0] + q[1] * kappa[1]);
        let after = twice * (q[2] * kappa[2] + q[3] * kappa[3]);
        Moments {
            bending: [
                self.value * q[0] + before * kappa[0],
                self.value * q[1] + before * kappa[1],
                self.value * q[2] + after * kappa[2],
                self.value * q[3] + after * kappa[3],
            ],
            twisting: moments.twisting,
        }
    }
}

impl BendingStrain {
    /// 1 for the angle, 0 for the tangent.
    pub(super) fn share(self) -> f64 {
        match self {
            Self::Tangent => 0.0,
            Self::Angle => 1.0,
        }
    }

    /// Bending strain, from the components of the curvature binormal.
    pub(crate) fn of(self, strains: &VertexStrains) -> VertexStrains {
        if self == Self::Tangent {
            return *strains;
        }
        let [k0, k1, ..] = strains.curvature;
        let c = 1.0 / (1.0 + 0.25 * (k0 * k0 + k1 * k1));
        AngleRatio::of(c, self.share()).turning(strains)
    }
}

/// Second derivatives with respect to the two components of the curvature binormal in the frame of
/// an edge.
pub(super) struct PairHessian {
    pub(super) first: f64,
    pub(super) mixed: f64,
    pub(super) second: f64,
}

impl PairHessian {
    /// Computes them at the components κ, with the moments Q with respect to λκ.
    #[inline(always)]
    pub(super) fn new(
        [kappa_1, kappa_2]: [f64; 2],
        [q_1, q_2]: [f64; 2],
        stiffness: &VertexStiffness,
        ratio: &AngleRatio,
    ) -> Self {
        let [k_1, k_2] = stiffness.bending;
        let (value, twice) = (ratio.value, 2.0 * ratio.first);
        let (m_1, m_2) = (k_1 * kappa_1, k_2 * kappa_2);
        let work = q_1 * kappa_1 + q_2 * kappa_2;
        let along =
            0.5 * twice * twice * (m_1 * kappa_1 + m_2 * kappa_2) + 2.0 * ratio.second * work;
        let u_1 = twice * (value * m_1 + q_1) + along * kappa_1;
        let u_2 = twice * (value * m_2 + q_2) + along * kappa_2;
        let (square, shared) = (value * value, twice * work);
        Self {
            first: square * k_1 + shared + 2.0 * u_1 * kappa_1,
            mixed: u_1 * kappa_2 + u_2 * kappa_1,
            second: square * k_2 + shared + 2.0 * u_2 * kappa_2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::test_support::assert_close;

    #[test]
    fn the_factor_makes_the_angle_to_the_seventh_power_and_resists_folds() {
        let strain = |angle: f64| {
            let binormal = 2.0 * (0.5 * angle).tan();
            let strains = VertexStrains {
                curvature: [0.6 * binormal, 0.8 * binormal, 0.0, 0.0],
                twist: 0.0,
            };
            let [first, second, ..] = BendingStrain::Angle.of(&strains).curvature;
            assert_eq!(BendingStrain::Tangent.of(&strains), strains);
            first.hypot(second)
        };
        for angle in [0.05, 0.1, 0.2, 0.4] {
            let error = strain(angle) - angle;
            assert_close(error, angle.powi(7) / 840.0, 0.1);
        }
        assert!(strain(3.0) > 3.0 && strain(3.13) > 100.0);
    }
}
