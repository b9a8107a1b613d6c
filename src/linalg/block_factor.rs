//! Sparse elimination node by node: A = 𝓛 𝓤 with 4×4 blocks, 𝓛 with unit diagonal.
//!
//! Column k receives L_a U_k from every earlier column with a block in row k, then its blocks below the
//! diagonal are divided by the diagonal block, L_a = A_ak D⁻¹ (left-looking elimination; Golub & Van
//! Loan, 4th ed., sec. 3.2.11). The diagonal blocks are factored with partial pivoting inside the block
//! only, so the pattern is known beforehand; what that may cost in accuracy, the residual check of
//! [`super::CoupledSystem::solve`] finds. A symmetric matrix has U_b = A_bkᵀ at hand and needs half the
//! updates.

use super::error::{Inertia, SingularMatrix};
use super::instruction_set::{InstructionSet, kernel};
use super::node_block::{Block, DiagonalFactor, NODE, NodeVector, symmetric_pivots};
use super::symbolic::SymbolicFactor;

/// Numeric factors in the pattern of a [`SymbolicFactor`].
#[derive(Clone, Debug)]
pub(super) struct BlockFactor {
    symbolic: SymbolicFactor,
    symmetric: bool,
    /// Diagonal blocks as the elimination finds them.
    pivots: Vec<Block>,
    /// The same, factored.
    diagonal: Vec<DiagonalFactor>,
    /// Blocks of 𝓛 below the diagonal; before their column's turn, those of the reduced matrix.
    lower: Vec<Block>,
    /// Blocks of 𝓤 right of the diagonal, transposed, so that they share the lower blocks' places.
    upper: Vec<Block>,
    /// Block of the column at work in each row; scratch.
    place_of_row: Vec<u32>,
    /// A right-hand side in the order of elimination.
    vector: Vec<NodeVector>,
}

impl BlockFactor {
    pub(super) fn new(symbolic: SymbolicFactor, symmetric: bool) -> Self {
        let (nodes, blocks) = (symbolic.order.len(), symbolic.rows.len());
        Self {
            symbolic,
            symmetric,
            pivots: vec![Block::ZERO; nodes],
            diagonal: vec![DiagonalFactor::EMPTY; nodes],
            lower: vec![Block::ZERO; blocks],
            upper: vec![Block::ZERO; blocks],
            place_of_row: vec![0; nodes],
            vector: vec![[0.0; NODE]; nodes],
        }
    }

    /// Number of blocks below the diagonal.
    pub(super) fn blocks(&self) -> usize {
        self.lower.len()
    }

    /// Factors the matrix given by its diagonal blocks (node by node) and the blocks of the node graph's
    /// pairs below the diagonal and right of it (the latter transposed; not read if symmetric).
    pub(super) fn factor(
        &mut self,
        diagonal: &[Block],
        lower: &[Block],
        upper: &[Block],
    ) -> Result<Inertia, SingularMatrix> {
        self.load(diagonal, lower, upper);
        eliminate_blocks(InstructionSet::best_of_width(NODE), self)
    }

    #[inline(always)]
    fn eliminate(&mut self) -> Result<Inertia, SingularMatrix> {
        let mut inertia = Inertia::EMPTY;
        for k in 0..self.symbolic.order.len() {
            self.update_column(k);
            self.factor_pivot(k, &mut inertia)?;
            self.divide_column(k);
        }
        Ok(inertia)
    }

    fn load(&mut self, diagonal: &[Block], lower: &[Block], upper: &[Block]) {
        for (pivot, &node) in self.pivots.iter_mut().zip(&self.symbolic.order) {
            *pivot = diagonal[node];
        }
        self.lower.fill(Block::ZERO);
        if !self.symmetric {
            self.upper.fill(Block::ZERO);
        }
        for (pair, &(place, transposed)) in self.symbolic.places.iter().enumerate() {
            let place = place as usize;
            if self.symmetric {
                self.lower[place] = if transposed {
                    lower[pair].transposed()
                } else {
                    lower[pair]
                };
            } else if transposed {
                self.lower[place] = upper[pair].transposed();
                self.upper[place] = lower[pair].transposed();
            } else {
                self.lower[place] = lower[pair];
                self.upper[place] = upper[pair];
            }
        }
    }

