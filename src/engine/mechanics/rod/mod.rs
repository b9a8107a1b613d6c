//! The discrete elastic rod: topology, frames, strains, energies and their derivatives.
//!
//! [`vertex`] contains bending and twisting, [`edge`] stretching; [`ElasticRods`] sums them over
//! all rods into a gradient and a band matrix, in parallel (`parts`). `clamped_end` weights vertices next to clamps, and
//! `turning_ghost` allows a ghost edge to rotate with a joint or body. [`RodGeometry`] computes
//! edges, frames and strains from the unknowns. Both process several edges or vertices at a time,
//! in lanes (`frame_lanes`, `edge_lanes`, `vertex_lanes`), with the formulas of a single one;
//! `trigonometry` provides sines and angles for that.
//!
//! Papers: Bergou et al. 2008 (Discrete elastic rods), Bergou et al. 2010 (Discrete viscous
//! threads: time-parallel frames), Kaldor et al. 2010 (twist that includes whole turns), Panetta
//! et al. 2019 (the corrected Hessian).

mod clamped_end;
mod copies;
mod discretization;
pub mod edge;
mod edge_lanes;
mod elastic;
mod frame_lanes;
mod geometry;
mod holonomy;
mod parts;
mod placement;
pub mod topology;
pub mod transport;
mod trigonometry;
mod turning_angle;
mod turning_ghost;
pub mod vertex;
mod vertex_hessian;
mod vertex_lanes;
mod virtual_strain;

pub(crate) use copies::{Original, RodCopies};
pub use discretization::{Edge, ElasticRods, GhostEdge, Vertex, VertexUnknowns, VertexWeights};
pub(crate) use elastic::ElasticEnergy;
pub use geometry::{ReferenceFrames, RodGeometry};
pub(crate) use holonomy::holonomy_jacobian;
pub(crate) use placement::{Placement, PlacementError};
pub use topology::{RodRange, STRIDE};
pub use turning_angle::BendingStrain;
pub(crate) use turning_ghost::TURNING_ROTATION;
pub(crate) use vertex_lanes::VERTEX_UNKNOWNS;
pub(crate) use virtual_strain::EdgeMotion;
