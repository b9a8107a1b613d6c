//! How an arm of a cell lays a rod: what `rodlab deploy` and `rodlab place` have in common.

use super::cell_task::{finish, refuse_unfinished};
use super::failure::Failure;
use super::interruption::watch_for_interruption;
use super::log_directory::log_directory;
use super::output::print_json;
use super::solve_arm::arm_named;
use super::task_arguments::TaskArguments;
use clap::Args;
use rodlab_files::results::write_whole;
use rodlab_lab::experiment::Fixtures;
use rodlab_planning::plan::deployment::{DeployedRod, LaidPath, Spare};
use rodlab_vision::{ColourRule, Point};
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{
    Correction, DeployRecord, DeployTask, LayingMethod, MotionRequest, Status, TaskHead,
    TaskRecord, Unfinished, middle_of_table,
};
use std::path::{Path, PathBuf};

/// Frames of the page of the arm in motion.
const FRAMES: usize = 400;

/// Cell, arm, and how it moves.
#[derive(Debug, Args)]
pub struct LayingArguments {
    /// The cell file
    #[arg(
        long,
        value_name = "FILE",
        default_value = "scenarios/cells/gantry.toml"
    )]
    cell: PathBuf,
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
        let cell = Cell::read(&self.cell)?;
        let arm = arm_named(&cell, self.arm.as_deref(), &self.cell)?;
        if !(self.task.dry_run || self.task.checked) {
            refuse_unfinished(&cell, arm)?;
        }
        let directory = self.directory(laying.task)?;
        let unfinished = Unfinished::of(&cell, arm, &directory);
        let place = self
            .task
            .place
            .or_else(|| middle_of_table(&cell, laying.outline));
        let place = place
            .ok_or_else(|| Failure::Input("--place is needed: the cell has no [table]".into()))?;
        let motion = MotionRequest {
            cell: &cell,
            arm,
            place,
            speed: self.task.hand_speed,
            margin: self.task.margin,
        };
        let (rod, path, motion) = motion.plan(|spare| plan(spare, &directory.join("plan")))?;
        write_whole(
            &directory.join("joints.csv"),
            motion.laying.to_csv()?.as_bytes(),
        )?;
        let page = cell.page(Some(&motion.laying), FRAMES);
        write_whole(&directory.join("cell.html"), page.as_bytes())?;
        let mut record = DeployRecord {
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
        if self.task.dry_run {
            record.write(&directory)?;
            return print_json(&record);
        }
        record.head.status = Status::Running;
        record.write(&directory)?;
        let interrupted = watch_for_interruption()?;
        let correction = laying
            .is_corrected
            .then(|| Correction::usual(rod.gravito_bending_length, self.task.hand_speed));
        let task = DeployTask {
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
            unfinished: Some(&unfinished),
            directory: &directory,
        };
        let end = task.run(&|| interrupted.is_raised());
        record.times_s = end.times;
        record.head.stopped = end.stopped;
        record.seen_length = end.seen_length;
        finish(
            record,
            end.laid,
            |record, laid| record.take(&laid),
            &[unfinished],
            &directory,
        )
    }
}
