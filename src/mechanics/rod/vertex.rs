//! Bending and twisting at one vertex: energy, gradient and Hessian in closed form.
//!
//! A vertex joins two edges e⁰ and e¹ with unit tangents t⁰, t¹, lengths l⁰, l¹ and material directors
//! m₁ʲ, m₂ʲ. Its strains are the curvature binormal seen by each edge's own frame and the twist,
//!
//! ```text
//! κb = 2 t⁰×t¹ / χ,  χ = 1 + t⁰·t¹                (Bergou et al. 2008, Eq. 1; thesis Eq. 1.3)
//! κ¹ʲ = m₂ʲ·κb,  κ²ʲ = −m₁ʲ·κb,  j = 0, 1          (Bergou et al. 2008, Eq. 2)
//! τ = θ¹ − θ⁰ + reference twist                     (thesis Eq. 1.5)
//! E = Σⱼ [EI₁(κ¹ʲ−κ̃¹ʲ)² + EI₂(κ²ʲ−κ̃²ʲ)²] / 4l̄ + GJ(τ−τ̃)² / 2l̄
//! ```
//!
//! with the Voronoi length l̄. Thesis Eq. 1.4 averages the two frames before squaring; averaging the
//! squares agrees with it to second order in the edge length and does not soften under strong twist: for
//! an isotropic, naturally straight rod the bending energy is EI|κb|²/2l̄ whatever the frames do.
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
//! (the twist: ∂τ/∂eʲ = κb/2lʲ). Frames are not free of spin: they are parallel transported in time from
//! the source tangent s of the step's start, so that the spin is dφ = dθ + c·de with
//! c = −(s×t)/((1+s·t) l). With these c the energy is one function of the unknowns during a whole step, and
//! gradient and Hessian are exact and symmetric everywhere, not only at the source: the antisymmetric
//! part of κb⊗M cancels against (∂E/∂φ) ∇c, the correction of Panetta et al. 2019.

use crate::mechanics::{Matrix3, Vector3};

/// Geometry of one edge, real or ghost, as a vertex sees it.
#[derive(Clone, Copy, Debug)]
pub struct EdgeFrame {
    /// Unit tangent t.
    pub tangent: Vector3,
    /// Length l, m.
    pub length: f64,
    /// First material director m₁.
    pub director_1: Vector3,
    /// Second material director m₂ = t × m₁.
    pub director_2: Vector3,
    /// Spin of the transported frame per change of the edge, c, 1/m.
    pub holonomy: Vector3,
}

/// Strains of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VertexStrains {
    /// κ¹⁰, κ²⁰, κ¹¹, κ²¹: the curvature binormal in the frames of the edges before and after.
    pub curvature: [f64; 4],
    /// Twist τ, rad.
    pub twist: f64,
}

/// Stiffness of a vertex: EI/2l̄ for each curvature and GJ/l̄ for the twist, N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexStiffness {
    /// EI₁/2l̄, EI₂/2l̄.
    pub bending: [f64; 2],
    /// GJ/l̄.
    pub twisting: f64,
}

/// Gradient and Hessian over (e⁰, φ⁰, e¹, φ¹).
#[derive(Clone, Copy, Debug)]
pub struct VertexDerivatives {
    /// Gradient; moments (N m) at places 3 and 7, forces (N) elsewhere.
    pub gradient: [f64; 8],
    /// Lower triangle of the Hessian, but for (∂E/∂φ)∇c, which is added once per edge.
    pub hessian: [[f64; 8]; 8],
}

impl VertexDerivatives {
    /// Drops all derivatives with respect to one of (e⁰, φ⁰, e¹, φ¹): a ghost edge is prescribed.
    pub fn forget(&mut self, entry: usize) {
        self.gradient[entry] = 0.0;
        self.hessian[entry] = [0.0; 8];
        for row in &mut self.hessian {
            row[entry] = 0.0;
        }
    }
}

