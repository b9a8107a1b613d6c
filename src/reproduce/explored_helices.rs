//! Helical rods explored by the arm of a virtual cell (thesis 6.3 and 6.4).

use super::cases::{Run, prepared};
use rodlab_files::results::ResultsError;
use rodlab_lab::experiment::ClampedRod;
use rodlab_lab::run::{PreparedRun, TableJob};
use rodlab_vision::ColourRule;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{
    Exploration, ExplorationRow, ExplorationTask, SearchSteps, Task, TaskRun, Workplace,
    quarter_sphere,
};
use rodlab_workcell::virtual_cell::{self, ChuckedSupply, Settings};
use std::path::Path;
use std::sync::Arc;

const CELL: &str = include_str!("../../scenarios/cells/helix_gantry.toml");
const ROD: &str = include_str!("../../scenarios/rods/nitinol_wire.toml");
/// Scenario file that is stored with the run, in addition to its own numbers.
const BASE: &str = include_str!("../../scenarios/helix_boundary.toml");
/// Directions of the thesis.
pub(super) const DIRECTIONS: usize = 328;
/// Interval of the directions in a quick version.
const QUICK: usize = 41;
/// Largest speed of the cells relative to real time.
const RATE: f64 = 40.0;
/// Processor time of a direction, s(measured; correct within a factor of two).
const SECONDS_PER_DIRECTION: f64 = 10.0;

/// Directions of the thesis, each explored separately by an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Explored {
    /// Interval between explored directions.
    pub every: usize,
    /// Distance ‖(κ, τ, ω)‖ at which a search ends.
    pub farthest: f64,
}

/// Options of the search.
pub(super) const SEARCH: SearchSteps = SearchSteps {
    step: 0.5,
    precision: 0.05,
    deviation: 0.015,
    speed: 0.05,
    return_speed: 0.1,
};

impl Explored {
    /// All directions of the thesis, or a few.
    pub fn of_the_thesis(quick: bool) -> Self {
        Self {
            every: if quick { QUICK } else { 1 },
            farthest: 14.0,
        }
    }

    fn directions(&self) -> Vec<[f64; 3]> {
        let all = quarter_sphere(DIRECTIONS).into_iter();
        all.skip(self.every / 2).step_by(self.every).collect()
    }
}

impl Run for Explored {
    fn id(&self) -> String {
        format!("explored_{}_{}", self.directions().len(), self.farthest)
    }

    fn prepare(&self) -> PreparedRun {
        let mut run = prepared(&self.id(), BASE, &[]);
        // This text identifies the run, so that another cell, rod or search gives another run.
        for (what, text) in [("cell", CELL), ("rod", ROD)] {
            let hash = blake3::hash(text.as_bytes()).to_hex();
            run.scenario_toml +=
                &format!("# explored in a virtual cell; hash of its {what}: {hash}\n");
        }
        run.scenario_toml += &format!("# {self:?} {SEARCH:?}\n");
        run.table = Some(Arc::new(*self));
        run
    }

    fn extent(&self) -> String {
        format!("{} directions were explored", self.directions().len())
    }

    fn cost(&self) -> f64 {
        SECONDS_PER_DIRECTION * self.directions().len() as f64
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            every: DIRECTIONS,
            farthest: 0.5,
        }
    }
}

impl TableJob for Explored {
    type Row = ExplorationRow;

    const TABLE: &'static str = "exploration.csv";
    const ROWS: &'static str = "directions";

    fn count(&self) -> usize {
        self.directions().len()
    }

