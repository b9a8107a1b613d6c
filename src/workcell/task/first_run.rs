//! Motions that have not been carried out yet, which `safety.first_run` slows down.
//!
//! A file in the user's state directory records each motion that was finished.

use super::state_folder::state_folder;
use crate::cell::Cell;
use rodlab_robot::JointTrajectory;
use std::fs;
use std::io;
use std::path::PathBuf;

/// Number of digits of the hash that names a record.
const DIGITS: usize = 32;

/// The record of a motion, which may not exist yet.
pub struct FirstRun {
    file: PathBuf,
    slow: Option<f64>,
}

impl FirstRun {
    /// The record of planned motions of the arms of a cell, at full speed, by a command. Arms are
    /// identified by their drivers.
    pub fn of(cell: &Cell, command: &str, motions: &[JointTrajectory]) -> Self {
        let mut hash = blake3::Hasher::new();
        hash.update(command.as_bytes());
        for arm in &cell.arms {
            hash.update(format!("{:?}", arm.driver).as_bytes());
        }
        for motion in motions {
            for column in &motion.columns {
                hash.update(column.header().as_bytes());
            }
            let numbers = motion.times.iter().chain(motion.points.iter().flatten());
            for number in numbers {
                hash.update(&number.to_le_bytes());
            }
        }
        let name = &hash.finalize().to_hex()[..DIGITS];
        Self {
            file: state_folder("finished").join(name),
            slow: cell.safety.first_run,
        }
    }

    /// The speed relative to the planned one, at most `chosen`.
    pub fn speed(&self, chosen: f64) -> f64 {
        match self.slow {
            Some(slow) if slow < chosen && !self.file.exists() => {
                tracing::warn!(
                    "first run of this motion: at {:.0} % of the planned speed (`safety.first_run`)",
                    100.0 * slow
                );
                slow
            }
            _ => chosen,
        }
    }

    /// Records that the motion was finished.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finished(&self) -> io::Result<()> {
        if self.slow.is_none() {
            return Ok(());
        }
        self.file.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(&self.file, "")
    }
}
