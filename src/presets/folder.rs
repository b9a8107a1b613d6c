//! The folder to which presets are written.

use super::embedded::FILES;
use std::env;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::NamedTempFile;
use thiserror::Error;

/// The presets cannot be written to the cache.
#[derive(Debug, Error)]
#[error("{} cannot be written: {error}; presets are unpacked there (XDG_CACHE_HOME names another place)", path.display())]
pub struct CannotUnpack {
    path: PathBuf,
    error: io::Error,
}

/// The folder with all files, in the cache of the user. The files are compared and written once
/// per process.
pub(super) fn unpacked() -> Result<&'static Path, CannotUnpack> {
    static UNPACKED: OnceLock<PathBuf> = OnceLock::new();
    if let Some(folder) = UNPACKED.get() {
        return Ok(folder);
    }
    let folder = cache()
        .join("rodlab")
        .join(concat!("presets-", env!("CARGO_PKG_VERSION")));
    unpack(&folder)?;
    Ok(UNPACKED.get_or_init(|| folder))
}

/// `XDG_CACHE_HOME`, `~/.cache`, or the folder for temporary files.
fn cache() -> PathBuf {
    let absolute = |name| {
        env::var_os(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    absolute("XDG_CACHE_HOME")
        .or_else(|| absolute("HOME").map(|home| home.join(".cache")))
        .unwrap_or_else(env::temp_dir)
}

/// Writes the files that are missing from a folder or differ from the embedded ones. Each is
/// written atomically, so that several processes can unpack at the same time.
fn unpack(folder: &Path) -> Result<(), CannotUnpack> {
    for (path, bytes) in FILES {
        let path = folder.join(path);
        if fs::read(&path).is_ok_and(|present| present == *bytes) {
            continue;
        }
        place(&path, bytes).map_err(|error| CannotUnpack { path, error })?;
    }
    Ok(())
}

fn place(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().expect("files lie in a folder");
    fs::create_dir_all(folder)?;
    let mut aside = NamedTempFile::new_in(folder)?;
    aside.write_all(bytes)?;
    aside.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_missing_or_changed_are_written() {
        let folder = tempfile::tempdir().unwrap();
        unpack(folder.path()).unwrap();
        let (first, last) = (&FILES[0], &FILES[FILES.len() - 1]);
        fs::write(folder.path().join(first.0), "changed").unwrap();
        fs::remove_file(folder.path().join(last.0)).unwrap();
        unpack(folder.path()).unwrap();
        for (path, bytes) in FILES {
            assert_eq!(
                &fs::read(folder.path().join(path)).unwrap(),
                bytes,
                "{path}"
            );
        }
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let error = unpack(&file).unwrap_err().to_string();
        assert!(
            error.contains("file") && error.contains("XDG_CACHE_HOME"),
            "{error}"
        );
    }
}
