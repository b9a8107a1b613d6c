//! Bending and twisting at one vertex: energy, gradient and Hessian in closed form.
//!
//! A vertex joins two edges e⁰ and e¹ with unit tangents t⁰, t¹, lengths l⁰, l¹ and material
//! directors m₁ʲ, m₂ʲ. The strains of the vertex are the curvature binormal in the frame of each
//! edge, and the twist,
//!
//! ```text
//! κb = 2 t⁰×t¹ / χ,  χ = 1 + t⁰·t¹                (Bergou et al. 2008, Eq. 1; thesis Eq. 1.3)
//! κ¹ʲ = m₂ʲ·κb,  κ²ʲ = −m₁ʲ·κb,  j = 0, 1          (Bergou et al. 2008, Eq. 2)
//! τ = θ¹ − θ⁰ + reference twist                     (thesis Eq. 1.5)
//! E = Σⱼ [EI₂(κ¹ʲ−κ̃¹ʲ)² + EI₁(κ²ʲ−κ̃²ʲ)²] / 4l̄ + GJ(τ−τ̃)² / 2l̄
//! ```
//!
//! with the Voronoi length l̄. The superscript gives the director towards which the rod bends: κ¹
//! is the curvature towards m₁, that is, about m₂, and κ² that about −m₁. Second moments and
//! natural curvatures of cross-sections refer to the axes *about* which they bend;
//! `VertexStrains::about_directors` and [`VertexStiffness::about_directors`] convert.
//!
//! ```text
//!          m₂ ↑                  I₁ = ∫ y₂² dA = w h³/12 resists bending about m₁ (curvature κb·m₁),
//!        ┌────┼────┐ ┐           I₂ = ∫ y₁² dA = h w³/12 resists bending about m₂ (curvature κb·m₂).
//!        │    ⊙────┼─│─→ m₁
//!        └─────────┘ ┘ h         ⊙: the tangent t = m₁ × m₂ points at the reader
//!        └──── w ──┘
//! ```
//!
//! Thesis Eq. 1.4 averages the two frames before squaring; averaging the
//! squares agrees with it to second order in the edge length and does not soften under strong twist: for
//! an isotropic, naturally straight rod the bending energy is EI|κb|²/2l̄ for any frames.
//!
//! Naturally straight rods may bend by the angle φ instead of |κb| = 2 tan(φ/2):
//! [`super::BendingStrain`].
//!
//! **Derivatives.** With t̃ = (t⁰+t¹)/χ, any S = κb·(M⁰+M¹), where Mʲ is a fixed combination of the
//! directors of edge j, and Σ = 2(M⁰+M¹)/χ, Nʲ = tʲ×Mʲ, has under a change of the edges that carries the
//! frames along without spin
//!
//! ```text
//! ∂S/∂e⁰ = g⁰ = (−S t̃ + t¹×Σ)/l⁰,   ∂S/∂e¹ = g¹ = (−S t̃ − t⁰×Σ)/l¹
//! ∂g⁰/∂e⁰ = −(t̃⊗g⁰ + g⁰⊗t̃)/l⁰ − S(1 − t⁰⊗t⁰)/(χ l⁰²) + κb⊗M⁰/l⁰²
//! ∂g⁰/∂e¹ = −t̃⊗g¹/l⁰ − g⁰⊗t̃/l¹ − [(S/χ)(1 + t⁰⊗t¹) + Σ×]/(l⁰l¹)
//! ∂S/∂φʲ = κb·Nʲ,   ∂²S/∂φʲ² = −κb·Mʲ
//! ```
//!
//! (the twist: ∂τ/∂eʲ = κb/2lʲ). Frames are not free of spin: they are parallel transported in
//! time from the source tangent s at the start of the step. So the spin is dφ = dθ + c·de with c =
//! −(s×t)/((1+s·t) l). With these c the energy is a single function of the unknowns during a whole
//! step, and gradient and Hessian are exact and symmetric everywhere, not only at the source: the
//! antisymmetric part of κb⊗M cancels against (∂E/∂φ) ∇c, the correction of Panetta et al. 2019.

