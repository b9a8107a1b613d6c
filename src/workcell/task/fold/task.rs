//! Folds a sheet with an arm, measures it after each part, and scores it.

use super::motion::{FoldMotion, FoldMotionRequest, heading};
use super::record::FoldRecord;
use super::score::{FoldScore, Look, looks_csv};
use super::sight::{SeenEnd, Sight};
use super::way::{FoldRequest, FoldWay};
use crate::cell::{Cell, PlanError};
use crate::task::error::WorkError;
use crate::task::stage::Stage;
use crate::task::step::{Step, Task};
use crate::task::working_arm::{Grip, WorkingArm};
use crate::task::workplace::Workplace;
use image::RgbImage;
use nalgebra::Vector3;
use rodlab_lab::experiment::{Crease, Paper};
use rodlab_robot::{JointTrajectory, Pose};
use rodlab_vision::{ColourRule, edges_overlay, encode_picture, sheet_overlay};
use std::time::Duration;

/// Time for which the sheet rests before a picture is taken.
const REST: Duration = Duration::from_millis(300);
/// Resolution of the slide in a picture, m: a smaller slide is ignored.
const LEAST_SLIDING: f64 = 3e-4;
/// Largest rotation of the free end about the vertical, rad; the ends of a side of 21 cm have then
/// slid by 5 mm.
const MOST_ASKEW: f64 = 0.05;
/// Travel of the edge along the fold, m, after which no paper may lie at its first place.
const CLEARLY_AWAY: f64 = 0.04;
/// Margin for the check that no paper is left, m: a loop bulges by less in the picture.
const BULGE: f64 = 0.015;

const LOOK: Stage = Stage::new("look", "locating the sheet", UNTOUCHED);
const APPROACH: Stage = Stage::new("approach", "going to its edge", UNTOUCHED);
const TAKE: Stage = Stage::new("take", "taking the edge", HELD);
const FOLD: Stage = Stage::new("fold", "folding", HELD);
const SCORE: Stage = Stage::new("score", "scoring", HELD);
const LET_GO: Stage = Stage::new("let-go", "releasing the edge", HELD);
const RETREAT: Stage = Stage::new("retreat", "going out of the picture", LET_LIE);
const LOOK_AGAIN: Stage = Stage::new("look-again", "looking again", LET_LIE);
/// Advice after the stages before the sheet is gripped; further ones for a sheet that is held, and
/// after its release.
const UNTOUCHED: &str = "the sheet was not touched: inspect the arm and the camera, then run the command again with --checked";
const HELD: &str = "the gripper may hold the sheet: inspect the arm, open the gripper and lay the sheet flat, then run the command \
                    again with --checked";
const LET_LIE: &str = "the sheet is folded and released: inspect the arm; `rodlab measure sheet` measures the sheet; pass --checked to the \
                       next task";

/// Plan of a fold.
pub struct FoldPlan {
    /// Index of the arm.
    pub arm: usize,
    /// Title of the sheet.
    pub title: String,
    /// The sheet.
    pub paper: Paper,
    /// Target of its edge.
    pub crease: Crease,
    /// Name of the algorithm that plans its path.
    pub algorithm: String,
    /// Algorithm that plans its path.
    pub request: FoldRequest,
    /// Whether its parts are replanned if the sheet has slid.
    pub is_closed_loop: bool,
    /// Expected frame of the sheet. The measured frame uses the direction of a side that is
    /// nearest to that of this frame.
    pub frame: Pose,
    /// Colour of the paper.
    pub colour: ColourRule,
    /// Greatest speed of the hand while it folds, m/s.
    pub speed: f64,
    /// Greatest speed of the hand on the way to the sheet, m/s.
    pub approach_speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
}

/// A task that folds a sheet, measures it after each part, and scores the fold.
pub struct FoldTask {
    plan: FoldPlan,
    /// The motions for the expected place of the sheet.
    expected: Option<FoldMotion>,
    record: FoldRecord,
    /// State of the sheet, after it was found.
    folding: Option<Folding>,
}

/// State of a sheet on the table.
struct Folding {
    sight: Sight,
    frame: Pose,
    /// Measured offset of its free end before anything moved, from the length in the file, m.
    zero: f64,
    way: FoldWay,
    motion: FoldMotion,
    /// Joint positions at the end of the last motion.
    last: Vec<f64>,
}