    fn row(&self, index: usize, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<ExplorationRow> {
        let direction = self.directions()[index];
        let explored = explore(direction, self.farthest, goes_on);
        if !goes_on() {
            return None;
        }
        let mut row = explored.unwrap_or_else(|words| {
            tracing::warn!("direction {}: {words}", index + 1);
            ExplorationRow::failed(direction, words)
        });
        row.direction = index + 1;
        Some(row)
    }

    fn conclude(&self, _: &[ExplorationRow], _: &Path) -> Result<Vec<String>, ResultsError> {
        Ok(Vec::new())
    }
}

/// Explores a direction in its own cell.
fn explore(
    direction: [f64; 3],
    farthest: f64,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<ExplorationRow, String> {
    with_cell(|cell, rod, directory| {
        let exploration = exploration(rod, &[direction], farthest);
        let task = ExplorationTask::new(exploration, cell, directory, true);
        let mut run = TaskRun::planned(task.map_err(|error| error.to_string())?, Vec::new());
        let explored = run.carry_out(&Workplace {
            is_interrupted: &|| !goes_on(),
            ..Workplace::alone(cell, directory)
        });
        explored.map_err(|error| error.to_string())?;
        let row = run.task.record().rows.first().cloned();
        row.ok_or_else(|| "nothing was explored".to_owned())
    })
}

/// An exploration of directions.
fn exploration(rod: ClampedRod, directions: &[[f64; 3]], farthest: f64) -> Exploration {
    Exploration {
        arm: 0,
        rod,
        directions: directions.to_vec(),
        farthest,
        margin: 5e-3,
        search: SEARCH,
        approach_speed: 0.1,
        colour: ColourRule::parse("blue").expect("a rule"),
        keeps_pictures: false,
    }
}

/// Serves the cell in a thread, and calls a function with the client's cell, the rod and an empty
/// directory.
fn with_cell<T>(
    task: impl FnOnce(&Cell, ClampedRod, &Path) -> Result<T, String>,
) -> Result<T, String> {
    let in_words = |error: &dyn std::fmt::Display| error.to_string();
    let folder = tempfile::tempdir().map_err(|error| in_words(&error))?;
    let place = |name: &str, text: &str| {
        let path = folder.path().join(name);
        let written = std::fs::write(&path, text);
        written.map(|()| path).map_err(|error| in_words(&error))
    };
    let cell = Cell::read(&place("cell.toml", CELL)?).map_err(|error| in_words(&error))?;
    let file = place("rod.toml", ROD)?;
    let rod = ClampedRod::read(&file).map_err(|error| in_words(&error))?;
    let chucked = ChuckedSupply::new(&file, &cell).map_err(|error| in_words(&error))?;
    let settings = Settings {
        chucked,
        ..Settings::empty(RATE)
    };
    let directory = folder.path().join("explored");
    std::fs::create_dir_all(&directory).map_err(|error| in_words(&error))?;
    let done = virtual_cell::with_cell(&cell, settings, |cell| task(cell, rod, &directory));
    done.map_err(|error| in_words(&error))?.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_workcell::task::{WorkError, read_exploration};
    use std::time::{Duration, Instant};

    /// Two directions that lose stability early.
    const TWO: [[f64; 3]; 2] = [
        [0.577_350_269, 0.577_350_269, -0.577_350_269],
        [0.249, 0.498, -0.831],
    ];

    /// The 21st of the 328 directions. A wire that has snapped here snaps far earlier the second
    /// time unless it is regrasped.
    const SNAPS: [[f64; 3]; 1] = [[0.9375, 0.299_694_16, 0.176_853_497]];

    #[test]
    fn a_snapped_rod_stays_different_until_it_is_regrasped() {
        let rows = with_cell(|cell, rod, directory| {
            let exploration = exploration(rod, &SNAPS, 9.0);
            let task = ExplorationTask::new(exploration, cell, directory, true);
            let mut run = TaskRun::planned(task.unwrap(), Vec::new());
            run.carry_out(&Workplace::alone(cell, directory)).unwrap();
            Ok(run.task.record().rows.clone())
        });
        let row = &rows.unwrap()[0];
        assert!(row.relative_difference.unwrap().abs() < 0.05, "{row:?}");
    }

    #[test]
    fn an_interrupted_exploration_resumes_at_its_direction_and_agrees_with_theory() {
        let rows = with_cell(|cell, rod, directory| {
            let planned = |is_new| {
                let exploration = exploration(rod.clone(), &TWO, 9.0);
                let task = ExplorationTask::new(exploration, cell, directory, is_new);
                TaskRun::planned(task.unwrap(), Vec::new())
            };
            let mut run = planned(true);
            // Interrupt some time after the first row was written, during the second ray.
            let first = std::cell::Cell::new(None::<Instant>);
            let is_interrupted = || {
                let has_row = || read_exploration(directory).is_ok_and(|rows| rows.len() == 1);
                if first.get().is_none() && has_row() {
                    first.set(Some(Instant::now()));
                }
                let since = first.get().map(|since| since.elapsed());
                since.is_some_and(|since| since > Duration::from_millis(700))
            };
            let at = Workplace {
                is_recorded: true,
                ..Workplace::alone(cell, directory)
            };
            let ended = run.carry_out(&Workplace {
                is_interrupted: &is_interrupted,
                ..at
            });
            let error = ended.unwrap_err();
            assert!(matches!(error.error, WorkError::Interrupted), "{error}");
            let before = run.task.record().rows.clone();
            assert!(before.len() == 1 && run.task.record().is_clamped);
            let mut run = planned(false);
            run.carry_out(&at).unwrap();
            let rows = run.task.record().rows.clone();
            assert_eq!(rows[0], before[0]);
            Ok(rows)
        });
        let rows = rows.unwrap();
        assert_eq!(rows.len(), 2);
        for row in rows {
            assert!(row.relative_difference.unwrap().abs() < 0.03, "{row:?}");
        }
    }
}
