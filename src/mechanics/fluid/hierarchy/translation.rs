//! Moving expansions from one centre to another.
//!
//! The potentials of an expansion are three B (of the components of the force) and a scalar B₀ that goes
//! with a centre c, such that the flow derives from (x − c)·B + B₀ ([module](super)). A new centre c + s
//! therefore adds s·B to B₀.

use super::super::instruction_set::{LANES, Lanes, kernel};
use super::harmonics::{Complex, complete, half, half_size, irregular, regular, whole, whole_size};

/// Number of potentials.
pub(super) const POTENTIALS: usize = 4;

/// A coefficient of all four potentials.
pub(super) type Coefficient = Complex<POTENTIALS>;

/// Scratch for [`raise`] and [`lower`].
pub(super) struct ShiftTables {
    half: Vec<Complex<1>>,
    shift: Vec<Complex<1>>,
    from: Vec<Coefficient>,
}

impl ShiftTables {
    /// For expansions up to degree `order`.
    pub fn new(order: usize) -> Self {
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
    /// Adds the multipole expansion `child` about c + `shift` to that about c:
    /// Mₙᵐ += Σ Υₖˡ(shift) Mₙ₋ₖᵐ⁻ˡ.
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
                // B₀ belongs to −(y − c)·f, and y − c is longer by the shift.
                add_coefficient(&sum, shift, -1.0, &mut parent[half(n, m)]);
            }
        }
    }
}

kernel! {
    /// Adds the local expansion `parent` about c to that about c + `shift`:
    /// Fₙᵐ += Σ Υₖˡ*(shift) Fₙ₊ₖᵐ⁺ˡ.
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

/// `to` += `f`, and to B₀ also `sign` `shift`·B.
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

/// Scratch for [`act`]: eight multipole expansions in lanes, by coefficient and potential, and what they
/// act with.
pub(super) struct ActionTables {
    /// Displacements from the sources' centres to the target's.
    pub displacement: [Lanes; 3],
    /// Multipole expansions of the sources.
    pub multipoles: Vec<[Complex<LANES>; POTENTIALS]>,
    /// Local expansion at the target, by sources.
    pub local: Vec<[Complex<LANES>; POTENTIALS]>,
    irregular: Vec<Complex<LANES>>,
}

impl ActionTables {
    /// For expansions up to degree `order`.
    pub fn new(order: usize) -> Self {
        Self {
            displacement: Default::default(),
            multipoles: vec![Default::default(); half_size(order)],
            local: vec![Default::default(); half_size(order)],
            irregular: vec![Default::default(); whole_size(order)],
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
    /// Adds what eight sources do at the target to its local expansion:
    /// Fₙᵐ += (−1)ⁿ Σ Mₖˡ* Θₙ₊ₖᵐ⁺ˡ(D), n + k ≤ order.
    ///
    /// With a + i b = Mₖˡ, l > 0, the terms of l and −l are a (Θ⁺ + Θ⁻) + i b (Θ⁻ − Θ⁺), where
    /// Θ⁺ = Θₙ₊ₖᵐ⁺ˡ and Θ⁻ = (−1)ˡ Θₙ₊ₖᵐ⁻ˡ.
    fn act(order: usize, tables: &mut ActionTables) {
        let ActionTables { displacement, multipoles, local, irregular: theta } = tables;
        irregular(order, displacement, theta);
        for coefficient in multipoles.iter_mut() {
            let [x, y, z, rest] = coefficient;
            for part in 0..2 {
                for lane in 0..LANES {
                    rest[part][lane] = displacement[2][lane].mul_add(
                        z[part][lane],
                        displacement[1][lane].mul_add(
                            y[part][lane],
                            displacement[0][lane].mul_add(x[part][lane], rest[part][lane]),
                        ),
                    );
                }
            }
        }
        for n in 0..=order {
            for m in 0..=n {
                let mut sums = [[[0.0; LANES]; 2]; POTENTIALS];
                for k in 0..=order - n {
                    let row = whole(n + k, m as isize);
                    add_zonal(&multipoles[half(k, 0)], &theta[row], &mut sums);
                    let mut sign = 1.0;
                    for l in 1..=k {
                        sign = -sign;
                        let [plus, minus] = [&theta[row + l], &theta[row - l]];
                        add_tesseral(&multipoles[half(k, l)], plus, minus, sign, &mut sums);
                    }
                }
                let parity = if n % 2 == 0 { 1.0 } else { -1.0 };
                for (sum, local) in sums.iter().zip(&mut local[half(n, m)]) {
                    for part in 0..2 {
                        for lane in 0..LANES {
                            local[part][lane] = sum[part][lane].mul_add(parity, local[part][lane]);
                        }
                    }
                }
            }
        }
    }
}

/// `sums` += Mₖ⁰ Θ; Mₖ⁰ is real.
#[inline(always)]
fn add_zonal(
    multipole: &[Complex<LANES>; POTENTIALS],
    theta: &Complex<LANES>,
    sums: &mut [Complex<LANES>; POTENTIALS],
) {
    for (sum, [a, _]) in sums.iter_mut().zip(multipole) {
        for lane in 0..LANES {
            sum[0][lane] = a[lane].mul_add(theta[0][lane], sum[0][lane]);
        }
        for lane in 0..LANES {
            sum[1][lane] = a[lane].mul_add(theta[1][lane], sum[1][lane]);
        }
    }
}

/// `sums` += a (Θ⁺ + Θ⁻) + i b (Θ⁻ − Θ⁺), `sign` being what `minus` lacks.
#[inline(always)]
fn add_tesseral(
    multipole: &[Complex<LANES>; POTENTIALS],
    plus: &Complex<LANES>,
    minus: &Complex<LANES>,
    sign: f64,
    sums: &mut [Complex<LANES>; POTENTIALS],
) {
    let mut even = [[0.0; LANES]; 2];
    let mut odd = [[0.0; LANES]; 2];
    for part in 0..2 {
        for lane in 0..LANES {
            even[part][lane] = sign.mul_add(minus[part][lane], plus[part][lane]);
            odd[part][lane] = sign.mul_add(minus[part][lane], -plus[part][lane]);
        }
    }
    for (sum, [a, b]) in sums.iter_mut().zip(multipole) {
        for lane in 0..LANES {
            let real = (-b[lane]).mul_add(odd[1][lane], sum[0][lane]);
            sum[0][lane] = a[lane].mul_add(even[0][lane], real);
        }
        for lane in 0..LANES {
            let imaginary = b[lane].mul_add(odd[0][lane], sum[1][lane]);
            sum[1][lane] = a[lane].mul_add(even[1][lane], imaginary);
        }
    }
}
