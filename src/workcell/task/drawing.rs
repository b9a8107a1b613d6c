//! Rods laid along the strokes of a drawing, one after another: each is taken, laid and released,
//! and at the end one picture shows all of them.

use super::deploy::{DeployTask, LOOK, RETREAT, SCORE, TAKE};
use super::deploy_record::{DeployRecord, stroke_folder};
use super::error::WorkError;
use super::record::{Report, TaskHead, TaskRecord};
use super::step::{Step, Task};
use super::stopped::LaidAlong;
use super::working_arm::WorkingArm;
use super::workplace::Workplace;
use crate::cell::{Cell, PlanError};
use rodlab_files::results::ResultsError;
use rodlab_robot::JointTrajectory;
use serde::{Serialize, Serializer};
use std::path::Path;

/// Pause between two motions on the page of a plan, s.
const PAUSE: f64 = 1.0;

/// The record of a drawing: that of its only stroke, or of each stroke.
#[derive(Clone, Debug)]
pub struct DrawingRecord {
    /// The pattern, as given.
    pattern: String,
    strokes: Vec<DeployRecord>,
}

/// Contents of `manifest.json` if there are several strokes.
#[derive(Serialize)]
struct Several<'a> {
    pattern: &'a str,
    strokes: &'a [DeployRecord],
}

impl Serialize for DrawingRecord {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.strokes.as_slice() {
            [only] => only.serialize(serializer),
            strokes => Several {
                pattern: &self.pattern,
                strokes,
            }
            .serialize(serializer),
        }
    }
}

impl TaskRecord for DrawingRecord {
    fn report(&self, head: &TaskHead, directory: &Path) -> Report {
        if let [only] = self.strokes.as_slice() {
            return only.report(head, directory);
        }
        let count = self.strokes.len();
        let mut report = Report::new(&format!(
            "{count} rods laid along the strokes of {}",
            self.pattern
        ));
        report.head(head);
        for (index, stroke) in self.strokes.iter().enumerate() {
            stroke.rows_of_stroke(index + 1, &mut report);
        }
        report.times(head);
        let folders = (0..count).map(stroke_folder);
        let scores = folders.map(|folder| (format!("{folder}/score.svg"), folder));
        report.pictures(directory, scores);
        report.pictures(directory, [("picture.png", "Picture of the camera")]);
        report.page("The arm in motion");
        report
    }
}

/// A task that lays rods along the strokes of a drawing.
pub struct DrawingTask {
    strokes: Vec<DeployTask>,
    record: DrawingRecord,
    arm: usize,
    approach_speed: f64,
}

impl DrawingTask {
    /// The task of laying a rod along each stroke of `pattern`, in this order; there is at least
    /// one.
    pub fn new(pattern: &str, mut strokes: Vec<DeployTask>) -> Self {
        if strokes.len() > 1 {
            strokes.iter_mut().for_each(DeployTask::lies_among_others);
        }
        let records = strokes.iter().map(|stroke| stroke.record().clone());
        let (arm, approach_speed) = strokes[0].mover();
        Self {
            record: DrawingRecord {
                pattern: pattern.to_owned(),
                strokes: records.collect(),
            },
            strokes,
            arm,
            approach_speed,
        }
    }

    /// Asks the user for the next rod.
    fn ask_for_rod(&self, stroke: usize, at: &Workplace<'_>) -> Result<(), WorkError> {
        let length = 1e2 * self.record.strokes[stroke].rod.length;
        let count = self.strokes.len();
        let words = format!(
            "put the end of rod {} of {count}, cut to {length:.1} cm, between the fingers",
            stroke + 1
        );
        match (at.ask)(&words) {
            true => at.check(),
            false => Err(WorkError::Interrupted),
        }
    }

