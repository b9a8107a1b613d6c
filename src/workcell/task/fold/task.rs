//! A sheet folded by an arm, looked at on the way and scored.

use super::motion::FoldMotionRequest;
use super::score::{FoldScore, Look, looks_csv};
use super::sight::{SeenEnd, Sight};
use super::stage::{FoldStage, FoldTaskError};
use super::way::{FoldRequest, FoldWay};
use crate::cell::Cell;
use crate::task::look::next_picture;
use crate::task::stage_clock::StageClock;
use crate::task::stopped::{HandPlace, Stopped};
use crate::task::unfinished::Unfinished;
use crate::task::working_arm::{Grip, WorkingArm};
use image::RgbImage;
use nalgebra::Vector3;
use rodlab_files::results::{ResultsError, write_whole};
use rodlab_lab::experiment::{Crease, Paper};
use rodlab_robot::{JointTrajectory, Pose};
use rodlab_vision::{ColourRule, edges_overlay, encode_picture, sheet_overlay};
use std::path::Path;
use std::time::Duration;

/// How long a sheet is left to itself before it is looked at.
const REST: Duration = Duration::from_millis(300);
/// What a camera cannot tell from no sliding, m: less is no reason to plan anew.
const LEAST_SLIDING: f64 = 3e-4;
/// How far the free end may turn about the vertical, rad: at its ends a sheet of 21 cm has then slid by 5 mm.
const MOST_ASKEW: f64 = 0.05;
/// The edge must have come so far along the fold, m, before it shows that nothing lies where it lay.
const CLEARLY_AWAY: f64 = 0.04;
/// How far from where no paper can be it is looked for, m: as far as a loop may bulge in the picture.
const BULGE: f64 = 0.015;

/// What is folded, by whom and how.
pub struct FoldTask<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// The sheet.
    pub paper: Paper,
    /// Where its edge goes.
    pub crease: Crease,
    /// The same as it is planned.
    pub request: FoldRequest,
    /// Whether its parts are planned anew where the sheet has slid.
    pub is_closed_loop: bool,
    /// Which of the directions of the sheet that lies there is taken: the nearest to this one, rad.
    pub heading: f64,
    /// Which pixels are paper.
    pub colour: &'a ColourRule,
    /// Greatest speed of the hand while it folds, m/s.
    pub speed: f64,
    /// The same on the way to the sheet.
    pub approach_speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
    /// What says that it was begun, if it is to be said.
    pub unfinished: Option<&'a Unfinished>,
    /// Where everything is written.
    pub directory: &'a Path,
}

/// What a fold came to.
pub struct FoldEnd {
    /// Stages that were done, with the time that each took, s.
    pub times: Vec<(FoldStage, f64)>,
    /// What was seen on the way.
    pub looks: Vec<Look>,
    /// The frame of the sheet, once it was seen.
    pub frame: Option<Pose>,
    /// The score, or why there is none.
    pub score: Result<FoldScore, FoldTaskError>,
    /// How the cell was left, where it ended early.
    pub stopped: Option<Stopped>,
}

/// What is known of a sheet that lies there.
struct Lying<'a> {
    sight: Sight<'a>,
    frame: Pose,
    /// Where its free end seemed to be before anything moved, from where its file says, m.
    zero: f64,
}

