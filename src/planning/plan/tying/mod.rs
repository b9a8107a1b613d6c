//! Knots tied on the table (thesis 5.5.6), after a rod is laid along a pattern that crosses itself.
//!
//! A laid rod passes over everything that is already there. Where it must pass under, its end is
//! moved there. A pattern longer than the rod continues as the path of the rod's end: one gripper
//! moves the end along the table, over strands and under strands that another gripper lifts
//! meanwhile.
//!
//! Two rods are laid one after the other, the second over the first. Then their ends are moved,
//! first that of the second rod: under and over strands of the other rod or of their own.

#[cfg(test)]
pub mod drawn;
mod passage;
mod path;
mod schedule;

pub use passage::{Pass, Passage, Place, TiedRod, TyingError, laid_length, passages};
pub use path::{GripperPoses, LiftPath, TyingTask};
pub use schedule::{Handling, Schedule};
