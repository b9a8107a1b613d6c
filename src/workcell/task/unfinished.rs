//! Tasks that did not finish. The next task with the same arm is rejected until the user has
//! inspected the arm.
//!
//! A mark file in the user's state directory records such a task, since a killed task can record
//! nothing.

use super::error::WorkError;
use super::state_folder::state_folder;
use crate::cell::Cell;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Number of digits of the hash that names a mark.
const DIGITS: usize = 16;

/// The mark of a task.
pub struct Unfinished {
    /// Index of the arm.
    pub(super) arm: usize,
    file: PathBuf,
    directory: PathBuf,
}

impl Unfinished {
    /// The mark of a task with an arm of a cell and the results directory of the task. The driver
    /// of the arm identifies it.
    pub fn of(cell: &Cell, arm: usize, directory: &Path) -> Self {
        let moved_by = format!("{:?}", cell.arms[arm].driver);
        let hash = blake3::hash(moved_by.as_bytes()).to_hex();
        Self {
            arm,
            file: state_folder("unfinished").join(&hash[..DIGITS]),
            directory: std::path::absolute(directory).unwrap_or_else(|_| directory.to_owned()),
        }
    }

    /// The results directory of the task that left the mark, if any.
    pub fn left(&self) -> Option<String> {
        fs::read_to_string(&self.file).ok()
    }

    /// Writes the mark before the arm moves.
    ///
    /// # Errors
    /// The mark cannot be written.
    pub(super) fn mark(&self) -> Result<(), WorkError> {
        let made = self.file.parent().map_or(Ok(()), fs::create_dir_all);
        let marked =
            made.and_then(|()| fs::write(&self.file, self.directory.display().to_string()));
        marked
            .map_err(|error| WorkError::Failed(format!("cannot mark the task as started: {error}")))
    }

    /// Removes the mark of a task that finished.
    ///
    /// # Errors
    /// The mark cannot be removed.
    pub fn clear(&self) -> io::Result<()> {
        match fs::remove_file(&self.file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }
}
