//! Input files of scenarios: regular files of limited size.

use rodlab_files::input;
use std::path::Path;

/// Maximum size of a scenario file, bytes: its tree takes some hundred times as much memory.
pub const LARGEST_TEXT: u64 = 16 << 20;
/// Largest CSV file, bytes.
pub const LARGEST_TABLE: u64 = 256 << 20;

/// Reads a regular file of at most `largest` bytes.
///
/// # Errors
/// A message that names the file.
pub fn read(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let named = |reason| format!("{} cannot be read: {reason}", path.display());
    input::read(path, largest).map_err(named)
}

/// Reads a text file up to the maximum size of scenario files.
///
/// # Errors
/// A message that names the file.
pub fn read_text_file(path: &Path) -> Result<Vec<u8>, String> {
    read(path, LARGEST_TEXT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