use crate::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// Geometry of one edge, real or ghost, for a vertex.
#[derive(Clone, Copy, Debug)]
pub struct EdgeFrame {
    /// Unit tangent t.
    pub tangent: Vector3,
    /// Length l, m; infinite for a ghost edge, whose direction is prescribed.
    pub length: f64,
    /// Inverse of the length of the edge, 1/m.
    pub inverse_length: f64,
    /// First material director m₁.
    pub director_1: Vector3,
    /// Second material director m₂ = t × m₁.
    pub director_2: Vector3,
    /// Spin of the transported frame per change of the edge, c, 1/m.
    pub holonomy: Vector3,
}

/// Strains of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VertexStrains {
    /// κ¹⁰, κ²⁰, κ¹¹, κ²¹: the curvature binormal in the frames of the edges before and after.
    pub curvature: [f64; 4],
    /// Twist τ, rad.
    pub twist: f64,
}

impl VertexStrains {
    /// Strains of a curvature whose binormal has the components `curvature` along m₁ and m₂, in the frames of both
    /// edges, and a `twist` (rad).
    pub(crate) fn about_directors(curvature: [f64; 2], twist: f64) -> Self {
        let [about_1, about_2] = curvature;
        Self {
            curvature: [about_2, -about_1, about_2, -about_1],
            twist,
        }
    }
}

/// Stiffness of a vertex: EI/2l̄ for each curvature and GJ/l̄ for the twist, N m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VertexStiffness {
    /// Stiffnesses for κ¹, EI₂/2l̄, and for κ², EI₁/2l̄.
    pub bending: [f64; 2],
    /// GJ/l̄.
    pub twisting: f64,
}

impl VertexStiffness {
    /// Stiffness of a vertex of the Voronoi length `voronoi` (m), in a rod with the bending stiffnesses `bending` about
    /// m₁ and m₂, EI₁ and EI₂, and the twisting stiffness `twisting`, GJ, N m².
    pub fn about_directors(bending: [f64; 2], twisting: f64, voronoi: f64) -> Self {
        let [about_1, about_2] = bending;
        Self {
            bending: [about_2, about_1].map(|stiffness| 0.5 * stiffness / voronoi),
            twisting: twisting / voronoi,
        }
    }

    /// Every stiffness, multiplied by a factor.
    pub(crate) fn times(&self, factor: f64) -> Self {
        Self {
            bending: self.bending.map(|bending| factor * bending),
            twisting: factor * self.twisting,
        }
    }
}

/// Gradient with respect to (e⁰, φ⁰, e¹, φ¹): forces, N, and moments, N m. Also the gradient of a
/// single strain.
#[derive(Clone, Copy, Debug)]
pub struct VertexGradient {
    /// Over e⁰.
    pub e0: Vector3,
    /// Over φ⁰.
    pub phi0: f64,
    /// Over e¹.
    pub e1: Vector3,
    /// Over φ¹.
    pub phi1: f64,
}

/// Curvature binormal κb of two unit tangents.
#[inline(always)]
pub(crate) fn curvature_binormal(before: &Vector3, after: &Vector3) -> Vector3 {
    before.cross(after) * (2.0 / (1.0 + before.dot(after)))
}

/// Curvature strains of two framed edges.
#[inline(always)]
pub fn curvatures(before: &EdgeFrame, after: &EdgeFrame) -> [f64; 4] {
    let binormal = curvature_binormal(&before.tangent, &after.tangent);
    [
        before.director_2.dot(&binormal),
        -before.director_1.dot(&binormal),
        after.director_2.dot(&binormal),
        -after.director_1.dot(&binormal),
    ]
}

/// Bending energy and twisting energy of a vertex, J.
#[inline(always)]
pub(crate) fn energies(
    strains: &VertexStrains,
    natural: &VertexStrains,
    stiffness: &VertexStiffness,
) -> (f64, f64) {
    let mut bending = 0.0;
    for k in 0..4 {
        let difference = strains.curvature[k] - natural.curvature[k];
        bending += 0.5 * stiffness.bending[k % 2] * difference * difference;
    }
    let difference = strains.twist - natural.twist;
    (bending, 0.5 * stiffness.twisting * difference * difference)
}

