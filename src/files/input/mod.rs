//! Checked reading of files: only regular files of bounded size, and XML of bounded depth.

mod encoding;
mod numbers;
mod table;
mod xml;

pub use encoding::xml_text;
pub use numbers::{is_positive, number, numbers, positive};
pub use table::{Column, Table};
pub use xml::{DEEPEST, check_nesting};

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// Reads a regular file of at most `largest` bytes. Pipes, which may be endless or block, and
/// devices are rejected before they are opened.
///
/// # Errors
/// The reason, as a message after the name of the file.
pub fn read(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let failed = |error: std::io::Error| error.to_string();
    let about = fs::metadata(path).map_err(failed)?;
    if about.is_dir() {
        return Err("it is a directory".into());
    }
    if !about.is_file() {
        return Err("it is a pipe or a device; allowed: regular files".into());
    }
    let mut bytes = Vec::new();
    // Some system files report length zero but are not empty.
    let file = File::open(path).map_err(failed)?;
    let read = file.take(largest + 1).read_to_end(&mut bytes);
    read.map_err(failed)?;
    if bytes.len() as u64 > largest {
        let size = match largest >> 20 {
            0 => format!("{largest} bytes"),
            mebibytes => format!("{mebibytes} MiB"),
        };
        return Err(format!(
            "it is larger than {size}, the largest size allowed"
        ));
    }
    Ok(bytes)
}

/// Reads a text in UTF-8 of at most `largest` bytes, see [`read`].
///
/// # Errors
/// The reason, as a message after the name of the file.
pub fn read_text(path: &Path, largest: u64) -> Result<String, String> {
    String::from_utf8(read(path, largest)?).map_err(|_| "it is not text in UTF-8".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_up_to_the_stated_size_are_read() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        fs::write(&path, [7; 100]).unwrap();
        assert_eq!(read(&path, 100).unwrap().len(), 100);
        let message = read(&path, 99).unwrap_err();
        assert!(message.contains("larger than 99 bytes"), "{message}");
        let message = read(directory.path(), 100).unwrap_err();
        assert!(message.contains("a directory"), "{message}");
        fs::write(&path, [0xff]).unwrap();
        assert!(read_text(&path, 100).unwrap_err().contains("UTF-8"));
    }
}
