//! The Newton system of rods that touch: a symmetric band and small dense elements between distant
//! unknowns, factored together.

use super::banded::BandedSymmetric;
use super::block_factor::BlockFactor;
use super::coupled_matrix::CoupledMatrix;
use super::element::{Element, ElementMatrix, SharedUnknown, UNUSED};
use super::error::{Inertia, SingularMatrix};
use super::node_block::{NODE, NodeVector};
use super::node_graph::{BandPattern, NodeGraph};
use super::symbolic::SymbolicFactor;

/// Residual, relative to |A||x| + |b| in each row, above which a solution is refined once.
/// A stable elimination leaves 1e-15 to 1e-13; refinement costs as much as the first solution.
const REFINEMENT_THRESHOLD: f64 = 1e-11;

/// Relative residual above which a solution is refused. Newton's method tolerates inexact corrections, so
/// this only has to catch systems that are singular to working precision.
const LARGEST_RESIDUAL: f64 = 1e-4;

/// Rows whose |A||x| + |b| is below this multiple of the largest contain only round-off.
const NEGLIGIBLE_SCALE: f64 = 1e-14;

/// A band and elements, with the factorisation of their sum.
///
/// [`CoupledSystem::new`] finds the pattern, the order of elimination and the places of all entries
/// once. Then any number of matrices of that pattern can be assembled and factored without
/// allocation: [`assemble`](Self::assemble), [`add_element`](Self::add_element),
/// [`factor`](Self::factor), [`solve`](Self::solve).
#[derive(Clone, Debug)]
pub struct CoupledSystem {
    dimension: usize,
    symmetric: bool,
    matrix: CoupledMatrix,
    factor: BlockFactor,
    right_hand_side: Vec<NodeVector>,
    solution: Vec<NodeVector>,
    residual: Vec<NodeVector>,
    scale: Vec<NodeVector>,
}

impl CoupledSystem {
    /// Finds the pattern of a band of `dimension` unknowns together with `elements`, chooses an order of elimination that fills
    /// it little, and makes room for its factors.
    ///
    /// `held` marks the unknowns that keep their value (length `dimension`): the entries of elements
    /// in their rows and columns are dropped. `shared` lists the unknowns that equal
    /// another one, their owner, which may be free or held but not shared itself. Their rows and
    /// columns are added to those of the owner, and then become those of held unknowns. With
    /// `symmetric`, elements must be symmetric matrices; only one triangle is read. `chains` lists,
    /// in order, the first node of each part that the band does not couple with the parts before.
    pub fn new(
        dimension: usize,
        elements: &[Element],
        held: &[bool],
        shared: &[SharedUnknown],
        chains: &[usize],
        symmetric: bool,
    ) -> Self {
        assert_eq!(held.len(), dimension);
        let nodes = dimension.div_ceil(NODE);
        // Unknowns that pad the last node count as held.
        let mut held = held.to_vec();
        held.resize(NODE * nodes, true);
        let mut owners: Vec<usize> = (0..held.len()).collect();
        for one in shared {
            held[one.unknown] = true;
            owners[one.unknown] = one.owner;
        }
        let owned = |unknown: &usize| owners.get(*unknown).copied().unwrap_or(UNUSED);
        let elements: Vec<Element> = elements
            .iter()
            .map(|element| std::array::from_fn(|place| owned(&element[place])))
            .collect();
        let elements = &elements;
        let band = BandPattern {
            owners,
            held,
            chains: chains.to_vec(),
        };
        let graph = NodeGraph::new(elements, &band);
        let factor = BlockFactor::new(SymbolicFactor::new(&graph), symmetric);
        let vector = vec![[0.0; NODE]; nodes];
        Self {
            dimension,
            symmetric,
            matrix: CoupledMatrix::new(graph, elements, &band, symmetric),
            factor,
            right_hand_side: vector.clone(),
            solution: vector.clone(),
            residual: vector.clone(),
            scale: vector,
        }
    }

    /// Number of 4×4 blocks of the factor below its diagonal: the measure of fill.
    pub fn factor_blocks(&self) -> usize {
        self.factor.blocks()
    }

    /// Sets the matrix to `band`, which may couple nodes at most two apart. Held unknowns must have
    /// been eliminated from it, see [`BandedSymmetric::hold`].
    pub fn assemble(&mut self, band: &BandedSymmetric) {
        assert_eq!(band.dimension(), self.dimension);
        self.matrix.assemble(band);
    }

    /// Adds the matrix of the element with the given index in the list passed to [`Self::new`].
    #[inline]
    pub fn add_element(&mut self, index: usize, matrix: &ElementMatrix) {
        self.matrix.add_element(index, matrix);
    }

    /// Factors the assembled matrix. A symmetric one reports the signs of its pivots, held unknowns
    /// counted as positive.
    ///
    /// # Errors
    /// A pivot that is zero or not finite.
    pub fn factor(&mut self) -> Result<Option<Inertia>, SingularMatrix> {
        let inertia = self.factor.factor(&self.matrix.parts())?;
        let filling = self.solution.as_flattened().len() - self.dimension;
        Ok(self.symmetric.then(|| Inertia {
            positive: inertia.positive - filling,
            ..inertia
        }))
    }

    /// Solves A x = b in place with the factors of the last [`Self::factor`], and refines the
    /// solution once if its residual is too large.
    ///
    /// # Errors
    /// A residual that stays large: the system is singular to working precision.
    pub fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), SingularMatrix> {
        assert_eq!(right_hand_side.len(), self.dimension);
        self.right_hand_side.as_flattened_mut()[..self.dimension].copy_from_slice(right_hand_side);
        self.solution.copy_from_slice(&self.right_hand_side);
        self.factor.solve(&mut self.solution);
        if self.worst_residual().1 > REFINEMENT_THRESHOLD {
            self.refine();
            let (unknown, residual) = self.worst_residual();
            if residual > LARGEST_RESIDUAL {
                return Err(SingularMatrix {
                    unknown,
                    pivot: residual,
                });
            }
        }
        right_hand_side.copy_from_slice(&self.solution.as_flattened()[..self.dimension]);
        Ok(())
    }

    /// Adds the solution of the residual equation to the solution.
    fn refine(&mut self) {
        self.factor.solve(&mut self.residual);
        for (own, correction) in self.solution.iter_mut().zip(&self.residual) {
            for (own, correction) in own.iter_mut().zip(correction) {
                *own += correction;
            }
        }
    }

    /// Computes the residual; returns the unknown whose relative residual is largest, and that residual.
    fn worst_residual(&mut self) -> (usize, f64) {
        self.matrix.residual(
            &self.solution,
            &self.right_hand_side,
            &mut self.residual,
            &mut self.scale,
        );
        let scale = self.scale.as_flattened();
        let floor = NEGLIGIBLE_SCALE * scale.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let mut worst = (0, 0.0);
        for (unknown, (residual, scale)) in
            self.residual.as_flattened().iter().zip(scale).enumerate()
        {
            let relative = residual.abs() / (scale + floor);
            if relative.is_nan() {
                return (unknown, f64::INFINITY);
            }
            if relative > worst.1 {
                worst = (unknown, relative);
            }
        }
        worst
    }
}

#[cfg(test)]
mod tests;
