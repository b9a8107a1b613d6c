//! A sheet folded in the virtual cell, with drivers and camera, by the task of `rodlab fold`.

use super::Result;
use super::cases::Case;
use super::folds::{Folded, SCENARIOS};
use rodlab_files::results::{ResultsError, SCENARIO, write_whole};
use rodlab_lab::experiment::{FoldingTables, from_text};
use rodlab_planning::plan::fold::{Algorithm, Objective};
use rodlab_robot::Pose;
use rodlab_vision::ColourRule;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{
    FoldPlan, FoldRecord, FoldRequest, FoldTask, Task, TaskError, TaskRun, Workplace,
};
use rodlab_workcell::virtual_cell::{
    HeldSheet, RodError, ServeError, Settings, SimulatedSheet, with_cell,
};
use std::fs;
use std::path::Path;

/// The cell.
const CELL: &str = include_str!("../../scenarios/cells/gantry.toml");
/// Friction of the table.
pub(super) const FRICTION: f64 = 0.12;
/// Number of parts of a path; the camera takes a picture after each (thesis sec. 4.6.5).
pub(super) const PARTS: usize = 5;
/// Requested speed of the cell relative to real time.
const RATE: f64 = 10.0;
/// Speed of the hand during folding and otherwise, m/s, as in `rodlab fold`.
const SPEEDS: [f64; 2] = [0.05, 0.1];
/// Smallest distance of the arm to obstacles, m, as in `rodlab fold`.
const MARGIN: f64 = 0.01;

/// Reason why folding a sheet failed.
#[derive(Debug, thiserror::Error)]
pub(super) enum FoldingError {
    /// The cell cannot be served, or stopped early.
    #[error(transparent)]
    Served(#[from] ServeError),
    /// The cell has no sheet.
    #[error(transparent)]
    Sheet(#[from] RodError),
    /// The sheet was not grasped.
    #[error("the sheet was not taken: {0}")]
    NotTaken(String),
}

/// A sheet after folding, successful or not.
pub(super) struct FoldedInCell {
    /// Measurements and score of the task, from camera and joints.
    pub record: FoldRecord,
    /// Success, or the reason for the failure.
    pub ended: Result<(), TaskError>,
    /// Motion of the simulated sheet while it was held.
    pub held: HeldSheet,
    /// Target displacement of the edge, m.
    pub target: f64,
}

/// Folds the sheet of a simulated run in the virtual cell, in closed loop. Pictures and logs are
/// written to a folder next to the run.
pub(super) fn fold_in_cell(case: &Case<Folded>) -> Result<Result<FoldedInCell, FoldingError>> {
    let text = fs::read_to_string(case.directory.join(SCENARIO))
        .map_err(ResultsError::io("read", &case.directory))?;
    let loaded = from_text("scenario", &text, Path::new(""), &[]);
    let loaded = loaded.expect("the scenario of a run");
    let tables: Option<&FoldingTables> = loaded.scenario.experiment.tables();
    let mut name = case.directory.file_name().unwrap_or_default().to_owned();
    name.push("-cell");
    let directory = case.directory.with_file_name(name);
    fs::create_dir_all(&directory).map_err(ResultsError::io("create", &directory))?;
    let scenario = &SCENARIOS[case.run.scenario];
    for (name, text) in [("cell.toml", CELL), ("paper.toml", scenario.paper)] {
        write_whole(&directory.join(name), text.as_bytes())?;
    }
    let cell = Cell::read(&directory.join("cell.toml")).expect("a cell of this program");
    let is_diagonal = scenario.crease == "diagonal-strip";
    let fold = FoldInCell {
        tables: tables.expect("a sheet that is folded"),
        algorithm: if scenario.is_held {
            Algorithm::Held { friction: FRICTION }
        } else {
            Algorithm::Optimal(Objective::Sum)
        },
        is_diagonal,
        directory: &directory,
    };
    Ok(fold.in_cell(&cell))
}

/// The task of folding.
struct FoldInCell<'a> {
    tables: &'a FoldingTables,
    algorithm: Algorithm,
    is_diagonal: bool,
    directory: &'a Path,
}

impl FoldInCell<'_> {
    fn in_cell(&self, cell: &Cell) -> Result<FoldedInCell, FoldingError> {
        let table = cell.table.expect("the gantry has a table").top;
        let file = self.directory.join("paper.toml");
        let sheet = SimulatedSheet::new(&file, FRICTION, self.is_diagonal, None, &table)?;
        let settings = Settings {
            sheet: Some(sheet),
            ..Settings::empty(RATE)
        };
        let folding = &self.tables.folding;
        let plan = FoldPlan {
            arm: 0,
            title: String::new(),
            paper: folding.paper,
            crease: folding.crease,
            algorithm: String::new(),
            request: FoldRequest {
                sheet: folding.sheet(),
                thickness: folding.paper.thickness,
                target: folding.target(),
                algorithm: self.algorithm,
                parts: PARTS,
            },
            is_closed_loop: true,
            frame: Pose::identity(),
            colour: ColourRule::Background,
            speed: SPEEDS[0],
            approach_speed: SPEEDS[1],
            margin: MARGIN,
        };
        let mut run = TaskRun::planned(FoldTask::new(cell, plan, None), Vec::new());
        let (ended, served) = with_cell(cell, settings, |cell| {
            run.carry_out(&Workplace::alone(cell, self.directory))
        })?;
        let held = served.sheet().and_then(SimulatedSheet::last_held);
        match (held, ended) {
            (Some(held), ended) => Ok(FoldedInCell {
                record: run.task.record().clone(),
                ended,
                held,
                target: folding.target(),
            }),
            (None, Err(error)) => Err(FoldingError::NotTaken(error.to_string())),
            (None, Ok(())) => Err(FoldingError::NotTaken("nothing was held".into())),
        }
    }
}
