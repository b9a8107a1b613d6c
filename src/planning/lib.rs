//! Plans without a simulation in time: knots and their theory, patterns, grasps, folds, and their
//! surrogate models.
//!
//! | module | content |
//! |---|---|
//! | [`knot`] | knots from parameters, the knot determinant, theory of tightening |
//! | [`learn`] | samples, networks, training, models in files |
//! | [`plan`] | patterns, optimal grasps, trajectories of a gripper |

// Tests compare with a tolerance, and may use any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod knot;
pub mod learn;
pub mod plan;
#[cfg(test)]
mod reference;
