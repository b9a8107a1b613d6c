//! A logarithm that vectorises and has the same bytes on every machine.

/// ln(n/d) for normal positive n ≥ d, to about one unit in the last place, with a single division.
///
/// `difference` is n − d, which the caller may know more accurately than by subtraction; if n/d is
/// near 1 it determines the result.
///
/// With k the power of two nearest to n/d and d' = 2ᵏ d, ln(n/d) = k ln 2 + 2 artanh((n − d')/(n +
/// d')). The difference of the bit patterns of n and d is 2⁵² log₂(n/d) to within 0.087·2⁵², so
/// that rounding it gives a k with |(n − d')/(n + d')| < 0.201. Within this range the artanh
/// series may end after s²² with a remainder below 5·10⁻¹⁸. If n/d is near 1, k is 0 and
/// `difference` is used.
#[inline(always)]
pub(super) fn logarithm_of_ratio(n: f64, d: f64, difference: f64) -> f64 {
    /// 2⁵², whose last mantissa bit counts ones.
    const ONES: f64 = 4_503_599_627_370_496.0;
    let exponent = n.to_bits().wrapping_sub(d.to_bits());
    let k = exponent.wrapping_add(1 << 51) >> 52;
    let scaled = f64::from_bits(d.to_bits().wrapping_add(k << 52));
    let numerator = if k == 0 { difference } else { n - scaled };
    let k = f64::from_bits(ONES.to_bits() | k) - ONES;
    let s = numerator / (n + scaled);
    let s2 = s * s;
    let mut series = 1.0 / 23.0;
    for odd in [
        21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0_f64,
    ] {
        series = s2.mul_add(series, 1.0 / odd);
    }
    k.mul_add(std::f64::consts::LN_2, 2.0 * s * series)
}

#[cfg(test)]
mod tests {
    use super::logarithm_of_ratio;

    #[test]
    fn agrees_with_the_standard_logarithm_over_twelve_decades() {
        let mut worst: f64 = 0.0;
        for i in 0..20_000 {
            let d = 1e-6 * 1.000_7_f64.powi(i % 5_000);
            let n = d * 1.0014_f64.powi(i);
            let expected = (n / d).ln();
            let error = (logarithm_of_ratio(n, d, n - d) - expected).abs();
            // Rounding n/d alone changes the logarithm by ε.
            worst = worst.max(error / (expected.abs() + 1.0));
        }
        assert!(worst < 4.0 * f64::EPSILON, "{worst:e}");
    }

    #[test]
    fn is_accurate_near_one_and_exact_at_one() {
        for i in 1..50 {
            let x = 0.5_f64.powi(i);
            let expected = x.ln_1p();
            let error = logarithm_of_ratio(1.0 + x, 1.0, x) - expected;
            assert!(error.abs() < 2.0 * f64::EPSILON * expected, "{x:e}");
        }
        assert_eq!(logarithm_of_ratio(0.3, 0.3, 0.0), 0.0);
    }
}
