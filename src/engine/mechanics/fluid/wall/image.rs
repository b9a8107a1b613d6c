//! The image of a segment in a plane wall, in closed form.
//!
//! A regularized point force f acts at height h over a wall (the plane z = 0, unit normal n). An
//! image system at the mirrored point makes its flow vanish on the wall, exactly and for any ε
//! (Ainley et al. 2008; Cortez and Varela 2015): minus the regularized Stokeslet, a doublet of
//! Stokeslets, a potential dipole of the companion blob 3ε²/(4π R⁵), and the difference of the
//! rotlets of the two blobs. With X from the mirrored point to the point of evaluation at height
//! z, R² = |X|² + ε², and g = −(1 − 2 n nᵀ) f, these terms add up to
//!
//! 8πη u* = −(1/R + ε²/R³) f − (f·X) X/R³ + 2h ((f·n) X − (g·X) n)/R³ + 2hz ((1/R³ − 3ε²/R⁵) g − 3 (g·X) X/R⁵).
//!
//! For ε → 0 that is Blake's image (1971). The last term is that of the dipole; it vanishes on the wall, where the
//! others cancel the Stokeslet.
//!
//! # Along a segment
//! The image of a segment with tangent t is the mirrored segment with tangent t* = t − 2 (t·n) n. With its foot, offset p and
//! coordinate ζ as in [`segment`](super::super::segment), X = p − ζ t*, and h = h_a + ζ t·n is linear in ζ,
//! as the force density is. With q and T the parts of p and t* along the wall and Z = z + h, the last two terms are
//!
//! 2h (q_X nᵀ + n q_Xᵀ)/R³ and 2hz (−(1 − 2 n nᵀ)(1/R³ − 3ε²/R⁵) + 3 (q_X q_Xᵀ − Z² n nᵀ + [Z q_X × n]×)/R⁵),
//!
//! q_X = q − ζ T. Only the last part is not symmetric; it is the cross product with a vector along the wall.
//! The integrals K_k = ∫ ζᵏ/R⁵ dζ follow from J_k: with s = ζ/R,
//!
//! | integral | closed form |
//! |---|---|
//! | K₀ | J₀ (1/R₀² + 1/R₁² + (1 − s₀s₁)/ρ²)/3 |
//! | K₁ | J₁ (1/R₀² + 1/(R₀R₁) + 1/R₁²)/3 |
//! | K₂ | J₀ (s₀² + s₀s₁ + s₁²)/3 |
//! | K₃ | J₁ − ρ² K₁ |
//! | K₄ | J₂ − ρ² K₂ |
//!
//! and (1 − s₀s₁)/ρ² = (ρ² + ζ₀² + ζ₁²)/((R₀R₁ + ζ₀ζ₁) R₀R₁) if ζ₀ζ₁ > 0, which contains no
//! difference of nearly equal numbers. The formula needs no quadrature, and therefore has no
//! smallest height: the only error is rounding.

use super::super::segment::{Integrals, Offset, Segment, Symmetric, combine, full};
use crate::mechanics::{Matrix3, Vector3};

/// The flow at `x` that the image of a segment in a wall adds to
/// [`segment_integral`](super::super::segment_integral), as matrices A₁ and A₂ of the force
/// densities at `start` and `end`.
///
/// The wall goes through `point` with the unit normal `normal`; all points are on the side that the normal points to.
/// `regularization` is ε, m.
pub fn segment_image_integral(
    x: &Vector3,
    start: &Vector3,
    end: &Vector3,
    regularization: f64,
    point: &Vector3,
    normal: &Vector3,
) -> [Matrix3; 2] {
    let image = Image::new(start, end, regularization * regularization, point, normal);
    let height = (x - point).dot(normal);
    image
        .integral((*x).into(), height, &(*normal).into())
        .map(|part| part.full())
}

/// The matrix of the cross product with a vector.
pub(super) fn cross(w: &[f64; 3]) -> Matrix3 {
    Matrix3::new(0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0)
}

/// A matrix as its symmetric part and the vector of its antisymmetric part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub symmetric: Symmetric,
    /// w of the part f ↦ w × f.
    pub axial: [f64; 3],
}

impl Part {
    fn full(&self) -> Matrix3 {
        full(&self.symmetric) + cross(&self.axial)
    }
}

/// The image of a segment in the form that the kernel needs.
pub(super) struct Image {
    /// The segment mirrored in the wall.
    pub mirrored: Segment,
    /// Height of the segment's start over the wall, m.
    pub height: f64,
    /// t·n: the rate of growth of its height along the segment.
    pub slope: f64,
}

