//! A rod laid along a pattern by an arm.

use super::correction::Correction;
use super::deploy_plan::DeployPlan;
use super::deploy_record::{DeployRecord, DeployScore, PATTERN};
use super::error::WorkError;
use super::stage::Stage;
use super::step::{Step, Task};
use super::stopped::LaidAlong;
use super::working_arm::{Grip, WorkingArm};
use super::workplace::Workplace;
use crate::cell::{Cell, PlanError};
use image::RgbImage;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, Paper, plot_to_scale};
use rodlab_lab::experiment::Fixtures;
use rodlab_robot::JointTrajectory;
use rodlab_vision::{Point, SCORE_POINTS, Score, part_of_curve, pattern_csv, score, score_figure};

const APPROACH: Stage = Stage::new(
    "approach",
    "going to the first point",
    "no rod is laid yet: inspect the arm and its surroundings, then run the command again with --checked",
);
pub(super) const TAKE: Stage = Stage::new(
    "take",
    "taking the rod",
    "no rod is laid yet: check whether the gripper holds the rod, open it, then run the command again with --checked",
);
const LAY: Stage = Stage::new(
    Stage::LAY,
    "laying it",
    "the gripper may hold the rod: inspect the arm, take the rod out and off the table, then run the command again with --checked; \
     laying starts from the beginning",
);
const LET_GO: Stage = Stage::new(
    "let-go",
    "letting it go",
    "the rod is laid up to the gripper, which may still hold it: inspect the arm and open the gripper; pass --checked to the next task",
);
pub(super) const RETREAT: Stage = Stage::new(
    "retreat",
    "going out of the picture",
    "the rod is laid and released: inspect the arm and move it out of the picture; `rodlab trace` with the camera and `rodlab score` \
     show the rod; pass --checked to the next task",
);
pub(super) const LOOK: Stage = Stage::new("look", "looking", LIES);
pub(super) const SCORE: Stage = Stage::new("score", "scoring", LIES);
/// Advice after a task in which only the last picture, or its score, failed.
const LIES: &str = "the rod is laid, and the arm is out of the way: inspect the camera and its picture; `rodlab trace` with the \
                    camera and `rodlab score` show the rod; pass --checked to the next task";

/// A task that lays a rod, takes a picture of it and scores it.
pub struct DeployTask {
    plan: DeployPlan,
    /// Correction of the path during laying, if any.
    correction: Option<Correction>,
    record: DeployRecord,
    /// The picture of the laid rod.
    picture: Option<RgbImage>,
    /// Distance of the rod from the pattern, after the measurement.
    score: Option<Score>,
}

impl DeployTask {
    /// Creates the task from its plan in a cell.
    pub fn new(cell: &Cell, plan: DeployPlan, correction: Option<Correction>) -> Self {
        Self {
            record: DeployRecord {
                cell: cell.title.clone(),
                arm: cell.arms[plan.arm].name.clone(),
                pattern: plan.name.clone(),
                rod: plan.rod,
                cut_length_m: None,
                largest_friction_demand: plan.largest_friction_demand(),
                motion: plan.motion.report.clone(),
                seen_length: None,
                score: None,
                pegs: None,
            },
            plan,
            correction,
            picture: None,
            score: None,
        }
    }

    /// The rod is cut to its length, and lies among others: it is the one that begins nearest to the
    /// start of its path.
    pub(super) fn lies_among_others(&mut self) {
        self.record.cut_length_m = Some(self.plan.rod.length);
    }

    /// The arm, and the greatest speed of its hand on the way to the rod, m/s.
    pub(super) fn mover(&self) -> (usize, f64) {
        (self.plan.arm, self.plan.approach_speed)
    }

    /// Uses a picture of the laid rod.
    pub(super) fn saw(&mut self, picture: RgbImage) {
        self.picture = Some(picture);
    }

