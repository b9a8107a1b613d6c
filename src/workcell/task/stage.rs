//! What is done in a step of a task, for programs and people.

use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// What is done in a step, for programs and people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// Its name in records.
    pub name: Cow<'static, str>,
    /// In words: "going to the first point".
    pub words: Cow<'static, str>,
    /// What to do after a task that ended in it.
    pub next: &'static str,
}

impl Stage {
    /// The name of steps in which a rod is laid.
    pub const LAY: &'static str = "lay";

    /// A stage by its name, in words, and what to do after a task that ended in it.
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
