//! Knots tied on the table (thesis 5.5.6), after a rod is laid along a pattern that crosses itself.
//!
//! A laid rod passes over everything that is already there. Where it must pass under, its end is
//! moved there: a pattern longer than the rod continues as the path of the end, which one gripper
//! moves along the table, under strands that another gripper lifts meanwhile, and over others.
//!
//! Two rods are laid one after the other, the second over the first. Then their ends are moved,
//! that of the second rod first: under strands of the other rod, or of its own, and over them.

#[cfg(test)]
pub mod drawn;
mod passage;
mod path;
mod schedule;

pub use passage::{Pass, Passage, Place, TiedRod, TyingError, laid_length, passages};
pub use path::{GripperPoses, LiftPath, TyingTask};
pub use schedule::{Handling, Schedule};
