//! Runs any task step by step, and records its progress.

use super::error::{TaskError, WorkError};
use super::record::{Report, Status, TaskHead, TaskRecord, write_manifest};
use super::stage::Stage;
use super::step::Task;
use super::stopped::{HandPlace, LaidLength, Stopped};
use super::workplace::Workplace;
use crate::cell::Cell;
use rodlab_files::results::ResultsError;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// A task with its progress.
pub struct TaskRun<T> {
    /// Record of any task.
    pub head: TaskHead,
    /// The task.
    pub task: T,
}

/// Contents of `manifest.json`.
#[derive(Serialize)]
struct Manifest<'a, R> {
    #[serde(flatten)]
    head: &'a TaskHead,
    #[serde(flatten)]
    record: &'a R,
}

impl<T: Task> TaskRun<T> {
    /// Creates the run of a task that was planned now, with its command line.
    pub fn planned(task: T, command_line: Vec<String>) -> Self {
        Self {
            head: TaskHead::planned(command_line),
            task,
        }
    }

    /// Contents of `manifest.json`.
    pub fn manifest(&self) -> impl Serialize + '_ {
        Manifest {
            head: &self.head,
            record: self.task.record(),
        }
    }

    /// Contents of `report.md`, with the pictures in a directory.
    pub fn report(&self, directory: &Path) -> Report {
        self.task.record().report(&self.head, directory)
    }

    /// Writes `manifest.json` and `report.md` with the current state.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn note(&self, directory: &Path) -> Result<(), ResultsError> {
        write_manifest(&self.manifest(), directory)?;
        self.report(directory).write_text(directory)
    }

    /// Writes `manifest.json`, the figures, and the report with its page.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn conclude(&self, directory: &Path) -> Result<Report, ResultsError> {
        write_manifest(&self.manifest(), directory)?;
        self.task.write_figures(directory)?;
        let report = self.report(directory);
        report.write(directory)?;
        Ok(report)
    }

    /// Carries out the steps of the task. The directory always contains the current progress.
    ///
    /// # Errors
    /// A step failed; the arms hold.
    pub fn carry_out(&mut self, at: &Workplace<'_>) -> Result<(), TaskError> {
        self.head.status = Status::Running;
        self.head.stopped = None;
        let ended = self.work(at);
        self.head.ended(ended.as_ref().err());
        self.head.stopped = ended.as_ref().err().and_then(|error| {
            let stage = error.stopped_in()?;
            Some(self.left_in(stage, at.cell))
        });
        ended
    }

    fn work(&mut self, at: &Workplace<'_>) -> Result<(), TaskError> {
        let steps = self.task.steps();
        for (number, step) in (1..).zip(&steps) {
            let stage = &step.stage;
            let failed = |error| TaskError {
                stage: Box::new(stage.clone()),
                error,
            };
            if at.is_recorded {
                let noted = self.note(at.directory).map_err(WorkError::from);
                noted.map_err(failed)?;
            }
            at.check().map_err(failed)?;
            at.display.step(number, steps.len(), stage);
            let begin = Instant::now();
            step.act(&mut self.task, at).map_err(failed)?;
            tracing::info!("done, {number} of {}: {}", steps.len(), stage.words);
            let time = begin.elapsed().as_secs_f64();
            self.head.times_s.push((stage.clone(), time));
        }
        Ok(())
    }

    /// State in which the cell is left if a stage ends early.
    fn left_in(&self, stage: &Stage, cell: &Cell) -> Stopped {
        let arms = self.task.arms().into_iter();
        let hands: Vec<HandPlace> = arms.map(|arm| HandPlace::of(cell, arm)).collect();
        let done = self.head.times_s.iter();
        let done = done.filter(|(stage, _)| stage.name == Stage::LAY).count();
        let paths = self.task.paths().into_iter().enumerate();
        let laid = paths.map(|(number, along)| -> LaidLength {
            match stage.name == Stage::LAY && number == done {
                true => along.until(&hands[number % hands.len()]),
                false => along.whole(number < done),
            }
        });
        Stopped {
            during: stage.words.clone().into(),
            laid: laid.collect(),
            next: self.task.next_step(stage),
            hands,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::PlanError;
    use crate::task::step::Step;
    use crate::test_cells::gantry;
    use rodlab_robot::JointTrajectory;
    use std::cell::Cell as Shared;

    const ONE: Stage = Stage::new("one", "doing one thing", "do it by hand");
    const OTHER: Stage = Stage::new("other", "doing another thing", "do it by hand, too");

    /// Counts.
    #[derive(Serialize)]
    struct Counts {
        count: usize,
    }

    impl TaskRecord for Counts {
        fn report(&self, head: &TaskHead, _: &Path) -> Report {
            let mut report = Report::new("Counted");
            report.head(head);
            report.times(head);
            report
        }
    }

    /// A task with three counted steps; the last one fails.
    struct Counting(Counts);

    impl Task for Counting {
        type Record = Counts;

        fn record(&self) -> &Counts {
            &self.0
        }

        fn arms(&self) -> Vec<usize> {
            Vec::new()
        }

        fn motion(&self, _: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
            Ok(None)
        }

        fn steps(&self) -> Vec<Step<Self>> {
            let count = |task: &mut Self, _: &Workplace<'_>| {
                task.0.count += 1;
                Ok(())
            };
            vec![
                Step::new(&ONE, count),
                Step::new(&OTHER, count),
                Step::new(&ONE, |_, _| Err(WorkError::failed("it is stuck"))),
            ]
        }
    }

    #[test]
    fn progress_is_recorded_if_a_step_fails_or_does_not_start() {
        let (cell, folder) = (gantry(), tempfile::tempdir().unwrap());
        let asked = Shared::new(0);
        let run = |most: usize| {
            asked.set(0);
            let is_interrupted = || {
                asked.set(asked.get() + 1);
                asked.get() > most
            };
            let mut run = TaskRun::planned(Counting(Counts { count: 0 }), Vec::new());
            let ended = run.carry_out(&Workplace {
                is_recorded: true,
                is_interrupted: &is_interrupted,
                ..Workplace::alone(&cell, folder.path())
            });
            run.conclude(folder.path()).unwrap();
            let text = std::fs::read(folder.path().join("manifest.json")).unwrap();
            let manifest: serde_json::Value = serde_json::from_slice(&text).unwrap();
            let report = std::fs::read_to_string(folder.path().join("report.md")).unwrap();
            (ended.unwrap_err(), manifest, report)
        };
        let (error, manifest, report) = run(9);
        assert_eq!(error.to_string(), "doing one thing: it is stuck");
        assert_eq!(manifest["status"], "failed");
        assert_eq!(
            (&manifest["count"], &manifest["times_s"][1][0]),
            (&2.into(), &"other".into())
        );
        assert_eq!(manifest["stopped"]["next"], "do it by hand");
        assert!(
            report.contains("| doing another thing | 0.0 s by "),
            "{report}"
        );
        let (error, manifest, report) = run(1);
        assert_eq!(
            error.to_string(),
            "doing another thing: interrupted; the arm holds"
        );
        assert_eq!(
            (&manifest["status"], &manifest["count"]),
            (&"interrupted".into(), &1.into())
        );
        assert!(report.contains("do it by hand, too"), "{report}");
        assert!(folder.path().join("report.html").is_file());
    }
}
