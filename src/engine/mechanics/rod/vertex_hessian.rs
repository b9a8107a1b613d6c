//! The Hessian of the bending and twisting energy of a vertex; formulas and names as in [`super::vertex`].
//!
//! With the moments Q = ∂E/∂(strain) and the stiffness K it is Σ K ∇(strain)⊗∇(strain) + Σ Q ∇∇(strain).

use super::turning_angle::{AngleRatio, PairHessian};
use super::vertex::{Common, EdgeFrame, Moments, VertexStiffness, VertexStrains};
use crate::mechanics::{Matrix3, Vector3};

/// Blocks of the lower triangle of the Hessian with respect to (e⁰, φ⁰, e¹, φ¹), except (∂E/∂φ)∇c,
/// which is added once per edge. The block of eⁱ and φʲ is a vector with respect to eⁱ on either
/// side of the diagonal.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // the names are the rows and columns
pub(crate) struct VertexHessian {
    pub e0e0: Matrix3,
    pub e1e0: Matrix3,
    pub e1e1: Matrix3,
    pub e0phi0: Vector3,
    pub e0phi1: Vector3,
    pub e1phi0: Vector3,
    pub e1phi1: Vector3,
    pub phi0phi0: f64,
    pub phi1phi0: f64,
    pub phi1phi1: f64,
}

/// Hessian of the energy of a vertex.
#[inline(always)]
pub(crate) fn hessian(
    before: &EdgeFrame,
    after: &EdgeFrame,
    strains: &VertexStrains,
    natural: &VertexStrains,
    stiffness: &VertexStiffness,
) -> VertexHessian {
    let common = Common::new(before, after);
    let moments = Moments::new(strains, natural, stiffness);
    let [kappa_10, kappa_20, kappa_11, kappa_21] = strains.curvature;
    let [bending_1, bending_2] = stiffness.bending;
    let mut hessian = strain_curvature(before, after, &common, &moments);
    let [one, other] = slopes_before(before, &common, [kappa_10, kappa_20]);
    hessian.add_square_before(bending_1, &one);
    hessian.add_square_before(bending_2, &other);
    let [one, other] = slopes_after(after, &common, [kappa_11, kappa_21]);
    hessian.add_square_after(bending_1, &one);
    hessian.add_square_after(bending_2, &other);
    hessian.add_twist(stiffness.twisting, before, after, &common);
    hessian
}

/// Hessian of the energy of a vertex that bends by the turning angle with weight `share`
/// ([`super::turning_angle`]).
#[inline(always)]
pub(crate) fn hessian_of_angle(
    before: &EdgeFrame,
    after: &EdgeFrame,
    kappa: &[f64; 4],
    moments: &Moments,
    ratio: &AngleRatio,
    stiffness: &VertexStiffness,
) -> VertexHessian {
    let common = Common::new(before, after);
    let over_components = ratio.over_components(moments, kappa);
    let mut hessian = strain_curvature(before, after, &common, &over_components);
    let q = &moments.bending;
    let pair = PairHessian::new([kappa[0], kappa[1]], [q[0], q[1]], stiffness, ratio);
    let [one, other] = slopes_before(before, &common, [kappa[0], kappa[1]]);
    hessian.add_outer_before(&one.combined(pair.first, &other, pair.mixed), &one);
    hessian.add_outer_before(&one.combined(pair.mixed, &other, pair.second), &other);
    let pair = PairHessian::new([kappa[2], kappa[3]], [q[2], q[3]], stiffness, ratio);
    let [one, other] = slopes_after(after, &common, [kappa[2], kappa[3]]);
    hessian.add_outer_after(&one.combined(pair.first, &other, pair.mixed), &one);
    hessian.add_outer_after(&one.combined(pair.mixed, &other, pair.second), &other);
    hessian.add_twist(stiffness.twisting, before, after, &common);
    hessian
}

/// Gradient of a strain in the frame of one edge, with respect to e⁰, e¹ and the angle of that
/// edge.
struct SeenGradient {
    e0: Vector3,
    e1: Vector3,
    phi: f64,
}

