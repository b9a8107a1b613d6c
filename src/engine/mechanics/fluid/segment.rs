//! The flow of a straight segment that carries a linear force density, in closed form.
//!
//! A point force f on the fluid, spread over a blob of size ε, moves the fluid at distance r by
//! (thesis Eq. 2.20; Cortez 2018, Eq. 3)
//!
//! 8πη u = (1/R + ε²/R³) f + (f·r) r / R³,  R² = |r|² + ε².
//!
//! A segment from `start` to `end` with force per length f(s) = f₁ (1 − s/L) + f₂ s/L then moves it by
//! (Eq. 2.21) 8πη u = A₁ f₁ + A₂ f₂. This file evaluates A₁ and A₂ exactly.
//!
//! # Derivation
//!
//! Let t be the unit tangent, a = (x − start)·t the coordinate of the foot of the evaluation point, and
//! p = x − start − a t its offset, normal to t. With z = s − a the vector from the segment to x is
//! r = p − z t, so R² = ρ² + z² with ρ² = |p|² + ε² ≥ ε², and z runs from z₀ = −a to z₁ = L − a. The
//! integrals needed, I_k = ∫ zᵏ/R dz and J_k = ∫ zᵏ/R³ dz, all follow from R₀, R₁ and S = R₀ + R₁:
//!
//! | integral | closed form |
//! |---|---|
//! | I₀ | ln((S + L)/(S − L)) |
//! | I₁ | R₁ − R₀ = L (z₀ + z₁)/S |
//! | J₀ | (z₁/R₁ − z₀/R₀)/ρ² = 2 L S/(R₀ R₁ (S² − L²)) |
//! | J₁ | 1/R₀ − 1/R₁ = L (z₀ + z₁)/(S R₀ R₁) |
//! | J₂ | I₀ − ρ² J₀ |
//! | J₃ | I₁ − ρ² J₁ |
//!
//! The forms on the right contain no difference of nearly equal numbers, except S − L if x is
//! beside the segment (z₀ < 0 < z₁). In this case, with q = R + |z|, S + L = q₀ + q₁ and S − L =
//! ρ²/q₀ + ρ²/q₁ = ρ² (S + L)/(q₀ q₁).
//!
//! The moments of the kernel are then M_k = (I_k + ε² J_k) 1 + J_k p pᵀ − J_{k+1} (p tᵀ + t pᵀ) +
//! J_{k+2} t tᵀ, and A₂ = (M₁ + a M₀)/L, A₁ = M₀ − A₂. They equal Eqs. 2.24–2.26 of the thesis,
//! whose recursions T_{k,l} suffer from cancellation, unlike this form. The r_α of the thesis runs
//! from the segment to x, so that its e must be read as x_i − x_{i+1}.

use super::logarithm::logarithm_of_ratio;
use crate::mechanics::{Matrix3, Vector3};

/// Upper triangle xx, xy, xz, yy, yz, zz of a symmetric 3×3 matrix.
pub(super) type Symmetric = [f64; 6];

/// The matrices A₁ and A₂ of a segment from `start` to `end` (m) at the point `x`, with
/// 8πη u(x) = A₁ f₁ + A₂ f₂ for the force densities f₁, f₂ (N/m) on the fluid at `start` and `end`.
///
/// `regularization` is ε, m. The relative error is a few rounding errors times 1 + |x − start|/L,
/// also on the segment's axis, at its nodes and for ε much smaller or larger than L. A segment without
/// length gives zero.
pub fn segment_integral(
    x: &Vector3,
    start: &Vector3,
    end: &Vector3,
    regularization: f64,
) -> [Matrix3; 2] {
    let segment = Segment::new(start, end, regularization * regularization);
    segment.integral((*x).into()).map(|a| full(&a))
}

/// The 3×3 matrix of an upper triangle.
pub(super) fn full(a: &Symmetric) -> Matrix3 {
    Matrix3::new(a[0], a[1], a[2], a[1], a[3], a[4], a[2], a[4], a[5])
}

/// A segment in the form that the kernel needs.
pub(super) struct Segment {
    /// First node, m.
    pub start: [f64; 3],
    /// Unit tangent.
    pub tangent: [f64; 3],
    /// Length L, m.
    pub length: f64,
    /// 1/L, or zero if L is zero, in which case A₁ and A₂ vanish.
    pub inverse_length: f64,
    /// ε², m².
    pub regularization_squared: f64,
}

