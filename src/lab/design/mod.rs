//! Inverse design: what makes a given curve the equilibrium of a rod.
//!
//! The natural shape along the rod does so in closed form; the page `design` of the guide has the equations, the recursion is that of
//! [`rodlab_engine::mechanics::statics`]. A few numbers, such as poses of clamps and loads, are those with which the equilibrium is closest.
//!
//! | file | what |
//! |---|---|
//! | `request`, `outcome` | what is wanted, and what was found by the way that suits |
//! | `curve` | the wanted curve as a spline with nodes at equal distances |
//! | `task` | from a scenario and a curve to the natural strains |
//! | `numbers`, `keys` | to the values of keys, and the numbers that keys name |
//! | `check` | the equilibrium of what was found |
//! | `unloaded` | the nodes of the rod without stress |
//! | `files`, `figure` | what is written |

mod check;
mod curve;
mod error;
mod figure;
mod files;
mod keys;
mod numbers;
mod outcome;
mod request;
mod task;
#[cfg(test)]
mod tests;
mod unloaded;

pub use error::DesignError;
pub use files::{DESIGNED, FIGURE, NATURAL, NODES, RESULT, write};
pub use numbers::{DesignedKey, DesignedNumbers};
pub use outcome::{Design, design};
pub use request::Request;
pub use task::Designed;
