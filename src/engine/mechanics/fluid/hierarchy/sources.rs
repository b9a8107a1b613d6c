//! From force densities to the multipole expansion of a leaf.

use super::super::chain::{Link, Slot, lay_out};
use super::harmonics::{Complex, half, half_size, regular};
use super::translation::{Coefficient, POTENTIALS};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::mechanics::Vector3;

/// Gauss points of a segment.
const GAUSS: usize = 2;

/// Point forces that represent the linear densities on the segments of some nodes.
#[derive(Default)]
pub(super) struct Sources {
    slots: Vec<Slot>,
    points: Vec<Point>,
    lanes: Vec<PointLanes>,
}

/// A Gauss point; its force follows from the densities at the two ends of the segment.
struct Point {
    nodes: [usize; 2],
    /// Weights, as lengths in m; zero for an end that is not among the nodes.
    weights: [f64; 2],
}

/// Eight Gauss points.
#[derive(Clone, Default)]
pub(super) struct PointLanes {
    /// Offset from the centre of the expansion, m.
    offset: [Lanes; 3],
    regularization_squared: Lanes,
    forces: [Lanes; 3],
}

/// Scratch for [`Sources::expand`].
pub(super) struct SourceTables {
    regular: Vec<Complex<LANES>>,
    multipoles: Vec<[Complex<LANES>; POTENTIALS]>,
}

impl SourceTables {
    /// Creates the scratch for expansions up to degree `order`.
    pub(crate) fn new(order: usize) -> Self {
        Self {
            regular: vec![Default::default(); half_size(order)],
            multipoles: vec![Default::default(); half_size(order)],
        }
    }
}

impl Sources {
    /// Finds the Gauss points of the segments that end at the nodes (in ascending order).
    pub(crate) fn place(
        &mut self,
        links: &[Link],
        positions: &[Vector3],
        nodes: &[usize],
        centre: &Vector3,
    ) {
        lay_out(links, nodes, &mut self.slots);
        self.points.clear();
        self.lanes.clear();
        for pair in self.slots.windows(2).filter(|pair| pair[0].joined) {
            let [start, end] = [pair[0].node, pair[1].node].map(|node| positions[node]);
            let length = (end - start).norm();
            for gauss in 0..GAUSS {
                let side = if gauss == 0 { -1.0 } else { 1.0 };
                let place = 0.5 + side * 0.5 / 3f64.sqrt();
                let share = |slot: &Slot, hat: f64| {
                    if slot.own {
                        hat * length / GAUSS as f64
                    } else {
                        0.0
                    }
                };
                let (chunk, lane) = (self.points.len() / LANES, self.points.len() % LANES);
                if lane == 0 {
                    self.lanes.push(PointLanes::default());
                }
                let lanes = &mut self.lanes[chunk];
                let offset = start + (end - start) * place - centre;
                for k in 0..3 {
                    lanes.offset[k][lane] = offset[k];
                }
                lanes.regularization_squared[lane] = links[pair[0].node].regularization_squared;
                self.points.push(Point {
                    nodes: [pair[0].node, pair[1].node],
                    weights: [share(&pair[0], 1.0 - place), share(&pair[1], place)],
                });
            }
        }
    }

    /// Sets `multipoles` to the expansion of these densities, which have three numbers per node.
    pub(crate) fn expand(
        &mut self,
        set: InstructionSet,
        order: usize,
        densities: &[f64],
        tables: &mut SourceTables,
        multipoles: &mut [Coefficient],
    ) {
        for (index, point) in self.points.iter().enumerate() {
            let forces = &mut self.lanes[index / LANES].forces;
            for k in 0..3 {
                let [f, g] = point.nodes.map(|node| densities[3 * node + k]);
                forces[k][index % LANES] = point.weights[0] * f + point.weights[1] * g;
            }
        }
        tables.multipoles.fill(Default::default());
        for lanes in &self.lanes {
            expand(
                set,
                order,
                lanes,
                &mut tables.regular,
                &mut tables.multipoles,
            );
        }
        for (sum, lanes) in multipoles.iter_mut().zip(&tables.multipoles) {
            for part in 0..2 {
                for k in 0..POTENTIALS {
                    sum[part][k] = lanes[k][part].iter().sum();
                }
            }
        }
    }
}

kernel! {
    /// Adds Σ f Υₙᵐ(a) of eight point forces f at offsets a to the moments of B, and to those of B₀
    /// −Σ (a·f) Υₙᵐ(a) − Σ ε²/2 (f·∇) Υₙᵐ(a).
    fn expand(
        order: usize,
        points: &PointLanes,
        table: &mut [Complex<LANES>],
        moments: &mut [[Complex<LANES>; POTENTIALS]],
    ) {
        let PointLanes { offset, regularization_squared, forces } = points;
        regular(order, offset, table);
        let mut along = [0.0; LANES];
        let mut blob = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            along[lane] = -offset[2][lane].mul_add(
                forces[2][lane],
                offset[1][lane].mul_add(forces[1][lane], offset[0][lane] * forces[0][lane]),
            );
            let half_square = 0.5 * regularization_squared[lane];
            for k in 0..3 {
                blob[k][lane] = -half_square * forces[k][lane];
            }
        }
        for n in 0..=order {
            for m in 0..=n {
                let value = &table[half(n, m)];
                let gradient = gradient(n, m, table);
                let moment = &mut moments[half(n, m)];
                for part in 0..2 {
                    for k in 0..3 {
                        for lane in 0..LANES {
                            let sum = &mut moment[k][part][lane];
                            *sum = forces[k][lane].mul_add(value[part][lane], *sum);
                        }
                    }
                    for lane in 0..LANES {
                        let sum = &mut moment[3][part][lane];
                        let mut value = along[lane].mul_add(value[part][lane], *sum);
                        for k in 0..3 {
                            value = blob[k][lane].mul_add(gradient[k][part][lane], value);
                        }
                        *sum = value;
                    }
                }
            }
        }
    }
}

/// ∇Υₙᵐ from the table of all Υ.
#[inline(always)]
fn gradient(n: usize, m: usize, table: &[Complex<LANES>]) -> [Complex<LANES>; 3] {
    let mut gradient = [[[0.0; LANES]; 2]; 3];
    if n == 0 {
        return gradient;
    }
    let zero = [[0.0; LANES]; 2];
    let same = if m < n { &table[half(n - 1, m)] } else { &zero };
    let upper = if m + 1 < n {
        &table[half(n - 1, m + 1)]
    } else {
        &zero
    };
    // Υₙ₋₁ᵐ⁻¹; for m = 0 it is −Υₙ₋₁¹*, which is `upper`.
    let (lower, signs) = if m > 0 {
        (&table[half(n - 1, m - 1)], [1.0, 1.0])
    } else {
        (upper, [-1.0, 1.0])
    };
    for lane in 0..LANES {
        let [up_re, up_im] = [upper[0][lane], upper[1][lane]];
        let [low_re, low_im] = [signs[0] * lower[0][lane], signs[1] * lower[1][lane]];
        // ∂_x = (Υᵐ⁺¹ − Υᵐ⁻¹)/2, ∂_y = (Υᵐ⁺¹ + Υᵐ⁻¹)/(2i).
        gradient[0][0][lane] = 0.5 * (up_re - low_re);
        gradient[0][1][lane] = 0.5 * (up_im - low_im);
        gradient[1][0][lane] = 0.5 * (up_im + low_im);
        gradient[1][1][lane] = -0.5 * (up_re + low_re);
        gradient[2][0][lane] = same[0][lane];
        gradient[2][1][lane] = same[1][lane];
    }
    gradient
}