impl Segment {
    /// The segment from `start` to `end`, m; it may have no length.
    pub(crate) fn new(start: &Vector3, end: &Vector3, regularization_squared: f64) -> Self {
        let edge = end - start;
        let length = edge.norm();
        let inverse_length = if length > 0.0 { 1.0 / length } else { 0.0 };
        Self {
            start: (*start).into(),
            tangent: (edge * inverse_length).into(),
            length,
            inverse_length,
            regularization_squared,
        }
    }

    /// A₁ and A₂ at `x`.
    ///
    /// This function and its parts are free of branches, so that they vectorise when called in
    /// loops over lanes. Every `mul_add` is written out so that the results have the same bytes on
    /// every machine.
    #[inline(always)]
    pub(crate) fn integral(&self, x: [f64; 3]) -> [Symmetric; 2] {
        let offset = self.offset(x);
        let [first, second] = self.moments(&offset);
        [
            combine(&first, &offset.p, &self.tangent),
            combine(&second, &offset.p, &self.tangent),
        ]
    }

    /// Position of `x`.
    #[inline(always)]
    pub(crate) fn offset(&self, x: [f64; 3]) -> Offset {
        let t = self.tangent;
        let r = [
            x[0] - self.start[0],
            x[1] - self.start[1],
            x[2] - self.start[2],
        ];
        let a = r[2].mul_add(t[2], r[1].mul_add(t[1], r[0] * t[0]));
        let p = [
            (-a).mul_add(t[0], r[0]),
            (-a).mul_add(t[1], r[1]),
            (-a).mul_add(t[2], r[2]),
        ];
        let epsilon2 = self.regularization_squared;
        let rho2 = p[2].mul_add(p[2], p[1].mul_add(p[1], p[0].mul_add(p[0], epsilon2)));
        let z1 = self.length - a;
        Offset {
            a,
            p,
            rho2,
            r0: a.mul_add(a, rho2).sqrt(),
            r1: z1.mul_add(z1, rho2).sqrt(),
        }
    }

    /// Coefficients of A₁ and A₂ for [`combine`].
    #[inline(always)]
    pub(crate) fn moments(&self, offset: &Offset) -> [[f64; 4]; 2] {
        self.weigh(offset, &self.integrals(offset))
    }

    /// The integrals of the table above.
    #[inline(always)]
    pub(crate) fn integrals(&self, offset: &Offset) -> Integrals {
        let &Offset {
            a, rho2, r0, r1, ..
        } = offset;
        let length = self.length;
        let z0 = -a;
        let z1 = length - a;
        let sum = r0 + r1;
        let beside = (z0 < 0.0) & (z1 > 0.0);
        let q = (r0 - z0) * (r1 + z1);
        // (S + L)/(S − L) = numerator/denominator and S² − L² = product/cofactor.
        let longer = sum + length;
        let numerator = if beside { q } else { longer };
        let denominator = if beside { rho2 } else { sum - length };
        let product = if beside { longer * longer } else { longer } * denominator;
        let cofactor = if beside { q } else { 1.0 };
        let difference = if beside { q - rho2 } else { 2.0 * length };
        let i0 = logarithm_of_ratio(numerator, denominator, difference);

        let r01 = r0 * r1;
        let scale = length / (r01 * sum * product);
        let j0 = 2.0 * sum * sum * cofactor * scale;
        let j1 = (z0 + z1) * product * scale;
        let i1 = j1 * r01;
        Integrals {
            i0,
            i1,
            j0,
            j1,
            j2: (-rho2).mul_add(j0, i0),
            j3: (-rho2).mul_add(j1, i1),
        }
    }

    /// [`moments`](Self::moments) from the integrals.
    #[inline(always)]
    pub(crate) fn weigh(&self, offset: &Offset, integrals: &Integrals) -> [[f64; 4]; 2] {
        let &Integrals {
            i0,
            i1,
            j0,
            j1,
            j2,
            j3,
        } = integrals;
        let epsilon2 = self.regularization_squared;
        let whole = [epsilon2.mul_add(j0, i0), j0, j1, j2];
        let weighted = [epsilon2.mul_add(j1, i1), j1, j2, j3];
        let mut first = [0.0; 4];
        let mut second = [0.0; 4];
        for k in 0..4 {
            second[k] = offset.a.mul_add(whole[k], weighted[k]) * self.inverse_length;
            first[k] = whole[k] - second[k];
        }
        [first, second]
    }
}

