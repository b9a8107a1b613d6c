//! From the local expansion of a leaf to the flow at its nodes.

use super::super::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use super::harmonics::{Complex, half, half_size, regular};
use super::translation::{Coefficient, POTENTIALS};
use crate::mechanics::Vector3;

/// Functions whose values give the flow: three B, then the gradients of B and B₀, component by component.
const FUNCTIONS: usize = 3 + 3 * POTENTIALS;

/// The nodes of a leaf, relative to the centre of its expansion.
#[derive(Default)]
pub(super) struct Targets {
    nodes: usize,
    offsets: Vec<[Lanes; 3]>,
}

/// Scratch for [`Targets::evaluate`].
pub(super) struct TargetTables {
    regular: Vec<Complex<LANES>>,
    /// Factors of Re Υ and Im Υ in each function.
    factors: Vec<Complex<FUNCTIONS>>,
}

impl TargetTables {
    /// For expansions up to degree `order`.
    pub fn new(order: usize) -> Self {
        Self {
            regular: vec![Default::default(); half_size(order)],
            factors: vec![[[0.0; FUNCTIONS]; 2]; half_size(order)],
        }
    }
}

impl Targets {
    /// Takes over the nodes.
    pub fn place(&mut self, positions: &[Vector3], nodes: &[usize], centre: &Vector3) {
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
    pub fn count(&self) -> usize {
        self.nodes
    }

    /// Sets `velocities` to the flow of the local expansion.
    pub fn evaluate(
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

/// Factors of Re Υₙᵐ and Im Υₙᵐ, m ≥ 0, in the real functions Σ Υₙᵐ* Fₙᵐ over all m; for gradients
/// Fₙ₊₁ᵐ takes the place of Fₙᵐ for ∂_z and −Fₙ₊₁ᵐ⁺¹ for ∂_x + i ∂_y.
fn find_factors(order: usize, local: &[Coefficient], factors: &mut [Complex<FUNCTIONS>]) {
    for n in 0..=order {
        for m in 0..=n {
            let weight = if m == 0 { 1.0 } else { 2.0 };
            let factor = &mut factors[half(n, m)];
            for k in 0..3 {
                factor[0][k] = weight * local[half(n, m)][0][k];
                factor[1][k] = weight * local[half(n, m)][1][k];
            }
            for k in 0..POTENTIALS {
                let mut set = |direction: usize, real: f64, imaginary: f64| {
                    factor[0][3 + 3 * k + direction] = real;
                    factor[1][3 + 3 * k + direction] = imaginary;
                };
                if n == order {
                    (0..3).for_each(|direction| set(direction, 0.0, 0.0));
                    continue;
                }
                let at = |m: usize| local[half(n + 1, m)].map(|part| part[k]);
                let [up_re, up_im] = at(m + 1);
                // The terms of m and −m together; Fₙ₊₁¹⁻ᵐ belongs to the latter.
                let [low_re, low_im] = if m > 0 { at(m - 1) } else { [0.0; 2] };
                set(0, low_re - up_re, low_im - up_im);
                set(1, -(up_im + low_im), up_re + low_re);
                let [re, im] = at(m);
                set(2, weight * re, weight * im);
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
        factors: &[Complex<FUNCTIONS>],
    ) -> [Lanes; 3] {
        regular(order, offset, table);
        let mut values = [[0.0; LANES]; FUNCTIONS];
        for (harmonic, factor) in table.iter().zip(factors) {
            for part in 0..2 {
                for (value, &factor) in values.iter_mut().zip(&factor[part]) {
                    for lane in 0..LANES {
                        value[lane] = factor.mul_add(harmonic[part][lane], value[lane]);
                    }
                }
            }
        }
        let mut flow = [[0.0; LANES]; 3];
        for direction in 0..3 {
            for lane in 0..LANES {
                let mut u = values[direction][lane] - values[3 + 9 + direction][lane];
                for k in 0..3 {
                    u = (-offset[k][lane]).mul_add(values[3 + 3 * k + direction][lane], u);
                }
                flow[direction][lane] = u;
            }
        }
        flow
    }
}