impl SeenGradient {
    /// The sum of `own` times this gradient and `factor` times another.
    #[inline(always)]
    fn combined(&self, own: f64, other: &Self, factor: f64) -> Self {
        Self {
            e0: self.e0 * own + other.e0 * factor,
            e1: self.e1 * own + other.e1 * factor,
            phi: self.phi * own + other.phi * factor,
        }
    }
}

/// Gradients of the two components of the curvature binormal in the frame of the edge before. When the frame spins, κ¹ turns
/// into κ² and κ² into −κ¹.
#[inline(always)]
fn slopes_before(
    before: &EdgeFrame,
    common: &Common,
    [kappa_1, kappa_2]: [f64; 2],
) -> [SeenGradient; 2] {
    let slope = |kappa: f64, director: &Vector3, phi: f64| {
        let (e0, e1) = common.natural_gradient(kappa, &(director * common.two_over_chi));
        let e0 = e0 + before.holonomy * phi;
        SeenGradient { e0, e1, phi }
    };
    [
        slope(kappa_1, &before.director_2, kappa_2),
        slope(kappa_2, &-before.director_1, -kappa_1),
    ]
}

/// Gradients of the two components in the frame of the edge after.
#[inline(always)]
fn slopes_after(
    after: &EdgeFrame,
    common: &Common,
    [kappa_1, kappa_2]: [f64; 2],
) -> [SeenGradient; 2] {
    let slope = |kappa: f64, director: &Vector3, phi: f64| {
        let (e0, e1) = common.natural_gradient(kappa, &(director * common.two_over_chi));
        let e1 = e1 + after.holonomy * phi;
        SeenGradient { e0, e1, phi }
    };
    [
        slope(kappa_1, &after.director_2, kappa_2),
        slope(kappa_2, &-after.director_1, -kappa_1),
    ]
}

impl VertexHessian {
    /// Adds `weight` g⊗g of a strain in the frame of the edge before.
    #[inline(always)]
    fn add_square_before(&mut self, weight: f64, g: &SeenGradient) {
        let phi = g.phi * weight;
        self.add_square_of_edges(weight, g);
        self.e0phi0 += g.e0 * phi;
        self.e1phi0 += g.e1 * phi;
        self.phi0phi0 += g.phi * phi;
    }

    /// Adds `weight` g⊗g of a strain in the frame of the edge after.
    #[inline(always)]
    fn add_square_after(&mut self, weight: f64, g: &SeenGradient) {
        let phi = g.phi * weight;
        self.add_square_of_edges(weight, g);
        self.e0phi1 += g.e0 * phi;
        self.e1phi1 += g.e1 * phi;
        self.phi1phi1 += g.phi * phi;
    }

    /// Adds f⊗g of strains in the frame of the edge before; with other terms the sum is symmetric.
    #[inline(always)]
    fn add_outer_before(&mut self, f: &SeenGradient, g: &SeenGradient) {
        self.add_outer_of_edges(f, g);
        self.e0phi0 += f.e0 * g.phi;
        self.e1phi0 += f.e1 * g.phi;
        self.phi0phi0 += f.phi * g.phi;
    }

    /// Adds f⊗g of strains in the frame of the edge after.
    #[inline(always)]
    fn add_outer_after(&mut self, f: &SeenGradient, g: &SeenGradient) {
        self.add_outer_of_edges(f, g);
        self.e0phi1 += f.e0 * g.phi;
        self.e1phi1 += f.e1 * g.phi;
        self.phi1phi1 += f.phi * g.phi;
    }

    #[inline(always)]
    fn add_outer_of_edges(&mut self, f: &SeenGradient, g: &SeenGradient) {
        self.e0e0 += outer(&f.e0, &g.e0);
        self.e1e0 += outer(&f.e1, &g.e0);
        self.e1e1 += outer(&f.e1, &g.e1);
    }

