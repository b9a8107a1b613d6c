//! Explores one direction after another. Resumes after an early end.

use super::explore::{Exploration, ExploreError, is_clamped};
use super::ray::Ray;
use super::record::ExplorationRecord;
use super::row::{ExplorationRow, ExplorationSummary, TABLE, read_rows};
use super::walk::{LOG, Searched, Walker};
use crate::cell::{Cell, PlanError, straight};
use crate::task::error::WorkError;
use crate::task::stage::Stage;
use crate::task::step::{Step, Task};
use crate::task::working_arm::{Grip, WorkingArm};
use crate::task::workplace::Workplace;
use rodlab_files::results::{CsvStream, ResultsError, read_whole_rows};
use rodlab_robot::JointTrajectory;
use rodlab_vision::{encode_picture, marker_overlay};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// Tolerance within which joints count as on a ray, rad or m.
const ON_RAY: f64 = 0.05;

const APPROACH: Stage = Stage::new("approach", "going to the end of the straight rod", NEXT);
const TAKE: Stage = Stage::new("take", "clamping the rod", NEXT);
const RETURN: Stage = Stage::new("return", "going back to the straight rod", NEXT);
/// Advice after an early end in any stage.
const NEXT: &str =
    "inspect arm, chuck and rod, then run the same command again; finished directions are kept";

/// An exploration in progress.
pub struct ExplorationTask {
    exploration: Exploration,
    /// Joint positions in which the arm holds the straight rod.
    start: Vec<f64>,
    record: ExplorationRecord,
}

/// A row of `plan.csv`.
#[derive(Serialize)]
struct PlanRow {
    direction: usize,
    kappa: f64,
    tau: f64,
    omega: f64,
    roll_rad: f64,
    reach: f64,
    limit: String,
    theory: Option<f64>,
}

impl Task for ExplorationTask {
    type Record = ExplorationRecord;

    fn record(&self) -> &ExplorationRecord {
        &self.record
    }

    fn arms(&self) -> Vec<usize> {
        vec![self.exploration.arm]
    }

    /// The motion along the first direction.
    fn motion(&self, cell: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
        let first = self.ray(cell, 0);
        let Exploration { search, .. } = &self.exploration;
        self.exploration.motion(cell, &first.points, search.speed)
    }

    fn steps(&self) -> Vec<Step<Self>> {
        let (done, count) = (self.record.rows.len(), self.exploration.directions.len());
        let mut steps = match self.record.is_clamped {
            _ if done >= count => Vec::new(),
            true => vec![Step::new(&RETURN, Self::straighten)],
            false => vec![
                Step::new(&APPROACH, Self::approach),
                Step::new(&TAKE, Self::clamp),
            ],
        };
        steps.extend((done..count).map(|index| {
            let stage = Stage {
                name: format!("direction-{}", index + 1).into(),
                words: format!("direction {}", index + 1).into(),
                next: NEXT,
            };
            Step::new(&stage, move |task: &mut Self, at| task.explore(index, at))
        }));
        steps
    }

    fn next_step(&self, stage: &Stage) -> String {
        let rod = match self.record.is_clamped {
            true => "the rod is clamped between chuck and hand",
            false => "no rod is clamped",
        };
        format!("{rod}: {}", stage.next)
    }

    /// `plan.csv`: the distance to which each direction can be followed, and the reason for that limit.
    fn write_plan(&self, cell: &Cell, directory: &Path) -> Result<(), ResultsError> {
        let mut table = CsvStream::create(&directory.join("plan.csv"))?;
        for (index, direction) in self.exploration.directions.iter().enumerate() {
            let ray = self.ray(cell, index);
            let [kappa, tau, omega] = *direction;
            table.write(&PlanRow {
                direction: index + 1,
                kappa,
                tau,
                omega,
                roll_rad: ray.roll,
                reach: ray.reach(),
                limit: ray.limit.clone().unwrap_or_default(),
                theory: ray.theory(),
            })?;
        }
        table.flush()
    }

    fn write_figures(&self, directory: &Path) -> Result<(), ResultsError> {
        self.record.write_figures(directory)
    }
}

impl ExplorationTask {
    /// Creates the task in a cell, or resumes an earlier task with the same plan from its
    /// directory. If the cell `is_new`, no rod is clamped.
    ///
    /// # Errors
    /// The task cannot start.
    pub fn new(
        exploration: Exploration,
        cell: &Cell,
        directory: &Path,
        is_new: bool,
    ) -> Result<Self, ExploreError> {
        let start = exploration.start(cell)?;
        let plan = exploration.plan(cell);
        let mut record = ExplorationRecord {
            is_clamped: is_clamped(directory, &plan)? && !is_new,
            plan,
            summary: ExplorationSummary::default(),
            rows: Vec::new(),
        };
        if directory.join(TABLE).is_file() {
            record.take(read_rows(directory)?);
        }
        Ok(Self {
            exploration,
            start,
            record,
        })
    }

