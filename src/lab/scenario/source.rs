//! The texts of a scenario, and positions in them.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All sources of a scenario: the file or the table in memory, the files it extends, and overrides
/// from the command line.
#[derive(Clone, Debug, Default)]
pub struct Sources(Vec<Source>);

/// One text or table.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name in messages: the path of the file, the name of the table, or the option of the
    /// override.
    pub name: String,
    /// Text of the file; a table in memory has none.
    pub text: Option<Arc<str>>,
    /// The directory relative to which it names other files.
    pub directory: PathBuf,
}

/// A stretch of one source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Index of the source.
    pub source: usize,
    /// Range of bytes in its text. Without text, an empty range at the ordinal number of the key
    /// or value in the table.
    pub bytes: Range<usize>,
}

impl Sources {
    /// Adds a text, or a table without text, and returns its index.
    pub fn add(&mut self, name: String, text: Option<Arc<str>>, directory: &Path) -> usize {
        self.0.push(Source {
            name,
            text,
            directory: directory.to_owned(),
        });
        self.0.len() - 1
    }

    /// The source with an index that [`Sources::add`] returned.
    pub fn get(&self, source: usize) -> &Source {
        &self.0[source]
    }
}

/// Line and column, both counted from one, of a byte of a text.
pub fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = String::from_utf8_lossy(&text.as_bytes()[..byte.min(text.len())]);
    let line = before.matches('\n').count() + 1;
    let column = before
        .rsplit('\n')
        .next()
        .map_or(0, |tail| tail.chars().count())
        + 1;
    (line, column)
}
