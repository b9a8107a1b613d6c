//! Reading of files with a size limit.

use super::VisionError;
use rodlab_files::input;
use std::path::Path;

/// Largest text file, bytes.
const LARGEST_TEXT: u64 = 256 << 20;

/// Reads a regular file of at most `largest` bytes. Pipes and devices are rejected, since they may
/// be endless.
///
/// # Errors
/// [`VisionError::Unreadable`].
pub fn read_file(path: &Path, largest: u64) -> Result<Vec<u8>, VisionError> {
    input::read(path, largest).map_err(|reason| VisionError::Unreadable {
        path: path.into(),
        reason,
    })
}

/// Reads a text file of at most 256 MiB.
///
/// # Errors
/// [`VisionError::Unreadable`].
pub fn read_text(path: &Path) -> Result<String, VisionError> {
    String::from_utf8(read_file(path, LARGEST_TEXT)?).map_err(|_| VisionError::Unreadable {
        path: path.into(),
        reason: "it is not text in UTF-8".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    #[cfg(unix)]
    fn endless_files_and_folders_are_refused_before_they_are_read() {
        let directory = tempfile::tempdir().unwrap();
        for path in [Path::new("/dev/zero"), directory.path()] {
            assert!(read_file(path, 1 << 20).is_err());
            assert!(super::super::read_picture(path).is_err());
            assert!(super::super::read_curve(path, None).is_err());
            assert!(super::super::read_poses(path).is_err());
            assert!(super::super::Camera::read(path).is_err());
        }
        let path = directory.path().join("long");
        fs::write(&path, [7; (1 << 20) + 1]).unwrap();
        let message = read_file(&path, 1 << 20).unwrap_err().to_string();
        assert!(message.contains("larger than 1 MiB"), "{message}");
        assert_eq!(read_file(&path, 2 << 20).unwrap().len(), (1 << 20) + 1);
    }
}
