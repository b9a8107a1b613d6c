//! How an arm of a cell lays a rod: what `rodlab deploy` and `rodlab place` have in common.

use super::cell_task::CellTask;
use super::chosen_cell::{CellChoice, FULL_SPEED, TaskCell};
use super::log_directory::log_directory;
use super::prelude::*;
use super::solve_arm::arm_named;
use super::task_arguments::{GANTRY, TaskArguments};
use rodlab_lab::experiment::Fixtures;
use rodlab_planning::plan::deployment::{DeployedRod, LaidPath, Spare};
use rodlab_robot::Pose;
use rodlab_vision::{ColourRule, Point};
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{
    Correction, DeployRecord, DeployTask, LayingMethod, MotionRequest, TaskHead,
};
use rodlab_workcell::virtual_cell::{RodSupply, Settings};

/// Frames of the page of the arm in motion.
const FRAMES: usize = 400;

/// Cell, arm, and how it moves.
#[derive(Debug, Args)]
pub struct LayingArguments {
    #[command(flatten)]
    choice: CellChoice,
    /// Name of the arm; not needed where the cell has only one
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    #[command(flatten)]
    task: TaskArguments,
}

/// What is laid.
pub struct Laying<'a> {
    /// The subcommand.
    pub task: &'a str,
    /// The pattern, for people.
    pub pattern: &'a str,
    /// The pattern without lead-in and lead-out, m.
    pub outline: &'a [Point],
    /// Pegs between which it is laid.
    pub fixtures: Option<&'a Fixtures>,
    /// Whether its path is planned anew from where it is seen to lie.
    pub is_corrected: bool,
    /// The rod for the gripper of a virtual cell, with the pose of the pattern in the cell.
    pub supply: &'a dyn Fn(Pose) -> Result<RodSupply, Failure>,
}

impl LayingArguments {
    /// The directory of a task, empty.
    pub fn directory(&self, task: &str) -> Result<PathBuf, Failure> {
        log_directory(task, self.task.out.as_deref())
    }

    /// The cell, see [`CellChoice::read`].
    pub fn cell(&self) -> Result<TaskCell, Failure> {
        self.choice.read(GANTRY, self.task.dry_run)
    }

    /// Lays a rod along the path that `plan` gives for the room that there is and writes into a directory.
    pub fn lay(
        &self,
        cell: &TaskCell,
        laying: &Laying<'_>,
        plan: impl Fn(&Spare<'_>, &Path) -> Result<(DeployedRod, LaidPath), Failure>,
    ) -> Result<(), Failure> {
        let colour = ColourRule::parse(&self.task.colour)?;
        let dry_run = self.task.dry_run;
        let arm = arm_named(&cell.cell, "--arm", self.arm.as_deref(), &cell.file)?;
        if !dry_run {
            cell.refuse_unfinished(arm, self.task.checked)?;
        }
        let out = self.task.out.as_deref();
        let task = CellTask::new(laying.task, out, cell, &[arm], &self.choice)?;
        let motion = MotionRequest {
            cell: &cell.cell,
            arm,
            place: self.task.place(&cell.cell, laying.outline)?,
            speed: self.task.hand_speed,
            margin: self.task.margin,
        };
        let (rod, path, motion) = motion.plan(|spare| plan(spare, &task.directory.join("plan")))?;
        task.write_motion(&motion.laying, FRAMES)?;
        let record = DeployRecord {
            head: TaskHead::planned(std::env::args().collect()),
            cell: cell.cell.title.clone(),
            arm: cell.cell.arms[arm].name.clone(),
            pattern: laying.pattern.to_owned(),
            motion: motion.report.clone(),
            times_s: Vec::new(),
            seen_length: None,
            score: None,
            pegs: None,
        };
        let correction = laying
            .is_corrected
            .then(|| Correction::usual(rod.gravito_bending_length, self.task.hand_speed));
        let deploy = |cell: &Cell| {
            let deploying = DeployTask {
                cell,
                arm,
                motion: &motion,
                approach_speed: self.task.approach_speed,
                pattern: laying.outline,
                path: &path,
                rod: &rod,
                colour: &colour,
                laying: correction.as_ref().map(|way| way as &dyn LayingMethod),
                fixtures: laying.fixtures,
                unfinished: task.unfinished.first(),
                directory: &task.directory,
            };
            task.carry_out(record, dry_run, |record, is_interrupted| {
                let end = deploying.run(is_interrupted);
                record.times_s = end.times;
                record.head.stopped = end.stopped;
                record.seen_length = end.seen_length;
                end.laid.map(|laid| record.take(&laid))
            })
        };
        let settings = || {
            let begin = path.points[0].position;
            let begin = motion.frame * nalgebra::Point3::new(begin.x, begin.y, 0.0);
            let supply = (laying.supply)(motion.frame)?;
            Ok(Settings {
                // A person lays the free end where the rod is to begin.
                supply: Some(supply.with_free_end([begin.x, begin.y])),
                ..Settings::empty(FULL_SPEED)
            })
        };
        cell.work(settings, deploy)
    }
}
