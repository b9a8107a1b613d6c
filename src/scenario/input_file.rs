//! Files that scenarios are made of: regular ones, of a bounded size.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// Largest scenario file, bytes: as a tree it takes some hundred times as much memory.
pub const LARGEST_TEXT: u64 = 16 << 20;
/// Largest CSV file, bytes.
pub const LARGEST_TABLE: u64 = 256 << 20;

/// Reads a regular file of at most `largest` bytes. Pipes, which may never end or never begin, and devices are refused
/// before they are opened.
///
/// # Errors
/// A message that names the file.
pub fn read(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let place = path.display();
    let unreadable = |error| format!("{place} cannot be read: {error}");
    let about = fs::metadata(path).map_err(unreadable)?;
    if about.is_dir() {
        return Err(format!("{place} cannot be read: it is a directory"));
    }
    if !about.is_file() {
        return Err(format!(
            "{place} cannot be read: it is a pipe or a device; allowed: regular files"
        ));
    }
    let mut bytes = Vec::new();
    // Some files of the system say that they are empty, and are not.
    let file = File::open(path).map_err(unreadable)?;
    let read = file.take(largest + 1).read_to_end(&mut bytes);
    read.map_err(unreadable)?;
    if bytes.len() as u64 > largest {
        return Err(format!(
            "{place} cannot be read: it is larger than {} MiB; allowed: at most that",
            largest >> 20
        ));
    }
    Ok(bytes)
}

/// Reads a text file of the size that scenarios may have.
///
/// # Errors
/// A message that names the file.
pub fn read_text_file(path: &Path) -> Result<Vec<u8>, String> {
    read(path, LARGEST_TEXT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_up_to_the_stated_size_are_read() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        fs::write(&path, [7; 1 << 20]).unwrap();
        assert_eq!(read(&path, 1 << 20).unwrap().len(), 1 << 20);
        fs::write(&path, [7; (1 << 20) + 1]).unwrap();
        let message = read(&path, 1 << 20).unwrap_err();
        assert!(message.contains("larger than 1 MiB"), "{message}");
        let message = read(directory.path(), 1 << 20).unwrap_err();
        assert!(message.contains("a directory"), "{message}");
    }

    #[test]
    #[cfg(unix)]
    fn endless_files_and_pipes_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let pipe = directory.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        for path in [Path::new("/dev/zero"), &pipe] {
            let message = read(path, 1 << 20).unwrap_err();
            assert!(message.contains("regular files"), "{message}");
        }
    }
}
