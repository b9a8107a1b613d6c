//! The texts that a scenario is made of, and places in them.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All texts that make up a scenario: the file, those it extends, and overrides from the command line.
#[derive(Clone, Debug, Default)]
pub struct Sources(Vec<Source>);

/// One text.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name in messages: the path of the file, or the override's option.
    pub name: String,
    /// Its text.
    pub text: Arc<str>,
    /// The directory against which it names other files.
    pub directory: PathBuf,
}

/// A stretch of one text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Index of the text.
    pub source: usize,
    /// Bytes of the text.
    pub bytes: Range<usize>,
}

impl Sources {
    /// Adds a text and returns its index.
    pub fn add(&mut self, name: String, text: String, directory: &Path) -> usize {
        self.0.push(Source {
            name,
            text: text.into(),
            directory: directory.to_owned(),
        });
        self.0.len() - 1
    }

    /// The text of an index that [`Sources::add`] returned.
    pub fn get(&self, source: usize) -> &Source {
        &self.0[source]
    }
}

impl Source {
    /// Line and column, both counted from one, of a byte.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        let before = String::from_utf8_lossy(&self.text.as_bytes()[..byte.min(self.text.len())]);
        let line = before.matches('\n').count() + 1;
        let column = before
            .rsplit('\n')
            .next()
            .map_or(0, |tail| tail.chars().count())
            + 1;
        (line, column)
    }
}