impl Image {
    /// The image of the segment from `start` to `end`, m, in the wall through `point` with the unit normal `n`.
    pub(crate) fn new(
        start: &Vector3,
        end: &Vector3,
        regularization_squared: f64,
        point: &Vector3,
        n: &Vector3,
    ) -> Self {
        let heights = [start, end].map(|x| (x - point).dot(n));
        let mirrored = Segment::new(
            &(start - n * (2.0 * heights[0])),
            &(end - n * (2.0 * heights[1])),
            regularization_squared,
        );
        Self {
            slope: (heights[1] - heights[0]) * mirrored.inverse_length,
            height: heights[0],
            mirrored,
        }
    }

    /// Contribution of the image to A₁ and A₂ at `x`, which is at height `z` over the wall with unit normal `n`.
    fn integral(&self, x: [f64; 3], z: f64, n: &[f64; 3]) -> [Part; 2] {
        let offset = self.mirrored.offset(x);
        let moments = self.moments(&offset);
        moments.map(|moments| self.combine(&moments, &offset, z, n))
    }

    /// Coefficients of both matrices for [`combine`](Self::combine).
    ///
    /// Free of branches, with every `mul_add` written out, like the kernel of the segment itself.
    #[inline(always)]
    pub(crate) fn moments(&self, offset: &Offset) -> [Moments; 2] {
        let integrals = self.mirrored.integrals(offset);
        let [first, second] = self.mirrored.weigh(offset, &integrals);
        let &Integrals { j0, j1, j2, j3, .. } = &integrals;
        let &Offset {
            a, rho2, r0, r1, ..
        } = offset;
        let (z0, z1) = (-a, self.mirrored.length - a);
        let inverse = 1.0 / (r0 * r1);
        let (u0, u1) = (inverse * (r1 / r0), inverse * (r0 / r1));
        let z01 = z0 * z1;
        let beyond = z01 > 0.0;
        let numerator = if beyond {
            z1.mul_add(z1, z0.mul_add(z0, rho2))
        } else {
            r0.mul_add(r1, -z01)
        };
        let denominator = if beyond { r0.mul_add(r1, z01) } else { rho2 };
        let third = 1.0 / 3.0;
        let k0 = third * j0 * ((u0 + u1) + inverse * (numerator / denominator));
        let k1 = third * j1 * ((u0 + u1) + inverse);
        let k2 = third * j0 * (z0 * z0).mul_add(u0, (z1 * z1).mul_add(u1, z01 * inverse));
        let k3 = (-rho2).mul_add(k1, j1);
        let k4 = (-rho2).mul_add(k2, j2);

        let slope = self.slope;
        let foot = self.foot(offset);
        // h and h (ζ + a)/L as polynomials of ζ.
        let c = [
            foot * a * self.mirrored.inverse_length,
            slope.mul_add(a, foot) * self.mirrored.inverse_length,
            slope * self.mirrored.inverse_length,
        ];
        let once = |lower: f64, upper: f64| foot.mul_add(lower, slope * upper);
        let twice = |x: f64, y: f64, z: f64| c[0].mul_add(x, c[1].mul_add(y, c[2] * z));
        let whole = [
            once(j0, j1),
            once(j1, j2),
            once(k0, k1),
            once(k1, k2),
            once(k2, k3),
        ];
        let weighted = [
            twice(j0, j1, j2),
            twice(j1, j2, j3),
            twice(k0, k1, k2),
            twice(k1, k2, k3),
            twice(k2, k3, k4),
        ];
        let mut moments = [Moments::default(); 2];
        moments[0].0[..4].copy_from_slice(&first[..4]);
        moments[1].0[..4].copy_from_slice(&second[..4]);
        for k in 0..5 {
            moments[0].0[4 + k] = whole[k] - weighted[k];
            moments[1].0[4 + k] = weighted[k];
        }
        moments
    }

    /// h_a, the height of the segment's line at the foot, m.
    #[inline(always)]
    fn foot(&self, offset: &Offset) -> f64 {
        self.slope.mul_add(offset.a, self.height)
    }

