//! Sparse elimination node by node: A = 𝓛 𝓤 with 4×4 blocks, 𝓛 with unit diagonal.
//!
//! Column k divides its blocks below the diagonal by the diagonal block, L_a = A_ak D⁻¹, and subtracts
//! L_a U_b from every block (a, b) of the rows that it reaches (right-looking elimination; Golub & Van
//! Loan, 4th ed., sec. 3.2.11). The diagonal blocks are factored with partial pivoting inside the block
//! only, so the pattern is known beforehand; what that may cost in accuracy, the residual check of
//! [`super::CoupledSystem::solve`] finds. A symmetric matrix has U_b = A_bkᵀ at hand and needs half the
//! updates.

use super::error::{Inertia, SingularMatrix};
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
        let mut inertia = Inertia::EMPTY;
        let mut first_target = 0;
        for k in 0..self.symbolic.order.len() {
            self.factor_pivot(k, &mut inertia)?;
            first_target = self.eliminate(k, first_target);
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
                self.lower[place] = if transposed { lower[pair].transposed() } else { lower[pair] };
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
            for (row, &pivot) in symmetric_pivots(&self.pivots[k]).iter().enumerate() {
                inertia.count(pivot, NODE * node + row)?;
            }
        }
        self.diagonal[k] = DiagonalFactor::new(&self.pivots[k])
            .map_err(|(row, pivot)| SingularMatrix { unknown: NODE * node + row, pivot })?;
        Ok(())
    }

    /// Eliminates column k; its updates go to the targets from `target` on. Returns where those of the
    /// next column begin.
    #[inline(always)]
    fn eliminate(&mut self, k: usize, mut target: usize) -> usize {
        let column = self.symbolic.column(k);
        for place in column.clone() {
            if self.symmetric {
                self.upper[place] = self.lower[place];
            }
            self.lower[place] = self.diagonal[k].divide(&self.lower[place]);
        }
        for b in column.clone() {
            let (lower_b, upper_b) = (self.lower[b], self.upper[b]);
            let pivot = &mut self.pivots[self.symbolic.rows[b] as usize];
            pivot.subtract_product(&lower_b, &upper_b);
            let count = column.end - b - 1;
            let targets = &self.symbolic.targets[target..target + count];
            for (a, &block) in (b + 1..column.end).zip(targets) {
                let block = block as usize;
                let (lower_a, upper_a) = (self.lower[a], self.upper[a]);
                self.lower[block].subtract_product(&lower_a, &upper_b);
                if !self.symmetric {
                    self.upper[block].subtract_product(&upper_a, &lower_b);
                }
            }
            target += count;
        }
        target
    }

    /// Solves A x = b in place.
    pub(super) fn solve(&mut self, x: &mut [NodeVector]) {
        let Self { symbolic, vector, .. } = self;
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
