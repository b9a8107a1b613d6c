//! Marks of files: length and hash of the output of a run, used to detect later changes.

use super::ResultsError;
use super::files::{END_STATE, SCENARIO, START, SUMMARY, TIMINGS, VTK_FOLDER, frame_names};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Size of a read, bytes.
const BLOCK: usize = 1 << 16;

/// Length and hash of a file, or of all files of a series of frames, one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileMark {
    /// Length, bytes.
    pub bytes: u64,
    /// BLAKE3 hash of the contents, in hexadecimal.
    pub blake3: String,
}

impl FileMark {
    /// The mark of a file with these contents.
    pub(super) fn of(contents: &[u8]) -> Self {
        let mut marker = Marker::default();
        marker.update(contents);
        marker.mark()
    }
}

/// The marks of files, by their names in the results directory.
pub type FileMarks = BTreeMap<String, FileMark>;

/// Computes the mark of the bytes written to it.
#[derive(Clone, Default)]
pub(super) struct Marker {
    hasher: blake3::Hasher,
    bytes: u64,
}

impl Marker {
    /// Adds further bytes.
    pub fn update(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
        self.bytes += bytes.len() as u64;
    }

    /// Adds further bytes of a file, at most `most`.
    fn read(&mut self, file: impl Read, most: u64) -> io::Result<()> {
        let mut file = file.take(most);
        let mut block = vec![0; BLOCK];
        loop {
            match file.read(&mut block)? {
                0 => return Ok(()),
                read => self.update(&block[..read]),
            }
        }
    }

    /// Bytes so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The mark of all bytes so far.
    pub fn mark(&self) -> FileMark {
        FileMark {
            bytes: self.bytes,
            blake3: self.hasher.finalize().to_hex().to_string(),
        }
    }
}

/// A file whose mark is computed while it is written.
pub(super) struct MarkedFile {
    file: File,
    marker: Marker,
}

impl MarkedFile {
    /// An empty file.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(Self {
            file: File::create(path)?,
            marker: Marker::default(),
        })
    }

    /// Reads the first `length` bytes of a file that is open for reading and writing; new bytes
    /// will follow them.
    pub fn after(mut file: File, length: u64) -> io::Result<Self> {
        let mut marker = Marker::default();
        marker.read(&mut file, length)?;
        Ok(Self { file, marker })
    }

    /// The file.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// The mark of the bytes read and written.
    pub fn mark(&self) -> FileMark {
        self.marker.mark()
    }

    /// The same, to be compared.
    pub fn marker(&self) -> &Marker {
        &self.marker
    }

    /// Bytes of the file.
    pub fn bytes(&self) -> u64 {
        self.marker.bytes()
    }

    /// Whether the path still refers to this complete file.
    pub fn is_in_place(&self, path: &Path) -> bool {
        let (Ok(named), Ok(open)) = (fs::metadata(path), self.file.metadata()) else {
            return false;
        };
        // Files that are not regular, such as devices, have no length.
        is_same_file(&named, &open) && (!open.is_file() || open.len() == self.marker.bytes())
    }
}

impl Write for MarkedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.marker.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(unix)]
fn is_same_file(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_same_file(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
}

/// Checks that files in a results directory match their marks, by length and hash.
///
/// # Errors
/// [`ResultsError::Altered`] names the first one that does not.
pub fn check_files(directory: &Path, marks: &FileMarks) -> Result<(), ResultsError> {
    check_lengths(directory, marks)?;
    marks.iter().try_for_each(|(name, mark)| {
        if let Some(names) = frame_names(name) {
            return marked_frames(directory, mark, names).map(drop);
        }
        let path = directory.join(name);
        let mut marker = Marker::default();
        File::open(&path)
            .and_then(|file| marker.read(file, u64::MAX))
            .map_err(ResultsError::io("read", &path))?;
        compare(&path, mark, &marker)
    })
}

/// Small files that are written at once at the end of a run.
const WRITTEN_ONCE: [&str; 5] = [SCENARIO, START, END_STATE, SUMMARY, TIMINGS];

/// Marks the existing files of a directory that are written at once.
///
/// # Errors
/// [`ResultsError::Io`] if one cannot be read.
pub(super) fn marks_of_whole_files(directory: &Path) -> Result<FileMarks, ResultsError> {
    let mut marks = FileMarks::new();
    for name in WRITTEN_ONCE {
        let path = directory.join(name);
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(ResultsError::io("read", path)(error)),
        };
        let mut marker = Marker::default();
        let read = marker.read(file, u64::MAX);
        read.map_err(ResultsError::io("read", &path))?;
        marks.insert(name.to_owned(), marker.mark());
    }
    Ok(marks)
}

