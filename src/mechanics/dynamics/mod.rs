//! Time stepping: the implicit step, Newton's method, step control.
//!
//! The loop is [`Simulation::advance`]: drag at the start of the step or of the predicted motion, contact candidates,
//! an implicit stage solved by Newton's method, smaller steps where that fails, and acceptance.

mod backward_difference;
mod equilibrium;
mod exchange;
mod failure;
mod history;
mod intervene;
mod measure;
mod newton;
mod observe;
mod parameters;
mod path;
mod report;
mod simulation;
mod stage;
mod step_control;

pub use crate::mechanics::system::{Grasp, Resultants};
pub use parameters::{IntegrationParameters, Scheme, StepSize};
pub use report::{Energies, Exchange, SimulationError, SimulationState, StepReport};
pub use simulation::Simulation;

#[cfg(test)]
mod barrier_tests;
#[cfg(test)]
mod complementarity_tests;
#[cfg(test)]
mod equilibrium_tests;
#[cfg(test)]
mod intervene_tests;
#[cfg(test)]
mod path_tests;
#[cfg(test)]
mod rubbing_tests;
#[cfg(test)]
mod tests;
