//! Directories for logs of what was moved.

use super::prelude::*;

/// Where results go: as given, or in `results` by a name.
pub fn results_directory(given: Option<&Path>, name: &str) -> PathBuf {
    given.map_or_else(|| Path::new("results").join(name), Path::to_owned)
}

/// An empty directory, given or named after `what` and the time: everything that moves an arm has its own.
pub fn log_directory(what: &str, given: Option<&Path>) -> Result<PathBuf, Failure> {
    let now = jiff::Timestamp::now().strftime("%Y%m%dT%H%M%S%.3fZ");
    let directory = results_directory(given, &format!("{what}-{now}"));
    let made = std::fs::create_dir_all(&directory).and_then(|()| std::fs::read_dir(&directory));
    match made.map(|mut entries| entries.next().is_some()) {
        Ok(false) => Ok(directory),
        Ok(true) => Err(Failure::Input(format!(
            "--out: {} is not empty; every log needs a directory of its own",
            directory.display()
        ))),
        Err(error) => Err(no_directory(&directory, &error)),
    }
}

/// Why there is no directory for results.
pub fn no_directory(directory: &Path, error: &std::io::Error) -> Failure {
    let directory = directory.display();
    Failure::Input(format!("--out: {directory} cannot be made: {error}"))
}
