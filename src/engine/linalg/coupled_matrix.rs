//! The sum of a symmetric band and small dense elements, as 4×4 blocks of coupled nodes.

use super::banded::{BandedSymmetric, HALF_BANDWIDTH};
use super::element::{Element, ElementMatrix, is_free};
use super::instruction_set::{InstructionSet, kernel};
use super::node_block::{Block, BlockMatrix, NODE, NodeVector};
use super::node_graph::{BandPattern, NodeGraph};
use std::cmp::Ordering;

/// Number of unknowns of a node that form its position; they come first.
const POSITION: usize = 3;

/// The assembled matrix, with the positions of all entries found beforehand.
#[derive(Clone, Debug)]
pub(super) struct CoupledMatrix {
    symmetric: bool,
    graph: NodeGraph,
    /// Three groups of blocks, one after the other: diagonal blocks, blocks of the graph's pairs
    /// below the diagonal, and blocks right of it, transposed (none if symmetric).
    blocks: Vec<Block>,
    /// Blocks that couple each node k with k + 1 and k + 2.
    band_places: Vec<[Option<usize>; 2]>,
    /// Blocks below the diagonal that the band does not fill.
    other_places: Vec<usize>,
    /// Moves of entries that couple the positions of two nodes, from each element to the matrix.
    block_moves: Vec<BlockMove>,
    /// Moves of the other entries to values of the matrix.
    moves: Vec<Move>,
    /// Start of the moves of each element; those of element e end at the start of e + 1.
    element_starts: Vec<Starts>,
    /// Band entries in rows and columns of shared unknowns, and the values to which they are
    /// added.
    band_moves: Vec<BandMove>,
    /// Values in the rows and columns of shared unknowns where the band may have entries.
    shared_values: Vec<u32>,
    /// Values on the diagonal of shared unknowns.
    shared_diagonals: Vec<u32>,
}

/// Start of the moves of an element.
#[derive(Clone, Copy, Debug)]
struct Starts {
    block_moves: usize,
    moves: usize,
}

/// A 3×3 part of an element matrix that couples the positions of two of its nodes, and the block
/// to which it is added.
#[derive(Clone, Copy, Debug)]
struct BlockMove {
    block: u32,
    /// First row and column of the entries.
    first: [u8; 2],
    /// Whether the block is stored transposed.
    transposed: bool,
}

impl BlockMove {
    #[inline(always)]
    fn add(&self, matrix: &ElementMatrix, blocks: &mut [Block]) {
        let [row, column] = self.first.map(usize::from);
        let block = &mut blocks[self.block as usize].0;
        for r in 0..POSITION {
            for c in 0..POSITION {
                let place = if self.transposed {
                    NODE * r + c
                } else {
                    NODE * c + r
                };
                block[place] += matrix[row + r][column + c];
            }
        }
    }
}

/// One entry of an element matrix (row-major) and the value to which it is added.
#[derive(Clone, Copy, Debug)]
struct Move {
    entry: u32,
    value: u32,
}

/// One entry of the band, below the diagonal or on it, and the value to which it is added.
#[derive(Clone, Copy, Debug)]
struct BandMove {
    column: u32,
    below: u32,
    value: u32,
}

impl CoupledMatrix {
    /// The zero matrix of the given pattern.
    pub(super) fn new(
        graph: NodeGraph,
        elements: &[Element],
        band: &BandPattern,
        symmetric: bool,
    ) -> Self {
        let (nodes, pairs) = (graph.nodes, graph.pairs().len());
        let is_other = |&(_, (p, q)): &(usize, &(u32, u32))| p - q > 2;
        let others = (nodes..).zip(graph.pairs()).filter(is_other);
        let mut matrix = Self {
            symmetric,
            blocks: vec![Block::ZERO; nodes + if symmetric { pairs } else { 2 * pairs }],
            other_places: others.map(|(place, _)| place).collect(),
            band_places: (0..nodes)
                .map(|q| [1, 2].map(|apart| graph.pair(q + apart, q).map(|pair| nodes + pair)))
                .collect(),
            block_moves: Vec::with_capacity(16 * elements.len()),
            moves: Vec::new(),
            element_starts: Vec::with_capacity(elements.len() + 1),
            band_moves: Vec::new(),
            shared_values: Vec::new(),
            shared_diagonals: Vec::new(),
            graph,
        };
        for element in elements {
            matrix.begin_element();
            matrix.place_element(element, &band.held);
        }
        matrix.begin_element();
        matrix.place_shared(band);
        matrix.drop_shared(&band.owners);
        matrix
    }

