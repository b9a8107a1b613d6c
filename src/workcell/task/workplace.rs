//! Where a task is carried out: what its steps move, look at and write to.

use super::error::WorkError;
use super::unfinished::Unfinished;
use crate::cell::Cell;
use image::RgbImage;
use rodlab_files::results::write_whole;
use rodlab_robot::{CameraPicture, open_camera};
use rodlab_vision::{decode_picture, encode_picture};
use std::path::Path;
use std::time::Duration;

/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(10);

/// A cell, a directory, and whether the task continues.
#[derive(Clone, Copy)]
pub struct Workplace<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Where everything is written.
    pub directory: &'a Path,
    /// Whether manifest and report are written there, too.
    pub is_recorded: bool,
    /// What states of arms that the task was begun, if it is to be stated.
    pub marks: &'a [Unfinished],
    /// Whether an interruption was requested.
    pub is_interrupted: &'a dyn Fn() -> bool,
}

impl<'a> Workplace<'a> {
    /// In a cell of the program's own: without marks, records and interruptions.
    pub fn alone(cell: &'a Cell, directory: &'a Path) -> Self {
        Self {
            cell,
            directory,
            is_recorded: false,
            marks: &[],
            is_interrupted: &|| false,
        }
    }
}

impl Workplace<'_> {
    /// Whether the task continues.
    ///
    /// # Errors
    /// An interruption was requested.
    pub fn check(&self) -> Result<(), WorkError> {
        match (self.is_interrupted)() {
            true => Err(WorkError::Interrupted),
            false => Ok(()),
        }
    }

    /// States that an arm moves from now on.
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
    /// It cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), WorkError> {
        Ok(write_whole(&self.directory.join(name), bytes)?)
    }

    /// The next picture of the camera.
    ///
    /// # Errors
    /// There is no camera, it has no source, or no picture comes.
    pub fn look(&self) -> Result<RgbImage, WorkError> {
        let missing = |what: &str| WorkError::failed(what);
        let camera = self.cell.camera.as_ref();
        let camera = camera.ok_or_else(|| missing("the cell has no [camera]"))?;
        let source = camera
            .source
            .as_deref()
            .ok_or_else(|| missing("camera.source is missing: where its pictures come from"))?;
        let opened = open_camera(source).ok_or_else(|| {
            WorkError::Failed(format!(
                "camera.source: {source:?} is no camera; needed: ros1://, rosbridge:// or ros2://"
            ))
        })?;
        let mut camera = opened.map_err(WorkError::failed)?;
        match camera.picture(PATIENCE).map_err(WorkError::failed)? {
            CameraPicture::Pixels(picture) => Ok(picture),
            CameraPicture::File(bytes) => Ok(decode_picture(&bytes)?),
        }
    }

    /// The same, written to a file of the results.
    ///
    /// # Errors
    /// None comes, or it cannot be written.
    pub fn picture(&self, name: &str) -> Result<RgbImage, WorkError> {
        let picture = self.look()?;
        self.write(name, &encode_picture(&picture))?;
        Ok(picture)
    }
}
