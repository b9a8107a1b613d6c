//! Shifts of expansions from one centre to another.
//!
//! An expansion has the potentials B (one for each component of the force) and a scalar B₀ that
//! depends on the centre c, so that the flow derives from (x − c)·B + B₀ ([module](super)). A new
//! centre c + s therefore adds s·B to B₀.

use super::harmonics::{Complex, complete, half, half_size, irregular, regular, whole, whole_size};
use crate::linalg::instruction_set::{LANES, Lanes, kernel};

/// Number of potentials.
pub(super) const POTENTIALS: usize = 4;

/// A coefficient of the four potentials.
pub(super) type Coefficient = Complex<POTENTIALS>;

/// Scratch for [`raise`] and [`lower`].
pub(super) struct ShiftTables {
    half: Vec<Complex<1>>,
    shift: Vec<Complex<1>>,
    from: Vec<Coefficient>,
}

impl ShiftTables {
    /// Creates the scratch for expansions up to degree `order`.
    pub(crate) fn new(order: usize) -> Self {
        Self {
            half: vec![Default::default(); half_size(order)],
            shift: vec![Default::default(); whole_size(order)],
            from: vec![Default::default(); whole_size(order)],
        }
    }

    #[inline(always)]
    fn fill(&mut self, order: usize, shift: &[f64; 3], from: &[Coefficient]) {
        regular(order, &shift.map(|s| [s]), &mut self.half);
        complete(order, &self.half, &mut self.shift);
        complete(order, from, &mut self.from);
    }
}

/// `sum` += (`a` + i `b`) f.
#[inline(always)]
fn add_product(sum: &mut Coefficient, a: f64, b: f64, f: &Coefficient) {
    for k in 0..POTENTIALS {
        sum[0][k] = a.mul_add(f[0][k], (-b).mul_add(f[1][k], sum[0][k]));
        sum[1][k] = a.mul_add(f[1][k], b.mul_add(f[0][k], sum[1][k]));
    }
}

kernel! {
    /// Adds the multipole expansion `child` about c + `shift` to the one about c: Mₙᵐ += Σ
    /// Υₖˡ(shift) Mₙ₋ₖᵐ⁻ˡ.
    fn raise(
        order: usize,
        shift: &[f64; 3],
        child: &[Coefficient],
        parent: &mut [Coefficient],
        tables: &mut ShiftTables,
    ) {
        tables.fill(order, shift, child);
        for n in 0..=order {
            for m in 0..=n {
                let mut sum = Coefficient::default();
                for k in 0..=n {
                    let rest = n - k;
                    let (k_, m_, rest_) = (k as isize, m as isize, rest as isize);
                    for l in (-k_).max(m_ - rest_)..=k_.min(m_ + rest_) {
                        let [[a], [b]] = tables.shift[whole(k, l)];
                        add_product(&mut sum, a, b, &tables.from[whole(rest, m_ - l)]);
                    }
                }
                // B₀ belongs to −(y − c)·f, and the shift increases y − c.
                add_coefficient(&sum, shift, -1.0, &mut parent[half(n, m)]);
            }
        }
    }
}

kernel! {
    /// Adds the local expansion `parent` about c to the one about c + `shift`: Fₙᵐ += Σ
    /// Υₖˡ*(shift) Fₙ₊ₖᵐ⁺ˡ.
    fn lower(
        order: usize,
        shift: &[f64; 3],
        parent: &[Coefficient],
        child: &mut [Coefficient],
        tables: &mut ShiftTables,
    ) {
        tables.fill(order, shift, parent);
        for n in 0..=order {
            for m in 0..=n {
                let mut sum = Coefficient::default();
                for k in 0..=order - n {
                    for l in -(k as isize)..=k as isize {
                        let [[a], [b]] = tables.shift[whole(k, l)];
                        add_product(&mut sum, a, -b, &tables.from[whole(n + k, m as isize + l)]);
                    }
                }
                add_coefficient(&sum, shift, 1.0, &mut child[half(n, m)]);
            }
        }
    }
}

/// Adds `f` to `to`, and `sign` `shift`·B also to its B₀.
#[inline(always)]
fn add_coefficient(f: &Coefficient, shift: &[f64; 3], sign: f64, to: &mut Coefficient) {
    for part in 0..2 {
        let [x, y, z, rest] = f[part];
        let along = shift[2].mul_add(z, shift[1].mul_add(y, shift[0] * x));
        to[part][0] += x;
        to[part][1] += y;
        to[part][2] += z;
        to[part][3] += sign.mul_add(along, rest);
    }
}

/// Scratch for [`act`]: multipole expansions of eight sources in lanes, and the factors of their
/// action.
pub(super) struct ActionTables {
    /// Displacements from the sources' centres to the target's.
    pub displacement: [Lanes; 3],
    /// Multipole expansions of the sources.
    pub multipoles: [Vec<Complex<LANES>>; POTENTIALS],
    /// Local expansion at the target, one lane per source.
    pub local: [Vec<Complex<LANES>>; POTENTIALS],
    irregular: Vec<Complex<LANES>>,
    /// Factors of the multipole expansion in one coefficient of the local expansion.
    row: Vec<Factors>,
}

