//! Direct solution of the Newton systems of rods.
//!
//! Unknowns are numbered with stride 4 per node: the position of node k at 4k, 4k+1, 4k+2, the angle of
//! the edge that starts there at 4k+3. A vertex couples eleven consecutive unknowns, so rods without
//! contact give one symmetric band ([`BandedSymmetric`], [`BandedFactor`]). Contact and the closing of
//! rings couple distant nodes through small dense elements; [`CoupledSystem`] factors band and elements
//! together.
//!
//! Neither factorisation allocates once it is set up. Every number is the result of the same
//! operations in the same order on every machine, for any number of threads: the same matrix gives
//! the same bytes. Parts of the band that are not coupled, and coupled systems, are factored in all
//! threads of the pool.
//! `instruction_set` compiles kernels, here and in the mechanics, for the registers of the machine
//! in use.

mod banded;
mod banded_lanes;
mod block_factor;
mod branches;
mod coupled;
mod coupled_matrix;
mod dissection;
mod element;
mod elimination;
mod elimination_order;
mod elimination_tree;
mod error;
mod in_parts;
pub(crate) mod instruction_set;
mod islands;
mod lane_vector;
mod node_block;
mod node_graph;
mod panel;
mod supernodes;
mod symbolic;

pub use banded::{BandedFactor, BandedSymmetric, HALF_BANDWIDTH};
pub(crate) use banded_lanes::BandedLanes;
pub use coupled::CoupledSystem;
pub use element::{Element, ElementMatrix, SharedUnknown, UNUSED};
pub(crate) use error::{Inertia, SingularMatrix};
pub(crate) use in_parts::{Span, in_chunks, in_parts};
pub(crate) use islands::{Couplings, Islands};
pub(crate) use lane_vector::LaneVector;