    /// The matrix by its blocks.
    pub(super) fn parts(&self) -> BlockMatrix<'_> {
        let (diagonal, rest) = self.blocks.split_at(self.graph.nodes);
        let (lower, upper) = rest.split_at(self.graph.pairs().len());
        BlockMatrix {
            diagonal,
            lower,
            upper,
        }
    }

    /// Sets the matrix to `band`, from which held unknowns were eliminated.
    pub(super) fn assemble(&mut self, band: &BandedSymmetric) {
        debug_assert!(
            band.columns().iter().enumerate().all(|(j, column)| {
                let reached = (3 * NODE - j % NODE).min(HALF_BANDWIDTH + 1);
                column[reached..].iter().all(|&value| value == 0.0)
            }),
            "the band couples nodes three apart"
        );
        // The transposed blocks right of the diagonal equal those below it.
        let of_copy = (!self.symmetric).then(|| self.graph.pairs().len());
        for place in &self.other_places {
            self.blocks[*place] = Block::ZERO;
            of_copy.inspect(|copy| self.blocks[place + copy] = Block::ZERO);
        }
        let set = InstructionSet::best_of_width(NODE);
        copy_band(
            set,
            &mut self.blocks,
            band.columns(),
            &self.band_places,
            of_copy,
        );
        for &value in &self.shared_values {
            *value_mut(&mut self.blocks, value) = 0.0;
        }
        for &value in &self.shared_diagonals {
            *value_mut(&mut self.blocks, value) = 1.0;
        }
        for &BandMove {
            column,
            below,
            value,
        } in &self.band_moves
        {
            *value_mut(&mut self.blocks, value) += band.columns()[column as usize][below as usize];
        }
    }

    /// Adds the matrix of an element.
    #[inline]
    pub(super) fn add_element(&mut self, index: usize, matrix: &ElementMatrix) {
        let [own, next] = [index, index + 1].map(|index| self.element_starts[index]);
        for of_block in &self.block_moves[own.block_moves..next.block_moves] {
            of_block.add(matrix, &mut self.blocks);
        }
        let entries = matrix.as_flattened();
        for &Move { entry, value } in &self.moves[own.moves..next.moves] {
            *value_mut(&mut self.blocks, value) += entries[entry as usize];
        }
    }

    /// Computes the residual b − A x, and in each row |A||x| + |b|, the scale by which to judge it
    /// (Oettli & Prager 1964).
    pub(super) fn residual(
        &self,
        x: &[NodeVector],
        right_hand_side: &[NodeVector],
        residual: &mut [NodeVector],
        scale: &mut [NodeVector],
    ) {
        let set = InstructionSet::best_of_width(NODE);
        let pairs = self.graph.pairs();
        let mut parts = self.parts();
        if self.symmetric {
            parts.upper = parts.lower;
        }
        find_residual(set, &parts, pairs, x, right_hand_side, residual, scale);
    }

    /// Finds the destinations of the entries of an element. A symmetric matrix stores no block
    /// right of the diagonal.
    fn place_element(&mut self, element: &Element, held: &[bool]) {
        let corners: [Option<usize>; 4] =
            std::array::from_fn(|corner| node_at(element, POSITION * corner, held));
        for (row, p) in corners.iter().enumerate() {
            for (column, q) in corners.iter().enumerate() {
                let both = p.zip(*q).and_then(|(p, q)| self.block(p, q));
                if let Some((block, transposed)) = both {
                    self.block_moves.push(BlockMove {
                        block: block as u32,
                        first: [row, column].map(|corner| (POSITION * corner) as u8),
                        transposed,
                    });
                }
            }
        }
        // Neighbouring entries are in the same block: look it up only where the nodes change.
        let mut nodes = (usize::MAX, usize::MAX);
        let mut place = None;
        for (row, &i) in element.iter().enumerate() {
            for (column, &j) in element.iter().enumerate() {
                let in_block =
                    corners[row / POSITION].is_some() && corners[column / POSITION].is_some();
                if in_block || !is_free(i, held) || !is_free(j, held) {
                    continue;
                }
                if nodes != (i / NODE, j / NODE) {
                    nodes = (i / NODE, j / NODE);
                    place = self.block(nodes.0, nodes.1);
                }
                if let Some(place) = place {
                    let entry = (element.len() * row + column) as u32;
                    let value = value_in(place, i, j);
                    self.moves.push(Move { entry, value });
                }
            }
        }
    }

    /// Records where the moves of the next element begin.
    fn begin_element(&mut self) {
        self.element_starts.push(Starts {
            block_moves: self.block_moves.len(),
            moves: self.moves.len(),
        });
    }

    /// Finds the destinations of band entries in rows or columns of shared unknowns: the rows and
    /// columns of their owners, on both sides of the diagonal.
    fn place_shared(&mut self, band: &BandPattern) {
        let (owners, held) = (&band.owners, &band.held);
        let is_shared = |unknown: usize| owners[unknown] != unknown;
        for j in 0..owners.len() {
            let end = (j + HALF_BANDWIDTH + 1).min(NODE * band.end_of_reach(j / NODE));
            for i in j..end {
                let (row, column) = (owners[i], owners[j]);
                let goes = is_shared(i) || is_shared(j);
                if !goes || held[row] || held[column] {
                    continue;
                }
                let both = [(row, column), (column, row)];
                let sides = if i == j { &both[..1] } else { &both[..] };
                for &(row, column) in sides {
                    let Some(place) = self.block(row / NODE, column / NODE) else {
                        continue;
                    };
                    self.band_moves.push(BandMove {
                        column: j as u32,
                        below: (i - j) as u32,
                        value: value_in(place, row, column),
                    });
                }
            }
        }
    }

    /// Block (p, q) of two nodes, and whether it is stored transposed; none where a symmetric matrix stores
    /// only block (q, p).
    fn block(&self, p: usize, q: usize) -> Option<(usize, bool)> {
        let (nodes, pairs) = (self.graph.nodes, self.graph.pairs().len());
        let pair = |p, q| self.graph.pair(p, q).expect("the graph holds the elements");
        match p.cmp(&q) {
            Ordering::Equal => Some((p, false)),
            Ordering::Greater => Some((nodes + pair(p, q), false)),
            Ordering::Less if self.symmetric => None,
            Ordering::Less => Some((nodes + pairs + pair(q, p), true)),
        }
    }

    /// Finds the values that the band may have in rows and columns of shared unknowns.
    fn drop_shared(&mut self, owners: &[usize]) {
        let pairs = self.graph.pairs().len();
        let is_shared = |&(unknown, owner): &(usize, &usize)| unknown != *owner;
        for (i, _) in owners.iter().enumerate().filter(is_shared) {
            let (p, r) = (i / NODE, i % NODE);
            let in_row = |k: usize| NODE * k + r;
            let in_column = |k: usize| NODE * r + k;
            let mut drop = |block: usize, place: usize| {
                self.shared_values
                    .push((NODE * NODE * block + place) as u32);
            };
            for k in 0..NODE {
                drop(p, in_row(k));
                drop(p, in_column(k));
            }
            for apart in 1..=2 {
                let after = self.band_places[p][apart - 1];
                let before = p
                    .checked_sub(apart)
                    .and_then(|q| self.band_places[q][apart - 1]);
                for copy in if self.symmetric {
                    vec![0]
                } else {
                    vec![0, pairs]
                } {
                    for k in 0..NODE {
                        after.inspect(|block| drop(block + copy, in_column(k)));
                        before.inspect(|block| drop(block + copy, in_row(k)));
                    }
                }
            }
            self.shared_diagonals
                .push((NODE * NODE * p + NODE * r + r) as u32);
        }
    }
}

