//! Viscous fluid around rods: regularized Stokeslet segments and resistive force theory.

mod drag;
mod elimination;
mod error;
mod filament;
mod gmres;
mod initial_guess;
mod instruction_set;
mod lanes;
mod logarithm;
mod model;
mod operator;
mod preconditioner;
mod quadrature;
mod resistive_force_theory;
mod segment;
mod stokeslet_drag;
#[cfg(test)]
mod tests;

pub use drag::{Fluid, FluidMemory, FluidReport};
pub use error::FluidError;
pub use filament::Filament;
pub use model::FluidModel;
pub use operator::FlowOperator;
pub use quadrature::{segment_integral_by_quadrature, segment_integral_error};
pub use resistive_force_theory::DragCoefficients;
pub use segment::segment_integral;
