//! Name and description of a step of a task.

use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Name and description of a step, for records and reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// Name in records.
    pub name: Cow<'static, str>,
    /// Description: "going to the first point".
    pub words: Cow<'static, str>,
    /// Advice after a task that ended in this stage.
    pub next: &'static str,
}

impl Stage {
    /// Name of the steps in which a rod is laid.
    pub const LAY: &'static str = "lay";

    /// Creates a stage from its name, its description, and the advice after a task that ended in
    /// it.
    pub const fn new(name: &'static str, words: &'static str, next: &'static str) -> Self {
        Self {
            name: Cow::Borrowed(name),
            words: Cow::Borrowed(words),
            next,
        }
    }
}

impl Serialize for Stage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.name.serialize(serializer)
    }
}
