//! Descriptions of files and columns of results directories, for every run and for kinds of
//! experiments.

use super::KINDS;
use rodlab_files::results::{Column, FILES, FileDescription};

/// Meaning of a key of `rodlab explain` such as `series.contacts`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Described<'a> {
    /// A file: its general description, then the additions of kinds of experiments.
    File(Vec<&'static FileDescription>),
    /// A column of a file.
    Column(&'static FileDescription, &'static Column),
    /// A file that has no such column.
    NoColumn(Vec<&'static FileDescription>, &'a str),
}

/// All descriptions of files. Kinds that share a folder may share descriptions, too.
pub fn described_files() -> Vec<&'static FileDescription> {
    let mut files: Vec<&'static FileDescription> = FILES.iter().collect();
    for file in KINDS.iter().flat_map(|kind| kind.files()) {
        if !files.iter().any(|known| std::ptr::eq(*known, file)) {
            files.push(file);
        }
    }
    files
}

/// Looks up a file or a column: `series.csv`, `series`, `series.contacts` or
/// `series.csv.contacts`. `None` if the key does not name a file.
pub fn describe(key: &str) -> Option<Described<'_>> {
    let called = |word: &str| -> Vec<&'static FileDescription> {
        let files = described_files().into_iter();
        files.filter(|file| file.is_called(word)).collect()
    };
    let whole = called(key);
    if !whole.is_empty() {
        return Some(Described::File(whole));
    }
    // The longest matching file name is used, so that `series.csv.contacts` is not read as a
    // column `csv.contacts`.
    key.rmatch_indices('.').find_map(|(dot, _)| {
        let (word, name) = (&key[..dot], &key[dot + 1..]);
        let files = called(word);
        let mut columns = files
            .iter()
            .flat_map(|file| file.columns().map(move |column| (*file, column)));
        match columns.find(|(_, column)| column.name == name) {
            Some((file, column)) => Some(Described::Column(file, column)),
            None if files.is_empty() => None,
            None => Some(Described::NoColumn(files, name)),
        }
    })
}

/// The files with a column of this name.
pub fn files_with_column(name: &str) -> Vec<(&'static FileDescription, &'static Column)> {
    let files = described_files().into_iter();
    files
        .flat_map(|file| file.columns().map(move |column| (file, column)))
        .filter(|(_, column)| column.name == name)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_columns_are_found_with_and_without_their_ending() {
        let column = |key| match describe(key) {
            Some(Described::Column(file, column)) => (file.names[0], column.name),
            other => panic!("{key}: {other:?}"),
        };
        for key in ["series.contacts", "series.csv.contacts"] {
            assert_eq!(column(key), ("series.csv", "contacts"));
        }
        // Columns of a kind, in a common file and in a file of its own.
        assert_eq!(
            column("series.traction_start_n"),
            ("series.csv", "traction_start_n")
        );
        assert_eq!(column("boundary.kappa"), ("boundary.csv", "kappa"));
        for key in ["series", "series.csv"] {
            assert!(
                matches!(describe(key), Some(Described::File(files)) if files[0].names == ["series.csv"])
            );
        }
        assert!(matches!(describe("rods.png"), Some(Described::File(_))));
        assert!(matches!(
            describe("series.contact"),
            Some(Described::NoColumn(_, "contact"))
        ));
        assert_eq!(describe("rods"), None);
        assert_eq!(describe("contact.friction"), None);
        assert_eq!(files_with_column("first_contact_s").len(), 1);
    }
}
