//! Viscous fluid around rods: regularized Stokeslet segments and resistive force theory.

mod drag;
mod error;
mod filament;
mod logarithm;
mod model;
mod resistive_force_theory;
mod segment;

pub use drag::{Fluid, FluidMemory, FluidReport};
pub use error::FluidError;
pub use filament::Filament;
pub use model::FluidModel;
pub use resistive_force_theory::DragCoefficients;
pub use segment::segment_integral;
