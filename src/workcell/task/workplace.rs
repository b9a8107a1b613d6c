//! Workplace of the steps of a task: the cell, its camera, and the results directory.

use super::display::{Display, Hidden};
use super::error::WorkError;
use super::speed_override::SpeedOverride;
use super::unfinished::Unfinished;
use crate::cell::{Cell, Signals};
use image::RgbImage;
use rodlab_files::results::write_whole;
use rodlab_robot::{CameraPicture, open_camera};
use rodlab_vision::{decode_picture, encode_picture};
use std::path::Path;
use std::time::Duration;

/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(10);

/// A cell, a directory, and the request to interrupt the task.
#[derive(Clone, Copy)]
pub struct Workplace<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Directory of the results.
    pub directory: &'a Path,
    /// Whether manifest and report are written to the directory, too.
    pub is_recorded: bool,
    /// Marks of the arms of the task, if arms are marked.
    pub marks: &'a [Unfinished],
    /// Whether an interruption was requested.
    pub is_interrupted: &'a dyn Fn() -> bool,
    /// Asks the user to do something and waits; whether the task may continue.
    pub ask: &'a dyn Fn(&str) -> bool,
    /// Safety signals, if the cell has some.
    pub signals: Option<&'a Signals>,
    /// Display of the progress.
    pub display: &'a dyn Display,
    /// Speed of all motions relative to the planned ones, at most 1.
    pub speed_scale: f64,
    /// Speed relative to that one, which may change during a motion.
    pub speed_override: Option<&'a SpeedOverride>,
}

impl<'a> Workplace<'a> {
    /// A workplace in a cell that only this program uses: without marks, records,
    /// interruptions and display.
    pub fn alone(cell: &'a Cell, directory: &'a Path) -> Self {
        Self {
            cell,
            directory,
            is_recorded: false,
            marks: &[],
            is_interrupted: &|| false,
            ask: &|_| true,
            signals: None,
            display: &Hidden,
            speed_scale: 1.0,
            speed_override: None,
        }
    }
}

impl Workplace<'_> {
    /// Checks whether the task may continue.
    ///
    /// # Errors
    /// A safety signal forbids motions, or an interruption was requested.
    pub fn check(&self) -> Result<(), WorkError> {
        match (self.forbidden(), (self.is_interrupted)()) {
            (Some(reason), _) => Err(WorkError::Failed(reason)),
            (None, true) => Err(WorkError::Interrupted),
            (None, false) => Ok(()),
        }
    }

    /// The reason why a safety signal forbids motions.
    pub(super) fn forbidden(&self) -> Option<String> {
        self.signals.and_then(Signals::fault)
    }

    /// Whether the task must end early.
    pub(super) fn is_ended(&self) -> bool {
        (self.is_interrupted)() || self.forbidden().is_some()
    }

    /// The wanted speed of motions at the moment, from 0 (motions are held) to 1: the lower one of
    /// the user's and that of the safety signals.
    pub(super) fn pace(&self) -> f64 {
        let chosen = self.speed_override.map_or(1.0, SpeedOverride::get);
        self.signals
            .map_or(chosen, |signals| chosen.min(signals.speed()))
    }

    /// Marks an arm before it moves.
    ///
    /// # Errors
    /// The mark cannot be written.
    pub fn mark(&self, arm: usize) -> Result<(), WorkError> {
        let mut marks = self.marks.iter().filter(|mark| mark.arm == arm);
        marks.try_for_each(Unfinished::mark)
    }

    /// Writes a file of the results.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), WorkError> {
        let file = self.directory.join(name);
        write_whole(&file, bytes)?;
        self.display.wrote(&file);
        Ok(())
    }

    /// Takes the next picture of the camera.
    ///
    /// # Errors
    /// The cell has no camera, the camera has no source, or no picture arrives.
    pub fn look(&self) -> Result<RgbImage, WorkError> {
        let missing = |what: &str| WorkError::failed(what);
        let camera = self.cell.camera.as_ref();
        let camera = camera.ok_or_else(|| missing("the cell has no [camera]"))?;
        let source = camera
            .source
            .as_deref()
            .ok_or_else(|| missing("camera.source, the source of its pictures, is missing"))?;
        let opened = open_camera(source).ok_or_else(|| {
            WorkError::Failed(format!(
                "camera.source: {source:?} is not a camera; needed: ros1://, rosbridge:// or ros2://"
            ))
        })?;
        let mut camera = opened.map_err(WorkError::failed)?;
        // A camera may be silent for as long as a driver.
        let patience = self.cell.streaming.watchdog.max(PATIENCE);
        match camera.picture(patience).map_err(WorkError::failed)? {
            CameraPicture::Pixels(picture) => Ok(picture),
            CameraPicture::File(bytes) => Ok(decode_picture(&bytes)?),
        }
    }

    /// Takes a picture and writes it to a file of the results.
    ///
    /// # Errors
    /// No picture arrives, or it cannot be written.
    pub fn picture(&self, name: &str) -> Result<RgbImage, WorkError> {
        let picture = self.look()?;
        self.write(name, &encode_picture(&picture))?;
        Ok(picture)
    }
}