/// Fast check: files written at once by length and hash, all others by length.
///
/// # Errors
/// [`ResultsError::Altered`] names the first one that differs.
pub fn check_quickly(directory: &Path, marks: &FileMarks) -> Result<(), ResultsError> {
    check_lengths(directory, marks)?;
    check_whole_files(directory, marks)
}

/// Checks only the files that are written at once.
///
/// # Errors
/// [`ResultsError::Altered`] names the first one that differs.
pub(super) fn check_whole_files(directory: &Path, marks: &FileMarks) -> Result<(), ResultsError> {
    let whole = marks.iter();
    let whole = whole.filter(|(name, _)| WRITTEN_ONCE.contains(&name.as_str()));
    let whole = whole.map(|(name, mark)| (name.clone(), mark.clone()));
    check_files(directory, &whole.collect())
}

/// Checks the lengths only, which is fast.
///
/// # Errors
/// [`ResultsError::Altered`] names the first one that differs.
pub fn check_lengths(directory: &Path, marks: &FileMarks) -> Result<(), ResultsError> {
    marks.iter().try_for_each(|(name, mark)| {
        let path = directory.join(name);
        let length = match frame_names(name) {
            Some(names) => length_of_frames(directory, mark.bytes, names)?,
            None => length_of(&path)?,
        };
        if length == mark.bytes {
            return Ok(());
        }
        let what = format!("has {length} bytes instead of the {} written", mark.bytes);
        Err(ResultsError::Altered { path, what })
    })
}

fn length_of(path: &Path) -> Result<u64, ResultsError> {
    let found = fs::metadata(path).map_err(|_| missing(path.to_owned()))?;
    Ok(found.len())
}

/// Number of frames in the first `bytes` of their series.
fn length_of_frames(
    directory: &Path,
    bytes: u64,
    names: fn(usize) -> String,
) -> Result<u64, ResultsError> {
    let (mut length, mut index) = (0, 0);
    while length < bytes {
        length += length_of(&directory.join(names(index)))?.max(1);
        index += 1;
    }
    Ok(length)
}

/// Reads the marked frames before the series is continued.
///
/// # Errors
/// [`ResultsError::Altered`] names a frame that is missing, or the folder.
pub(super) fn marked_frames(
    directory: &Path,
    mark: &FileMark,
    names: fn(usize) -> String,
) -> Result<Marker, ResultsError> {
    let mut marker = Marker::default();
    let mut index = 0;
    while marker.bytes() < mark.bytes {
        let path = directory.join(names(index));
        let file = File::open(&path).map_err(|_| missing(path.clone()))?;
        let before = marker.bytes();
        let read = marker.read(file, u64::MAX);
        read.map_err(ResultsError::io("read", &path))?;
        if marker.bytes() == before {
            return Err(missing(path));
        }
        index += 1;
    }
    compare(&directory.join(VTK_FOLDER), mark, &marker)?;
    Ok(marker)
}

/// Compares the mark of a file with the expected one.
pub(super) fn compare(path: &Path, mark: &FileMark, read: &Marker) -> Result<(), ResultsError> {
    if read.mark() == *mark {
        return Ok(());
    }
    Err(ResultsError::Altered {
        path: path.to_owned(),
        what: "does not hold what was written".to_owned(),
    })
}

pub(super) fn missing(path: PathBuf) -> ResultsError {
    let what = "is missing".to_owned();
    ResultsError::Altered { path, what }
}
