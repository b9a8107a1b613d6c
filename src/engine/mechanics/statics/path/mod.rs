//! Paths of equilibria R(q, λ) = 0 (continuation).
//!
//! The path parameter λ replaces time, so that everything that a scene prescribes over time may
//! drive the path: moving clamps and loads with a schedule. [`Tracer`] follows a path by steps of
//! λ or of pseudo-arclength (Keller 1977; Riks 1979), finds folds and bifurcations by the inertia
//! of the Hessian, and switches to the branches that leave there along the null vector. A branch
//! that closes is followed once around.

mod bordered;
mod closing;
mod critical;
mod location;
mod plan;
mod tracer;

pub use location::{PathPoint, PointKind};
pub use plan::{PathMethod, PathPlan};
pub use tracer::{EndedEarly, Tracer};
