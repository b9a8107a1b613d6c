//! One direction after the other, and what is resumed after an end.

use super::ray::{Ray, RayRequest};
use super::record::{ExplorationPlan, ExplorationRecord};
use super::row::{ExplorationRow, ExplorationSummary, Found, TABLE, read_rows};
use super::walk::{LOG, SearchSteps, Searched, Walker};
use crate::cell::{Cell, HandPathRequest};
use crate::task::error::WorkError;
use crate::task::record::TaskHead;
use crate::task::working_arm::{Grip, WorkingArm};
use rodlab_engine::mechanics::kirchhoff::Helix;
use rodlab_files::results::{CsvStream, ResultsError, read_whole_rows, write_whole};
use rodlab_lab::experiment::ClampedRod;
use rodlab_robot::{JointTrajectory, Pose};
use rodlab_vision::{ColourRule, encode_picture, marker_overlay};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// Largest difference of a joint, rad or m, with which it still stands on a ray.
const ON_RAY: f64 = 0.05;

/// What is explored with what.
pub struct Exploration<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// The rod.
    pub rod: &'a ClampedRod,
    /// Unit vectors (κ, τ, ω).
    pub directions: &'a [[f64; 3]],
    /// Distance ‖(κ, τ, ω)‖ at which a search ends.
    pub farthest: f64,
    /// Least distance of arm and rod to anything else, m.
    pub margin: f64,
    /// Steps of the search.
    pub search: SearchSteps,
    /// Greatest speed of the hand on the way to the straight rod, m/s.
    pub approach_speed: f64,
    /// Which pixels are markers.
    pub colour: &'a ColourRule,
    /// Whether pictures of instabilities are kept.
    pub keeps_pictures: bool,
    /// Where everything is written.
    pub directory: &'a Path,
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

/// Why an exploration ended early.
#[derive(Debug, thiserror::Error)]
pub enum ExploreError {
    /// The cell lacks something, or the rod cannot be held straight.
    #[error("{0}")]
    Input(String),
    /// Something failed.
    #[error("{doing}: {reason}")]
    Failed {
        /// While this was done.
        doing: String,
        /// In words.
        reason: String,
    },
    /// Somebody asked for the end; arm and chuck hold.
    #[error("interrupted; arm and chuck hold, and the same command goes on")]
    Interrupted,
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl Exploration<'_> {
    /// What the manifest says of it.
    pub fn plan(&self) -> ExplorationPlan {
        let Self { cell, rod, .. } = self;
        ExplorationPlan {
            cell: cell.title.clone(),
            arm: cell.arms[self.arm].name.clone(),
            rod: (rod.title.clone(), rod.length, rod.radius),
            directions: self.directions.to_vec(),
            farthest: self.farthest,
            margin_m: self.margin,
            search: self.search,
        }
    }

    /// The manifest of one that is about to begin, with no rod clamped.
    pub fn record(&self, command_line: Vec<String>) -> ExplorationRecord {
        ExplorationRecord {
            head: TaskHead::planned(command_line),
            is_clamped: false,
            plan: self.plan(),
            summary: ExplorationSummary::default(),
        }
    }

    /// Joints of the arm where it holds the straight rod.
    ///
    /// # Errors
    /// The cell has no chuck, no camera or no gripper, or the arm does not reach the end of the straight rod.
    pub fn start(&self) -> Result<Vec<f64>, ExploreError> {
        let Self { cell, rod, .. } = self;
        let input = |words: &str| ExploreError::Input(words.into());
        let chuck = cell.chuck.ok_or_else(|| {
            input("the cell has no [chuck]: the end of a rod that does not move is held there")
        })?;
        if cell.camera.is_none() {
            return Err(input("the cell has no [camera] to look at the rod"));
        }
        let arm = &cell.arms[self.arm];
        let end = chuck.pose * Pose::translation(rod.length, 0.0, 0.0);
        let joints = arm.chain.reach(&(arm.base.inverse() * end), &arm.home);
        let joints = joints.map_err(|nearest| {
            ExploreError::Input(format!(
                "arm {} does not reach the end of the straight rod; it comes within {:.3} m of it",
                arm.name, nearest.distance
            ))
        })?;
        let path = cell.follow_poses(&HandPathRequest {
            arm: self.arm,
            from: joints.clone(),
            poses: &[end],
            margin: self.margin,
        });
        match path.ends {
            None => Ok(joints),
            Some(words) => Err(ExploreError::Input(format!(
                "the straight rod cannot be held: {words}"
            ))),
        }
    }