    #[inline(always)]
    fn add_square_of_edges(&mut self, weight: f64, g: &SeenGradient) {
        let (e0, e1) = (g.e0 * weight, g.e1 * weight);
        self.e0e0 += outer(&e0, &g.e0);
        self.e1e0 += outer(&e1, &g.e0);
        self.e1e1 += outer(&e1, &g.e1);
    }

    /// Adds `weight` ∇τ⊗∇τ.
    #[inline(always)]
    fn add_twist(&mut self, weight: f64, before: &EdgeFrame, after: &EdgeFrame, common: &Common) {
        let half = common.binormal * 0.5;
        let e0 = half * common.inverse_length_0 - before.holonomy;
        let e1 = half * common.inverse_length_1 + after.holonomy;
        let (f0, f1) = (e0 * weight, e1 * weight);
        self.e0e0 += outer(&f0, &e0);
        self.e1e0 += outer(&f1, &e0);
        self.e1e1 += outer(&f1, &e1);
        self.e0phi0 -= f0;
        self.e0phi1 += f0;
        self.e1phi0 -= f1;
        self.e1phi1 += f1;
        self.phi0phi0 += weight;
        self.phi1phi0 -= weight;
        self.phi1phi1 += weight;
    }
}

/// Σ Q ∇∇(strain).
#[inline(always)]
fn strain_curvature(
    before: &EdgeFrame,
    after: &EdgeFrame,
    common: &Common,
    moments: &Moments,
) -> VertexHessian {
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

    // Spins: ∂S/∂φʲ and its gradients, from Nʲ = tʲ × Mʲ instead of Mʲ.
    let (n0, n1) = (t0.cross(&m0), t1.cross(&m1));
    let (s_phi0, s_phi1) = (binormal.dot(&n0), binormal.dot(&n1));
    let (g0_phi0, g1_phi0) = common.natural_gradient(s_phi0, &(n0 * common.two_over_chi));
    let (g0_phi1, g1_phi1) = common.natural_gradient(s_phi1, &(n1 * common.two_over_chi));
    let phi0phi0 = -binormal.dot(&m0);
    let phi1phi1 = -binormal.dot(&m1);

    let identity = Matrix3::identity();
    let twist = 0.5 * moments.twisting;
    let mut e0e0 = outer_symmetric(mean, &g0) * -l0
        - (identity - outer(t0, t0)) * (s_chi * l0 * l0)
        + outer_symmetric(binormal, &(m0 - (mean + t0) * twist)) * (0.5 * l0 * l0);
    let mut e1e1 = outer_symmetric(mean, &g1) * -l1
        - (identity - outer(t1, t1)) * (s_chi * l1 * l1)
        + outer_symmetric(binormal, &(m1 - (mean + t1) * twist)) * (0.5 * l1 * l1);
    let mut e0e1 = outer(mean, &g1) * -l0
        - outer(&g0, mean) * l1
        - ((identity + outer(t0, t1)) * s_chi
            + (sigma - t0 * (twist * common.two_over_chi)).cross_matrix()
            + outer(binormal, mean) * twist)
            * (l0 * l1);
    e0e0 += outer_symmetric(&g0_phi0, c0) + outer(c0, c0) * phi0phi0;
    e1e1 += outer_symmetric(&g1_phi1, c1) + outer(c1, c1) * phi1phi1;
    e0e1 += outer(&g0_phi1, c1) + outer(c0, &g1_phi0);
    VertexHessian {
        e0e0,
        e1e0: e0e1.transpose(),
        e1e1,
        e0phi0: g0_phi0 + c0 * phi0phi0,
        e0phi1: g0_phi1,
        e1phi0: g1_phi0,
        e1phi1: g1_phi1 + c1 * phi1phi1,
        phi0phi0,
        phi1phi0: 0.0,
        phi1phi1,
    }
}

/// a⊗b.
#[inline(always)]
fn outer(a: &Vector3, b: &Vector3) -> Matrix3 {
    a * b.transpose()
}

/// a⊗b + b⊗a.
#[inline(always)]
fn outer_symmetric(a: &Vector3, b: &Vector3) -> Matrix3 {
    outer(a, b) + outer(b, a)
}
