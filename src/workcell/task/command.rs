//! Commands that plan tasks: their properties beside the arguments, and the data for planning.

use super::step::Task;
use crate::cell::{Cell, PlanError};
use crate::virtual_cell::Settings;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// Speed relative to real time of a virtual cell that only one process uses: as fast as it can be simulated.
const FULL_SPEED: f64 = 100.0;

/// A command that plans a task from its arguments. The command line selects the cell, asks before
/// anything moves, and runs the task.
pub trait TaskCommand {
    /// Name of the command, used in the names of its results directories.
    const NAME: &'static str;
    /// Preset cell that is simulated if the user names no other.
    const CELL: &'static str = "gantry";
    /// What the camera is used for. Cells without camera, driver or gripper are rejected before
    /// anything moves. `None` if the task itself checks what the cell lacks.
    const CAMERA: Option<&'static str> = None;

    /// The task.
    type Task: Task;
    /// Failure of planning.
    type Error: From<PlanError>;

    /// Returns the options of the run.
    fn way(&self) -> Way<'_>;

    /// Validates the arguments that can be checked before a cell is read.
    ///
    /// # Errors
    /// The arguments contradict each other, or name something that does not exist.
    fn check(&self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Indices of the arms that move.
    ///
    /// # Errors
    /// The cell lacks an arm.
    fn arms(&self, planning: &Planning<'_>) -> Result<Vec<usize>, Self::Error> {
        Ok(vec![planning.arm("--arm", self.way().arm)?])
    }

    /// The name of the results directory in which the task is resumed; `None` if each run needs an
    /// empty directory.
    fn resumed_in(&self) -> Option<String> {
        None
    }

    /// Plans the task of the given arms. Nothing moves.
    ///
    /// # Errors
    /// The task cannot be done.
    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<Self::Task, Self::Error>;
}

/// Options of a run of a task.
#[derive(Clone, Copy, Debug)]
pub struct Way<'a> {
    /// Name of the arm; not needed if the cell has only one.
    pub arm: Option<&'a str>,
    /// Whether the task is only planned.
    pub dry_run: bool,
    /// Whether the user has inspected the arms after a task that did not finish; `None` if the
    /// task may stop at any time.
    pub checked: Option<bool>,
    /// Directory for the results.
    pub out: Option<&'a Path>,
}

/// Data for the planning of a task.
pub struct Planning<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// File of the cell.
    pub file: &'a Path,
    /// Whether this process simulates the cell, each time from its initial state.
    pub is_virtual: bool,
    directory: PathBuf,
    settings: RefCell<Settings>,
}

impl<'a> Planning<'a> {
    /// Planning in a cell that was read from `file`, with results in a directory that need not
    /// exist yet.
    pub fn new(cell: &'a Cell, file: &'a Path, is_virtual: bool, directory: PathBuf) -> Self {
        Self {
            cell,
            file,
            is_virtual,
            directory,
            settings: RefCell::new(Settings::empty(FULL_SPEED)),
        }
    }

    /// Returns the index of the arm whose name was given by a flag. The name may be omitted if the
    /// cell has only one arm.
    ///
    /// # Errors
    /// The arm does not exist, or the cell has several.
    pub fn arm(&self, flag: &str, name: Option<&str>) -> Result<usize, PlanError> {
        self.cell.arm_named(flag, name, self.file)
    }

    /// The directory of the results; it is created if it does not exist.
    ///
    /// # Errors
    /// The directory cannot be created.
    pub fn directory(&self) -> Result<&Path, PlanError> {
        std::fs::create_dir_all(&self.directory).map_err(|error| {
            let directory = self.directory.display();
            PlanError::Input(format!("--out: {directory} cannot be made: {error}"))
        })?;
        Ok(&self.directory)
    }

    /// Directory of the results, which may not exist yet.
    pub fn results(&self) -> &Path {
        &self.directory
    }

    /// Adds the objects of the task to the cell, if the cell is simulated.
    ///
    /// # Errors
    /// An object cannot be created.
    pub fn furnish<E>(&self, put: impl FnOnce(&mut Settings) -> Result<(), E>) -> Result<(), E> {
        match self.is_virtual {
            true => put(&mut self.settings.borrow_mut()),
            false => Ok(()),
        }
    }

    /// Settings of the simulated cell.
    pub fn into_settings(self) -> Settings {
        self.settings.into_inner()
    }
}
