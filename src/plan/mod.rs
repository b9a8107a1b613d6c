//! Plans: what a gripper must do so that a rod comes to lie where it should.

pub mod deployment;
pub mod grasp;
pub mod pattern;
pub mod tying;
