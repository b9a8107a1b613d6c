//! Origin of each table: the table as written, and the number of the copy.

use crate::scenario::issue::{Issue, KeyPath};
use std::collections::BTreeMap;

/// Origins of the tables of arrays with copies.
#[derive(Clone, Debug, Default)]
pub struct Origins(BTreeMap<String, Vec<Origin>>);

/// Origin of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Index of the table in the array as written.
    pub written: usize,
    /// Index of the copy among those of the table.
    pub copy: Option<usize>,
}

/// Number of tables of an array before and after expansion.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Copied {
    /// Key of the array.
    pub key: String,
    /// Tables as written.
    pub written: usize,
    /// Tables after expansion.
    pub expanded: usize,
}

impl Origins {
    /// Adds the array of a key, with the origin of each of its tables.
    pub fn insert(&mut self, key: &str, origins: Vec<Origin>) {
        self.0.insert(key.to_owned(), origins);
    }

    /// The arrays that have copies.
    pub fn copied(&self) -> Vec<Copied> {
        let copied = |(key, origins): (&String, &Vec<Origin>)| Copied {
            key: key.clone(),
            written: origins.last().map_or(0, |last| last.written + 1),
            expanded: origins.len(),
        };
        self.0.iter().map(copied).collect()
    }

    /// Converts a fault in the expanded document to a fault in the document as written.
    pub fn restore(&self, issue: Issue) -> Issue {
        let [key, index, below @ ..] = issue.path.steps() else {
            return issue;
        };
        let known = self.0.get(key).zip(index.parse::<usize>().ok());
        let Some(origin) = known.and_then(|(origins, index)| origins.get(index)) else {
            return issue;
        };
        let path = KeyPath::from(key.as_str()).index(origin.written);
        Issue {
            path: below.iter().fold(path, |path, step| path.key(step)),
            copy: origin.copy,
            ..issue
        }
    }
}
