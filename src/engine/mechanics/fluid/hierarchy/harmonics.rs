//! Solid harmonics, normalised so that sums need no factors (Dehnen 2014, section A1).
//!
//! With P the associated Legendre functions,
//!
//! Υₙᵐ(r) = (−1)ᵐ rⁿ Pₙᵐ(cos ϑ) e^{imφ}/(n+m)!,  Θₙᵐ(r) = (−1)ᵐ (n−m)! Pₙᵐ(cos ϑ) e^{imφ}/rⁿ⁺¹,
//!
//! where both have f₋ₘ = (−1)ᵐ f*ₘ, and
//!
//! - 1/|x − y| = Σ Υₙᵐ*(y) Θₙᵐ(x) for |y| < |x|,
//! - Υₙᵐ(x + y) = Σ Υₖˡ(x) Υₙ₋ₖᵐ⁻ˡ(y),
//! - ∂_z Υₙᵐ = Υₙ₋₁ᵐ,  (∂_x + i ∂_y) Υₙᵐ = Υₙ₋₁ᵐ⁺¹,  (∂_x − i ∂_y) Υₙᵐ = −Υₙ₋₁ᵐ⁻¹.
//!
//! Tables hold real and imaginary parts of W points at a time, for all m ≥ 0 at [`half`] or for all m at
//! [`whole`].

/// Entries of a table with m ≥ 0 up to degree `order`.
pub(super) const fn half_size(order: usize) -> usize {
    (order + 1) * (order + 2) / 2
}

/// Entries of a table with all m up to degree `order`.
pub(super) const fn whole_size(order: usize) -> usize {
    (order + 1) * (order + 1)
}

/// Index of degree n and 0 ≤ m ≤ n in a table with m ≥ 0.
#[inline(always)]
pub(super) const fn half(n: usize, m: usize) -> usize {
    n * (n + 1) / 2 + m
}

/// Index of degree n and |m| ≤ n in a table with all m.
#[inline(always)]
pub(super) const fn whole(n: usize, m: isize) -> usize {
    (n * (n + 1)).wrapping_add_signed(m)
}

/// Real and imaginary parts of W complex numbers.
pub(super) type Complex<const W: usize> = [[f64; W]; 2];

/// Fills `table` with Υₙᵐ(r), m ≥ 0, up to degree `order`.
#[inline(always)]
pub(super) fn regular<const W: usize>(order: usize, r: &[[f64; W]; 3], table: &mut [Complex<W>]) {
    let [x, y, z] = r;
    let square = square_of(r);
    table[0] = [[1.0; W], [0.0; W]];
    for m in 0..=order {
        if m > 0 {
            let factor = -0.5 / m as f64;
            table[half(m, m)] = times(&table[half(m - 1, m - 1)], x, y, &[factor; W]);
        }
        for n in m + 1..=order {
            let inverse = 1.0 / (n * n - m * m) as f64;
            let odd = (2 * n - 1) as f64 * inverse;
            for part in 0..2 {
                for lane in 0..W {
                    let below = if n > m + 1 {
                        table[half(n - 2, m)][part][lane]
                    } else {
                        0.0
                    };
                    table[half(n, m)][part][lane] = (odd * z[lane]).mul_add(
                        table[half(n - 1, m)][part][lane],
                        -(inverse * square[lane]) * below,
                    );
                }
            }
        }
    }
}

/// Fills `table` with Θₙᵐ(r) for all m up to degree `order`.
#[inline(always)]
pub(super) fn irregular<const W: usize>(order: usize, r: &[[f64; W]; 3], table: &mut [Complex<W>]) {
    let [x, y, z] = r;
    let mut inverse_square = square_of(r);
    let mut inverse = [0.0; W];
    for lane in 0..W {
        inverse_square[lane] = 1.0 / inverse_square[lane];
        inverse[lane] = inverse_square[lane].sqrt();
    }
    table[0] = [inverse, [0.0; W]];
    for m in 0..=order {
        let diagonal = whole(m, m as isize);
        if m > 0 {
            let mut factor = inverse_square;
            for lane in 0..W {
                factor[lane] *= -((2 * m - 1) as f64);
            }
            table[diagonal] = times(&table[whole(m - 1, m as isize - 1)], x, y, &factor);
        }
        for n in m + 1..=order {
            let odd = (2 * n - 1) as f64;
            let even = ((n - 1) * (n - 1) - m * m) as f64;
            for part in 0..2 {
                for lane in 0..W {
                    let below = if n > m + 1 {
                        table[whole(n - 2, m as isize)][part][lane]
                    } else {
                        0.0
                    };
                    let last = table[whole(n - 1, m as isize)][part][lane];
                    table[whole(n, m as isize)][part][lane] =
                        inverse_square[lane] * (odd * z[lane]).mul_add(last, -even * below);
                }
            }
        }
        if m > 0 {
            for n in m..=order {
                table[whole(n, -(m as isize))] = mirrored(m, &table[whole(n, m as isize)]);
            }
        }
    }
}