    /// The ray of a direction, the first one being 0.
    pub fn ray(&self, start: &[f64], direction: usize) -> Ray {
        let request = RayRequest {
            cell: self.cell,
            arm: self.arm,
            rod: self.rod,
            start,
            farthest: self.farthest,
            margin: self.margin,
        };
        request.plan(Helix::from(self.directions[direction]))
    }

    /// The 3-D page of the cell along a ray, in no more than so many frames.
    ///
    /// # Errors
    /// A joint has no limit of acceleration or jerk.
    pub fn page(&self, ray: &Ray, most_frames: usize) -> Result<String, ExploreError> {
        let motion = self.motion(&ray.points, self.search.speed)?;
        Ok(self.cell.page(motion.as_ref(), most_frames))
    }

    /// Writes `plan.csv`: how far each direction can be led, and why no farther.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_plan(&self, start: &[f64]) -> Result<(), ExploreError> {
        let mut table = CsvStream::create(&self.directory.join("plan.csv"))?;
        for index in 0..self.directions.len() {
            let ray = self.ray(start, index);
            let [kappa, tau, omega] = self.directions[index];
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
        Ok(table.flush()?)
    }

    /// A motion over points of the joints of arm and chuck; `None` where there is only one.
    fn motion(
        &self,
        points: &[Vec<f64>],
        speed: f64,
    ) -> Result<Option<JointTrajectory>, ExploreError> {
        if points.len() < 2 {
            return Ok(None);
        }
        let chuck = self.cell.chuck.expect("the start was found");
        let (cell, axis) = (self.cell, chuck.axis);
        let motion = cell.motion_along(self.arm, axis, points, speed, 0.0);
        let motion = motion.map_err(|error| ExploreError::Input(error.to_string()))?;
        Ok(Some(motion))
    }

    /// Explores the directions that are not in the table yet, and writes a row for each when it is done.
    ///
    /// # Errors
    /// Something fails on the way: arm and chuck hold.
    pub fn run(
        &self,
        record: &mut ExplorationRecord,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), ExploreError> {
        let start = self.start()?;
        let table = self.directory.join(TABLE);
        let (mut rows, mut stream) = match table.is_file() {
            true => {
                let whole = read_whole_rows::<ExplorationRow>(&table)?;
                let stream = CsvStream::continue_unmarked(&table, whole.length)?;
                (whole.rows, stream)
            }
            false => (Vec::new(), CsvStream::create(&table)?),
        };
        record.summary = ExplorationSummary::of(&rows);
        if rows.len() >= self.directions.len() {
            return Ok(());
        }
        let walker = Walker {
            arm: WorkingArm {
                cell: self.cell,
                arm: self.arm,
                directory: self.directory,
                unfinished: None,
                is_interrupted,
            },
            rod: self.rod,
            colour: self.colour,
            steps: self.search,
        };
        self.straighten(&walker, record, &start, rows.len())?;
        for index in rows.len()..self.directions.len() {
            let began = Instant::now();
            let ray = self.ray(&start, index);
            let doing = format!("direction {}", index + 1);
            let searched = walker
                .search(&ray)
                .map_err(|error| in_words(error, &doing))?;
            let row = self.row(index, &ray, &searched, began);
            self.write_looks(index, &searched)?;
            tracing::info!(
                "direction {} of {}: {}",
                index + 1,
                self.directions.len(),
                match row.found {
                    Some(found) => format!("stability lost at {found:.3}"),
                    None => format!("the helix up to {:.2}", row.reach),
                }
            );
            stream.write(&row)?;
            stream.sync()?;
            rows.push(row);
            record.summary = ExplorationSummary::of(&rows);
            record.write(self.directory)?;
        }
        Ok(())
    }

