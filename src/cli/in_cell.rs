//! Runs any task in a cell: creates the directory of the results, asks before arms move, and
//! handles the end of the task.

use super::chosen_cell::{CellChoice, TaskCell, asked};
use super::exit_code::NOT_SEEN_WHOLE;
use super::interruption::watch_for_interruption;
use super::log_directory::{empty_directory, results_directory};
use super::prelude::*;
use super::safety_signals::{open_diagnostics, open_signals, write_signals};
use super::status_line::StatusLine;
use rodlab_files::results::write_whole;
use rodlab_robot::JointTrajectory;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::live::LivePage;
use rodlab_workcell::task::{
    Display, Displays, FirstRun, Planning, SpeedOverride, Task, TaskCommand, TaskError, TaskRecord,
    TaskRun, Unfinished, WorkError, Workplace,
};

/// Arguments of a command that carries out a task in a cell.
#[derive(Debug, Args)]
pub struct InCell<C: Args> {
    /// Arguments of the task.
    #[command(flatten)]
    pub what: C,
    #[command(flatten)]
    pub choice: CellChoice,
}

/// A task in a cell, with its directory and the marks of its arms.
struct Work<'a> {
    /// The planned motion, if there is one.
    motion: Option<JointTrajectory>,
    speed_override: SpeedOverride,
    /// The record of the motion; `None` if the cell is simulated.
    first_run: Option<FirstRun>,
    chosen: &'a TaskCell,
    choice: &'a CellChoice,
    directory: &'a Path,
    marks: Vec<Unfinished>,
    /// Whether the record is printed at the end.
    prints: bool,
    common: &'a Common,
}

impl<C: Args + TaskCommand> InCell<C>
where
    Failure: From<C::Error>,
{
    /// Plans the task, shows the plan, and carries it out unless it is a dry run.
    pub fn run(&self, common: &Common) -> Result<(), Failure> {
        self.what.check()?;
        let out = self.what.way().out;
        let directory = match self.what.resumed_in() {
            Some(name) => results_directory(out, &name),
            None => empty_directory(C::NAME, out)?,
        };
        self.run_in(directory, true, common)
    }

    /// Runs the task with its results in `directory`. `prints` determines whether the record is
    /// printed.
    pub fn run_in(&self, directory: PathBuf, prints: bool, common: &Common) -> Result<(), Failure> {
        let way = self.what.way();
        let chosen = self.choice.read(C::CELL, way.dry_run)?;
        let speed_override = self.choice.live.speed(&chosen.cell)?;
        let planning = Planning::new(&chosen.cell, &chosen.file, chosen.is_virtual, directory);
        let arms = self.what.arms(&planning)?;
        if let (false, Some(is_checked)) = (way.dry_run, way.checked) {
            chosen.refuse_unready(&arms, is_checked, C::CAMERA)?;
        }
        let task = self.what.plan(&planning, &arms)?;
        let directory = planning.directory()?.to_owned();
        let motion = write_motion(&task, &chosen.cell, &directory)?;
        let marked = arms.iter().filter(|_| way.checked.is_some());
        let marks = marked.map(|arm| Unfinished::of(&chosen.cell, *arm, &directory));
        let work = Work {
            first_run: (!chosen.is_virtual)
                .then(|| FirstRun::of(&chosen.cell, C::NAME, motion.as_slice())),
            motion,
            speed_override,
            marks: if chosen.is_virtual {
                Vec::new()
            } else {
                marks.collect()
            },
            chosen: &chosen,
            choice: &self.choice,
            directory: &directory,
            prints,
            common,
        };
        let mut run = TaskRun::planned(task, std::env::args().collect());
        run.head.cell_file = std::path::absolute(&chosen.file).ok();
        if way.dry_run {
            run.task.write_plan(&chosen.cell, &directory)?;
            return work.finish(&run, None);
        }
        let settings = planning.into_settings();
        chosen.work(settings, |cell| work.carry_out(run, &arms, cell))
    }
}

/// Writes the motion, and a page that shows it. Returns the motion.
fn write_motion<T: Task>(
    task: &T,
    cell: &Cell,
    directory: &Path,
) -> Result<Option<JointTrajectory>, Failure> {
    let motion = task.motion(cell)?;
    if let Some(joints) = &motion {
        write_whole(&directory.join("joints.csv"), joints.to_csv()?.as_bytes())?;
    }
    let page = cell.page(motion.as_ref(), T::FRAMES, &[]);
    write_whole(&directory.join("cell.html"), page.as_bytes())?;
    Ok(motion)
}

/// Asks the user to do something on the terminal; whether the task continues.
fn is_confirmed(words: &str) -> bool {
    let answer = asked(&format!("{words}, then press Enter (n ends the task): "));
    answer.is_ok_and(|answer| !answer.is_empty() && !answer.trim().starts_with('n'))
}