/// The diagonal block of a node from its columns of the band.
#[inline(always)]
fn symmetric_block(columns: &[[f64; HALF_BANDWIDTH + 1]; NODE]) -> Block {
    Block(std::array::from_fn(|i| {
        let (c, r) = (i / NODE, i % NODE);
        columns[c.min(r)][c.abs_diff(r)]
    }))
}

/// The block that couples a node with the one `APART` behind it, from the columns of the first.
#[inline(always)]
fn block_below<const APART: usize>(columns: &[[f64; HALF_BANDWIDTH + 1]; NODE]) -> Block {
    Block(std::array::from_fn(|i| {
        let (c, r) = (i / NODE, i % NODE);
        let below = NODE * APART + r - c;
        if below <= HALF_BANDWIDTH {
            columns[c][below]
        } else {
            0.0
        }
    }))
}

kernel! {
    /// Copies a band to the blocks of a matrix. If there are blocks right of the diagonal, they lie
    /// `of_copy` behind those below it.
    fn copy_band(
        blocks: &mut [Block],
        columns: &[[f64; HALF_BANDWIDTH + 1]],
        band_places: &[[Option<usize>; 2]],
        of_copy: Option<usize>,
    ) {
        let (columns, last) = columns.as_chunks::<NODE>();
        let mut padded = [[0.0; HALF_BANDWIDTH + 1]; NODE];
        padded[..last.len()].copy_from_slice(last);
        padded[last.len()..].iter_mut().for_each(|column| column[0] = 1.0);
        let padded = (!last.is_empty()).then_some(&padded);
        for (q, columns) in columns.iter().chain(padded).enumerate() {
            blocks[q] = symmetric_block(columns);
            let below = [block_below::<1>(columns), block_below::<2>(columns)];
            for (place, block) in band_places[q].iter().zip(below) {
                if let &Some(place) = place {
                    blocks[place] = block;
                    of_copy.inspect(|copy| blocks[place + copy] = block);
                }
            }
        }
    }
}