/// f₋ₘ of fₘ.
#[inline(always)]
pub(super) fn mirrored<const W: usize>(m: usize, f: &Complex<W>) -> Complex<W> {
    let sign = if m.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut mirrored = *f;
    for lane in 0..W {
        mirrored[0][lane] *= sign;
        mirrored[1][lane] *= -sign;
    }
    mirrored
}

/// Copies a table with m ≥ 0 into one with all m.
#[inline(always)]
pub(super) fn complete<const W: usize>(order: usize, from: &[Complex<W>], to: &mut [Complex<W>]) {
    for n in 0..=order {
        for m in 0..=n {
            let f = &from[half(n, m)];
            to[whole(n, m as isize)] = *f;
            to[whole(n, -(m as isize))] = mirrored(m, f);
        }
    }
}

#[inline(always)]
fn square_of<const W: usize>(r: &[[f64; W]; 3]) -> [f64; W] {
    let mut square = [0.0; W];
    for lane in 0..W {
        square[lane] = r[2][lane].mul_add(
            r[2][lane],
            r[1][lane].mul_add(r[1][lane], r[0][lane] * r[0][lane]),
        );
    }
    square
}

/// `factor` (x + i y) f.
#[inline(always)]
fn times<const W: usize>(
    f: &Complex<W>,
    x: &[f64; W],
    y: &[f64; W],
    factor: &[f64; W],
) -> Complex<W> {
    let mut product = [[0.0; W]; 2];
    for lane in 0..W {
        product[0][lane] = factor[lane] * x[lane].mul_add(f[0][lane], -y[lane] * f[1][lane]);
        product[1][lane] = factor[lane] * x[lane].mul_add(f[1][lane], y[lane] * f[0][lane]);
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: usize = 12;

    fn regular_table(r: [f64; 3]) -> Vec<[f64; 2]> {
        let mut table = vec![Complex::default(); half_size(ORDER)];
        let mut all = vec![Complex::default(); whole_size(ORDER)];
        regular::<1>(ORDER, &r.map(|x| [x]), &mut table);
        complete(ORDER, &table, &mut all);
        all.iter().map(|[[re], [im]]| [*re, *im]).collect()
    }

    fn irregular_table(r: [f64; 3]) -> Vec<[f64; 2]> {
        let mut table = vec![Complex::default(); whole_size(ORDER)];
        irregular::<1>(ORDER, &r.map(|x| [x]), &mut table);
        table.iter().map(|[[re], [im]]| [*re, *im]).collect()
    }

    #[test]
    fn inverse_distances_expand() {
        let (x, y) = ([1.2, -0.7, 0.9], [0.1, 0.2, -0.15]);
        let distance = (0..3)
            .map(|k| (x[k] - y[k]) * (x[k] - y[k]))
            .sum::<f64>()
            .sqrt();
        let sum: f64 = (regular_table(y).iter().zip(irregular_table(x)))
            .map(|(a, b)| a[0] * b[0] + a[1] * b[1])
            .sum();
        assert!((sum * distance - 1.0).abs() < 1e-9, "{sum} {distance}");
    }

    #[test]
    fn regular_harmonics_add_up() {
        let (x, y) = ([0.3, -0.7, 0.5], [0.4, 0.2, -0.6]);
        let [a, b] = [x, y].map(regular_table);
        let c = regular_table(std::array::from_fn(|k| x[k] + y[k]));
        for n in 0..=ORDER {
            for m in -(n as isize)..=n as isize {
                let mut sum = [0.0; 2];
                for k in 0..=n {
                    for l in -(k as isize)..=k as isize {
                        if (m - l).unsigned_abs() <= n - k {
                            let (f, g) = (a[whole(k, l)], b[whole(n - k, m - l)]);
                            sum[0] += f[0] * g[0] - f[1] * g[1];
                            sum[1] += f[0] * g[1] + f[1] * g[0];
                        }
                    }
                }
                let expected = c[whole(n, m)];
                for part in 0..2 {
                    assert!((sum[part] - expected[part]).abs() < 1e-14, "{n} {m}");
                }
            }
        }
    }
}
