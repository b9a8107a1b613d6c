//! Inverse design: finds parameters for which a given curve is the equilibrium of a rod.
//!
//! A natural shape along the rod has a closed form: the page `design` of the guide has the
//! equations, [`rodlab_engine::mechanics::statics`] the recursion. A few numbers, such as poses of
//! clamps and loads, are fitted so that the equilibrium is closest to the curve.
//!
//! | file | what |
//! |---|---|
//! | `request`, `outcome` | what is wanted, and what was found by the way that suits |
//! | `curve` | the target curve as a spline with nodes at equal distances |
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
