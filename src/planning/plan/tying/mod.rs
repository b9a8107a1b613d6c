//! Knots tied on the table (thesis 5.5.6): what comes after a rod is laid along a pattern that crosses itself.
//!
//! A rod that is laid comes to lie over what lies there already. Where it must go under, its end is led there: a pattern that is
//! longer than the rod goes on as the path of the end, which one gripper leads along the table, under strands that
//! another gripper lifts meanwhile, and over others.
//!
//! Two rods are laid one after the other, the second over the first. Then their ends are led, that of the second rod first:
//! under strands of the other rod, or of its own, and over them.

#[cfg(test)]
pub mod drawn;
mod passage;
mod path;
mod schedule;

pub use passage::{Pass, Passage, Place, TiedRod, TyingError, laid_length, passages};
pub use path::{GripperPoses, LiftPath, TyingTask};
pub use schedule::{Handling, Schedule};
