//! The log of a stream: commands, reports and events.

use super::Part;
use super::pace::Pace;
use crate::driver::JointState;
use crate::unix_time::unix_time;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::Instant;

/// Tables `commanded.csv` and `state.csv` (`time_s`, `part`, `joint`, `position`) and `events.csv`
/// (`time_s`, `event`). Times are measured from the opening of the log, after the start on the
/// robot's clock if it has one. The first event, `opened`, has the seconds since 1970.
pub struct StreamLog {
    files: Option<Files>,
    opened: Instant,
    /// Time of the start on the log's clock, and number of logged points of each part.
    started: Option<f64>,
    logged: Vec<usize>,
    heard: Vec<(String, Instant)>,
    fault: Option<io::Error>,
}

struct Files {
    commanded: BufWriter<File>,
    state: BufWriter<File>,
    events: BufWriter<File>,
}

impl StreamLog {
    /// Opens a log in an existing directory.
    ///
    /// # Errors
    /// A file cannot be created.
    pub fn open(directory: &Path) -> io::Result<Self> {
        let create = |name: &str, header: &str| -> io::Result<BufWriter<File>> {
            let mut file = BufWriter::new(File::create(directory.join(name))?);
            writeln!(file, "{header}")?;
            Ok(file)
        };
        let table = "time_s,part,joint,position";
        let mut log = Self {
            files: Some(Files {
                commanded: create("commanded.csv", table)?,
                state: create("state.csv", table)?,
                events: create("events.csv", "time_s,event")?,
            }),
            ..Self::none()
        };
        // The only absolute time of the log, for comparison with other logs.
        log.event(&format!("opened {:.6}", unix_time().as_secs_f64()));
        Ok(log)
    }

    /// A log that discards everything.
    pub fn none() -> Self {
        Self {
            files: None,
            opened: Instant::now(),
            started: None,
            logged: Vec::new(),
            heard: Vec::new(),
            fault: None,
        }
    }

    /// Ends the log; returns the first write error, if there was one.
    pub fn finish(mut self) -> io::Result<()> {
        if let Some(files) = &mut self.files {
            let written = [&mut files.commanded, &mut files.state, &mut files.events]
                .into_iter()
                .try_for_each(Write::flush);
            self.fault = self.fault.or(written.err());
        }
        self.fault.map_or(Ok(()), Err)
    }

    /// Writes an event, and flushes it at once.
    pub fn event(&mut self, what: &str) {
        tracing::info!("{what}");
        let time = self.opened.elapsed().as_secs_f64();
        if what == "started" {
            self.started = Some(time);
        }
        let quoted = what.replace('"', "\"\"");
        self.write(|files| {
            writeln!(files.events, "{time:.6},\"{quoted}\"")?;
            files.commanded.flush()?;
            files.state.flush()?;
            files.events.flush()
        });
    }

    /// Writes the points up to a place on the trajectory, with the times at which they were due.
    pub(super) fn commanded(&mut self, place: f64, pace: &Pace, parts: &[Part]) {
        let Some(started) = self.started else { return };
        self.logged.resize(parts.len(), 0);
        for (index, part) in parts.iter().enumerate() {
            let trajectory = &part.trajectory;
            let due = trajectory.times.partition_point(|time| *time <= place);
            let from = std::mem::replace(&mut self.logged[index], due);
            self.write(|files| {
                for k in from..due {
                    let time = started + pace.time_of(trajectory.times[k]);
                    for (joint, position) in trajectory.joints.iter().zip(&trajectory.points[k]) {
                        writeln!(
                            files.commanded,
                            "{time:.6},{},{joint},{position}",
                            part.name
                        )?;
                    }
                }
                Ok(())
            });
        }
    }

    /// Writes the position of a part, once per report, with the time after the start.
    pub(super) fn state(&mut self, part: &Part, state: &JointState, heard: f64) {
        match self.heard.iter_mut().find(|(name, _)| *name == part.name) {
            Some((_, last)) if *last == state.received => return,
            Some((_, last)) => *last = state.received,
            None => self.heard.push((part.name.clone(), state.received)),
        }
        let time = self.started.unwrap_or(0.0) + heard;
        self.write(|files| {
            for (joint, position) in part.trajectory.joints.iter().zip(&state.positions) {
                writeln!(files.state, "{time:.6},{},{joint},{position}", part.name)?;
            }
            Ok(())
        });
    }

    fn write(&mut self, write: impl FnOnce(&mut Files) -> io::Result<()>) {
        if let Some(files) = &mut self.files
            && self.fault.is_none()
        {
            self.fault = write(files).err();
        }
    }
}
