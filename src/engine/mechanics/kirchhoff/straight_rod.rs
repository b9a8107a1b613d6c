//! The straight rod under axial force and twist, clamped at both ends.

/// Argument below which the quotient of [`stability_determinant`] is taken from its series.
const SMALL: f64 = 1e-3;

/// A function of the length ℓ that first vanishes where the straight rod with clamped ends buckles.
///
/// The limit κ → 0 of the helix has the twisting moment ω and the axial force (ω − τ) τ, in units
/// of EI. The displacement w of the rod across the axis, as a complex number, satisfies w'''' − i ω
/// w''' − (ω − τ) τ w'' = 0, whose solutions are 1, s, exp(i τ s) and exp(i (ω − τ) s). With A =
/// τℓ/2 and B = (ω − τ)ℓ/2, clamped ends need (B − A) sin A sin B = A B sin(B − A). Without the
/// factors that vanish for an unbuckled rod, this is
///
/// ( sinc A sinc B − sinc(B − A) ) / (A B).
///
/// The function covers Euler's column (ω = 0: ℓ = 2π/τ), Greenhill's twisted rod (τ = 0: tan(ωℓ/2)
/// = ωℓ/2) and, at ω = 2τ, the pulled rod that never buckles. Love 1944, articles 264 and 272;
/// Greenhill 1883.
pub(crate) fn stability_determinant(torsion: f64, twisting_moment: f64, length: f64) -> f64 {
    let a = 0.5 * torsion * length;
    let b = 0.5 * (twisting_moment - torsion) * length;
    // The function is symmetric in both: let a be the smaller one.
    let (a, b) = if a.abs() <= b.abs() { (a, b) } else { (b, a) };
    if a.abs() > SMALL {
        return (sinc(a) * sinc(b) - sinc(b - a)) / (a * b);
    }
    if b.abs() > SMALL {
        // Taylor series in a; sinc' and sinc'' follow from x sinc x = sin x.
        let slope = (libm::cos(b) - sinc(b)) / b;
        let bend = -sinc(b) - 2.0 * slope / b;
        let third = -slope - (2.0 * bend - 2.0 * slope / b) / b;
        return (slope - a * (sinc(b) / 6.0 + 0.5 * bend) + a * a * third / 6.0) / b;
    }
    -1.0 / 3.0
}

/// sin x / x.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        libm::sin(x) / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_meets_the_quotient() {
        for b in [0.5, 2.0, -3.0, 7.0] {
            for a in [1.001e-3, -1.001e-3] {
                let below = stability_determinant(2.0 * a * 0.998, 2.0 * (a * 0.998 + b), 1.0);
                let above = stability_determinant(2.0 * a, 2.0 * (a + b), 1.0);
                assert!((below - above).abs() < 2e-6, "{b}: {below} {above}");
            }
        }
        assert!((stability_determinant(2e-3, 6e-3, 1.0) + 1.0 / 3.0).abs() < 1e-4);
    }

    #[test]
    fn euler_and_greenhill() {
        let changes = |torsion, moment, length: f64| {
            let [before, after] = [0.999_999, 1.000_001]
                .map(|factor| stability_determinant(torsion, moment, factor * length));
            before * after < 0.0
        };
        assert!(changes(1.0, 0.0, std::f64::consts::TAU));
        assert!(changes(0.0, 1.0, 8.986_818_915_8));
    }
}