/// Common terms of all derivatives of a vertex.
pub(super) struct Common {
    pub(super) t0: Vector3,
    pub(super) t1: Vector3,
    /// t̃ = (t⁰ + t¹)/χ.
    pub(super) mean_tangent: Vector3,
    pub(super) binormal: Vector3,
    pub(super) two_over_chi: f64,
    pub(super) inverse_length_0: f64,
    pub(super) inverse_length_1: f64,
}

impl Common {
    #[inline(always)]
    pub(super) fn new(before: &EdgeFrame, after: &EdgeFrame) -> Self {
        let (t0, t1) = (before.tangent, after.tangent);
        let inverse_chi = 1.0 / (1.0 + t0.dot(&t1));
        Self {
            t0,
            t1,
            mean_tangent: (t0 + t1) * inverse_chi,
            binormal: t0.cross(&t1) * (2.0 * inverse_chi),
            two_over_chi: 2.0 * inverse_chi,
            inverse_length_0: before.inverse_length,
            inverse_length_1: after.inverse_length,
        }
    }

    /// g⁰ and g¹ for S and Σ.
    #[inline(always)]
    pub(super) fn natural_gradient(&self, s: f64, sigma: &Vector3) -> (Vector3, Vector3) {
        let along = self.mean_tangent * s;
        (
            (self.t1.cross(sigma) - along) * self.inverse_length_0,
            (-self.t0.cross(sigma) - along) * self.inverse_length_1,
        )
    }
}

/// Gradient of the energy of a vertex.
#[inline(always)]
pub fn gradient(
    before: &EdgeFrame,
    after: &EdgeFrame,
    strains: &VertexStrains,
    natural: &VertexStrains,
    stiffness: &VertexStiffness,
) -> VertexGradient {
    Moments::new(strains, natural, stiffness).gradient(before, after)
}

/// Derivatives of an energy with respect to the strains, N m.
pub(super) struct Moments {
    pub(super) bending: [f64; 4],
    pub(super) twisting: f64,
}

impl Moments {
    #[inline(always)]
    pub(super) fn new(
        strains: &VertexStrains,
        natural: &VertexStrains,
        stiffness: &VertexStiffness,
    ) -> Self {
        let mut bending = [0.0; 4];
        for k in 0..4 {
            bending[k] = stiffness.bending[k % 2] * (strains.curvature[k] - natural.curvature[k]);
        }
        Self {
            bending,
            twisting: stiffness.twisting * (strains.twist - natural.twist),
        }
    }

    /// Gradient of an energy with these derivatives.
    #[inline(always)]
    pub(super) fn gradient(&self, before: &EdgeFrame, after: &EdgeFrame) -> VertexGradient {
        let common = Common::new(before, after);
        let (m0, m1) = self.directors(before, after);
        let s = common.binormal.dot(&(m0 + m1));
        let (g0, g1) = common.natural_gradient(s, &((m0 + m1) * common.two_over_chi));
        let half = common.binormal * (0.5 * self.twisting);
        let phi0 = common.binormal.dot(&common.t0.cross(&m0)) - self.twisting;
        let phi1 = common.binormal.dot(&common.t1.cross(&m1)) + self.twisting;
        VertexGradient {
            e0: g0 + half * common.inverse_length_0 + before.holonomy * phi0,
            phi0,
            e1: g1 + half * common.inverse_length_1 + after.holonomy * phi1,
            phi1,
        }
    }

    /// M⁰ and M¹: the directors weighted with the bending moments.
    #[inline(always)]
    pub(super) fn directors(&self, before: &EdgeFrame, after: &EdgeFrame) -> (Vector3, Vector3) {
        (
            before.director_2 * self.bending[0] - before.director_1 * self.bending[1],
            after.director_2 * self.bending[2] - after.director_1 * self.bending[3],
        )
    }
}

#[cfg(test)]
#[path = "vertex_tests.rs"]
mod tests;