    /// The matrix of some moments, at height `z` over the wall with unit normal `n`.
    #[inline(always)]
    pub(crate) fn combine(&self, moments: &Moments, offset: &Offset, z: f64, n: &[f64; 3]) -> Part {
        let [m0, m1, m2, m3, j0, j1, k0, k1, k2] = moments.0;
        let (p, tangent, slope) = (&offset.p, &self.mirrored.tangent, self.slope);
        let above = z + self.foot(offset);
        let mut q = [0.0; 3];
        let mut t = [0.0; 3];
        for k in 0..3 {
            q[k] = (-above).mul_add(n[k], p[k]);
            t[k] = slope.mul_add(n[k], tangent[k]);
        }
        let mirrored = combine(&[m0, m1, m2, m3], p, tangent);
        let epsilon2 = self.mirrored.regularization_squared;
        let dipole = (-3.0 * epsilon2).mul_add(k0, j0);
        let z6 = 6.0 * z;
        let along = combine(&[-2.0 * z * dipole, z6 * k0, z6 * k1, z6 * k2], &q, &t);
        // Moments of Z, of Z ζ and of Z².
        let high0 = above.mul_add(k0, slope * k1);
        let high1 = above.mul_add(k1, slope * k2);
        let square = above.mul_add(high0, slope * high1);
        let normal = z * 2.0f64.mul_add(dipole, -3.0 * square);
        let mut v = [0.0; 3];
        let mut w = [0.0; 3];
        for k in 0..3 {
            v[k] = 2.0f64.mul_add(q[k].mul_add(j0, -t[k] * j1), normal * n[k]);
            w[k] = z6 * q[k].mul_add(high0, -t[k] * high1);
        }
        let mut symmetric = [0.0; 6];
        for (c, (row, column)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
            .into_iter()
            .enumerate()
        {
            let bridge = n[row].mul_add(v[column], n[column] * v[row]);
            symmetric[c] = (along[c] - mirrored[c]) + bridge;
        }
        Part {
            symmetric,
            axial: [
                w[1].mul_add(n[2], -w[2] * n[1]),
                w[2].mul_add(n[0], -w[0] * n[2]),
                w[0].mul_add(n[1], -w[1] * n[0]),
            ],
        }
    }
}

/// Coefficients of a matrix: four of the mirrored segment, the J of h and h ζ, and the K of h, h ζ
/// and h ζ².
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments(pub [f64; 9]);

#[cfg(test)]
mod tests {
    use super::super::super::quadrature::{DEEPEST, Random, integrate};
    use super::super::super::segment_integral;
    use super::*;

    /// A wall that is not parallel to any axis.
    fn wall() -> (Vector3, Vector3) {
        let normal = Vector3::new(0.3, -0.5, 0.8).normalize();
        (Vector3::new(0.2, 0.1, -0.3), normal)
    }

    /// The image of a point force at `y` term by term, in the form of Ainley et al., with the
    /// kernels H₁ and H₂ of the Stokeslet and D₁ and D₂ of the dipole.
    fn image_of_point(x: &Vector3, y: &Vector3, epsilon: f64) -> Matrix3 {
        let (point, n) = wall();
        let h = (y - point).dot(&n);
        let v = x - (y - n * (2.0 * h));
        let e2 = epsilon * epsilon;
        let r2 = v.norm_squared() + e2;
        let (r3, r5) = (r2.powf(-1.5), r2.powf(-2.5));
        let h1 = r2.powf(-0.5) + e2 * r3;
        let (slope_h1, slope_h2) = (-r3 - 3.0 * e2 * r5, -3.0 * r5);
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|f| {
            let g = n * (2.0 * f.dot(&n)) - f;
            let stokeslet = f * h1 + v * (f.dot(&v) * r3);
            let dipole = g * (-r3 + 3.0 * e2 * r5) + v * (3.0 * g.dot(&v) * r5);
            // Derivative along g of the Stokeslet n H₁ + (n·v) v H₂.
            let doublet = n * (g.dot(&v) * slope_h1)
                + (v * g.dot(&n) + g * n.dot(&v)) * r3
                + v * (n.dot(&v) * g.dot(&v) * slope_h2);
            let rotlets = v.cross(&n.cross(&g)) * (3.0 * e2 * r5);
            -stokeslet + (doublet + dipole * h + rotlets) * (2.0 * h)
        });
        Matrix3::from_columns(&columns)
    }

