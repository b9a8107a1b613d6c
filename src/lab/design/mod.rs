//! Inverse design: the natural shape of a rod with which a given curve is its equilibrium.
//!
//! The page `design` of the guide has the equations; the recursion is that of [`rodlab_engine::mechanics::statics`].
//!
//! | file | what |
//! |---|---|
//! | `curve` | the wanted curve as a spline with nodes at equal distances |
//! | `task` | from a scenario and a curve to the natural strains, and their check |
//! | `unloaded` | the nodes of the rod without stress |
//! | `files`, `figure` | what is written |

mod curve;
mod error;
mod figure;
mod files;
mod task;
#[cfg(test)]
mod tests;
mod unloaded;

pub use error::DesignError;
pub use files::{DESIGNED, FIGURE, NATURAL, NODES, RESULT, write};
pub use task::{Designed, Request, design};