/// Curvature binormal κb of two unit tangents.
#[inline(always)]
pub fn curvature_binormal(before: &Vector3, after: &Vector3) -> Vector3 {
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
pub fn energies(
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

/// First derivatives of the five strains over (e⁰, φ⁰, e¹, φ¹), holonomy included.
struct StrainGradients {
    strains: [[f64; 8]; 5],
}

impl StrainGradients {
    #[inline(always)]
    fn new(
        before: &EdgeFrame,
        after: &EdgeFrame,
        common: &Common,
        strains: &VertexStrains,
    ) -> Self {
        let mut rows = [[0.0; 8]; 5];
        let kappa = &strains.curvature;
        let directors = [
            before.director_2,
            -before.director_1,
            after.director_2,
            -after.director_1,
        ];
        // κ¹ turns into κ² and κ² into −κ¹ when the frame spins.
        let spins = [kappa[1], -kappa[0], kappa[3], -kappa[2]];
        for k in 0..4 {
            let (g0, g1) = common.natural_gradient(kappa[k], &(directors[k] * common.two_over_chi));
            let spin = [
                if k < 2 { spins[k] } else { 0.0 },
                if k < 2 { 0.0 } else { spins[k] },
            ];
            store(
                &mut rows[k],
                &(g0 + before.holonomy * spin[0]),
                spin[0],
                &(g1 + after.holonomy * spin[1]),
                spin[1],
            );
        }
        let half = common.binormal * 0.5;
        store(
            &mut rows[4],
            &(half * common.inverse_length_0 - before.holonomy),
            -1.0,
            &(half * common.inverse_length_1 + after.holonomy),
            1.0,
        );
        Self { strains: rows }
    }
}

#[inline(always)]
fn store(row: &mut [f64; 8], e0: &Vector3, phi0: f64, e1: &Vector3, phi1: f64) {
    *row = [e0.x, e0.y, e0.z, phi0, e1.x, e1.y, e1.z, phi1];
}

/// What all derivatives of a vertex share.
struct Common {
    t0: Vector3,
    t1: Vector3,
    /// t̃ = (t⁰ + t¹)/χ.
    mean_tangent: Vector3,
    binormal: Vector3,
    two_over_chi: f64,
    inverse_length_0: f64,
    inverse_length_1: f64,
}

impl Common {
    #[inline(always)]
    fn new(before: &EdgeFrame, after: &EdgeFrame) -> Self {
        let (t0, t1) = (before.tangent, after.tangent);
        let inverse_chi = 1.0 / (1.0 + t0.dot(&t1));
        Self {
            t0,
            t1,
            mean_tangent: (t0 + t1) * inverse_chi,
            binormal: t0.cross(&t1) * (2.0 * inverse_chi),
            two_over_chi: 2.0 * inverse_chi,
            inverse_length_0: 1.0 / before.length,
            inverse_length_1: 1.0 / after.length,
        }
    }

    /// g⁰ and g¹ for S and Σ.
    #[inline(always)]
    fn natural_gradient(&self, s: f64, sigma: &Vector3) -> (Vector3, Vector3) {
        let along = self.mean_tangent * s;
        (
            (self.t1.cross(sigma) - along) * self.inverse_length_0,
            (-self.t0.cross(sigma) - along) * self.inverse_length_1,
        )
    }
}

#[inline(always)]
fn outer_symmetric(a: &Vector3, b: &Vector3) -> Matrix3 {
    let product = a * b.transpose();
    product + product.transpose()
}

#[inline(always)]
fn cross_matrix(v: &Vector3) -> Matrix3 {
    v.cross_matrix()
}

/// Gradient of the energy of a vertex over (e⁰, φ⁰, e¹, φ¹).
#[inline]
pub fn gradient(
    before: &EdgeFrame,
    after: &EdgeFrame,
    strains: &VertexStrains,
    natural: &VertexStrains,
    stiffness: &VertexStiffness,
) -> [f64; 8] {
    let common = Common::new(before, after);
    let moments = Moments::new(strains, natural, stiffness);
    let (m0, m1) = moments.directors(before, after);
    let s = common.binormal.dot(&(m0 + m1));
    let (g0, g1) = common.natural_gradient(s, &((m0 + m1) * common.two_over_chi));
    let half = common.binormal * (0.5 * moments.twisting);
    let phi0 = common.binormal.dot(&common.t0.cross(&m0)) - moments.twisting;
    let phi1 = common.binormal.dot(&common.t1.cross(&m1)) + moments.twisting;
    let mut gradient = [0.0; 8];
    store(
        &mut gradient,
        &(g0 + half * common.inverse_length_0 + before.holonomy * phi0),
        phi0,
        &(g1 + half * common.inverse_length_1 + after.holonomy * phi1),
        phi1,
    );
    gradient
}

/// Derivatives of the energy with respect to the strains.
struct Moments {
    bending: [f64; 4],
    twisting: f64,
}

impl Moments {
    #[inline(always)]
    fn new(strains: &VertexStrains, natural: &VertexStrains, stiffness: &VertexStiffness) -> Self {
        let mut bending = [0.0; 4];
        for k in 0..4 {
            bending[k] = stiffness.bending[k % 2] * (strains.curvature[k] - natural.curvature[k]);
        }
        Self {
            bending,
            twisting: stiffness.twisting * (strains.twist - natural.twist),
        }
    }

    /// M⁰ and M¹: the directors weighted with the bending moments.
    #[inline(always)]
    fn directors(&self, before: &EdgeFrame, after: &EdgeFrame) -> (Vector3, Vector3) {
        (
            before.director_2 * self.bending[0] - before.director_1 * self.bending[1],
            after.director_2 * self.bending[2] - after.director_1 * self.bending[3],
        )
    }
}

/// Gradient and Hessian of the energy of a vertex over (e⁰, φ⁰, e¹, φ¹).
#[inline]
pub fn derivatives(
    before: &EdgeFrame,
    after: &EdgeFrame,
    strains: &VertexStrains,
    natural: &VertexStrains,
    stiffness: &VertexStiffness,
) -> VertexDerivatives {
    let common = Common::new(before, after);
    let moments = Moments::new(strains, natural, stiffness);
    let first = StrainGradients::new(before, after, &common, strains);

    let weights = [
        stiffness.bending[0],
        stiffness.bending[1],
        stiffness.bending[0],
        stiffness.bending[1],
        stiffness.twisting,
    ];
    let slopes = [
        moments.bending[0],
        moments.bending[1],
        moments.bending[2],
        moments.bending[3],
        moments.twisting,
    ];
    let mut gradient = [0.0; 8];
    let mut hessian = [[0.0; 8]; 8];
    for k in 0..5 {
        let row = &first.strains[k];
        for i in 0..8 {
            gradient[i] += slopes[k] * row[i];
            let weighted = weights[k] * row[i];
            for j in 0..=i {
                hessian[i][j] += weighted * row[j];
            }
        }
    }
    let second = SecondDerivatives::new(before, after, &common, &moments);
    second.add_to(&mut hessian);
    VertexDerivatives { gradient, hessian }
}

/// Σ (∂E/∂strain) ∂²strain, by blocks.
struct SecondDerivatives {
    e0e0: Matrix3,
    e1e0: Matrix3,
    e1e1: Matrix3,
    e0phi0: Vector3,
    e0phi1: Vector3,
    e1phi0: Vector3,
    e1phi1: Vector3,
    phi0phi0: f64,
    phi1phi1: f64,
}

impl SecondDerivatives {
    #[inline(always)]
    fn new(before: &EdgeFrame, after: &EdgeFrame, common: &Common, moments: &Moments) -> Self {
        let (m0, m1) = moments.directors(before, after);
        let (t0, t1, mean) = (&common.t0, &common.t1, &common.mean_tangent);
        let binormal = &common.binormal;
        let (l0, l1) = (common.inverse_length_0, common.inverse_length_1);
        let inverse_chi = 0.5 * common.two_over_chi;
        let (c0, c1) = (&before.holonomy, &after.holonomy);

        let s = binormal.dot(&(m0 + m1));
        let sigma = (m0 + m1) * common.two_over_chi;
        let (g0, g1) = common.natural_gradient(s, &sigma);
        let s_chi = s * inverse_chi;

        // Spins: ∂S/∂φʲ and its gradients, from Nʲ = tʲ × Mʲ in the place of Mʲ.
        let (n0, n1) = (t0.cross(&m0), t1.cross(&m1));
        let (s_phi0, s_phi1) = (binormal.dot(&n0), binormal.dot(&n1));
        let (g0_phi0, g1_phi0) = common.natural_gradient(s_phi0, &(n0 * common.two_over_chi));
        let (g0_phi1, g1_phi1) = common.natural_gradient(s_phi1, &(n1 * common.two_over_chi));
        let phi0phi0 = -binormal.dot(&m0);
        let phi1phi1 = -binormal.dot(&m1);

        let identity = Matrix3::identity();
        let twist = 0.5 * moments.twisting;
        let mut e0e0 = outer_symmetric(mean, &g0) * -l0
            - (identity - t0 * t0.transpose()) * (s_chi * l0 * l0)
            + outer_symmetric(binormal, &(m0 - (mean + t0) * twist)) * (0.5 * l0 * l0);
        let mut e1e1 = outer_symmetric(mean, &g1) * -l1
            - (identity - t1 * t1.transpose()) * (s_chi * l1 * l1)
            + outer_symmetric(binormal, &(m1 - (mean + t1) * twist)) * (0.5 * l1 * l1);
        let mut e0e1 = mean * g1.transpose() * -l0
            - g0 * mean.transpose() * l1
            - ((identity + t0 * t1.transpose()) * s_chi
                + cross_matrix(&(sigma - t0 * (twist * common.two_over_chi)))
                + binormal * mean.transpose() * twist)
                * (l0 * l1);
        e0e0 += outer_symmetric(&g0_phi0, c0) + c0 * c0.transpose() * phi0phi0;
        e1e1 += outer_symmetric(&g1_phi1, c1) + c1 * c1.transpose() * phi1phi1;
        e0e1 += g0_phi1 * c1.transpose() + c0 * g1_phi0.transpose();
        Self {
            e0e0,
            e1e0: e0e1.transpose(),
            e1e1,
            e0phi0: g0_phi0 + c0 * phi0phi0,
            e0phi1: g0_phi1,
            e1phi0: g1_phi0,
            e1phi1: g1_phi1 + c1 * phi1phi1,
            phi0phi0,
            phi1phi1,
        }
    }

    #[inline(always)]
    fn add_to(&self, hessian: &mut [[f64; 8]; 8]) {
        for i in 0..3 {
            for j in 0..=i {
                hessian[i][j] += self.e0e0[(i, j)];
                hessian[4 + i][4 + j] += self.e1e1[(i, j)];
            }
            for j in 0..3 {
                hessian[4 + i][j] += self.e1e0[(i, j)];
            }
            hessian[3][i] += self.e0phi0[i];
            hessian[7][i] += self.e0phi1[i];
            hessian[4 + i][3] += self.e1phi0[i];
            hessian[7][4 + i] += self.e1phi1[i];
        }
        hessian[3][3] += self.phi0phi0;
        hessian[7][7] += self.phi1phi1;
    }
}

#[cfg(test)]
#[path = "vertex_tests.rs"]
mod tests;