    /// Scores all strokes. Those that are seen whole are scored even if others are not.
    fn score(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let mut first = Ok(());
        for (index, stroke) in self.strokes.iter_mut().enumerate() {
            let directory = at.directory.join(stroke_folder(index));
            let own = Workplace {
                directory: &directory,
                ..*at
            };
            let scored = stroke.score(&own);
            self.record.strokes[index].clone_from(stroke.record());
            let scored = scored.map_err(|error| match error {
                WorkError::NotSeenWhole(reason) => {
                    WorkError::NotSeenWhole(format!("stroke {}: {reason}", index + 1))
                }
                other => other,
            });
            first = first.and(scored);
        }
        first
    }

    /// Step of a stroke, in its folder if there are several.
    fn step(&self, stroke: usize, step: Step<DeployTask>) -> Step<Self> {
        let count = self.strokes.len();
        let mut stage = step.stage.clone();
        if count > 1 {
            let words = format!("stroke {} of {count}, {}", stroke + 1, stage.words);
            stage.words = words.into();
        }
        Step::new(&stage, move |task: &mut Self, at| {
            let directory = at.directory.join(stroke_folder(stroke));
            if stroke > 0 && step.stage == TAKE {
                task.ask_for_rod(stroke, at)?;
            }
            let own = Workplace {
                directory: if count > 1 { &directory } else { at.directory },
                ..*at
            };
            std::fs::create_dir_all(own.directory).map_err(WorkError::failed)?;
            let done = step.act(&mut task.strokes[stroke], &own);
            task.record.strokes[stroke].clone_from(task.strokes[stroke].record());
            done
        })
    }
}

impl Task for DrawingTask {
    type Record = DrawingRecord;

    fn record(&self) -> &DrawingRecord {
        &self.record
    }

    fn arms(&self) -> Vec<usize> {
        vec![self.arm]
    }

    /// The motions of all strokes, and the ways between them.
    fn motion(&self, cell: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
        let mut all: Option<JointTrajectory> = None;
        for stroke in &self.strokes {
            let Some(laying) = stroke.motion(cell)? else {
                continue;
            };
            let Some(motion) = &mut all else {
                all = Some(laying);
                continue;
            };
            let from = &motion.points[motion.points.len() - 1];
            let way = cell.approach(self.arm, from, &laying.points[0], self.approach_speed)?;
            for next in way.iter().chain([&laying]) {
                let begin = motion.times[motion.times.len() - 1] + PAUSE - next.times[0];
                motion
                    .times
                    .extend(next.times.iter().map(|time| begin + time));
                motion.points.extend_from_slice(&next.points);
            }
        }
        Ok(all)
    }

    fn paths(&self) -> Vec<LaidAlong<'_>> {
        self.strokes.iter().flat_map(DeployTask::paths).collect()
    }

    fn steps(&self) -> Vec<Step<Self>> {
        let of_stroke = |(index, stroke): (usize, &DeployTask)| -> Vec<Step<Self>> {
            let steps = stroke.steps().into_iter();
            steps.map(|step| self.step(index, step)).collect()
        };
        if let [_] = self.strokes.as_slice() {
            return of_stroke((0, &self.strokes[0]));
        }
        let mut steps = Vec::new();
        for (index, stroke) in self.strokes.iter().enumerate() {
            let own = stroke.steps().into_iter();
            let own = own.filter(|step| ![RETREAT, LOOK, SCORE].contains(&step.stage));
            steps.extend(own.map(|step| self.step(index, step)));
        }
        let (arm, speed) = (self.arm, self.approach_speed);
        steps.push(Step::new(&RETREAT, move |_, at: &Workplace<'_>| {
            WorkingArm { at, arm }.go_home("retreat", speed)
        }));
        steps.push(Step::new(&LOOK, |task: &mut Self, at| {
            let picture = at.picture("picture.png")?;
            let strokes = task.strokes.iter_mut();
            strokes.for_each(|stroke| stroke.saw(picture.clone()));
            Ok(())
        }));
        steps.push(Step::new(&SCORE, Self::score));
        steps
    }

    fn write_figures(&self, directory: &Path) -> Result<(), ResultsError> {
        let mut strokes = self.strokes.iter();
        strokes.try_for_each(|stroke| stroke.write_figures(directory))
    }
}
