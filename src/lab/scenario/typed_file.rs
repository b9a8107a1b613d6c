//! TOML files other than scenarios, with the same units, the same `extends` and the same messages.

use super::decode::decode;
use super::document::Node;
use super::error::ScenarioError;
use super::issue::{Issues, KeyPath};
use super::load::located;
use super::merged::merged;
use super::source::Sources;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// A file as typed, and the data to locate its keys.
#[derive(Debug)]
pub struct TypedFile<T> {
    /// Contents of the file.
    pub typed: T,
    sources: Sources,
    document: Node,
}

impl<T: DeserializeOwned> TypedFile<T> {
    /// Reads a file and those that it extends.
    ///
    /// # Errors
    /// A file that cannot be read or is not TOML, unknown keys and wrong types.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let (sources, document) = merged(path, &[])?;
        match decode(&document) {
            Ok(typed) => Ok(Self {
                typed,
                sources,
                document,
            }),
            Err(issues) => Err(located(&sources, &document, issues)),
        }
    }

    /// Faults found later, with the positions of their keys.
    pub fn locate(&self, issues: Issues) -> ScenarioError {
        located(&self.sources, &self.document, issues)
    }

    /// The directory of the file that contains a key: file names are relative to it.
    pub fn directory_of(&self, path: &KeyPath) -> PathBuf {
        let (_, value) = self.document.locate(path);
        self.sources.get(value.source).directory.clone()
    }
}
