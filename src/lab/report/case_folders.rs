//! Folders of the cases of a results directory: a single run is one case; a sweep has a folder for
//! each case.

use rodlab_files::results::{ResultsError, SUMMARY, Table};
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the cases of a sweep.
const CASES: &str = "cases";

/// A case of a results directory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseFolder {
    /// Id of the case; for a single run the id of the directory.
    pub name: String,
    /// Folder of its files.
    pub path: PathBuf,
    /// The swept parameters, as (dotted key, value).
    pub parameters: Vec<(String, String)>,
}

/// The cases of a results directory in the order of its `summary.csv`, then by id.
///
/// # Errors
/// [`ResultsError::Io`] or [`ResultsError::Damaged`] if the folder or the summary cannot be read.
pub fn case_folders(directory: &Path) -> Result<Vec<CaseFolder>, ResultsError> {
    let cases = directory.join(CASES);
    if !cases.is_dir() {
        return Ok(vec![CaseFolder {
            name: name_of(directory),
            path: directory.to_owned(),
            parameters: Vec::new(),
        }]);
    }
    let io = |error| ResultsError::io("read", cases.clone())(error);
    let mut names = Vec::new();
    for entry in fs::read_dir(&cases).map_err(io)? {
        let entry = entry.map_err(io)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() && !name.starts_with('.') {
            names.push(name);
        }
    }
    let summary = directory.join(SUMMARY);
    let table = if summary.exists() {
        Some(Table::read(&summary)?)
    } else {
        None
    };
    let row_of = |name: &str| {
        let mut ids = table.as_ref()?.column("case")?;
        ids.position(|id| id == name)
    };
    names.sort_by_key(|name| (row_of(name).unwrap_or(usize::MAX), name.clone()));
    let folder = |name: String| CaseFolder {
        path: cases.join(&name),
        parameters: match (&table, row_of(&name)) {
            (Some(table), Some(row)) => parameters(table, row),
            _ => Vec::new(),
        },
        name,
    };
    Ok(names.into_iter().map(folder).collect())
}

/// The swept parameters of a `summary.csv`: its columns between `case` and `status`.
pub fn parameter_columns(summary: &Table) -> impl Iterator<Item = &str> {
    let columns = summary.columns().iter().map(String::as_str).skip(1);
    columns.take_while(|column| *column != "status")
}

fn parameters(summary: &Table, row: usize) -> Vec<(String, String)> {
    let values = summary.row(row).iter().skip(1).cloned();
    parameter_columns(summary)
        .map(str::to_owned)
        .zip(values)
        .collect()
}

fn name_of(directory: &Path) -> String {
    let name = directory.file_name().map(|name| name.to_string_lossy());
    name.map_or_else(|| "run".into(), |name| name.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_come_in_the_order_of_the_summary_with_their_parameters() {
        let directory = tempfile::tempdir().unwrap();
        for case in ["b-1", "a-2", "c-3", ".tmp"] {
            fs::create_dir_all(directory.path().join(CASES).join(case)).unwrap();
        }
        let summary =
            "case,contact.friction,status,steps\nb-1,0.1,finished,3\na-2,0.2,finished,4\n";
        fs::write(directory.path().join(SUMMARY), summary).unwrap();
        let folders = case_folders(directory.path()).unwrap();
        let names: Vec<&str> = folders.iter().map(|folder| folder.name.as_str()).collect();
        assert_eq!(names, ["b-1", "a-2", "c-3"]);
        assert_eq!(
            folders[1].parameters,
            [("contact.friction".into(), "0.2".into())]
        );
        assert!(folders[2].parameters.is_empty());
    }

    #[test]
    fn a_single_run_is_one_case() {
        let directory = tempfile::tempdir().unwrap();
        let folders = case_folders(directory.path()).unwrap();
        assert_eq!(folders.len(), 1);
        assert_eq!(folders[0].path, directory.path());
    }
}
