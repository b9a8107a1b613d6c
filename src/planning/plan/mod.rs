//! Plans: what a gripper must do so that a rod comes to lie, or a sheet is folded, as it should.

pub mod deployment;
pub mod files;
pub mod fold;
mod fold_figures;
pub mod fold_request;
pub mod grasp;
pub mod pattern;
pub mod remedy;
pub mod request;
pub mod tying;