/// Re Θ, Im Θ of [`act`] for a, then the same for b.
type Factors = [Lanes; 4];

impl ActionTables {
    /// Creates the scratch for expansions up to degree `order`.
    pub(crate) fn new(order: usize) -> Self {
        let table = || vec![Complex::default(); half_size(order)];
        Self {
            displacement: Default::default(),
            multipoles: std::array::from_fn(|_| table()),
            local: std::array::from_fn(|_| table()),
            irregular: vec![Default::default(); whole_size(order)],
            row: vec![Factors::default(); half_size(order)],
        }
    }
}

/// Floating-point operations of [`act`] for one source: eight per potential for each pair of (n, m) and
/// (k, l > 0).
pub(super) fn operations_of_action(order: usize) -> usize {
    let pairs = |n| (0..=order - n).sum::<usize>() * (n + 1);
    8 * POTENTIALS * (0..=order).map(pairs).sum::<usize>()
}

kernel! {
    /// Adds the action of eight sources to the local expansion of the target: Fₙᵐ += (−1)ⁿ Σ Mₖˡ*
    /// Θₙ₊ₖᵐ⁺ˡ(D), n + k ≤ order.
    ///
    /// With a + i b = Mₖˡ, l > 0, the terms of l and −l are a (Θ⁺ + Θ⁻) + i b (Θ⁻ − Θ⁺), where
    /// Θ⁺ = Θₙ₊ₖᵐ⁺ˡ and Θ⁻ = (−1)ˡ Θₙ₊ₖᵐ⁻ˡ.
    fn act(order: usize, tables: &mut ActionTables) {
        let ActionTables { displacement, multipoles, local, irregular: theta, row } = tables;
        irregular(order, displacement, theta);
        let [x, y, z, rest] = multipoles;
        for (((x, y), z), rest) in x.iter().zip(&*y).zip(&*z).zip(rest) {
            add_along(displacement, [x, y, z], rest);
        }
        for n in 0..=order {
            let parity = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
            let row = &mut row[..half_size(order - n)];
            for m in 0..=n {
                for k in 0..=order - n {
                    let centre = whole(n + k, m as isize);
                    row[half(k, 0)] = zonal(parity, &theta[centre]);
                    let mut sign = parity;
                    for l in 1..=k {
                        sign = -sign;
                        row[half(k, l)] =
                            tesseral(parity, &theta[centre + l], sign, &theta[centre - l]);
                    }
                }
                for (multipoles, local) in multipoles.iter().zip(&mut *local) {
                    add_row(row, multipoles, &mut local[half(n, m)]);
                }
            }
        }
    }
}

/// `rest` += D·B.
#[inline(always)]
fn add_along(
    displacement: &[Lanes; 3],
    potentials: [&Complex<LANES>; 3],
    rest: &mut Complex<LANES>,
) {
    for (displacement, potential) in displacement.iter().zip(potentials) {
        for part in 0..2 {
            for lane in 0..LANES {
                rest[part][lane] =
                    displacement[lane].mul_add(potential[part][lane], rest[part][lane]);
            }
        }
    }
}

/// The factors of Mₖ⁰, which is real.
#[inline(always)]
fn zonal(parity: f64, theta: &Complex<LANES>) -> Factors {
    let mut factors = Factors::default();
    for part in 0..2 {
        for lane in 0..LANES {
            factors[part][lane] = parity * theta[part][lane];
        }
    }
    factors
}

/// The factors of a and b, signs included.
#[inline(always)]
fn tesseral(
    plus_sign: f64,
    plus: &Complex<LANES>,
    minus_sign: f64,
    minus: &Complex<LANES>,
) -> Factors {
    let mut factors = Factors::default();
    for lane in 0..LANES {
        factors[0][lane] = minus_sign.mul_add(minus[0][lane], plus_sign * plus[0][lane]);
        factors[1][lane] = minus_sign.mul_add(minus[1][lane], plus_sign * plus[1][lane]);
        factors[2][lane] = plus_sign.mul_add(plus[1][lane], -minus_sign * minus[1][lane]);
        factors[3][lane] = minus_sign.mul_add(minus[0][lane], -plus_sign * plus[0][lane]);
    }
    factors
}

/// Computes `sum` += Σ a (first two factors) + b (last two factors).
#[inline(always)]
fn add_row(row: &[Factors], multipoles: &[Complex<LANES>], sum: &mut Complex<LANES>) {
    let mut sums = [[0.0; LANES]; 4];
    for (factors, [a, b]) in row.iter().zip(multipoles) {
        for part in 0..2 {
            for lane in 0..LANES {
                sums[part][lane] = a[lane].mul_add(factors[part][lane], sums[part][lane]);
            }
            for lane in 0..LANES {
                sums[2 + part][lane] =
                    b[lane].mul_add(factors[2 + part][lane], sums[2 + part][lane]);
            }
        }
    }
    for part in 0..2 {
        for lane in 0..LANES {
            sum[part][lane] += sums[part][lane] + sums[2 + part][lane];
        }
    }
}
