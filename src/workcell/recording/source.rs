//! Reads the log of a motion or of a task: one folder per motion, with its tables.

use super::RecordingError;
use rodlab_robot::JointTrajectory;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// The event with which a log begins, before the time on the clock of this machine, s.
const OPENED: &str = "opened ";
/// Depth of folders that are searched.
const DEPTH: usize = 4;

/// The tables of a motion.
pub struct MotionLog {
    /// Folder below the directory, empty for the directory itself.
    pub name: String,
    folder: PathBuf,
    /// Time of its begin, s.
    opened: f64,
    /// Events with their times after the begin, s.
    events: Vec<(f64, String)>,
}

/// Joints of a part at a time.
pub struct Joints {
    /// Time, s.
    pub time: f64,
    /// The arm or axis.
    pub part: String,
    /// Names of its joints.
    pub names: Vec<String>,
    /// Their positions, rad or m.
    pub positions: Vec<f64>,
}

/// Folders of motions in a directory, in the order of their begin.
pub fn motions(directory: &Path) -> Result<Vec<MotionLog>, RecordingError> {
    let tables = files(directory)?.into_iter();
    let tables = tables.filter(|path| path.ends_with("events.csv"));
    let found = tables.map(|table| MotionLog::read(directory, table));
    let mut found = found.collect::<Result<Vec<_>, _>>()?;
    found.sort_by(|a, b| a.opened.total_cmp(&b.opened));
    Ok(found)
}

/// Files in a directory and its folders.
pub fn files(directory: &Path) -> Result<Vec<PathBuf>, RecordingError> {
    let mut files = Vec::new();
    collect(directory, DEPTH, &mut files)?;
    Ok(files)
}

fn collect(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) -> Result<(), RecordingError> {
    for entry in fs::read_dir(folder).map_err(RecordingError::at(folder))? {
        let path = entry.map_err(RecordingError::at(folder))?.path();
        if path.is_file() {
            files.push(path);
        } else if path.is_dir() && depth > 0 {
            collect(&path, depth - 1, files)?;
        }
    }
    Ok(())
}

impl MotionLog {
    /// Reads the log of the motion with a table of events below a directory.
    fn read(directory: &Path, table: PathBuf) -> Result<Self, RecordingError> {
        let events = rows::<(f64, String)>(&table)?;
        let first = events.first();
        let opened = first.and_then(|(_, event)| event.strip_prefix(OPENED)?.parse().ok());
        let folder = table.parent().unwrap_or(directory).to_owned();
        let name = folder.strip_prefix(directory).unwrap_or(&folder);
        Ok(Self {
            name: name.display().to_string(),
            opened: opened.ok_or(RecordingError::WithoutTime(table))?,
            folder,
            events,
        })
    }

    /// The planned motion; `None` if it is not in the log.
    pub fn plan(&self) -> Option<JointTrajectory> {
        JointTrajectory::read(&self.folder.join("trajectory.csv")).ok()
    }

    /// Events with their times, s.
    pub fn events(&self) -> impl Iterator<Item = (f64, &str)> {
        let events = self.events.iter();
        events.map(|(time, event)| (self.opened + time, event.as_str()))
    }

    /// The rows of `state.csv` or `commanded.csv`; those of one part and time are together.
    pub fn joints(&self, table: &str) -> Result<Vec<Joints>, RecordingError> {
        let mut all: Vec<Joints> = Vec::new();
        for (time, part, joint, position) in
            rows::<(f64, String, String, f64)>(&self.folder.join(table))?
        {
            let time = self.opened + time;
            match all.last_mut() {
                Some(last)
                    if last.time == time && last.part == part && !last.names.contains(&joint) =>
                {
                    last.names.push(joint);
                    last.positions.push(position);
                }
                _ => all.push(Joints {
                    time,
                    part,
                    names: vec![joint],
                    positions: vec![position],
                }),
            }
        }
        Ok(all)
    }
}

/// Messages of safety signals in a directory: time, s, name and content.
pub fn signals(directory: &Path) -> Result<Vec<(f64, String, String)>, RecordingError> {
    let path = directory.join("signals.csv");
    match path.is_file() {
        true => rows(&path),
        false => Ok(Vec::new()),
    }
}

/// Photographs in a directory, `picture.png` and others whose names begin so, with the times at
/// which they were written, s.
pub fn pictures(directory: &Path) -> Result<Vec<(f64, Vec<u8>)>, RecordingError> {
    let mut pictures = Vec::new();
    for entry in fs::read_dir(directory).map_err(RecordingError::at(directory))? {
        let path = entry.map_err(RecordingError::at(directory))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if !(name.starts_with("picture") && name.ends_with(".png")) {
            continue;
        }
        let written = fs::metadata(&path).and_then(|data| data.modified());
        let written = written.map_err(RecordingError::at(&path))?;
        let time = written.duration_since(UNIX_EPOCH).unwrap_or_default();
        let file = fs::read(&path).map_err(RecordingError::at(&path))?;
        pictures.push((time.as_secs_f64(), file));
    }
    Ok(pictures)
}

/// All rows of a table.
fn rows<Row: serde::de::DeserializeOwned>(path: &Path) -> Result<Vec<Row>, RecordingError> {
    let text = fs::read(path).map_err(RecordingError::at(path))?;
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let rows = reader.deserialize().collect::<Result<Vec<Row>, _>>();
    rows.map_err(|error| RecordingError::Table {
        path: path.to_owned(),
        error,
    })
}
