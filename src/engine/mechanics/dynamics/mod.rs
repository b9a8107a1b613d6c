//! Time stepping: the implicit step, Newton's method, step control.
//!
//! [`Simulation`] is the entry point. `Integrator::step` takes a step: it evaluates the drag at
//! the start of the step or for the predicted motion, finds contact candidates, solves an implicit
//! stage by Newton's method, repeats a failed step with smaller ones, and accepts the result.
//!
//! | file | what |
//! |---|---|
//! | `parameters` | scheme, step and tolerances, with the reason for each default |
//! | `state`, `history` | configuration and velocities, at present and at the last steps |
//! | `scheme/` | one file per time scheme: its equations, its derivation, its order |
//! | `stage`, `newton` | one attempt at a step: prediction, contact forces, Newton's method |
//! | `step_control` | the size of the next step |
//! | `integrator` | the step |
//! | `flow_scene`, `drag`, `exchange` | rods in the fluid; its forces; work and losses of a step |
//! | `equilibrium`, `path` | statics of the same scene |
//! | `adjoint/` | derivatives of results over fields along rods |
//! | `sensitivity/` | derivatives of motions and equilibria over parameters of the scene |
//! | `validity`, `validity_memory` | remarks on strains beyond the theory, on spurious energy, on steps far smaller than requested |
//! | `report`, `failure`, `observe` | reports, failures of steps, observations |
//! | `advice` | advice on failed steps |

pub mod adjoint;
mod advice;
mod background;
mod certificate;
mod contact_passes;
mod coupling;
mod drag;
mod equilibrium;
mod exchange;
mod failure;
mod flow_overlaps;
mod flow_scene;
mod history;
mod impact;
#[cfg(test)]
mod impact_tests;
mod integrator;
mod intervene;
mod lockstep;
mod measure;
mod newton;
mod observe;
mod parameters;
mod path;
mod report;
mod scheme;
pub mod sensitivity;
mod simulation;
mod stage;
mod state;
mod step_control;
mod touches;
mod validity;
mod validity_memory;

pub use crate::mechanics::system::{BodyMotion, Break, Grasp, Resultants};
pub use lockstep::Lockstep;
pub use measure::HeldPose;
pub use parameters::{IntegrationParameters, Scheme, StepSize};
pub use report::{Energies, Exchange, SimulationError, SimulationState, StepReport};
pub use simulation::Simulation;
pub use touches::Touch;
pub use validity::{LARGEST_CATCH, apparent_friction};

#[cfg(test)]
mod actuation_tests;
#[cfg(test)]
mod background_tests;
#[cfg(test)]
mod balance_tests;
#[cfg(test)]
mod ball_tests;
#[cfg(test)]
mod barrier_tests;
#[cfg(test)]
mod body_rigid_contact_tests;
#[cfg(test)]
mod breaking_tests;
#[cfg(test)]
mod complementarity_tests;
#[cfg(test)]
mod damping_tests;
#[cfg(test)]
mod directed_friction_tests;
#[cfg(test)]
mod equilibrium_tests;
#[cfg(test)]
mod event_tests;
#[cfg(test)]
mod flow_tests;
#[cfg(test)]
mod fluid_body_tests;
#[cfg(test)]
mod free_body_tests;
#[cfg(test)]
mod friction_tests;
#[cfg(test)]
mod inertia_tests;
#[cfg(test)]
mod intervene_tests;
#[cfg(test)]
mod joined_body_tests;
#[cfg(test)]
mod joined_rigid_contact_tests;
#[cfg(test)]
mod joint_start_tests;
#[cfg(test)]
mod joint_tests;
#[cfg(test)]
mod lockstep_tests;
#[cfg(test)]
mod many_rods_tests;
#[cfg(test)]
mod moving_obstacle_tests;
#[cfg(test)]
mod natural_shape_tests;
#[cfg(test)]
mod node_force_tests;
#[cfg(test)]
mod overdamped_tests;
#[cfg(test)]
mod own_friction_tests;
#[cfg(test)]
mod parallel_tests;
#[cfg(test)]
mod path_tests;
#[cfg(test)]
mod plasticity_tests;
#[cfg(test)]
mod pushed_tests;
#[cfg(test)]
mod rolling_tests;
#[cfg(test)]
mod section_contact_tests;
#[cfg(test)]
mod section_tests;
#[cfg(test)]
mod sheath_tests;
#[cfg(test)]
mod slide_tests;
#[cfg(test)]
mod smooth_contact_tests;
#[cfg(test)]
mod spring_tests;
#[cfg(test)]
mod tendon_tests;
#[cfg(test)]
mod test_log;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tie_tests;
