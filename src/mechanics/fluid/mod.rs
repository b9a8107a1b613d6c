//! Viscous fluid around rods: regularized Stokeslet segments and resistive force theory.

mod model;

pub use model::FluidModel;
