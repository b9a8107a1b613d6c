//! Continuous rods: inextensible, unshearable Kirchhoff rods, solved without a mesh.
//!
//! These are the limits of the discrete rod, in closed form or from ordinary differential
//! equations. They serve as exact solutions and for verifying the discrete rod.
//!
//! | file | contents |
//! |---|---|
//! | `elastica` | planar elasticas under a force and their weight, from one end on |
//! | `cantilever` | the same clamped at one end, under its own weight or a load at its tip |
//! | `hanging_strip` | strip held horizontally at one end, which hangs down |
//! | `heavy_loop` | height of a rod that is folded over onto itself |
//! | `helix` | helical equilibria and the linearised equations about them |
//! | `conjugate_point` | first loss of stability of a helix with clamped ends |
//! | `spatial_cantilever` | cantilever in space, of any section and natural shape, by multiple shooting |
//! | `straight_rod` | the same for the straight rod, twisted and pulled, in closed form |
//! | `suspended_loop` | a loop held at its two ends only, in space |
//! | `numerics` | zeros, Runge–Kutta and quadrature |

mod cantilever;
mod conjugate_point;
pub mod elastica;
mod hanging_strip;
mod heavy_loop;
mod helix;
pub mod numerics;
mod spatial_cantilever;
mod straight_rod;
mod suspended_loop;

pub use cantilever::{Cantilever, CantileverLoad};
pub use conjugate_point::{CriticalDistance, critical_distance};
pub use hanging_strip::{HangingStrip, StripError};
pub use heavy_loop::HeavyLoop;
pub use helix::Helix;
pub use spatial_cantilever::SpatialCantilever;
pub use suspended_loop::{EndSpin, LoopEnds, SuspendedLoop};
