//! A CSV file that grows row by row and can be cut back to an earlier length.

use super::later_sync::sync_now_or_later;
use super::mark::{self, FileMark, MarkedFile};
use super::{ResultsError, Value};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{self, OpenOptions};
use std::io::{self, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A CSV stream. The columns are the fields of the rows written to it; floats are written in the
/// shortest form that reads back to the same bits.
pub struct CsvStream {
    path: PathBuf,
    writer: csv::Writer<MarkedFile>,
    /// Whether the column names must still be written.
    is_empty: bool,
}

impl CsvStream {
    /// Starts an empty stream; an old file of that name is overwritten.
    pub fn create(path: &Path) -> Result<Self, ResultsError> {
        let file = MarkedFile::create(path).map_err(ResultsError::io("create", path))?;
        Ok(Self::over(path, file))
    }

    /// Continues a stream from its mark; later rows are dropped.
    ///
    /// # Errors
    /// [`ResultsError::Altered`] if the file is missing or does not match the mark,
    /// [`ResultsError::Io`].
    pub fn continue_at(path: &Path, mark: &FileMark) -> Result<Self, ResultsError> {
        Self::continue_if(path, mark.bytes, |file| {
            mark::compare(path, mark, file.marker())
        })
    }

    /// Continues a stream after its first `length` bytes, which have no mark; later rows are
    /// dropped.
    ///
    /// # Errors
    /// [`ResultsError::Altered`] if the file is shorter, [`ResultsError::Io`].
    pub fn continue_unmarked(path: &Path, length: u64) -> Result<Self, ResultsError> {
        Self::continue_if(path, length, |_| Ok(()))
    }

    fn continue_if(
        path: &Path,
        length: u64,
        check: impl FnOnce(&MarkedFile) -> Result<(), ResultsError>,
    ) -> Result<Self, ResultsError> {
        let opened = OpenOptions::new().read(true).write(true).open(path);
        let file = match opened {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(mark::missing(path.to_owned()));
            }
            opened => opened.map_err(ResultsError::io("open", path))?,
        };
        let file = MarkedFile::after(file, length).map_err(ResultsError::io("read", path))?;
        if file.bytes() < length {
            let what = format!("has {} bytes instead of {length}", file.bytes());
            let path = path.to_owned();
            return Err(ResultsError::Altered { path, what });
        }
        check(&file)?;
        let mut opened = file.file();
        opened
            .set_len(length)
            .and_then(|()| opened.seek(SeekFrom::End(0)))
            .map_err(ResultsError::io("cut back", path))?;
        Ok(Self::over(path, file))
    }

    fn over(path: &Path, file: MarkedFile) -> Self {
        Self {
            path: path.to_owned(),
            is_empty: file.bytes() == 0,
            writer: csv::WriterBuilder::new()
                .has_headers(false)
                .from_writer(file),
        }
    }

    /// Appends a row; the first row of a new file is preceded by the column names.
    pub fn write(&mut self, row: &impl Serialize) -> Result<(), ResultsError> {
        self.write_with(row, &[], &[])
    }

    /// Appends a row and further cells; `names` are the names of their columns.
    pub fn write_with(
        &mut self,
        row: &impl Serialize,
        names: &[String],
        cells: &[Value],
    ) -> Result<(), ResultsError> {
        let header = if self.is_empty {
            let mut header = header_of(row);
            header.extend_from_slice(names);
            self.writer.write_record(header)
        } else {
            Ok(())
        };
        self.is_empty = false;
        header
            .and_then(|()| self.writer.serialize((row, cells)))
            .map_err(|error| ResultsError::Io {
                action: "write",
                path: self.path.clone(),
                source: into_io(error),
            })
    }

    /// Flushes all rows to the operating system, so that readers can see them.
    pub fn flush(&mut self) -> Result<(), ResultsError> {
        self.writer
            .flush()
            .map_err(ResultsError::io("write", &self.path))
    }

    /// Flushes, syncs to the disk, and marks the bytes.
    ///
    /// # Errors
    /// [`ResultsError::Altered`] if the file was removed or replaced meanwhile,
    /// [`ResultsError::Io`].
    pub fn sync(&mut self) -> Result<FileMark, ResultsError> {
        self.flush()?;
        let marked = self.writer.get_ref();
        let synced = sync_now_or_later(|| marked.file().sync_data());
        synced.map_err(ResultsError::io("write", &self.path))?;
        if !marked.is_in_place(&self.path) {
            return Err(ResultsError::Altered {
                path: self.path.clone(),
                what: "was removed or replaced while the run wrote it".to_owned(),
            });
        }
        Ok(marked.mark())
    }
}

/// Names of the columns of a row, which are those of its fields.
pub(super) fn header_of(row: &impl Serialize) -> Vec<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(row).expect("plain rows go into memory");
    let bytes = writer.into_inner().expect("memory takes all bytes");
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().expect("the table was written here");
    header.iter().map(str::to_owned).collect()
}

/// Reads the whole lines of a file; ignores a partial last line after a crash or during a run.
pub(super) fn read_whole_lines(path: &Path) -> Result<Vec<u8>, ResultsError> {
    let mut bytes = fs::read(path).map_err(ResultsError::io("read", path))?;
    let newline = bytes.iter().rposition(|byte| *byte == b'\n');
    bytes.truncate(newline.map_or(0, |newline| newline + 1));
    Ok(bytes)
}

