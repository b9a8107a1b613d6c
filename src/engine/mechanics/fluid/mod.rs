//! Viscous fluid around rods: regularized Stokeslet segments and resistive force theory.
//!
//! [`Fluid`] is the entry point: it computes forces and local resistances from positions and velocities of nodes.
//!
//! | file | idea |
//! |---|---|
//! | `segment` | the flow of one segment in closed form (thesis Eq. 2.20–2.26, re-derived) |
//! | `quadrature` | the same by adaptive quadrature, as a check |
//! | `logarithm`, `lanes` | the same for eight segments at a time |
//! | `operator` | the collocation matrix A of all nodes, stored; products |
//! | `chain`, `patch` | parts of A: the blocks of some nodes with others |
//! | `hierarchy` | products with A by clusters of nodes, at a cost like N log N |
//! | `wall` | a plane at which the fluid is at rest, by images of the segments |
//! | `spheres` | spheres that rods carry, by their force and torque |
//! | `rotlets` | the flow of rods that spin about their axes |
//! | `flow` | choice between the two: exact for few nodes, by clusters for many |
//! | `ties`, `points` | nodes of joined filaments that are one point of the flow |
//! | `preconditioner` | approximate inverse of A, of two levels |
//! | `neighbourhoods`, `elimination` | the fine one, from the neighbourhoods of nodes |
//! | `coarse_space` | the coarse one, from aggregates of filaments |
//! | `gmres`, `initial_guess` | solving A f = 8πη u, warm-started |
//! | `stokeslet_drag` | a time series of such solves (thesis Eq. 2.27) |
//! | `stations` | nodes of filaments, their lengths |
//! | `age` | when the preconditioner is rebuilt |
//! | `largest_ratio` | ratio of the whole resistance to its local part |
//! | `background` | the flow without rods: wind, currents, shear |
//! | `report` | cost of a computation of the drag |
//! | `resistive_force_theory` | the cheap model: local coefficients along and across |
//! | `continuation` | the lengths of filaments that continue each other, for these coefficients |
//!
//! # Cost
//! Per pair of nodes and core (Zen 5): assembly 3.4 ns with AVX-512 (4.3 ns where A is too large
//! for the second-level cache), 5 ns with AVX2 and some 120 ns without either, limited by
//! arithmetic; a product 0.31 ns if A fits the second-level cache (136 nodes) and about twice that
//! if it streams from farther away (680 nodes, 24 bytes a pair). Quadrature is not cheaper for
//! distant pairs: an error of 10⁻⁸ beyond some five segment lengths takes three Gauss points, with
//! three square roots and three divisions. The closed form takes two of each and one logarithm.
//!
//! By clusters (expansions of degree 8, drag to 10⁻⁴), 6,800 nodes of helices 3 cm apart leave 3.1
//! million of 46 million pairs to be summed exactly: assembly takes 22 ms instead of 320, a
//! product some 13 ms instead of 64, on one core. With the helices 3 mm apart, the times are 63
//! and 43 ms. Below a thousand nodes, summing all pairs is cheaper.
//!
//! # Limits
//! Nodes closer than about a quarter of ε make A ill-conditioned, as always with regularized
//! Stokeslets: at a spacing of ε/8 the tolerance of 10⁻⁶ in the velocities leaves an error of 0.3
//! % in the drag, and solves become slow. Segments of different rods may be arbitrarily close, but
//! within a few radii the flow between their surfaces (lubrication) is not resolved. Nodes of
//! different rods that start at the same point are one point of the flow (`ties`); nodes that come
//! so close later make A singular. If the end of a rod enters another rod, A has a negative
//! eigenvalue for the motion that separates them; a step in which such a motion dominates is
//! rejected (`Fluid::dissipation`).
//!
//! The error of the drag by clusters was measured for helices, not proved. Velocities that
//! alternate from node to node, or nodes much closer than ε, may make it larger than
//! `far_field_error`.

mod age;
mod background;
mod chain;
mod coarse_space;
mod continuation;
mod drag;
mod elimination;
mod error;
mod filament;
mod flow;
mod gmres;
mod hierarchy;
mod initial_guess;
#[cfg(test)]
mod joined_tests;
mod lanes;
mod largest_ratio;
mod logarithm;
mod model;
mod neighbourhoods;
mod operator;
mod patch;
mod points;
mod preconditioner;
#[cfg(test)]
mod quadrature;
mod report;
mod resistive_force_theory;
mod rotlets;
mod segment;
mod spheres;
mod stations;
mod stokeslet_drag;
#[cfg(test)]
mod tests;
mod ties;
mod wall;
#[cfg(test)]
mod wall_tests;

pub use background::{BackgroundFlow, FlowKind};
pub use drag::{Coupling, Fluid, FluidMemory};
pub use error::FluidError;
pub use filament::{Connections, Filament, Sliding};
pub use model::FluidModel;
pub use operator::FlowOperator;
#[cfg(test)]
pub(crate) use quadrature::segment_integral_by_quadrature;
pub use resistive_force_theory::DragCoefficients;
pub use segment::segment_integral;
pub(crate) use spheres::Sphere;
pub use wall::{Wall, segment_image_integral};
