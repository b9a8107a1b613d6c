//! Points as lines of a file or of standard output, each at its time.

use super::{Driver, DriverError, JointState, PartTrajectory, Progress};
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;

/// Writes each point at its time, as CSV or as JSON lines.
pub struct FileDriver {
    path: Option<PathBuf>,
    json_lines: bool,
    sink: Option<Box<dyn Write + Send>>,
    trajectory: Option<PartTrajectory>,
    written: usize,
}

impl FileDriver {
    /// A driver for a file, or for standard output.
    pub fn new(path: Option<PathBuf>, json_lines: bool) -> Self {
        Self {
            path,
            json_lines,
            sink: None,
            trajectory: None,
            written: 0,
        }
    }

    fn fault(&self, error: &io::Error) -> DriverError {
        let place = self.path.as_ref();
        let place = place.map_or("standard output".into(), |path| path.display().to_string());
        DriverError::Lost(format!("{place} cannot be written: {error}"))
    }

    fn line(&self, trajectory: &PartTrajectory, index: usize) -> String {
        let (time, point) = (trajectory.times[index], &trajectory.points[index]);
        if self.json_lines {
            let value = serde_json::json!({
                "time_s": time, "joints": trajectory.joints, "positions": point
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

impl Driver for FileDriver {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        self.sink = Some(match &self.path {
            None => Box::new(io::stdout()),
            Some(path) => Box::new(File::create(path).map_err(|error| self.fault(&error))?),
        });
        if self.json_lines {
            return Ok(());
        }
        self.write(&format!("time_s,{}\n", joints.join(",")))
    }

    fn reports_state(&self) -> bool {
        false
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        Ok(None)
    }

    fn start(&mut self, trajectory: &PartTrajectory) -> Result<(), DriverError> {
        self.written = 0;
        self.trajectory = Some(trajectory.clone());
        Ok(())
    }

    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError> {
        let Some(trajectory) = self.trajectory.take() else {
            return Ok(Progress::Done);
        };
        let due = trajectory.times.partition_point(|time| *time <= elapsed);
        let lines: String = (self.written..due)
            .map(|k| self.line(&trajectory, k))
            .collect();
        self.written = due;
        let done = due == trajectory.times.len();
        self.trajectory = Some(trajectory);
        if !lines.is_empty() {
            self.write(&lines)?;
        }
        Ok(if done {
            Progress::Done
        } else {
            Progress::Running
        })
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        self.trajectory = None;
        Ok(())
    }
}