    /// The rows that are there.
    ///
    /// # Errors
    /// The table cannot be read.
    pub fn rows(&self) -> Result<Vec<ExplorationRow>, ResultsError> {
        match self.directory.join(TABLE).is_file() {
            true => read_rows(self.directory),
            false => Ok(Vec::new()),
        }
    }

    /// Brings the clamps to the straight rod: a new one is clamped there; one that is clamped already goes back along the ray on
    /// which it stands.
    fn straighten(
        &self,
        walker: &Walker<'_>,
        record: &mut ExplorationRecord,
        start: &[f64],
        direction: usize,
    ) -> Result<(), ExploreError> {
        let chuck = self.cell.chuck.expect("the start was found");
        let unseen =
            |reason: String| in_words(WorkError::Failed(reason), "looking where the arm stands");
        let mut joints = self.cell.stands(self.arm).map_err(unseen)?;
        joints.push(self.cell.axis_stands(chuck.axis).map_err(unseen)?);
        if record.is_clamped {
            let ray = self.ray(start, direction);
            let (_, away) = ray.nearest(&joints);
            let back = match away > ON_RAY {
                true => Err(WorkError::Failed(format!(
                    "a rod is clamped, but arm and chuck do not stand on the ray of direction {}: a joint is {away:.3} away from \
                     it. Bring the rod to be straight by hand",
                    direction + 1
                ))),
                false => walker.return_from(&ray, joints),
            };
            // It may have snapped meanwhile, or may have to be taken again.
            let back = back.and_then(|()| walker.take_anew());
            return back.map_err(|error| in_words(error, "going back to the straight rod"));
        }
        let doing = "going to the end of the straight rod";
        let mut straight = start.to_vec();
        straight.push(0.0);
        if let Some(points) = crate::cell::straight(&joints, &straight)
            && let Some(way) = self.motion(&points, self.approach_speed)?
        {
            let gone = walker.arm.follow(LOG, &way);
            gone.map_err(|error| in_words(error, doing))?;
        }
        let doing = "clamping the rod";
        let clamped = walker.arm.grip(Grip::Close);
        clamped.map_err(|error| in_words(error, doing))?;
        record.is_clamped = true;
        Ok(record.write(self.directory)?)
    }

    fn row(&self, index: usize, ray: &Ray, searched: &Searched, began: Instant) -> ExplorationRow {
        let [kappa, tau, omega] = self.directions[index];
        let theory = ray.theory();
        let found = searched.lost.map(|lost| 0.5 * (searched.stable + lost));
        ExplorationRow {
            direction: index + 1,
            kappa,
            tau,
            omega,
            outcome: found.map_or(Found::StaysHelix, |_| Found::Buckles),
            stable: searched.stable,
            lost: searched.lost,
            found,
            theory,
            relative_difference: found
                .zip(theory)
                .map(|(found, theory)| found / theory - 1.0),
            reach: ray.reach(),
            limit: ray.limit.clone().unwrap_or_default(),
            looks: searched.looks.len(),
            wall_time_s: began.elapsed().as_secs_f64(),
        }
    }

    /// Writes what was seen along a direction.
    fn write_looks(&self, index: usize, searched: &Searched) -> Result<(), ExploreError> {
        let folder = format!("directions/{:04}", index + 1);
        let folder = self.directory.join(folder);
        std::fs::create_dir_all(&folder).map_err(|error| ExploreError::Failed {
            doing: format!("direction {}", index + 1),
            reason: format!("{} cannot be made: {error}", folder.display()),
        })?;
        let mut looks = CsvStream::create(&folder.join("looks.csv"))?;
        for look in &searched.looks {
            looks.write(look)?;
        }
        looks.flush()?;
        if let Some(picture) = searched
            .lost_picture
            .as_ref()
            .filter(|_| self.keeps_pictures)
        {
            let shown = marker_overlay(&picture.pixels, &picture.spots, &picture.errors);
            write_whole(&folder.join("lost.png"), &encode_picture(&shown))?;
        }
        Ok(())
    }
}

fn in_words(error: WorkError, doing: &str) -> ExploreError {
    match error {
        WorkError::Interrupted => ExploreError::Interrupted,
        WorkError::Failed(reason) => ExploreError::Failed {
            doing: doing.into(),
            reason,
        },
    }
}