/// I_k = ∫ zᵏ/R dz and J_k = ∫ zᵏ/R³ dz along a segment.
pub(super) struct Integrals {
    /// I₀, without dimension.
    pub i0: f64,
    /// I₁, m.
    pub i1: f64,
    /// J₀, 1/m².
    pub j0: f64,
    /// J₁, 1/m.
    pub j1: f64,
    /// J₂, without dimension.
    pub j2: f64,
    /// J₃, m.
    pub j3: f64,
}

/// Position of an evaluation point relative to a segment.
pub(super) struct Offset {
    /// Coordinate a of the foot along the segment, m.
    pub a: f64,
    /// Offset p normal to the segment, m.
    pub p: [f64; 3],
    /// ρ² = |p|² + ε², m².
    pub rho2: f64,
    /// Regularized distance R₀ to the start, m.
    pub r0: f64,
    /// Regularized distance R₁ to the end, m.
    pub r1: f64,
}

/// c₀ 1 + c₁ p pᵀ − c₂ (p tᵀ + t pᵀ) + c₃ t tᵀ.
#[inline(always)]
pub(super) fn combine(c: &[f64; 4], p: &[f64; 3], t: &[f64; 3]) -> Symmetric {
    let mut u = [0.0; 3];
    let mut v = [0.0; 3];
    for k in 0..3 {
        u[k] = c[1].mul_add(p[k], -c[2] * t[k]);
        v[k] = c[3].mul_add(t[k], -c[2] * p[k]);
    }
    [
        p[0].mul_add(u[0], t[0].mul_add(v[0], c[0])),
        p[0].mul_add(u[1], t[0] * v[1]),
        p[0].mul_add(u[2], t[0] * v[2]),
        p[1].mul_add(u[1], t[1].mul_add(v[1], c[0])),
        p[1].mul_add(u[2], t[1] * v[2]),
        p[2].mul_add(u[2], t[2].mul_add(v[2], c[0])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_force_is_the_limit_of_a_short_segment() {
        let x = Vector3::new(0.3, -0.2, 0.5);
        let start = Vector3::new(0.1, 0.1, 0.1);
        let end = start + Vector3::new(1e-7, -2e-7, 2e-7);
        let epsilon = 0.05;
        let [a1, a2] = segment_integral(&x, &start, &end, epsilon);
        let r = x - start;
        let distance = (r.norm_squared() + epsilon * epsilon).sqrt();
        let stokeslet = Matrix3::identity()
            * (1.0 / distance + epsilon * epsilon / distance.powi(3))
            + r * r.transpose() / distance.powi(3);
        // The kernel decays like 1/R, so that it varies by about L/R along the segment.
        let variation = 3e-7 / distance;
        for a in [a1, a2] {
            assert!((a - stokeslet * 1.5e-7).norm() < 3.0 * variation * a.norm());
        }
    }

    #[test]
    fn halves_add_up_to_the_whole() {
        let (start, end) = (Vector3::new(-1.0, 0.2, 0.0), Vector3::new(2.0, 0.5, -0.7));
        let middle = (start + end) * 0.5;
        for x in [
            Vector3::new(0.1, 0.2, 0.3),
            middle,
            end,
            start * 4.0 - end * 3.0,
        ] {
            let [a1, a2] = segment_integral(&x, &start, &end, 0.02);
            let [b1, b2] = segment_integral(&x, &start, &middle, 0.02);
            let [c1, c2] = segment_integral(&x, &middle, &end, 0.02);
            // The density of the whole segment at its middle is the mean of those at its ends.
            let first = b1 + (b2 + c1) * 0.5 - a1;
            let second = c2 + (b2 + c1) * 0.5 - a2;
            assert!(first.norm() + second.norm() < 1e-13 * (a1.norm() + a2.norm()));
        }
    }

    #[test]
    fn a_segment_without_length_moves_nothing() {
        let start = Vector3::new(0.1, 0.2, 0.3);
        for x in [start, Vector3::zeros()] {
            let a = segment_integral(&x, &start, &start, 1e-3);
            assert_eq!(a, [Matrix3::zeros(); 2]);
        }
    }
}
