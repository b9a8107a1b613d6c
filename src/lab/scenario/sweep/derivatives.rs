//! The derivatives that a sweep adds to its table.

use super::axis::sweep_path;
use crate::scenario::decode::decode;
use crate::scenario::document::{Entry, Node};
use crate::scenario::issue::{Issue, Issues};
use crate::scenario::typed;

/// Probes and keys of `[sweep.derivatives]`.
#[derive(Clone, Debug)]
pub struct SweptDerivatives {
    /// Probes or columns; empty for all of them.
    pub of: Vec<String>,
    /// Dotted keys of the derivatives.
    pub to: Vec<String>,
    /// The table as typed.
    pub(super) typed: Node,
}

impl SweptDerivatives {
    /// Reads `[sweep.derivatives]`.
    pub(super) fn read(entry: &Entry) -> Result<Self, Issues> {
        let path = sweep_path().key("derivatives");
        let typed: typed::SweptDerivatives =
            decode(&entry.node).map_err(|issues: Issues| issues.below(&path))?;
        if typed.to.is_empty() {
            let message = "expected at least one key";
            return Err(Issue::new(path.key("to"), message).into());
        }
        Ok(Self {
            of: typed.of,
            to: typed.to,
            typed: entry.node.clone(),
        })
    }
}