    #[inline(always)]
    fn factor_pivot(&mut self, k: usize, inertia: &mut Inertia) -> Result<(), SingularMatrix> {
        let node = self.symbolic.order[k];
        if self.symmetric {
            // Rounding makes the two triangles differ, while the blocks beside this one are held once only. Left in,
            // the difference E would pass on to later pivots as L E Lᵀ, which grows from node to node of a chain.
            self.pivots[k].mirror_lower_triangle();
            for (row, &pivot) in symmetric_pivots(&self.pivots[k]).iter().enumerate() {
                inertia.count(pivot, NODE * node + row)?;
            }
        }
        self.diagonal[k] =
            DiagonalFactor::new(&self.pivots[k]).map_err(|(row, pivot)| SingularMatrix {
                unknown: NODE * node + row,
                pivot,
            })?;
        Ok(())
    }

    /// Subtracts from column k what the columns before it owe: L_a U_k of every column with a block in row k.
    #[inline(always)]
    fn update_column(&mut self, k: usize) {
        let symbolic = &self.symbolic;
        let column = symbolic.column(k);
        for place in column.clone() {
            self.place_of_row[symbolic.rows[place] as usize] = place as u32;
        }
        // Columns before k lie before it in storage.
        let (lower_before, lower) = self.lower.split_at_mut(column.start);
        let (upper_before, upper) = self.upper.split_at_mut(column.start);
        for source in symbolic.row(k) {
            let (b, end) = (source.block as usize, source.end as usize);
            let (lower_b, upper_b) = (lower_before[b], upper_before[b]);
            self.pivots[k].subtract_product(&lower_b, &upper_b);
            for a in b + 1..end {
                let row = symbolic.rows[a] as usize;
                let place = self.place_of_row[row] as usize - column.start;
                lower[place].subtract_product(&lower_before[a], &upper_b);
                if !self.symmetric {
                    upper[place].subtract_product(&upper_before[a], &lower_b);
                }
            }
        }
    }

    /// Turns the reduced column k into that of 𝓛.
    #[inline(always)]
    fn divide_column(&mut self, k: usize) {
        for place in self.symbolic.column(k) {
            if self.symmetric {
                self.upper[place] = self.lower[place];
            }
            self.lower[place] = self.diagonal[k].divide(&self.lower[place]);
        }
    }

    /// Solves A x = b in place.
    pub(super) fn solve(&mut self, x: &mut [NodeVector]) {
        let Self {
            symbolic, vector, ..
        } = self;
        for (own, &node) in vector.iter_mut().zip(&symbolic.order) {
            *own = x[node];
        }
        for k in 0..vector.len() {
            let own = vector[k];
            for place in symbolic.column(k) {
                let row = symbolic.rows[place] as usize;
                self.lower[place].subtract_from(&own, &mut vector[row]);
            }
        }
        for k in (0..vector.len()).rev() {
            let mut own = vector[k];
            for place in symbolic.column(k) {
                let row = symbolic.rows[place] as usize;
                self.upper[place].subtract_transposed_from(&vector[row], &mut own);
            }
            vector[k] = self.diagonal[k].solve(&own);
        }
        for (own, &node) in vector.iter().zip(&symbolic.order) {
            x[node] = *own;
        }
    }
}

kernel! {
    /// Factors the loaded blocks.
    fn eliminate_blocks(factor: &mut BlockFactor) -> Result<Inertia, SingularMatrix> {
        factor.eliminate()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::node_graph::{BandPattern, NodeGraph};

    #[test]
    fn wide_registers_change_no_byte() {
        let nodes = 40;
        let elements = [3, 11, 20, 30]
            .map(|far| std::array::from_fn(|k| NODE * [0, 1, far, far + 1][k / 3] + k % 3));
        let band = BandPattern {
            owners: (0..NODE * nodes).collect(),
            held: vec![false; NODE * nodes],
            chains: Vec::new(),
        };
        let graph = NodeGraph::new(&elements, &band);
        let block = |seed: usize, diagonal: f64| {
            let mut block = Block(std::array::from_fn(|i| ((7 * seed + i) as f64).sin()));
            (0..NODE).for_each(|k| block.0[NODE * k + k] += diagonal);
            block
        };
        let diagonal: Vec<Block> = (0..nodes).map(|k| block(k, 30.0)).collect();
        let lower: Vec<Block> = (0..graph.pairs().len()).map(|k| block(k, 0.0)).collect();
        let upper: Vec<Block> = (0..graph.pairs().len())
            .map(|k| block(3 * k, 0.0))
            .collect();
        for symmetric in [true, false] {
            let mut dispatched = BlockFactor::new(SymbolicFactor::new(&graph), symmetric);
            let mut portable = dispatched.clone();
            dispatched.factor(&diagonal, &lower, &upper).unwrap();
            portable.load(&diagonal, &lower, &upper);
            portable.eliminate().unwrap();
            assert_eq!(dispatched.lower, portable.lower);
            assert_eq!(dispatched.upper, portable.upper);
            assert_eq!(dispatched.pivots, portable.pivots);
        }
    }
}
