//! Sparse elimination node by node: A = 𝓛 𝓤 with 4×4 blocks, 𝓛 with unit diagonal.
//!
//! Columns that fill the same rows form one dense panel, a supernode (Ng & Peyton 1993). A panel
//! receives L_r U_cᵀ from every earlier panel with rows among its columns. Then its columns receive
//! the same from each other, one by one. The blocks below the diagonal are divided by the diagonal
//! block, L_r = A_rk D⁻¹ (left-looking elimination; Golub & Van Loan, 4th ed., sec. 3.2.11). The
//! diagonal blocks are factored with partial pivoting inside the block only, so the pattern is
//! known beforehand. The residual check of [`super::CoupledSystem::solve`] detects any loss of
//! accuracy from this. For a symmetric matrix U_r = A_rkᵀ is available, which halves the updates.
//!
//! Branches of the elimination tree are independent and are eliminated in parallel. The panels of
//! the trunk follow one after the other; the rows of each are processed in parallel. Every block
//! is the result of the same operations in the same order, for any number of threads.

use super::elimination::{Part, SMALLEST_TASK};
use super::error::{Inertia, SingularMatrix};
use super::instruction_set::{InstructionSet, kernel};
use super::node_block::{Block, BlockMatrix, DiagonalFactor, NODE, NodeVector};
use super::symbolic::SymbolicFactor;

/// Numeric factors in the pattern of a [`SymbolicFactor`].
#[derive(Clone, Debug)]
pub(super) struct BlockFactor {
    symbolic: SymbolicFactor,
    symmetric: bool,
    /// The diagonal blocks, factored.
    diagonal: Vec<DiagonalFactor>,
    /// Panels of 𝓛; before a column is eliminated, its part of the reduced matrix. Diagonal blocks
    /// are those found by the elimination.
    lower: Vec<Block>,
    /// Blocks of 𝓤 right of the diagonal, transposed, so that their indices are those of the lower
    /// blocks.
    upper: Vec<Block>,
    /// Row of the current panel that holds each row of the matrix, for the trunk and each branch;
    /// scratch.
    local_rows: Vec<Vec<u32>>,
    /// A right-hand side in the order of elimination.
    vector: Vec<NodeVector>,
}

impl BlockFactor {
    pub(super) fn new(symbolic: SymbolicFactor, symmetric: bool) -> Self {
        let (nodes, blocks) = (symbolic.order.len(), symbolic.supernodes.blocks());
        let branches = symbolic.branches.len();
        Self {
            symbolic,
            symmetric,
            diagonal: vec![DiagonalFactor::EMPTY; nodes],
            lower: vec![Block::ZERO; blocks],
            upper: vec![Block::ZERO; blocks],
            local_rows: vec![vec![0; nodes]; 1 + branches],
            vector: vec![[0.0; NODE]; nodes],
        }
    }

    /// Number of blocks stored for each triangle.
    pub(super) fn blocks(&self) -> usize {
        self.lower.len()
    }

    /// Factors a matrix.
    pub(super) fn factor(&mut self, matrix: &BlockMatrix) -> Result<Inertia, SingularMatrix> {
        self.factor_with(InstructionSet::best_of_width(NODE), matrix)
    }

    fn factor_with(
        &mut self,
        set: InstructionSet,
        matrix: &BlockMatrix,
    ) -> Result<Inertia, SingularMatrix> {
        let Self {
            symbolic,
            symmetric,
            diagonal,
            lower,
            upper,
            local_rows,
            ..
        } = self;
        let (of_trunk, of_branches) = local_rows.split_first_mut().expect("of the trunk");
        let mut part = Part {
            set,
            matrix,
            symbolic,
            symmetric: *symmetric,
            first_block: 0,
            first_column: 0,
            diagonal,
            lower,
            upper,
        };
        let mut inertia = part
            .reborrow()
            .eliminate_branches(&symbolic.branches, of_branches)?;
        for &supernode in &symbolic.trunk {
            part.eliminate_panel(supernode, of_trunk, SMALLEST_TASK, &mut inertia)?;
        }
        Ok(inertia)
    }

    /// Solves A x = b in place.
    pub(super) fn solve(&mut self, x: &mut [NodeVector]) {
        for (own, &node) in self.vector.iter_mut().zip(&self.symbolic.order) {
            *own = x[node];
        }
        let (set, symbolic) = (InstructionSet::best_of_width(NODE), &self.symbolic);
        solve_lower(set, symbolic, &self.lower, &mut self.vector);
        solve_upper(set, symbolic, &self.diagonal, &self.upper, &mut self.vector);
        for (own, &node) in self.vector.iter().zip(&self.symbolic.order) {
            x[node] = *own;
        }
    }
}

