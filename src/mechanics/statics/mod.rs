//! Equilibria: Newton's method without inertia. [`find_equilibrium`] goes downhill, so that it ends where
//! a rod would come to rest; [`nearby_equilibrium`] goes to the nearest one, and tells whether it is stable.

mod equilibrium;
mod nearby;

pub use equilibrium::find_equilibrium;
pub use nearby::nearby_equilibrium;
