//! One solution of a problem, or all of them.

use serde::Serialize;

/// One solution, or all.
#[derive(Serialize)]
#[serde(untagged)]
pub enum Answers<A> {
    /// Without `--all`.
    One(A),
    /// With `--all`.
    All {
        /// Solutions, the gentle one first.
        solutions: Vec<A>,
    },
}
