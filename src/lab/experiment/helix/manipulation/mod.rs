//! Manipulation of a helical rod in time (thesis 6.3): the robot's motion, and the loss of
//! stability of the rod.
//!
//! One end of a straight rod is fixed. The other is moved so that the rod would form the helices
//! of increasing distance ‖(κ, τ, ω)‖ along a direction. The error e of Eq. 6.1 shows when the rod
//! has left them.
//!
//! | file | what |
//! |---|---|
//! | `clamped_rod` | the rod between a chuck and a hand, from its file |
//! | `clamp_poses` | poses of chuck and hand for a rod that should be a helix |
//! | `end_path` | the path of the manipulated end, at a given speed and with jitter |
//! | `buckling` | the error e, where it grows, and whether the rod snaps |

mod buckling;
mod clamp_poses;
mod clamped_rod;
mod end_path;

pub use buckling::{Buckling, Observation, helix_error};
pub use clamp_poses::ClampPoses;
pub use clamped_rod::ClampedRod;
pub use end_path::{EndPath, Manipulation};
