//! Directories for logs of what was moved.

use super::failure::Failure;
use std::path::{Path, PathBuf};

/// An empty directory, given or named after `what` and the time: everything that moves an arm has its own.
pub fn log_directory(what: &str, given: Option<&Path>) -> Result<PathBuf, Failure> {
    let directory = given.map_or_else(
        || {
            let now = jiff::Timestamp::now()
                .strftime("%Y%m%dT%H%M%S%.3fZ")
                .to_string();
            Path::new("results").join(format!("{what}-{now}"))
        },
        Path::to_owned,
    );
    let made = std::fs::create_dir_all(&directory).and_then(|()| std::fs::read_dir(&directory));
    match made.map(|mut entries| entries.next().is_some()) {
        Ok(false) => Ok(directory),
        Ok(true) => Err(Failure::Input(format!(
            "--out: {} is not empty; every log needs a directory of its own",
            directory.display()
        ))),
        Err(error) => Err(Failure::Input(format!(
            "--out: {} cannot be made: {error}",
            directory.display()
        ))),
    }
}
