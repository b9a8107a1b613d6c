//! The segment integral by adaptive quadrature: slow, and independent of the closed form.

use super::segment_integral;
use crate::mechanics::{Matrix3, Vector3};

/// Points of the 15-point Kronrod rule on (0, 1]; the rule is symmetric and has a last point at 0.
/// Every second point, from the second on, belongs to the 7-point Gauss rule.
const POINTS: [f64; 7] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_5,
];
/// Weights of the Kronrod rule, the last one at 0.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_22,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];
/// Weights of the Gauss rule, the last one at 0.
const GAUSS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_7,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];
/// Number of halvings after which an interval is accepted.
pub(super) const DEEPEST: usize = 20;

/// Computes the result of [`segment_integral`] by adaptive Gauss–Kronrod quadrature of Eq. 2.21,
/// to an absolute `tolerance` (A₁ and A₂ are dimensionless) or to round-off.
pub(crate) fn segment_integral_by_quadrature(
    x: &Vector3,
    start: &Vector3,
    end: &Vector3,
    regularization: f64,
    tolerance: f64,
) -> [Matrix3; 2] {
    let edge = end - start;
    let length = edge.norm();
    let from_start = x - start;
    let integrand = |alpha: f64| {
        let r = from_start - edge * alpha;
        let distance = (r.norm_squared() + regularization * regularization).sqrt();
        let cube = distance.powi(3);
        let kernel = Matrix3::identity()
            * (1.0 / distance + regularization * regularization / cube)
            + r * r.transpose() / cube;
        [kernel * (length * (1.0 - alpha)), kernel * (length * alpha)]
    };
    // The integrand peaks at the foot of x, which halving must not miss.
    let foot = (from_start.dot(&edge) / (length * length)).clamp(0.0, 1.0);
    let before = integrate(&integrand, 0.0, foot, tolerance, DEEPEST);
    let after = integrate(&integrand, foot, 1.0, tolerance, DEEPEST);
    [before[0] + after[0], before[1] + after[1]]
}

/// Largest relative difference between [`segment_integral`] and quadrature over `pairs` pairs of a
/// point and a segment: points anywhere up to 100 lengths away, on the axis beyond the ends,
/// inside the rod, touching it and at the segment's nodes; lengths of 0.1 mm to 10 cm, ε from
/// 1/100 to 30 lengths. The pairs are random, but the same in every run.
pub(crate) fn segment_integral_error(pairs: usize) -> f64 {
    let mut random = Random(2018);
    let mut worst: f64 = 0.0;
    for pair in 0..pairs {
        let length = random.magnitude(1e-4, 0.1);
        let epsilon = length * random.magnitude(0.01, 30.0);
        let start = random.direction() * length;
        let tangent = random.direction();
        let across = random.direction().cross(&tangent).normalize();
        let along = 0.5 * length * (1.0 + random.number());
        let x = start
            + match pair % 5 {
                0 => random.direction() * (length * random.magnitude(0.01, 100.0)),
                1 => tangent * (length * random.number() * random.magnitude(1.0, 100.0)),
                2 => tangent * along + across * (epsilon * random.number()),
                3 => tangent * along + across * (2.0 * epsilon / 1.02),
                _ => tangent * (length * (pair / 5 % 2) as f64),
            };
        let end = start + tangent * length;
        let closed_form = segment_integral(&x, &start, &end, epsilon);
        let scale = closed_form[0].norm().min(closed_form[1].norm());
        let quadrature = segment_integral_by_quadrature(&x, &start, &end, epsilon, 1e-12 * scale);
        for (a, b) in closed_form.iter().zip(&quadrature) {
            worst = worst.max((a - b).norm() / b.norm());
        }
    }
    worst
}

/// A linear congruential generator (Knuth's MMIX).
pub(super) struct Random(pub u64);

impl Random {
    /// Uniform in (−1, 1).
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A random number between two magnitudes, uniform in the logarithm.
    pub(crate) fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        from * libm::pow(to / from, 0.5 + 0.5 * self.number())
    }

    pub(crate) fn direction(&mut self) -> Vector3 {
        Vector3::from_fn(|_, _| self.number()).normalize()
    }
}

/// Integrates by halving until the two rules agree.
pub(super) fn integrate(
    f: &impl Fn(f64) -> [Matrix3; 2],
    from: f64,
    to: f64,
    tolerance: f64,
    depth: usize,
) -> [Matrix3; 2] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let centre = f(middle);
    let mut kronrod = centre.map(|value| value * KRONROD[7]);
    let mut gauss = centre.map(|value| value * GAUSS[3]);
    for (i, point) in POINTS.iter().enumerate() {
        for x in [middle - half * point, middle + half * point] {
            for (k, value) in f(x).iter().enumerate() {
                kronrod[k] += value * KRONROD[i];
                if i % 2 == 1 {
                    gauss[k] += value * GAUSS[i / 2];
                }
            }
        }
    }
    let error = (0..2)
        .map(|k| (kronrod[k] - gauss[k]).norm() * half)
        .fold(0.0, f64::max);
    let round_off = 1e-14 * half * (kronrod[0].norm() + kronrod[1].norm());
    if error <= tolerance.max(round_off) || depth == 0 {
        return kronrod.map(|value| value * half);
    }
    let left = integrate(f, from, middle, 0.5 * tolerance, depth - 1);
    let right = integrate(f, middle, to, 0.5 * tolerance, depth - 1);
    [left[0] + right[0], left[1] + right[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_are_exact_to_their_degrees() {
        // Kronrod is exact to degree 22, Gauss to degree 13, on (−1, 1).
        for degree in (0..=22).step_by(2) {
            let exact = 2.0 / (degree as f64 + 1.0);
            let power = |x: f64| 2.0 * x.powi(degree);
            let middle = if degree == 0 { 1.0 } else { 0.0 };
            let kronrod: f64 = (0..7).map(|i| KRONROD[i] * power(POINTS[i])).sum::<f64>();
            assert!((kronrod + KRONROD[7] * middle - exact).abs() < 1e-15 * 4.0);
            if degree <= 12 {
                let gauss: f64 = (0..3).map(|i| GAUSS[i] * power(POINTS[2 * i + 1])).sum();
                assert!((gauss + GAUSS[3] * middle - exact).abs() < 1e-15 * 4.0);
            }
        }
    }

    #[test]
    fn the_closed_form_agrees_with_quadrature() {
        let worst = segment_integral_error(1000);
        assert!(worst < 1e-10, "{worst:e}");
    }

    #[test]
    fn agrees_with_the_potential_of_a_thin_line_far_away() {
        // At a great distance a segment acts as a point force of density × length, half of it from
        // either end.
        let x = Vector3::new(0.0, 3000.0, 4000.0);
        let end = Vector3::new(0.002, 0.0, 0.0);
        let [a1, a2] = segment_integral_by_quadrature(&x, &Vector3::zeros(), &end, 1e-3, 1e-18);
        let direction = x / 5000.0;
        let expected = (Matrix3::identity() + direction * direction.transpose()) * (0.001 / 5000.0);
        assert!((a1 - expected).norm() < 1e-6 * expected.norm());
        assert!((a2 - expected).norm() < 1e-6 * expected.norm());
    }
}
