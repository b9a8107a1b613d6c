//! Jacobians of all copies, and the corrections computed from them.

use super::sweep::Piece;
use super::{Copies, NONE};
use crate::linalg::HALF_BANDWIDTH;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};
use crate::mechanics::rod::STRIDE;

/// Columns of a node.
type Columns = [[Lanes; HALF_BANDWIDTH + 1]; STRIDE];

impl Copies {
    /// Solves J d = −R at the last evaluation for the corrections d, which are 0 at held unknowns.
    /// A lane with a singular Jacobian gets NaN.
    ///
    /// Each column is filled and eliminated while it is in the cache.
    pub(crate) fn solve(&mut self) {
        let set = self.set;
        let sides = self.band.sides_mut().iter_mut().zip(self.residual.iter());
        for ((side, residual), held) in sides.zip(&self.held) {
            *side = match held {
                true => NONE,
                false => residual.map(|value| -value),
            };
        }
        self.rods.begin_hessians();
        let mut kept = [NONE; STRIDE];
        let mut chains = self.shared.iter().peekable();
        let mut links: &[Lanes] = &[];
        for piece in &self.sweep {
            match *piece {
                Piece::Begin(node) => {
                    let columns = self.band.columns_mut();
                    columns[STRIDE * node..][..STRIDE].fill([NONE; HALF_BANDWIDTH + 1]);
                }
                Piece::Vertex(vertex) => self.rods.add_vertex(vertex, self.band.columns_mut()),
                Piece::Edge(edge) => self.rods.add_edge(edge, self.band.columns_mut()),
                Piece::Node { node, holds } => {
                    let first = STRIDE * node;
                    if let Some(chain) = chains.next_if(|chain| chain.first_node == node) {
                        links = &chain.masses;
                    }
                    let (link, rest) = links.split_at(STRIDE.min(links.len()));
                    links = rest;
                    let columns = self.band.columns_mut()[first..].first_chunk_mut();
                    let columns = columns.expect("those of a node");
                    let steps = [&self.per_acceleration_step, &self.per_step];
                    add_masses(set, steps, &self.masses[first..], link, &mut kept, columns);
                    if let Some(drag) = self.drag.get(first..first + STRIDE) {
                        add_resistance(set, &self.per_step, drag, columns);
                    }
                    if holds {
                        hold(&self.held[first..], columns);
                    }
                    self.band.eliminate(set, first, STRIDE);
                }
            }
        }
        self.band.substitute_back(set);
    }
}

/// Eliminates held unknowns: their rows and columns become zero, their diagonals one.
fn hold(held: &[bool], columns: &mut Columns) {
    for (j, column) in columns.iter_mut().enumerate() {
        if held[j] {
            *column = [NONE; HALF_BANDWIDTH + 1];
            column[0] = [1.0; LANES];
            continue;
        }
        for (entry, held) in column.iter_mut().zip(&held[j..]) {
            if *held {
                *entry = NONE;
            }
        }
    }
}

kernel! {
    /// Adds M/(hₐ h) for the lumped mass of a node and for the mass that it shares with the next
    /// node, if there is a `link`; `steps` are 1/hₐ and 1/h. `kept` is the value retained for the
    /// previous node, so that rows still sum to the lumped masses (`Assembly::add_shared_masses`).
    fn add_masses(
        steps: [&Lanes; 2],
        masses: &[Lanes],
        link: &[Lanes],
        kept: &mut [Lanes; STRIDE],
        columns: &mut Columns,
    ) {
        for (k, column) in columns.iter_mut().enumerate() {
            for lane in 0..LANES {
                column[0][lane] += masses[k][lane] * steps[0][lane] * steps[1][lane];
            }
            let Some(shared) = link.get(k) else {
                for lane in 0..LANES {
                    column[0][lane] -= kept[k][lane];
                    kept[k][lane] = 0.0;
                }
                continue;
            };
            for lane in 0..LANES {
                let mass = steps[0][lane] * steps[1][lane] * shared[lane];
                let sum = column[STRIDE][lane] + mass;
                let own = sum - column[STRIDE][lane];
                column[STRIDE][lane] = sum;
                column[0][lane] -= kept[k][lane] + own;
                kept[k][lane] = own;
            }
        }
    }
}

kernel! {
    /// Adds C/h.
    fn add_resistance(per_step: &Lanes, coefficients: &[Lanes], columns: &mut Columns) {
        for (column, coefficient) in columns.iter_mut().zip(coefficients) {
            for lane in 0..LANES {
                column[0][lane] += coefficient[lane] * per_step[lane];
            }
        }
    }
}
