//! Plans: what a gripper must do so that a rod comes to lie, or a sheet is folded, as it should.

pub mod deployment;
pub mod fold;
pub mod grasp;
pub mod pattern;
pub mod request;
pub mod tying;