impl FoldPlan {
    /// Plans motions for a sheet at a given place in a cell.
    fn motions<'a>(&self, cell: &'a Cell, frame: Pose) -> FoldMotionRequest<'a> {
        FoldMotionRequest {
            cell,
            arm: self.arm,
            frame,
            speed: self.speed,
            margin: self.margin,
        }
    }

    /// The motions for the expected place of the sheet.
    ///
    /// # Errors
    /// The arm cannot follow the path.
    pub fn expected(&self, cell: &Cell, way: &FoldWay) -> Result<FoldMotion, PlanError> {
        self.motions(cell, self.frame).plan(way)
    }
}

impl FoldTask {
    /// Creates the task from a plan in a cell, with the expected motions if they are to be shown.
    pub fn new(cell: &Cell, plan: FoldPlan, expected: Option<FoldMotion>) -> Self {
        let motion = expected.as_ref().map(|motion| motion.report.clone());
        Self {
            record: FoldRecord {
                cell: cell.title.clone(),
                arm: cell.arms[plan.arm].name.clone(),
                paper: plan.title.clone(),
                target_m: plan.request.target,
                algorithm: plan.algorithm.clone(),
                parts: plan.request.parts,
                closed_loop: plan.is_closed_loop,
                motion: motion.unwrap_or_default(),
                sheet_place: None,
                looks: Vec::new(),
                score: None,
            },
            expected,
            plan,
            folding: None,
        }
    }
}

impl Task for FoldTask {
    type Record = FoldRecord;

    fn record(&self) -> &FoldRecord {
        &self.record
    }

    fn arms(&self) -> Vec<usize> {
        vec![self.plan.arm]
    }

    fn motion(&self, _: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
        Ok(self.expected.as_ref().map(FoldMotion::whole))
    }

    fn steps(&self) -> Vec<Step<Self>> {
        let (arm, speed) = (self.plan.arm, self.plan.approach_speed);
        vec![
            Step::new(&LOOK, Self::find),
            Step::new(&APPROACH, move |task: &mut Self, at| {
                let first = &task.folding().motion.reaching.points[0];
                WorkingArm { at, arm }.go("approach", first, speed)
            }),
            Step::new(&TAKE, move |task: &mut Self, at| {
                let arm = WorkingArm { at, arm };
                arm.follow("reaching", &task.folding().motion.reaching)?;
                arm.grip(Grip::Close)
            }),
            Step::new(&FOLD, Self::fold),
            Step::new(&SCORE, |task: &mut Self, _| task.score()),
            Step::new(&LET_GO, move |_, at| WorkingArm { at, arm }.let_go()),
            Step::new(&RETREAT, move |task: &mut Self, at| {
                let Folding { frame, last, .. } = task.folding();
                let rising = task.plan.motions(at.cell, *frame).rising(last)?;
                let arm = WorkingArm { at, arm };
                arm.follow("rising", &rising)?;
                arm.go_home("retreat", speed)
            }),
            Step::new(&LOOK_AGAIN, |_, at| at.picture("left.png").map(drop)),
        ]
    }
}

impl FoldTask {
    fn folding(&self) -> &Folding {
        self.folding.as_ref().expect("the sheet was seen")
    }

    /// Locates the sheet, and plans its path from its measured place.
    fn find(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let plan = &self.plan;
        let sight = Sight::new(at.cell, plan.paper, plan.crease, &plan.colour)?;
        let picture = at.picture("look_0.png")?;
        let (frame, sheet) = sight.find(&picture, heading(&plan.frame))?;
        let overlay = sheet_overlay(&picture, &sheet);
        at.write("overlay_0.png", &encode_picture(&overlay))?;
        let zero = sight.end(&picture, &frame, 0.0)?.slid;
        let place = frame.translation.vector;
        self.record.sheet_place = Some([place.x, place.y, heading(&frame).to_degrees()]);
        let way = FoldWay::new(plan.request)?;
        let motion = plan.motions(at.cell, frame).plan(&way)?;
        self.folding = Some(Folding {
            sight,
            frame,
            zero,
            way,
            last: end(&motion.reaching).to_vec(),
            motion,
        });
        Ok(())
    }

    /// Moves the edge part by part, and takes a picture after each part.
    fn fold(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let arm = WorkingArm {
            at,
            arm: self.plan.arm,
        };
        for part in 0..self.folding().way.parts() {
            let motion = match part {
                0 => self.folding().motion.parts[0].clone(),
                _ => self.next_part(part, at.cell)?,
            };
            arm.carry(&format!("folding_{}", part + 1), &motion)?;
            arm.rest(REST)?;
            self.look(part, &arm.hand()?, at)?;
            let folding = self.folding.as_mut().expect("the sheet was seen");
            folding.last = end(&motion).to_vec();
            at.check()?;
        }
        Ok(())
    }

