//! Equilibria: Newton's method without inertia.
//!
//! `Descent` decreases the energy, so that it ends where a rod would come to rest.
//! `nearby_equilibrium` finds the nearest equilibrium and whether it is stable. [`Tracer`] follows
//! equilibria along a path of loads or moving clamps. [`natural_strains`] finds the natural shape
//! of a rod whose equilibrium is given.

mod equilibrium;
mod inner_product;
mod natural_shape;
mod nearby;
mod neutral;
mod path;
mod small_motions;
mod spectrum;

pub(crate) use equilibrium::Descent;
pub use natural_shape::{DesignError, Designed, natural_strains};
pub(crate) use nearby::nearby_equilibrium;
pub use path::{EndedEarly, PathMethod, PathPlan, PathPoint, PointKind, Tracer};
pub(crate) use small_motions::{SmallMotions, small_motions};
pub(crate) use spectrum::nearest_eigenvalue;