impl FoldTask<'_> {
    /// Does all of it; what was done until something fails is in the directory.
    pub fn run(&self, is_interrupted: &dyn Fn() -> bool) -> FoldEnd {
        let mut clock = StageClock::new(is_interrupted);
        let (mut looks, mut frame) = (Vec::new(), None);
        let score = self.stages(&mut clock, &mut looks, &mut frame);
        let stopped = score.as_ref().err().and_then(|error| {
            let hand = HandPlace::of(self.cell, self.arm);
            Stopped::by(error, vec![hand], Vec::new())
        });
        FoldEnd {
            times: clock.times,
            looks,
            frame,
            score,
            stopped,
        }
    }

    fn stages(
        &self,
        clock: &mut StageClock<'_, FoldStage>,
        looks: &mut Vec<Look>,
        frame: &mut Option<Pose>,
    ) -> Result<FoldScore, FoldTaskError> {
        let arm = WorkingArm {
            cell: self.cell,
            arm: self.arm,
            directory: self.directory,
            unfinished: self.unfinished,
            is_interrupted: clock.is_interrupted,
        };
        let lying = self.find()?;
        *frame = Some(lying.frame);
        let planned = FoldWay::new(self.request);
        let mut way = planned.map_err(|error| FoldTaskError::failed(FoldStage::Look, error))?;
        let request = FoldMotionRequest {
            cell: self.cell,
            arm: self.arm,
            frame: lying.frame,
            speed: self.speed,
            margin: self.margin,
        };
        let motion = request.plan(&way);
        let motion = motion.map_err(|error| FoldTaskError::failed(FoldStage::Look, error))?;
        clock.finish(FoldStage::Look, Ok(()))?;

        let (first, speed) = (&motion.reaching.points[0], self.approach_speed);
        clock.finish(FoldStage::Approach, arm.go("approach", first, speed))?;
        let reached = arm.follow("reaching", &motion.reaching);
        let taken = reached.and_then(|()| arm.grip(Grip::Close));
        clock.finish(FoldStage::Take, taken)?;

        let mut part_motion = motion.parts[0].clone();
        for part in 0..way.parts() {
            if part > 0 {
                part_motion = self.next_part(&request, &mut way, part, &part_motion, looks)?;
            }
            let followed = arm.carry(&format!("folding_{}", part + 1), &part_motion);
            let rested = followed.and_then(|()| arm.rest(REST));
            let hand = rested.and_then(|()| arm.hand());
            let hand = hand.map_err(FoldTaskError::of_work(FoldStage::Fold))?;
            self.look(&lying, part, &hand, looks)?;
            clock.check(FoldStage::Fold)?;
        }
        clock.finish(FoldStage::Fold, Ok(()))?;
        let score = FoldScore::of(looks, self.request.target);
        let unseen = "the free end of the sheet was not seen once";
        let score = score.ok_or_else(|| FoldTaskError::failed(FoldStage::Score, unseen))?;
        if score.is_end_hidden {
            tracing::warn!(
                "at the end the edge lies over the free end of the sheet: the length of the fold is not seen"
            );
        }
        clock.finish(FoldStage::Score, Ok(()))?;
        clock.finish(FoldStage::LetGo, arm.let_go())?;

        let last = &part_motion.points[part_motion.points.len() - 1];
        let rising = request.rising(last);
        let rising = rising.map_err(|error| FoldTaskError::failed(FoldStage::Retreat, error))?;
        let risen = arm.follow("rising", &rising);
        let gone = risen.and_then(|()| arm.go_home("retreat", speed));
        clock.finish(FoldStage::Retreat, gone)?;

        let picture = self.picture(FoldStage::LookAgain)?;
        self.write("left.png", &encode_picture(&picture))?;
        clock.finish(FoldStage::LookAgain, Ok(()))?;
        Ok(score)
    }

    /// Looks where the sheet lies.
    fn find(&self) -> Result<Lying<'_>, FoldTaskError> {
        let failed = |reason: String| FoldTaskError::failed(FoldStage::Look, reason);
        let sight = Sight::new(self.cell, self.paper, self.crease, self.colour).map_err(failed)?;
        let picture = self.picture(FoldStage::Look)?;
        self.write("look_0.png", &encode_picture(&picture))?;
        let seen = |error: rodlab_vision::VisionError| failed(error.to_string());
        let (frame, sheet) = sight.find(&picture, self.heading).map_err(seen)?;
        let overlay = sheet_overlay(&picture, &sheet);
        self.write("overlay_0.png", &encode_picture(&overlay))?;
        let zero = sight.end(&picture, &frame, 0.0).map_err(seen)?.slid;
        Ok(Lying { sight, frame, zero })
    }

    /// The motion of a part, planned anew where the sheet is seen to have slid.
    fn next_part(
        &self,
        request: &FoldMotionRequest<'_>,
        way: &mut FoldWay,
        part: usize,
        before: &JointTrajectory,
        looks: &mut [Look],
    ) -> Result<JointTrajectory, FoldTaskError> {
        let failed = |reason: String| FoldTaskError::failed(FoldStage::Fold, reason);
        let look = looks.last_mut().expect("a look after each part");
        if look.slid_m.is_none() {
            tracing::warn!(
                "after part {part} the edge lies over the free end of the sheet: how far it has slid since is not seen"
            );
        }
        let slid = look.slid_m.unwrap_or(way.slid(part - 1));
        let farther = slid - way.slid(part - 1);
        if !self.is_closed_loop || farther.abs() < LEAST_SLIDING {
            way.keep(part);
        } else {
            let planned = way.anew(part, slid);
            planned.map_err(|error| {
                failed(format!(
                    "the sheet has slid by {:.1} mm, and part {} of the way cannot be planned anew: {error}",
                    1e3 * slid,
                    part + 1
                ))
            })?;
            look.is_planned_anew = true;
        }
        let last = &before.points[before.points.len() - 1];
        let motion = request.onwards(last, &way.hands(part));
        motion.map_err(|error| failed(error.to_string()))
    }

    /// Looks how far the sheet has slid after a part, and whether its edge is still held.
    fn look(
        &self,
        lying: &Lying<'_>,
        part: usize,
        hand: &Pose,
        looks: &mut Vec<Look>,
    ) -> Result<(), FoldTaskError> {
        let picture = self.picture(FoldStage::Fold)?;
        let number = part + 1;
        let name = format!("look_{number}.png");
        self.write(&name, &encode_picture(&picture))?;
        let edge = (lying.frame.inverse() * hand).translation.vector;
        let before = looks.iter().rev().find_map(|look| look.slid_m);
        let before = before.unwrap_or(0.0);
        if edge.x > CLEARLY_AWAY {
            // A sheet that is held turns back no farther than half way between its edge and where its edge would lie flat.
            let place = 0.5 * (edge.x + before) - BULGE;
            let lies = lying.sight.is_paper_at(&picture, &lying.frame, place);
            if lies.map_err(|error| FoldTaskError::failed(FoldStage::Fold, error))? {
                let slipped = "the sheet has slipped out of the gripper, or slid far: paper lies where a held one does not reach";
                return Err(FoldTaskError::failed(FoldStage::Fold, slipped));
            }
        }
        let seen = self.see_end(lying, &picture, edge, before)?;
        looks.push(Look {
            part: number,
            edge_m: [edge.x, edge.z],
            slid_m: seen.as_ref().map(|seen| seen.slid - lying.zero),
            is_planned_anew: false,
        });
        self.write("looks.csv", looks_csv(looks).as_bytes())?;
        if let Some(seen) = seen {
            let overlay = edges_overlay(&picture, &seen.edges);
            let name = format!("overlay_{number}.png");
            self.write(&name, &encode_picture(&overlay))?;
        }
        Ok(())
    }

    /// The free end, which was seen to have slid by `before`, m; `None` where the edge lies over it.
    fn see_end(
        &self,
        lying: &Lying<'_>,
        picture: &RgbImage,
        edge: Vector3<f64>,
        before: f64,
    ) -> Result<Option<SeenEnd>, FoldTaskError> {
        let Lying { sight, frame, zero } = lying;
        let failed = |reason: String| FoldTaskError::failed(FoldStage::Fold, reason);
        if sight.is_end_hidden(frame, edge, before) {
            return Ok(None);
        }
        let seen = sight.end(picture, frame, zero + before);
        let seen = seen.map_err(|error| {
            failed(format!(
                "the free end of the sheet is not seen within 10 cm of where it was: {error}"
            ))
        })?;
        if sight.is_end_hidden(frame, edge, seen.slid - zero) {
            let hidden = "the edge lies over the free end of the sheet, which has slid there";
            return Err(failed(hidden.into()));
        }
        if seen.turned.abs() > MOST_ASKEW {
            return Err(failed(format!(
                "the sheet lies askew: its free end has turned by {:.1}°",
                seen.turned.to_degrees()
            )));
        }
        Ok(Some(seen))
    }

    fn picture(&self, stage: FoldStage) -> Result<RgbImage, FoldTaskError> {
        next_picture(self.cell).map_err(|reason| FoldTaskError::failed(stage, reason))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        write_whole(&self.directory.join(name), bytes)
    }
}
