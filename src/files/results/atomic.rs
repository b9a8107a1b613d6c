//! Atomic writing of files: to a temporary file that is synced and renamed.
//!
//! Waiting for the disk takes longer than many cases of a sweep. [`write_whole`] waits until the
//! file would survive a loss of power, [`write_whole_before`] only until its contents would, and
//! [`place_whole`] does not wait. In short cases of a sweep none of them waits
//! ([`LaterSync`](super::LaterSync)).

use super::ResultsError;
use super::later_sync::sync_now_or_later;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Prefix of temporary files; leftovers of a crash are removed at the next start.
pub(super) const TEMPORARY_PREFIX: &str = ".rodlab-unfinished-";

/// Whether a file name is that of a leftover temporary file.
pub fn is_unfinished(name: &OsStr) -> bool {
    name.to_string_lossy().starts_with(TEMPORARY_PREFIX)
}

/// Number of bytes that identify the kind of a file.
const HEAD: u64 = 4096;

/// Writes a whole file, or leaves the old one untouched.
///
/// A reader sees the old bytes or the new ones, never a part, even through a crash or a full disk.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    write_whole_before(path, bytes)?;
    // The new name is durable only after its directory is synced.
    #[cfg(unix)]
    sync(directory_of(path))?;
    Ok(())
}

/// Writes files, each with its name, like [`write_whole`] into a directory, which is created if it is
/// missing. Returns their paths.
///
/// # Errors
/// [`ResultsError::Io`] naming the first path that cannot be written.
pub fn write_files(
    directory: &Path,
    files: &[(&str, Vec<u8>)],
) -> Result<Vec<PathBuf>, ResultsError> {
    std::fs::create_dir_all(directory).map_err(ResultsError::io("write", directory))?;
    let mut paths = Vec::new();
    for (name, bytes) in files {
        let path = directory.join(name);
        write_whole(&path, bytes)?;
        paths.push(path);
    }
    Ok(paths)
}

/// Writes a file like [`write_whole`] to a path chosen by the user: replaces only a file that
/// `is_own` accepts by its first bytes.
///
/// # Errors
/// [`ResultsError::NotOwn`] if something else is there: a device, a link, a folder, another file;
/// otherwise as [`write_whole`].
pub fn replace_own(
    path: &Path,
    bytes: &[u8],
    is_own: impl Fn(&[u8]) -> bool,
) -> Result<(), ResultsError> {
    check_own(path, is_own)?;
    write_whole(path, bytes)
}

/// Checks that a path is free, or holds a file that `is_own` accepts by its first bytes, before it
/// is replaced or removed.
///
/// # Errors
/// [`ResultsError::NotOwn`] as for [`replace_own`]; [`ResultsError::Io`] if it cannot be read.
pub fn check_own(path: &Path, is_own: impl Fn(&[u8]) -> bool) -> Result<(), ResultsError> {
    let refusal = |what| {
        Err(ResultsError::NotOwn {
            path: path.to_owned(),
            what,
        })
    };
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => return refusal("a folder"),
        Ok(found) if !found.is_file() => return refusal("not a regular file"),
        Ok(found) if found.len() > 0 => {
            let mut head = Vec::new();
            let opened = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
            opened.map_err(ResultsError::io("read", path))?;
            if !is_own(&head) {
                return refusal("a file of another kind");
            }
        }
        _ => {}
    }
    Ok(())
}

/// Writes a whole file like [`write_whole`], which must follow in the same directory: it also
/// makes the name of this file durable.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub(super) fn write_whole_before(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    written_aside(directory_of(path), bytes)
        .and_then(|file| {
            sync_now_or_later(|| file.as_file().sync_all())?;
            Ok(file.persist(path)?)
        })
        .map(drop)
        .map_err(ResultsError::io("write", path))
}

/// Writes a whole file that is useless without later ones. Until it is [`sync`]ed, a loss of power
/// may leave it empty or remove it.
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
pub fn sync(path: &Path) -> Result<(), ResultsError> {
    File::open(path)
        .and_then(|file| sync_now_or_later(|| file.sync_all()))
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
    // Temporary files are private by default; results get the permissions of the user's mask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(directory)?;
    file.write_all(bytes)?;
    Ok(file)
}

/// Creates a file with its contents atomically, unless a file of its name exists. The file is not
/// synced.
///
/// # Errors
/// `AlreadyExists` if such a file exists; otherwise the error of the file system.
pub(super) fn create_whole(directory: &Path, name: &str, bytes: &[u8]) -> std::io::Result<()> {
    let file = written_aside(directory, bytes)?;
    file.persist_noclobber(directory.join(name))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_own_file_is_replaced_never_a_device_a_link_or_a_folder() {
        let directory = tempfile::tempdir().unwrap();
        let place = |name: &str| directory.path().join(name);
        let is_own: fn(&[u8]) -> bool = |head| head.starts_with(b"own");
        replace_own(&place("new"), b"own 1", is_own).unwrap();
        replace_own(&place("new"), b"own 2", is_own).unwrap();
        assert_eq!(fs::read(place("new")).unwrap(), b"own 2");
        fs::write(place("letter"), "to a friend").unwrap();
        fs::create_dir(place("folder")).unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(place("new"), place("link")).unwrap();
        for name in ["letter", "folder", "link"] {
            let error = replace_own(&place(name), b"own 3", is_own).unwrap_err();
            assert!(matches!(error, ResultsError::NotOwn { .. }), "{error}");
        }
        assert!(replace_own(Path::new("/dev/null"), b"own", is_own).is_err());
        assert_eq!(fs::read(place("letter")).unwrap(), b"to a friend");
        assert_eq!(fs::read(place("new")).unwrap(), b"own 2");
    }
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
