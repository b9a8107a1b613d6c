//! A helical rod manipulated in time (thesis 6.3): what a robot does to a rod, and where the rod ceases to follow.
//!
//! One end of a straight rod rests, the other is moved so that the rod would become the helices of growing distance
//! ‖(κ, τ, ω)‖ along a direction. The error e of Eq. 6.1 tells when it is one no longer.
//!
//! | file | what |
//! |---|---|
//! | `end_path` | where the manipulated end is when, at a given speed and with jitter |
//! | `buckling` | the error e, where it grows, and whether the rod snaps |

mod buckling;
mod end_path;

pub use buckling::{Buckling, Observation, helix_error};
pub use end_path::{EndPath, Manipulation};