kernel! {
    /// [`CoupledMatrix::residual`], with the blocks right of the diagonal also of a symmetric
    /// matrix.
    fn find_residual(
        matrix: &BlockMatrix,
        pairs: &[(u32, u32)],
        x: &[NodeVector],
        right_hand_side: &[NodeVector],
        residual: &mut [NodeVector],
        scale: &mut [NodeVector],
    ) {
        for (p, block) in matrix.diagonal.iter().enumerate() {
            residual[p] = right_hand_side[p];
            scale[p] = right_hand_side[p].map(f64::abs);
            block.subtract_from(&x[p], &mut residual[p]);
            block.add_magnitudes_to(&x[p], &mut scale[p]);
        }
        for (&(p, q), (lower, upper)) in pairs.iter().zip(matrix.lower.iter().zip(matrix.upper)) {
            let (p, q) = (p as usize, q as usize);
            lower.subtract_from(&x[q], &mut residual[p]);
            lower.add_magnitudes_to(&x[q], &mut scale[p]);
            upper.subtract_transposed_from(&x[p], &mut residual[q]);
            upper.add_transposed_magnitudes_to(&x[p], &mut scale[q]);
        }
    }
}

/// The node whose position starts at `place` of an element, if the element holds all of it and it
/// is free.
fn node_at(element: &Element, place: usize, held: &[bool]) -> Option<usize> {
    let unknowns = &element[place..place + POSITION];
    let node = unknowns[0] / NODE;
    let is_position = |(axis, unknown): (usize, &usize)| {
        *unknown == NODE * node + axis && is_free(*unknown, held)
    };
    unknowns.iter().enumerate().all(is_position).then_some(node)
}

/// The index of the value of the unknowns `row` and `column` in a block, which may be stored transposed.
fn value_in((block, transposed): (usize, bool), row: usize, column: usize) -> u32 {
    let (r, c) = (row % NODE, column % NODE);
    let (r, c) = if transposed { (c, r) } else { (r, c) };
    (NODE * NODE * block + NODE * c + r) as u32
}

/// The value with the given index, counted through all blocks.
#[inline(always)]
fn value_mut(blocks: &mut [Block], value: u32) -> &mut f64 {
    let value = value as usize;
    &mut blocks[value / (NODE * NODE)].0[value % (NODE * NODE)]
}