    fn ray(&self, cell: &Cell, direction: usize) -> Ray {
        self.exploration.ray(cell, &self.start, direction)
    }

    fn walker<'a>(&'a self, at: &'a Workplace<'a>) -> Walker<'a> {
        let Exploration {
            rod,
            arm,
            colour,
            search,
            ..
        } = &self.exploration;
        Walker {
            arm: WorkingArm { at, arm: *arm },
            rod,
            colour,
            steps: *search,
        }
    }

    /// Positions of the joints of arm and chuck.
    fn joints(&self, cell: &Cell) -> Result<Vec<f64>, WorkError> {
        let chuck = cell.chuck.expect("the start was found");
        let mut joints = cell.stands(self.exploration.arm)?;
        joints.push(cell.axis_stands(chuck.axis)?);
        Ok(joints)
    }

    fn approach(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let mut there = self.start.clone();
        there.push(0.0);
        let Some(points) = straight(&self.joints(at.cell)?, &there) else {
            return Ok(());
        };
        let speed = self.exploration.approach_speed;
        match self.exploration.motion(at.cell, &points, speed)? {
            Some(way) => self.walker(at).arm.follow(LOG, &way),
            None => Ok(()),
        }
    }

    fn clamp(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        self.walker(at).arm.grip(Grip::Close)?;
        self.record.is_clamped = true;
        Ok(())
    }

    /// Returns a clamped rod along its ray to the straight state.
    fn straighten(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let joints = self.joints(at.cell)?;
        let direction = self.record.rows.len();
        let ray = self.ray(at.cell, direction);
        let (_, away) = ray.nearest(&joints);
        if away > ON_RAY {
            return Err(WorkError::Failed(format!(
                "a rod is clamped, but arm and chuck are not on the ray of direction {}: a joint is {away:.3} away from it. \
                 Straighten the rod by hand",
                direction + 1
            )));
        }
        let walker = self.walker(at);
        walker.return_from(&ray, joints)?;
        // The rod may have snapped meanwhile, or may have to be gripped again.
        walker.take_anew()
    }

    /// Explores a direction, and writes its row when it is done.
    fn explore(&mut self, index: usize, at: &Workplace<'_>) -> Result<(), WorkError> {
        let began = Instant::now();
        let ray = self.ray(at.cell, index);
        let searched = self.walker(at).search(&ray)?;
        let row = self.exploration.row(index, &ray, &searched, began);
        self.write_looks(index, &searched, at)?;
        tracing::info!(
            "direction {} of {}: {}",
            index + 1,
            self.exploration.directions.len(),
            match row.found {
                Some(found) => format!("stability lost at {found:.3}"),
                None => format!("stable up to {:.2}", row.reach),
            }
        );
        let table = at.directory.join(TABLE);
        let mut stream = match table.is_file() {
            true => {
                let whole = read_whole_rows::<ExplorationRow>(&table)?;
                CsvStream::continue_unmarked(&table, whole.length)?
            }
            false => CsvStream::create(&table)?,
        };
        stream.write(&row)?;
        stream.sync()?;
        let mut rows = std::mem::take(&mut self.record.rows);
        rows.push(row);
        self.record.take(rows);
        Ok(())
    }

    /// Writes the measurements along a direction.
    fn write_looks(
        &self,
        index: usize,
        searched: &Searched,
        at: &Workplace<'_>,
    ) -> Result<(), WorkError> {
        let name = format!("directions/{:04}", index + 1);
        let folder = at.directory.join(&name);
        std::fs::create_dir_all(&folder).map_err(|error| {
            WorkError::Failed(format!("{} cannot be made: {error}", folder.display()))
        })?;
        let mut looks = CsvStream::create(&folder.join("looks.csv"))?;
        for look in &searched.looks {
            looks.write(look)?;
        }
        looks.flush()?;
        let picture = searched.lost_picture.as_ref();
        if let Some(picture) = picture.filter(|_| self.exploration.keeps_pictures) {
            let shown = marker_overlay(&picture.pixels, &picture.spots, &picture.errors);
            at.write(&format!("{name}/lost.png"), &encode_picture(&shown))?;
        }
        Ok(())
    }
}
