//! An approximate inverse of the flow operator: exact inverses of its diagonal blocks, kept while the
//! filaments move on.

use super::dense_inverse::DenseInverse;
use super::instruction_set::InstructionSet;
use super::operator::{FlowOperator, PARALLEL_FROM};
use super::{Filament, FluidError};
use rayon::prelude::*;
use std::ops::Range;

/// Most nodes of a filament that share a block. Longer filaments are cut into equal parts: the cost of
/// an inverse grows with the cube of its size, and distant parts hardly need each other.
const NODES_PER_BLOCK: usize = 96;

/// Inverses of the diagonal blocks of an operator.
pub(super) struct BlockPreconditioner {
    blocks: Vec<Block>,
    parallel: bool,
}

struct Block {
    nodes: Range<usize>,
    inverse: DenseInverse,
    product: Vec<f64>,
}

impl BlockPreconditioner {
    /// Cuts filaments into blocks.
    pub fn new(filaments: &[Filament]) -> Self {
        let mut blocks = Vec::new();
        let mut first = 0;
        for filament in filaments {
            let parts = filament.nodes.div_ceil(NODES_PER_BLOCK);
            for part in 0..parts {
                let start = first + filament.nodes * part / parts;
                let end = first + filament.nodes * (part + 1) / parts;
                let order = 3 * (end - start);
                blocks.push(Block {
                    nodes: start..end,
                    inverse: DenseInverse::new(order, InstructionSet::best()),
                    product: vec![0.0; order],
                });
            }
            first += filament.nodes;
        }
        Self {
            blocks,
            parallel: first >= PARALLEL_FROM,
        }
    }

    /// Cost of [`build`](Self::build) in units of one product of the operator of `nodes` nodes, from
    /// operation counts: 2 m³ for the inverse of order m, 18 n² for the product.
    pub fn building_cost(&self, nodes: usize) -> f64 {
        let inversions: f64 = self
            .blocks
            .iter()
            .map(|block| 2.0 * (3.0 * block.nodes.len() as f64).powi(3))
            .sum();
        inversions / (18.0 * (nodes as f64).powi(2))
    }

    /// Inverts the operator's diagonal blocks.
    ///
    /// # Errors
    /// [`FluidError::Singular`] where a block has no inverse.
    pub fn build(&mut self, operator: &FlowOperator) -> Result<(), FluidError> {
        let build = |block: &mut Block| {
            let first = block.nodes.start;
            block
                .inverse
                .invert(|i, j| operator.block(first + i / 3, first + j / 3)[(i % 3, j % 3)])
        };
        let worked = if self.parallel {
            self.blocks.par_iter_mut().map(build).all(|worked| worked)
        } else {
            self.blocks.iter_mut().map(build).all(|worked| worked)
        };
        if worked {
            Ok(())
        } else {
            Err(FluidError::Singular)
        }
    }

    /// `y` ≈ A⁻¹ `x`.
    pub fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        let multiply = |block: &mut Block| {
            let range = 3 * block.nodes.start..3 * block.nodes.end;
            block.inverse.multiply(&x[range], &mut block.product);
        };
        if self.parallel {
            self.blocks.par_iter_mut().for_each(multiply);
        } else {
            self.blocks.iter_mut().for_each(multiply);
        }
        for block in &self.blocks {
            y[3 * block.nodes.start..3 * block.nodes.end].copy_from_slice(&block.product);
        }
    }
}
