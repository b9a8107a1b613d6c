//! Files of sheets to fold.

use super::keys::{Paper, TypedPaper, resolve_paper};
use crate::scenario::keys::Section;
use crate::scenario::{Issues, KeyPath, ScenarioError, TypedFile};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::cell::RefCell;
use std::path::Path;

/// A sheet by its file.
pub struct PaperFile {
    /// Name of the sheet for readers.
    pub title: String,
    /// The sheet.
    pub paper: Paper,
}

#[derive(Debug, Deserialize)]
struct Typed {
    #[serde(rename = "extends")]
    _extends: Option<IgnoredAny>,
    title: Option<String>,
    folding: TypedFolding,
}

#[derive(Debug, Deserialize)]
struct TypedFolding {
    paper: TypedPaper,
}

impl PaperFile {
    /// Reads a sheet's file.
    ///
    /// # Errors
    /// All its faults, with file, line and key.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file: TypedFile<Typed> = TypedFile::read(path)?;
        let issues = RefCell::new(Issues::default());
        let directory = path.parent().unwrap_or(Path::new(""));
        let directory_of = |_: &KeyPath| directory.to_owned();
        let section = Section::new(KeyPath::from("folding.paper"), &issues, &directory_of);
        let paper = resolve_paper(&section, &file.typed.folding.paper);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let title = file.typed.title.clone();
        let found = paper.map(|paper| Self {
            title: title.unwrap_or_else(|| stem.into_owned()),
            paper,
        });
        match (issues.into_inner(), found) {
            (issues, Some(found)) if issues.0.is_empty() => Ok(found),
            (issues, _) => Err(file.locate(issues)),
        }
    }
}
