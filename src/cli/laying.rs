//! How an arm of a cell lays a rod: what `rodlab deploy` and `rodlab place` have in common.

use super::cell_task::{CellTask, refuse_unfinished};
use super::log_directory::log_directory;
use super::prelude::*;
use super::solve_arm::read_arm;
use super::task_arguments::{TaskArguments, TaskArm};
use rodlab_lab::experiment::Fixtures;
use rodlab_planning::plan::deployment::{DeployedRod, LaidPath, Spare};
use rodlab_vision::{ColourRule, Point};
use rodlab_workcell::task::{
    Correction, DeployRecord, DeployTask, LayingMethod, MotionRequest, TaskHead,
};

/// Frames of the page of the arm in motion.
const FRAMES: usize = 400;

/// Cell, arm, and how it moves.
#[derive(Debug, Args)]
pub struct LayingArguments {
    #[command(flatten)]
    arm: TaskArm,
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
}

impl LayingArguments {
    /// The directory of a task, empty.
    pub fn directory(&self, task: &str) -> Result<PathBuf, Failure> {
        log_directory(task, self.task.out.as_deref())
    }

    /// Lays a rod along the path that `plan` gives for the room that there is and writes into a directory.
    pub fn lay(
        &self,
        laying: &Laying<'_>,
        plan: impl Fn(&Spare<'_>, &Path) -> Result<(DeployedRod, LaidPath), Failure>,
    ) -> Result<(), Failure> {
        let colour = ColourRule::parse(&self.task.colour)?;
        let (cell, arm) = read_arm(&self.arm.cell, self.arm.name.as_deref())?;
        if !(self.task.dry_run || self.task.checked) {
            refuse_unfinished(&cell, arm)?;
        }
        let out = self.task.out.as_deref();
        let task = CellTask::new(laying.task, out, &cell, &[arm])?;
        let motion = MotionRequest {
            cell: &cell,
            arm,
            place: self.task.place(&cell, laying.outline)?,
            speed: self.task.hand_speed,
            margin: self.task.margin,
        };
        let (rod, path, motion) = motion.plan(|spare| plan(spare, &task.directory.join("plan")))?;
        task.write_motion(&motion.laying, FRAMES)?;
        let record = DeployRecord {
            head: TaskHead::planned(std::env::args().collect()),
            cell: cell.title.clone(),
            arm: cell.arms[arm].name.clone(),
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
        let deploying = DeployTask {
            cell: &cell,
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
        task.carry_out(record, self.task.dry_run, |record, is_interrupted| {
            let end = deploying.run(is_interrupted);
            record.times_s = end.times;
            record.head.stopped = end.stopped;
            record.seen_length = end.seen_length;
            end.laid.map(|laid| record.take(&laid))
        })
    }
}
