//! Driver that writes points to a file or to standard output, each at its time.

use super::{Driver, DriverError, Interpolant, JointState, Progress};
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Number of bytes that are read to recognise an earlier log.
const HEAD: u64 = 1 << 16;

/// Writes each point at its time, as CSV or as JSON lines.
pub struct FileDriver {
    path: Option<PathBuf>,
    json_lines: bool,
    sink: Option<Box<dyn Write + Send>>,
    joints: Vec<String>,
    motion: Option<Interpolant>,
    written: usize,
}

impl FileDriver {
    /// A driver for a file, or for standard output.
    pub fn new(path: Option<PathBuf>, json_lines: bool) -> Self {
        Self {
            path,
            json_lines,
            sink: None,
            joints: Vec::new(),
            motion: None,
            written: 0,
        }
    }

    /// Checks that a path is free, holds an earlier log of the same joints, or is a device or a
    /// pipe.
    ///
    /// # Errors
    /// A message if another file would be overwritten.
    pub fn check_place(path: &Path, joints: &[String], json_lines: bool) -> Result<(), String> {
        let Ok(found) = fs::metadata(path) else {
            return Ok(());
        };
        if found.is_dir() {
            return Err(format!("{} is a directory", path.display()));
        }
        if !found.is_file() || found.len() == 0 {
            return Ok(());
        }
        let mut head = Vec::new();
        let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
        read.map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
        if is_log(&head, joints, json_lines) {
            return Ok(());
        }
        Err(format!(
            "{} is not an earlier log of these joints ({}) and is not overwritten; move it away or choose another `path`",
            path.display(),
            joints.join(", ")
        ))
    }

    fn fault(&self, error: &io::Error) -> DriverError {
        let place = self.path.as_ref();
        let place = place.map_or("standard output".into(), |path| path.display().to_string());
        DriverError::Lost(format!("{place} cannot be written: {error}"))
    }

    fn line(&self, motion: &Interpolant, index: usize) -> String {
        let (time, point) = (motion.times()[index], &motion.points()[index]);
        if self.json_lines {
            let value = serde_json::json!({
                "time_s": time, "joints": self.joints, "positions": point
            });
            return format!("{value}\n");
        }
        let cells: Vec<String> = point.iter().map(f64::to_string).collect();
        format!("{time},{}\n", cells.join(","))
    }

    fn write(&mut self, text: &str) -> Result<(), DriverError> {
        let Some(sink) = &mut self.sink else {
            return Ok(());
        };
        let written = sink.write_all(text.as_bytes()).and_then(|()| sink.flush());
        written.map_err(|error| self.fault(&error))
    }
}

fn header(joints: &[String]) -> String {
    format!("time_s,{}\n", joints.join(","))
}

/// Whether a file begins like a log of these joints.
fn is_log(head: &[u8], joints: &[String], json_lines: bool) -> bool {
    if !json_lines {
        return head.starts_with(header(joints).as_bytes());
    }
    let first = head.split(|byte| *byte == b'\n').next();
    let first: Option<serde_json::Value> = first.and_then(|line| serde_json::from_slice(line).ok());
    first.is_some_and(|line| {
        line["time_s"].is_number()
            && line["joints"] == serde_json::json!(joints)
            && line["positions"].is_array()
    })
}

impl Driver for FileDriver {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        if let Some(path) = &self.path {
            Self::check_place(path, joints, self.json_lines).map_err(DriverError::Refused)?;
        }
        self.joints = joints.to_vec();
        self.sink = Some(match &self.path {
            None => Box::new(io::stdout()),
            Some(path) => Box::new(File::create(path).map_err(|error| self.fault(&error))?),
        });
        if self.json_lines {
            return Ok(());
        }
        self.write(&header(joints))
    }

    fn reports_state(&self) -> bool {
        false
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        Ok(None)
    }

    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        self.written = 0;
        self.motion = Some(motion.clone());
        Ok(())
    }

    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError> {
        let Some(motion) = self.motion.take() else {
            return Ok(Progress::Done);
        };
        let due = motion.times().partition_point(|time| *time <= elapsed);
        let lines: String = (self.written..due).map(|k| self.line(&motion, k)).collect();
        self.written = due;
        let done = due == motion.times().len();
        self.motion = Some(motion);
        if !lines.is_empty() {
            self.write(&lines)?;
        }
        Ok(Progress::over(done))
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        self.motion = None;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_logs_of_the_same_joints_are_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let joints = ["a".to_owned(), "b".to_owned()];
        let other = ["a".to_owned()];
        let mut accepted = 0;
        for json_lines in [false, true] {
            fs::write(&path, "").unwrap();
            let mut driver = FileDriver::new(Some(path.clone()), json_lines);
            let motion = Interpolant::new(&[0.0, 1.0], &[vec![0.0, 1.0], vec![0.0, 1.0]]);
            driver.connect(&joints).unwrap();
            driver.start(&motion).unwrap();
            driver.advance(2.0).unwrap();
            let log = fs::read_to_string(&path).unwrap();
            assert!(FileDriver::check_place(&path, &joints, json_lines).is_ok());
            assert!(FileDriver::check_place(&path, &joints, !json_lines).is_err());
            assert!(FileDriver::check_place(&path, &other, json_lines).is_err());
            let mut again = FileDriver::new(Some(path.clone()), json_lines);
            let refused = again.connect(&other).unwrap_err().to_string();
            assert!(refused.contains("is not overwritten"), "{refused}");
            assert_eq!(fs::read_to_string(&path).unwrap(), log);
            accepted += usize::from(again.connect(&joints).is_ok());
        }
        assert_eq!(accepted, 2);
        for foreign in ["precious", "time_s,energy_j\n", "{\"time_s\":0}\n", "\n"] {
            fs::write(&path, foreign).unwrap();
            for json_lines in [false, true] {
                assert!(FileDriver::check_place(&path, &joints, json_lines).is_err());
            }
        }
        assert!(FileDriver::check_place(Path::new("/dev/null"), &joints, false).is_ok());
        assert!(FileDriver::check_place(folder.path(), &joints, false).is_err());
    }
}