kernel! {
    /// Solves 𝓛 y = x in place.
    fn solve_lower(symbolic: &SymbolicFactor, lower: &[Block], vector: &mut [NodeVector]) {
        for supernode in &symbolic.supernodes.list {
            let width = supernode.width();
            let panel = &lower[supernode.blocks()];
            let (own, after) = vector[supernode.columns.start..].split_at_mut(width);
            let (square, below) = panel.split_at(width * width);
            for (row, blocks) in square.chunks_exact(width).enumerate() {
                let (before, rest) = own.split_at_mut(row);
                for (block, value) in blocks.iter().zip(before) {
                    block.subtract_from(value, &mut rest[0]);
                }
            }
            let rows = &symbolic.supernodes.rows[supernode.rows.clone()];
            for (&row, blocks) in rows.iter().zip(below.chunks_exact(width)) {
                let target = &mut after[row as usize - supernode.columns.end];
                for (block, value) in blocks.iter().zip(&*own) {
                    block.subtract_from(value, target);
                }
            }
        }
    }
}

kernel! {
    /// Solves 𝓤 x = y in place.
    fn solve_upper(
        symbolic: &SymbolicFactor,
        diagonal: &[DiagonalFactor],
        upper: &[Block],
        vector: &mut [NodeVector],
    ) {
        for supernode in symbolic.supernodes.list.iter().rev() {
            let width = supernode.width();
            let panel = &upper[supernode.blocks()];
            let (own, after) = vector[supernode.columns.start..].split_at_mut(width);
            let (square, below) = panel.split_at(width * width);
            let rows = &symbolic.supernodes.rows[supernode.rows.clone()];
            for (&row, blocks) in rows.iter().zip(below.chunks_exact(width)) {
                let value = &after[row as usize - supernode.columns.end];
                for (block, target) in blocks.iter().zip(&mut *own) {
                    block.subtract_transposed_from(value, target);
                }
            }
            for (row, blocks) in square.chunks_exact(width).enumerate().rev() {
                let (before, rest) = own.split_at_mut(row);
                rest[0] = diagonal[supernode.columns.start + row].solve(&rest[0]);
                for (block, target) in blocks.iter().zip(before) {
                    block.subtract_transposed_from(&rest[0], target);
                }
            }
        }
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
            let matrix = BlockMatrix {
                diagonal: &diagonal,
                lower: &lower,
                upper: &upper,
            };
            dispatched.factor(&matrix).unwrap();
            let set = InstructionSet::available().next().unwrap();
            portable.factor_with(set, &matrix).unwrap();
            assert_eq!(dispatched.lower, portable.lower);
            assert_eq!(dispatched.upper, portable.upper);
        }
    }

    #[test]
    fn threads_change_no_byte() {
        let (side, mut pairs) = (60, Vec::new());
        let nodes = side * side;
        for k in 0..nodes as u32 {
            pairs.extend(
                [1, 2, side as u32, side as u32 + 1].map(|apart| (k, (k + apart) % nodes as u32)),
            );
        }
        let graph = NodeGraph::of_pairs(nodes, &pairs);
        let block = |seed: usize, diagonal: f64| {
            let mut block = Block(std::array::from_fn(|i| ((7 * seed + i) as f64).sin()));
            (0..NODE).for_each(|k| block.0[NODE * k + k] += diagonal);
            block
        };
        let diagonal: Vec<Block> = (0..nodes).map(|k| block(k, 40.0)).collect();
        let lower: Vec<Block> = (0..graph.pairs().len()).map(|k| block(k, 0.0)).collect();
        for symmetric in [true, false] {
            let symbolic = SymbolicFactor::new(&graph);
            assert!(symbolic.branches.len() > 3);
            let of_trunk = symbolic.trunk.iter().map(|k| symbolic.products[*k]);
            assert!(of_trunk.max() > Some(2 * SMALLEST_TASK));
            let matrix = BlockMatrix {
                diagonal: &diagonal,
                lower: &lower,
                upper: &lower,
            };
            let factored = [1, 3].map(|threads| {
                let mut factor = BlockFactor::new(symbolic.clone(), symmetric);
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let inertia = pool
                    .build()
                    .unwrap()
                    .install(|| factor.factor(&matrix).unwrap());
                (factor.lower, factor.upper, inertia)
            });
            assert!(factored[0] == factored[1]);
        }
    }
}
