//! From the local expansion of a leaf to the flow at its nodes.

use super::harmonics::{Complex, half, half_size, regular};
use super::translation::{Coefficient, POTENTIALS};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::mechanics::Vector3;

/// Functions are evaluated three at a time: first the three B, then the gradient of each of them
/// and of B₀.
const GROUPS: usize = 1 + POTENTIALS;

/// The nodes of a leaf, relative to the centre of its expansion.
#[derive(Default)]
pub(super) struct Targets {
    nodes: usize,
    offsets: Vec<[Lanes; 3]>,
}

/// Scratch for [`Targets::evaluate`].
pub(super) struct TargetTables {
    regular: Vec<Complex<LANES>>,
    /// Factors of Re Υ and Im Υ in the functions of each group.
    factors: [Vec<Complex<3>>; GROUPS],
}

impl TargetTables {
    /// Creates the scratch for expansions up to degree `order`.
    pub(crate) fn new(order: usize) -> Self {
        Self {
            regular: vec![Default::default(); half_size(order)],
            factors: std::array::from_fn(|_| vec![Default::default(); half_size(order)]),
        }
    }
}

impl Targets {
    /// Takes over the nodes.
    pub(crate) fn place(&mut self, positions: &[Vector3], nodes: &[usize], centre: &Vector3) {
        self.nodes = nodes.len();
        self.offsets.clear();
        self.offsets
            .resize(nodes.len().div_ceil(LANES), Default::default());
        for (index, &node) in nodes.iter().enumerate() {
            for k in 0..3 {
                self.offsets[index / LANES][k][index % LANES] = positions[node][k] - centre[k];
            }
        }
    }

    /// Number of nodes.
    pub(crate) fn count(&self) -> usize {
        self.nodes
    }

    /// Sets `velocities` to the flow of the local expansion.
    pub(crate) fn evaluate(
        &self,
        set: InstructionSet,
        order: usize,
        local: &[Coefficient],
        tables: &mut TargetTables,
        velocities: &mut [[f64; 3]],
    ) {
        find_factors(order, local, &mut tables.factors);
        for (offset, velocities) in self.offsets.iter().zip(velocities.chunks_mut(LANES)) {
            let flow = flow(set, order, offset, &mut tables.regular, &tables.factors);
            for (lane, velocity) in velocities.iter_mut().enumerate() {
                *velocity = flow.map(|component| component[lane]);
            }
        }
    }
}

/// Factors of Re Υₙᵐ and Im Υₙᵐ, m ≥ 0, in the real functions Σ Υₙᵐ* Fₙᵐ over all m. For
/// gradients, Fₙᵐ is replaced by Fₙ₊₁ᵐ for ∂_z and by −Fₙ₊₁ᵐ⁺¹ for ∂_x + i ∂_y.
fn find_factors(order: usize, local: &[Coefficient], factors: &mut [Vec<Complex<3>>; GROUPS]) {
    let [values, gradients @ ..] = factors;
    for n in 0..=order {
        for m in 0..=n {
            let here = half(n, m);
            let weight = if m == 0 { 1.0 } else { 2.0 };
            values[here] = local[here].map(|[x, y, z, _]| [x, y, z].map(|b| weight * b));
            for (k, gradient) in gradients.iter_mut().enumerate() {
                if n == order {
                    gradient[here] = [[0.0; 3]; 2];
                    continue;
                }
                let above = |m: usize| local[half(n + 1, m)].map(|part| part[k]);
                let [re, im] = above(m);
                let [up_re, up_im] = above(m + 1);
                // The terms of m and −m together; Fₙ₊₁¹⁻ᵐ belongs to the latter.
                let [low_re, low_im] = if m > 0 { above(m - 1) } else { [0.0; 2] };
                gradient[here] = [
                    [low_re - up_re, -(up_im + low_im), weight * re],
                    [low_im - up_im, up_re + low_re, weight * im],
                ];
            }
        }
    }
}

kernel! {
    /// The flow 8πη u = B − Σ bₖ ∇Bₖ − ∇B₀ at eight offsets b.
    fn flow(
        order: usize,
        offset: &[Lanes; 3],
        table: &mut [Complex<LANES>],
        factors: &[Vec<Complex<3>>; GROUPS],
    ) -> [Lanes; 3] {
        regular(order, offset, table);
        let [values, gradients @ .., rest] = factors;
        let mut flow = sum(table, values);
        for (offset, gradient) in offset.iter().zip(gradients) {
            let gradient = sum(table, gradient);
            for direction in 0..3 {
                for lane in 0..LANES {
                    flow[direction][lane] =
                        (-offset[lane]).mul_add(gradient[direction][lane], flow[direction][lane]);
                }
            }
        }
        let rest = sum(table, rest);
        for direction in 0..3 {
            for lane in 0..LANES {
                flow[direction][lane] -= rest[direction][lane];
            }
        }
        flow
    }
}

/// Evaluates three functions: sums of the real and imaginary parts in the table, times their
/// factors.
#[inline(always)]
fn sum(table: &[Complex<LANES>], factors: &[Complex<3>]) -> [Lanes; 3] {
    let mut sums = [[0.0; LANES]; 3];
    for ([real, imaginary], factor) in table.iter().zip(factors) {
        for k in 0..3 {
            for lane in 0..LANES {
                let sum = factor[0][k].mul_add(real[lane], sums[k][lane]);
                sums[k][lane] = factor[1][k].mul_add(imaginary[lane], sum);
            }
        }
    }
    sums
}