    /// Distance of the rod from its pattern, after the measurement.
    pub fn laid(&self) -> Option<&Score> {
        self.score.as_ref()
    }

    fn lay(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let plan = &self.plan;
        match &self.correction {
            None => {
                let arm = WorkingArm { at, arm: plan.arm };
                arm.lay("laying", &plan.motion.laying, &plan.along())
            }
            Some(correction) => correction.lay(plan, at),
        }
    }

    pub(super) fn score(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let (plan, record) = (&self.plan, &mut self.record);
        let picture = self.picture.take().expect("a picture was taken");
        at.write(PATTERN, pattern_csv(&plan.pattern).as_bytes())?;
        let found = plan.seen(&picture, at.cell)?;
        found.write(&picture, at)?;
        let rod = match record.cut_length_m {
            Some(_) => found.from(plan.start())?,
            None => found.longest(plan.start())?,
        };
        at.write("rod.csv", pattern_csv(&rod).as_bytes())?;
        let length = record.seen_length.insert(plan.seen_length(&found, &rod)?);
        if !length.is_whole() {
            return Err(WorkError::NotSeenWhole(length.to_string()));
        }
        let part = part_of_curve(&rod, plan.path.lead_in, &plan.pattern)?;
        let score = score(&part, &plan.pattern, SCORE_POINTS, false)?;
        let figure = score_figure(&score, "the rod", "the pattern");
        at.write("score.svg", figure.svg(&Paper::default()).as_bytes())?;
        record.score = Some(DeployScore {
            by_arc_length: score.by_arc_length,
            by_nearest_point: score.by_nearest_point,
        });
        if let Some(fixtures) = &plan.fixtures {
            record.pegs = Some(fixtures.passed(&part));
            let figure = peg_figure(&rod, fixtures);
            at.write("pegs.svg", figure.svg(&Paper::default()).as_bytes())?;
        }
        self.score = Some(score);
        Ok(())
    }
}

impl Task for DeployTask {
    type Record = DeployRecord;

    fn record(&self) -> &DeployRecord {
        &self.record
    }

    fn arms(&self) -> Vec<usize> {
        vec![self.plan.arm]
    }

    fn motion(&self, _: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
        Ok(Some(self.plan.motion.laying.clone()))
    }

    fn paths(&self) -> Vec<LaidAlong<'_>> {
        vec![self.plan.along()]
    }

    fn steps(&self) -> Vec<Step<Self>> {
        let (arm, speed) = (self.plan.arm, self.plan.approach_speed);
        vec![
            Step::new(&APPROACH, move |task: &mut Self, at| {
                let first = &task.plan.motion.laying.points[0];
                WorkingArm { at, arm }.go("approach", first, speed)
            }),
            Step::new(&TAKE, move |_, at| WorkingArm { at, arm }.grip(Grip::Close)),
            Step::new(&LAY, Self::lay),
            Step::new(&LET_GO, move |_, at| WorkingArm { at, arm }.let_go()),
            Step::new(&RETREAT, move |_, at| {
                WorkingArm { at, arm }.go_home("retreat", speed)
            }),
            Step::new(&LOOK, |task: &mut Self, at| {
                task.saw(at.picture("picture.png")?);
                Ok(())
            }),
            Step::new(&SCORE, Self::score),
        ]
    }
}

/// Draws the rod between its pegs, from above.
fn peg_figure(rod: &[Point], fixtures: &Fixtures) -> Figure {
    let outline = |points: &[Point]| {
        let points = points.iter();
        points.map(|point| (point.x, Some(point.y))).collect()
    };
    let plot = LinePlot::new(
        "y in m",
        [
            Curve::new("the rod", outline(rod)),
            Curve::new("the pattern", outline(&fixtures.outline())).looking(Look::Dashed),
            Curve::new("pegs", fixtures.circles()).looking(Look::Bare),
        ],
    );
    plot_to_scale(plot, "x in m")
}
