//! Equilibria: Newton's method without inertia, kept stable by the inertia of the Hessian.

mod equilibrium;

pub use equilibrium::find_equilibrium;
