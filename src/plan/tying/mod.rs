//! Knots tied on the table (thesis 5.5.6): what comes after a rod is laid along a pattern that crosses itself.
//!
//! A rod that is laid comes to lie over what lies there already. Where it must go under, its end is led there: a pattern that is
//! longer than the rod goes on as the path of the end, which one gripper leads along the table, under strands that
//! another gripper lifts meanwhile, and over others.
//!
//! | file | what |
//! |---|---|
//! | `passage` | how a pattern comes to its crossings again, over or under |
//! | `schedule` | when the end is where, and when strands are lifted |
//! | `path` | poses of both grippers |

mod passage;
mod path;
mod schedule;

pub use passage::{Pass, Passage, TyingError, laid_length, passages};
pub use path::{GripperPoses, LiftPath, end_path, lift_paths};
pub use schedule::{Handling, Schedule};
