//! Answers that contain one solution of a problem, or all of them.

use serde::Serialize;

/// One solution, or all solutions.
#[derive(Serialize)]
#[serde(untagged)]
pub enum Answers<A> {
    /// One solution, without `--all`.
    One(A),
    /// All solutions, with `--all`.
    All {
        /// The solutions; the gentle one is first.
        solutions: Vec<A>,
    },
}