    #[test]
    fn an_image_agrees_with_quadrature_of_the_image_of_points() {
        let (point, n) = wall();
        let along = n.cross(&Vector3::x()).normalize();
        let mut random = Random(38);
        let mut worst: f64 = 0.0;
        for pair in 0..2000 {
            // Lengths of 0.2 to 30 ε; heights of one ε to 100 lengths; parallel, upright and oblique segments.
            let epsilon = random.magnitude(1e-3, 1e-1);
            let length = epsilon * random.magnitude(0.2, 30.0);
            let mut tangent = match pair % 4 {
                0 => along,
                1 => n,
                _ => random.direction(),
            };
            tangent *= if tangent.dot(&n) < 0.0 { -1.0 } else { 1.0 };
            let height = epsilon + length * random.magnitude(1e-3, 100.0);
            let start = point + along * random.number() + n * height;
            let end = start + tangent * length;
            let x = match pair % 5 {
                0 => start,
                1 => end,
                2 => start + tangent * (length * random.number()).abs(),
                3 => start + tangent * (length * random.magnitude(1.0, 50.0)),
                _ => start + random.direction() * (length * random.magnitude(0.1, 100.0)),
            };
            if (x - point).dot(&n) < 0.5 * epsilon {
                continue;
            }
            let [first, second] = segment_image_integral(&x, &start, &end, epsilon, &point, &n);
            let kernel = |s: f64| {
                let a = image_of_point(&x, &start.lerp(&end, s), epsilon) * length;
                [a * (1.0 - s), a * s]
            };
            let scale = first.norm().min(second.norm());
            let expected = integrate(&kernel, 0.0, 1.0, 1e-13 * scale, DEEPEST);
            for (got, expected) in [first, second].iter().zip(&expected) {
                worst = worst.max((got - expected).norm() / expected.norm());
            }
        }
        assert!(worst < 1e-10, "{worst:e}");
    }

    #[test]
    fn on_the_wall_the_fluid_is_at_rest() {
        let (point, n) = wall();
        let mut random = Random(1971);
        for pair in 0..1000 {
            let epsilon = random.magnitude(1e-3, 1e-1);
            let length = epsilon * random.magnitude(0.2, 30.0);
            let height = epsilon * random.magnitude(0.1, 100.0);
            let start = point + random.direction().cross(&n) * 0.3 + n * height;
            let tangent = match pair % 3 {
                0 => n,
                1 => n.cross(&random.direction()).normalize(),
                _ => (n + random.direction() * 0.9).normalize(),
            };
            let end = start + tangent * length;
            let reach = (height + length) * random.magnitude(0.1, 10.0);
            let x = start - n * height + n.cross(&random.direction()) * reach;
            let x = x - n * (x - point).dot(&n);
            let free = segment_integral(&x, &start, &end, epsilon);
            let image = segment_image_integral(&x, &start, &end, epsilon, &point, &n);
            for (free, image) in free.iter().zip(&image) {
                let slip = (free + image).norm() / free.norm();
                assert!(slip < 1e-12, "{slip:e}");
            }
        }
    }

    #[test]
    fn a_thin_short_segment_has_the_image_of_blake() {
        // Blake (1971) for a force at height h over z = 0:
        // −S + 2h (δ_jα δ_αk − δ_j3 δ_3k) ∂/∂R_k {h R_i/R³ − (δ_i3/R + R_i R_3/R³)}, by central differences.
        let (h, length) = (0.7, 1e-4);
        let start = Vector3::new(0.1, -0.2, h);
        let end = start + Vector3::new(0.6, 0.0, 0.8) * length;
        let x = Vector3::new(0.8, 0.5, 1.1);
        let [first, second] =
            segment_image_integral(&x, &start, &end, 1e-6, &Vector3::zeros(), &Vector3::z());
        let middle = (start + end) * 0.5;
        let h = middle.z;
        let r = x - Vector3::new(middle.x, middle.y, -h);
        let potential = |r: Vector3| {
            let d = r.norm();
            r * (h / d.powi(3)) - (Vector3::z() / d + r * (r.z / d.powi(3)))
        };
        let d = r.norm();
        for j in 0..3 {
            let axis = Vector3::ith(j, 1.0);
            let sign = if j == 2 { -1.0 } else { 1.0 };
            let step = 1e-5;
            let slope = (potential(r + axis * step) - potential(r - axis * step)) / (2.0 * step);
            let expected = -(axis / d + r * (r[j] / d.powi(3))) + slope * (sign * 2.0 * h);
            let got = (first + second).column(j) / length;
            assert!((got - expected).norm() < 1e-7 * expected.norm(), "{j}");
        }
    }

    #[test]
    fn two_points_move_each_other_alike() {
        // Lorentz' reciprocal theorem, which holds for equal blobs: G(x, y) is the transpose of G(y, x).
        let (point, n) = wall();
        let at =
            |height: f64, side: f64| point + n * height + n.cross(&Vector3::x()).normalize() * side;
        let (x, y) = (at(0.05, 0.2), at(0.3, -0.1));
        let (epsilon, edge) = (0.04, Vector3::new(1e-7, 0.0, 0.0));
        let flow = |x: &Vector3, y: &Vector3| {
            let [first, second] =
                segment_image_integral(x, &(y - edge), &(y + edge), epsilon, &point, &n);
            first + second
        };
        let (there, back) = (flow(&x, &y), flow(&y, &x).transpose());
        assert!((there - back).norm() < 1e-9 * there.norm());
    }
}
