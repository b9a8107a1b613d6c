//! Directories for logs of motions.

use super::prelude::*;

/// Directory for results: the given one, or `results/NAME`.
pub fn results_directory(given: Option<&Path>, name: &str) -> PathBuf {
    given.map_or_else(|| Path::new("results").join(name), Path::to_owned)
}

/// Path of an empty directory, as given or named after `what` and the time. The directory is not
/// created yet. Every motion of an arm has its own directory.
pub fn empty_directory(what: &str, given: Option<&Path>) -> Result<PathBuf, Failure> {
    let now = jiff::Timestamp::now().strftime("%Y%m%dT%H%M%S%.3fZ");
    let directory = results_directory(given, &format!("{what}-{now}"));
    match std::fs::read_dir(&directory).map(|mut entries| entries.next().is_some()) {
        Ok(true) => Err(Failure::Input(format!(
            "--out: {} is not empty; every log needs a directory of its own",
            directory.display()
        ))),
        _ => Ok(directory),
    }
}

/// Creates the directory of [`empty_directory`].
pub fn log_directory(what: &str, given: Option<&Path>) -> Result<PathBuf, Failure> {
    let directory = empty_directory(what, given)?;
    let made = std::fs::create_dir_all(&directory);
    made.at(format_args!(
        "--out: {} cannot be made",
        directory.display()
    ))?;
    Ok(directory)
}