    fn score(&mut self) -> Result<(), WorkError> {
        let score = FoldScore::of(&self.record.looks, self.plan.request.target);
        let unseen = "the free end of the sheet was never seen";
        let score = score.ok_or_else(|| WorkError::failed(unseen))?;
        if score.is_end_hidden {
            tracing::warn!(
                "the edge covers the free end of the sheet, so the length of the fold cannot be measured"
            );
        }
        self.record.score = Some(score);
        Ok(())
    }

    /// The motion of a part; it is replanned if the sheet has slid.
    fn next_part(&mut self, part: usize, cell: &Cell) -> Result<JointTrajectory, WorkError> {
        let Self {
            plan,
            record,
            folding,
            ..
        } = self;
        let Folding {
            way, frame, last, ..
        } = folding.as_mut().expect("the sheet was seen");
        let look = record.looks.last_mut().expect("a look after each part");
        if look.slid_m.is_none() {
            tracing::warn!(
                "after part {part} the edge covers the free end of the sheet, so its further slide cannot be measured"
            );
        }
        let slid = look.slid_m.unwrap_or(way.slid(part - 1));
        let farther = slid - way.slid(part - 1);
        if !plan.is_closed_loop || farther.abs() < LEAST_SLIDING {
            way.keep(part);
        } else {
            let planned = way.replan(part, slid);
            planned.map_err(|error| {
                WorkError::Failed(format!(
                    "the sheet has slid by {:.1} mm, and part {} of the path cannot be replanned: {error}",
                    1e3 * slid,
                    part + 1
                ))
            })?;
            look.is_replanned = true;
        }
        Ok(plan.motions(cell, *frame).onwards(last, &way.hands(part))?)
    }

    /// Measures the slide of the sheet after a part, and whether its edge is still held.
    fn look(&mut self, part: usize, hand: &Pose, at: &Workplace<'_>) -> Result<(), WorkError> {
        let folding = self.folding.as_ref().expect("the sheet was seen");
        let looks = &mut self.record.looks;
        let number = part + 1;
        let picture = at.picture(&format!("look_{number}.png"))?;
        let edge = (folding.frame.inverse() * hand).translation.vector;
        let before = looks.iter().rev().find_map(|look| look.slid_m);
        let before = before.unwrap_or(0.0);
        if edge.x > CLEARLY_AWAY {
            // The fold line of a held sheet is at most half way between the edge and the place of
            // the edge on the flat sheet.
            let place = 0.5 * (edge.x + before) - BULGE;
            let sight = &folding.sight;
            if sight.is_paper_at(&picture, &folding.frame, place)? {
                let slipped = "the sheet has slipped out of the gripper, or slid far: paper is \
                    where a held sheet does not reach";
                return Err(WorkError::failed(slipped));
            }
        }
        let seen = folding.see_end(&picture, edge, before)?;
        looks.push(Look {
            part: number,
            edge_m: [edge.x, edge.z],
            slid_m: seen.as_ref().map(|seen| seen.slid - folding.zero),
            is_replanned: false,
        });
        at.write("looks.csv", looks_csv(looks).as_bytes())?;
        if let Some(seen) = seen {
            let overlay = edges_overlay(&picture, &seen.edges);
            let name = format!("overlay_{number}.png");
            at.write(&name, &encode_picture(&overlay))?;
        }
        Ok(())
    }
}

/// Joint positions at the end of a motion.
fn end(motion: &JointTrajectory) -> &[f64] {
    &motion.points[motion.points.len() - 1]
}

impl Folding {
    /// Measures the free end, whose last measured slide was `before`, m; `None` if the edge hides
    /// it.
    fn see_end(
        &self,
        picture: &RgbImage,
        edge: Vector3<f64>,
        before: f64,
    ) -> Result<Option<SeenEnd>, WorkError> {
        let Self {
            sight, frame, zero, ..
        } = self;
        if sight.is_end_hidden(frame, edge, before) {
            return Ok(None);
        }
        let seen = sight.end(picture, frame, zero + before);
        let seen = seen.map_err(|error| {
            WorkError::Failed(format!(
                "the free end of the sheet is not seen within 10 cm of where it was: {error}"
            ))
        })?;
        if sight.is_end_hidden(frame, edge, seen.slid - zero) {
            let hidden = "the free end of the sheet has slid under the edge";
            return Err(WorkError::failed(hidden));
        }
        if seen.turned.abs() > MOST_ASKEW {
            return Err(WorkError::Failed(format!(
                "the sheet lies askew: its free end has turned by {:.1}°",
                seen.turned.to_degrees()
            )));
        }
        Ok(Some(seen))
    }
}
