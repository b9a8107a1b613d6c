//! Time stepping: the system of all rods, the implicit step, Newton's method, step control.

mod parameters;
mod simulation;

pub use parameters::{IntegrationParameters, Scheme, StepSize};
pub use simulation::{Energies, Simulation, SimulationError, SimulationState, StepReport};
