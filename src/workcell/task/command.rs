//! Commands that plan tasks: their properties beside the arguments, and the data for planning.

use super::step::Task;
use crate::cell::{Cell, PlanError};
use crate::virtual_cell::Settings;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// Speed relative to real time of a virtual cell that only one process uses: as fast as it can be simulated.
const FULL_SPEED: f64 = 100.0;

/// A command that plans a task from its arguments. The command line adds which cell, asks before anything moves, and runs the task.
pub trait TaskCommand {
    /// Its name, by which its results directories are named.
    const NAME: &'static str;
    /// The preset cell, which is simulated where no other is named.
    const CELL: &'static str = "gantry";
    /// Purpose of the camera: arms without camera, driver or gripper are refused before anything moves. `None` where the
    /// task itself finds out what it lacks.
    const CAMERA: Option<&'static str> = None;

    /// The task.
    type Task: Task;
    /// Failure of planning.
    type Error: From<PlanError>;

    /// Returns how it is run.
    fn way(&self) -> Way<'_>;

    /// Validates arguments that need no cell, before one is read.
    ///
    /// # Errors
    /// They contradict each other, or name something that is not there.
    fn check(&self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Indices of the arms that move.
    ///
    /// # Errors
    /// The cell lacks them.
    fn arms(&self, planning: &Planning<'_>) -> Result<Vec<usize>, Self::Error> {
        Ok(vec![planning.arm("--arm", self.way().arm)?])
    }

    /// The name of the results directory of a task that is resumed there; `None` where each task has an empty one.
    fn resumed_in(&self) -> Option<String> {
        None
    }

    /// Plans the task of arms. Nothing moves.
    ///
    /// # Errors
    /// It cannot be done.
    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<Self::Task, Self::Error>;
}

/// Options by which a task is run.
#[derive(Clone, Copy, Debug)]
pub struct Way<'a> {
    /// Name of the arm; not needed where the cell has only one.
    pub arm: Option<&'a str>,
    /// Whether it is planned only.
    pub dry_run: bool,
    /// Whether the arms were inspected after a task that did not finish; `None` where a task may end anywhere.
    pub checked: Option<bool>,
    /// Directory for the results.
    pub out: Option<&'a Path>,
}

/// Data for the planning of a task.
pub struct Planning<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Its file.
    pub file: &'a Path,
    /// Whether it is simulated by this process, new each time.
    pub is_virtual: bool,
    directory: PathBuf,
    settings: RefCell<Settings>,
}

impl<'a> Planning<'a> {
    /// In a cell by its file, with results in a directory that need not be there yet.
    pub fn new(cell: &'a Cell, file: &'a Path, is_virtual: bool, directory: PathBuf) -> Self {
        Self {
            cell,
            file,
            is_virtual,
            directory,
            settings: RefCell::new(Settings::empty(FULL_SPEED)),
        }
    }

    /// The index of an arm by its name, as given by a flag, which may be left out where there is only one.
    ///
    /// # Errors
    /// The arm does not exist, or the cell has several.
    pub fn arm(&self, flag: &str, name: Option<&str>) -> Result<usize, PlanError> {
        self.cell.arm_named(flag, name, self.file)
    }

    /// The directory of the results, which is made now if it is not there.
    ///
    /// # Errors
    /// It cannot be made.
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
    /// It cannot be made.
    pub fn furnish<E>(&self, put: impl FnOnce(&mut Settings) -> Result<(), E>) -> Result<(), E> {
        match self.is_virtual {
            true => put(&mut self.settings.borrow_mut()),
            false => Ok(()),
        }
    }

    /// Settings of the cell, if it is simulated.
    pub fn into_settings(self) -> Settings {
        self.settings.into_inner()
    }
}