/// The usable part of a truncated stream.
pub struct WholeRows<Row> {
    /// The rows, without a partial last one.
    pub rows: Vec<Row>,
    /// Length of these rows in bytes, for [`CsvStream::continue_unmarked`].
    pub length: u64,
}

/// Reads a stream to continue it.
///
/// # Errors
/// [`ResultsError::Io`] if it cannot be read, [`ResultsError::Damaged`] if a row is invalid.
pub fn read_whole_rows<Row: DeserializeOwned>(path: &Path) -> Result<WholeRows<Row>, ResultsError> {
    Ok(WholeRows {
        rows: read_rows(path)?,
        length: read_whole_lines(path)?.len() as u64,
    })
}

/// Reads all rows of a stream, without a partial last one.
pub(super) fn read_rows<Row: DeserializeOwned>(path: &Path) -> Result<Vec<Row>, ResultsError> {
    let bytes = read_whole_lines(path)?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let rows: Result<Vec<Row>, csv::Error> = reader.deserialize().collect();
    rows.map_err(|error| ResultsError::Damaged {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

fn into_io(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(source) => source,
        other => io::Error::other(format!("{other:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[derive(Serialize, serde::Deserialize, Debug, PartialEq)]
    struct Row {
        time_s: f64,
        rod: String,
        theta_rad: Option<f64>,
    }

    fn row(k: usize) -> Row {
        Row {
            time_s: k as f64 / 10.0,
            rod: "a, \"quoted\" name".into(),
            theta_rad: k.is_multiple_of(2).then_some(0.1 * k as f64),
        }
    }

    #[test]
    fn a_stream_cut_back_and_continued_equals_one_written_in_a_go() {
        let directory = tempfile::tempdir().unwrap();
        let (whole, cut) = (
            directory.path().join("whole.csv"),
            directory.path().join("cut.csv"),
        );
        let mut stream = CsvStream::create(&whole).unwrap();
        (0..10).for_each(|k| stream.write(&row(k)).unwrap());
        stream.flush().unwrap();

        let mut stream = CsvStream::create(&cut).unwrap();
        let empty = stream.sync().unwrap();
        (0..4).for_each(|k| stream.write(&row(k)).unwrap());
        let mark = stream.sync().unwrap();
        (4..7).for_each(|k| stream.write(&row(k + 100)).unwrap());
        drop(stream);
        for (start, mark) in [(4, mark), (0, empty)] {
            let mut stream = CsvStream::continue_at(&cut, &mark).unwrap();
            (start..10).for_each(|k| stream.write(&row(k)).unwrap());
            stream.flush().unwrap();
            assert_eq!(fs::read(&whole).unwrap(), fs::read(&cut).unwrap());
        }
    }

    #[test]
    fn a_stream_that_was_cut_garbled_or_removed_is_refused_and_left_as_it_is() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("series.csv");
        let mut stream = CsvStream::create(&path).unwrap();
        (0..4).for_each(|k| stream.write(&row(k)).unwrap());
        let mark = stream.sync().unwrap();
        let whole = fs::read(&path).unwrap();
        let mut garbled = whole.clone();
        garbled[20] ^= 1;
        for (bytes, what) in [(&whole[..30], "30 bytes"), (&garbled, "not hold")] {
            fs::write(&path, bytes).unwrap();
            let error = CsvStream::continue_at(&path, &mark).err().unwrap();
            assert!(matches!(error, ResultsError::Altered { .. }), "{error}");
            assert!(error.to_string().contains(what), "{error}");
            assert_eq!(fs::read(&path).unwrap(), bytes);
        }
        fs::remove_file(&path).unwrap();
        let error = CsvStream::continue_at(&path, &mark).err().unwrap();
        assert!(error.to_string().contains("is missing"), "{error}");
        assert!(matches!(error, ResultsError::Altered { .. }), "{error}");
    }

    #[test]
    fn series_deleted_during_a_run_are_noticed() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("series.csv");
        let mut stream = CsvStream::create(&path).unwrap();
        stream.write(&row(0)).unwrap();
        stream.sync().unwrap();
        fs::remove_file(&path).unwrap();
        stream.write(&row(1)).unwrap();
        let error = stream.sync().unwrap_err();
        assert!(error.to_string().contains("was removed"), "{error}");
        fs::write(&path, "another").unwrap();
        assert!(stream.sync().is_err());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_an_error_that_names_the_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("series.csv");
        std::os::unix::fs::symlink("/dev/full", &path).unwrap();
        let mut stream = CsvStream::create(&path).unwrap();
        let error = stream
            .write(&row(0))
            .and_then(|()| stream.flush())
            .unwrap_err();
        assert!(matches!(error, ResultsError::Io { .. }), "{error}");
        let message = error.to_string();
        assert!(
            message.contains("series.csv") && message.contains("No space left"),
            "{message}"
        );
    }

    proptest! {
        #[test]
        fn every_float_reads_back_to_the_same_bits(time_s: f64, theta_rad: Option<f64>) {
            prop_assume!(!time_s.is_nan());
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("floats.csv");
            let written = Row { time_s, rod: "r".into(), theta_rad };
            let mut stream = CsvStream::create(&path).unwrap();
            stream.write(&written).unwrap();
            stream.flush().unwrap();
            let mut reader = csv::Reader::from_path(&path).unwrap();
            let read: Row = reader.deserialize().next().unwrap().unwrap();
            prop_assert_eq!(read.time_s.to_bits(), time_s.to_bits());
            prop_assert_eq!(read.theta_rad.map(f64::to_bits), theta_rad.map(f64::to_bits));
        }
    }
}
