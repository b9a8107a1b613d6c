//! Stability of a helical rod with clamped ends, by the discrete rod (thesis 6.2).
//!
//! A point (κ, τ, ω) represents a naturally straight rod of unit length and bending stiffness,
//! held at both ends in the shape of a helix of curvature κ and torsion τ with the twisting moment
//! ω. Along a direction, the equilibrium next to the helix is found at increasing distances ‖(κ,
//! τ, ω)‖. The helix loses stability where the lowest eigenvalue of the Hessian is zero. The method
//! does not use [`critical_distance`](rodlab_engine::mechanics::kirchhoff::critical_distance),
//! which is the theory.
//!
//! | file | what |
//! |---|---|
//! | `kind`, `keys` | the experiment and its table |
//! | `discrete_rod` | the clamped rod: at once on a helix, or straight with ends to be moved |
//! | `critical_distance` | the loss of stability along one direction |
//! | `boundary` | all directions: rod, theory, contact |
//! | `row` | a row of `boundary.csv` |
//! | `comparison`, `sections`, `surface` | tables and figures of the boundary |

mod boundary;
mod comparison;
mod critical_distance;
mod discrete_rod;
mod files;
mod keys;
mod kind;
mod row;
mod sections;
mod surface;

pub use comparison::compare;
pub use critical_distance::{discrete_critical_distance, estimated_critical_distance};
pub use discrete_rod::DiscreteRod;
pub use files::SURFACE;
pub use keys::{HelixSearch, HelixStability};
pub use kind::HELIX_STABILITY;
pub use row::{BoundaryRow, Part, read_boundary};
pub use sections::sections_of;