impl Work<'_> {
    /// Carries out a task after the arms may move, and clears the marks of arms that finished
    /// their work.
    fn carry_out<T: Task>(
        &self,
        mut run: TaskRun<T>,
        arms: &[usize],
        cell: &Cell,
    ) -> Result<(), Failure> {
        run.note(self.directory)?;
        let chosen = self.choice.speed_scale;
        let first_run = self.first_run.as_ref();
        let speed_scale = first_run.map_or(chosen, |first_run| first_run.speed(chosen));
        let report = run.report(self.directory);
        self.chosen
            .confirm(arms, &report, self.directory, self.choice)?;
        let (live, plan) = (&self.choice.live, self.motion.as_slice());
        let page = live.page(cell, plan, &self.speed_override)?;
        // A simulated cell has neither diagnostics nor signals.
        let is_real = !self.chosen.is_virtual;
        let diagnostics = is_real
            .then(|| open_diagnostics(cell))
            .transpose()?
            .flatten();
        let interrupted = watch_for_interruption()?;
        let line = StatusLine::new(self.common);
        let mut displays: Vec<&dyn Display> = vec![&line];
        displays.extend(page.iter().map(|page| page as &dyn Display));
        displays.extend(diagnostics.iter().map(|topic| topic as &dyn Display));
        let signals = is_real.then(|| open_signals(cell)).transpose()?;
        let ended = run.carry_out(&Workplace {
            cell,
            directory: self.directory,
            is_recorded: true,
            marks: &self.marks,
            is_interrupted: &|| {
                interrupted.is_raised() || page.as_ref().is_some_and(LivePage::is_stopped)
            },
            ask: &|words| !is_real || self.choice.yes || is_confirmed(words),
            signals: signals.as_ref(),
            display: &Displays(displays),
            speed_scale,
            speed_override: Some(&self.speed_override),
        });
        drop(line);
        let listed = signals
            .as_ref()
            .and_then(|signals| write_signals(signals, self.directory).err());
        let unclear = match &ended {
            // The arms have done their work and hold nothing.
            Ok(())
            | Err(TaskError {
                error: WorkError::NotSeenWhole(_),
                ..
            }) => self.clear(),
            Err(_) => None,
        };
        let unrecorded = first_run.filter(|_| ended.is_ok());
        let unrecorded = unrecorded.and_then(|first_run| first_run.finished().err());
        let next = run.head.stopped.as_ref();
        let next = next.map(|stopped| stopped.next.as_str());
        let early = |error: TaskError| self.ended_early(&error.error, error.to_string(), next);
        let failure = unclear
            .or_else(|| ended.err().map(early))
            .or(listed)
            .or_else(|| unrecorded.map(Failure::system));
        let finished = self.finish(&run, failure);
        let words = match &finished {
            Ok(()) => format!("finished; the results are in {}", self.directory.display()),
            Err(failure) => failure.in_words(false),
        };
        if let Some(diagnostics) = diagnostics {
            diagnostics.end(finished.as_ref().map(|()| &*words).map_err(|_| &*words));
        }
        if let Some(page) = page {
            page.end(&words);
        }
        finished
    }

    /// Writes and prints the whole record, or returns the reason why the task ended early.
    fn finish<T: Task>(&self, run: &TaskRun<T>, failure: Option<Failure>) -> Result<(), Failure> {
        let report = run.conclude(self.directory)?;
        match (failure, run.task.record().answer()) {
            (Some(failure), _) => Err(failure),
            (None, _) if !self.prints => Ok(()),
            (None, Some(answer)) => self.choice.print(&report, &answer, self.directory),
            (None, None) => self.choice.print(&report, &run.manifest(), self.directory),
        }
    }

    /// Clears the marks of the arms; returns the error if that fails.
    fn clear(&self) -> Option<Failure> {
        let cleared = self.marks.iter().try_for_each(Unfinished::clear);
        let unclear =
            |error| Failure::System(format!("the end of the task cannot be recorded: {error}"));
        cleared.err().map(unclear)
    }

    /// Failure of a task that ended early, for a reason `in_words`, with the next step of the user.
    fn ended_early(&self, error: &WorkError, in_words: String, next: Option<&str>) -> Failure {
        let directory = self.directory.display();
        let mut message = format!("{in_words}; the log is in {directory}");
        if let Some(next) = next {
            message += &format!("\nnext: {next}");
        }
        match error {
            WorkError::Interrupted => Failure::interrupted(message),
            WorkError::NotSeenWhole(_) => Failure::Other {
                exit_code: NOT_SEEN_WHOLE,
                message: format!(
                    "{in_words}; it is not scored; see overlay.png and rod.csv in {directory}"
                ),
            },
            WorkError::Failed(_) | WorkError::Results(_) => Failure::System(message),
        }
    }
}
