//! Files that appear whole: written aside, synced, renamed.
//!
//! To wait for the disk takes longer than many a case of a sweep. [`write_whole`] waits until the file would
//! survive a loss of power, [`write_whole_before`] until it does together with the next one, and
//! [`place_whole`] not at all.

use super::ResultsError;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use tempfile::NamedTempFile;

/// Prefix of files being written; what is left of them after a crash is swept at the next start.
pub(super) const TEMPORARY_PREFIX: &str = ".rodlab-";

/// Writes a whole file, or leaves the old one untouched.
///
/// A reader sees the old bytes or the new ones, never a part, even through a crash or a full disk.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    write_whole_before(path, bytes)?;
    // The new name is safe only once the directory that holds it is.
    #[cfg(unix)]
    sync(directory_of(path))?;
    Ok(())
}

/// The same where [`write_whole`] follows in the same directory, which makes the name of this file safe, too.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub(super) fn write_whole_before(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    written_aside(directory_of(path), bytes)
        .and_then(|file| {
            file.as_file().sync_all()?;
            Ok(file.persist(path)?)
        })
        .map(drop)
        .map_err(ResultsError::io("write", path))
}

/// The same for a file that is worth nothing without others that follow: until it is [`sync`]ed, a loss of
/// power may leave it empty or take it away.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub(super) fn place_whole(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    written_aside(directory_of(path), bytes)
        .and_then(|file| Ok(file.persist(path)?))
        .map(drop)
        .map_err(ResultsError::io("write", path))
}

/// Waits until a file or directory would survive a loss of power.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub(crate) fn sync(path: &Path) -> Result<(), ResultsError> {
    File::open(path)
        .and_then(|file| file.sync_all())
        .map_err(ResultsError::io("write", path))
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A temporary file in `directory` that holds `bytes`.
fn written_aside(directory: &Path, bytes: &[u8]) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX);
    // Temporary files are private by default; results are as readable as the user's mask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(directory)?;
    file.write_all(bytes)?;
    Ok(file)
}

/// Makes a file that appears with its bytes in it, unless there is one of its name already. It is not synced.
///
/// # Errors
/// `AlreadyExists` where there is one; any other fault of the file system.
pub(super) fn create_whole(directory: &Path, name: &str, bytes: &[u8]) -> std::io::Result<()> {
    let file = written_aside(directory, bytes)?;
    file.persist_noclobber(directory.join(name))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn replaces_the_whole_file_and_leaves_nothing_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("summary.csv");
        write_whole(&path, b"a long first version").unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failure_names_the_file_and_leaves_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        // A directory of that name cannot be replaced by a file.
        let path = directory.path().join("manifest.json");
        fs::create_dir(&path).unwrap();
        let error = write_whole(&path, b"{}").unwrap_err();
        assert!(error.to_string().contains("manifest.json"), "{error}");
        assert!(path.is_dir());
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }
}
