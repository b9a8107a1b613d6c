//! Task that holds a rod before the camera in three poses, takes pictures, and fits the rod.

use super::pose::{HeldPose, HoldRequest};
use super::record::IdentificationRecord;
use super::strand::{directions, strand};
use crate::cell::{Cell, PlanError};
use crate::task::error::WorkError;
use crate::task::stage::Stage;
use crate::task::step::{Step, Task};
use crate::task::working_arm::{Grip, WorkingArm};
use crate::task::workplace::Workplace;
use rodlab_lab::experiment::RodFile;
use rodlab_lab::identify::{HeldRod, HeldView, ROD, identify_held, write};
use rodlab_planning::plan::deployment::DeployedRod;
use rodlab_robot::JointTrajectory;
use rodlab_vision::{ColourRule, Point, encode_picture, overlay};
use std::time::Duration;

const APPROACH: Stage = Stage::new("approach", "going to the handover of the rod", NOTHING);
const TAKE: Stage = Stage::new("take", "taking the rod", HELD);
const HOLD: Stage = Stage::new("hold", "holding the rod before the camera", HELD);
const LOOK: Stage = Stage::new("look", "looking", HELD);
const GIVE: Stage = Stage::new("give", "giving the rod back", HELD);
const FIT: Stage = Stage::new(
    "fit",
    "fitting the rod",
    "the pictures are kept: inspect overlay_1.png to overlay_3.png; pass --checked to the next task",
);
/// Advice if the gripper is empty.
const NOTHING: &str = "the gripper holds nothing: inspect the arm and its surroundings, then run the command again with --checked";
/// Advice if the gripper may hold the rod.
const HELD: &str = "the gripper may hold the rod: inspect the arm and take the rod out, then run the command again with --checked";

/// Time for which the rod swings before the first picture of a pose, and between pictures.
const SWINGING: [Duration; 2] = [Duration::from_secs(2), Duration::from_millis(500)];
/// Mean distance of the rod in two pictures below which it rests, pixels.
const STILL: f64 = 0.25;
/// Maximum number of pictures of a pose.
const PICTURES: usize = 20;

/// Plan of an identification.
pub struct IdentificationPlan {
    /// Index of the arm.
    pub arm: usize,
    /// The rod as expected.
    pub rod: RodFile,
    /// Length of its free part, m.
    pub free: f64,
    /// Colour of the rod.
    pub colour: ColourRule,
    /// Maximum speed of the hand without and with the rod, m/s.
    pub speeds: [f64; 2],
    /// Minimum distance to anything else, m.
    pub margin: f64,
}

/// An identification.
pub struct IdentificationTask {
    plan: IdentificationPlan,
    held: HeldRod,
    /// Joints at which the rod is handed over.
    handed: Vec<f64>,
    record: IdentificationRecord,
    views: Vec<HeldView>,
}

impl IdentificationTask {
    /// Builds the task from its plan in a cell, and chooses the poses.
    ///
    /// # Errors
    /// The camera sees too few poses.
    pub fn new(cell: &Cell, plan: IdentificationPlan) -> Result<Self, PlanError> {
        let DeployedRod {
            gravito_bending_length,
            radius,
            length,
        } = plan.rod.rod;
        if !(plan.free <= length) {
            return Err(PlanError::Input(format!(
                "--free: {} m is longer than the rod; allowed: up to {length} m",
                plan.free
            )));
        }
        let held = HeldRod {
            title: plan.rod.title.clone(),
            length: plan.free,
            radius,
            density: plan.rod.density,
            gravito_bending_length,
        };
        let request = HoldRequest {
            cell,
            arm: plan.arm,
            rod: &held,
            margin: plan.margin,
            speed: plan.speeds[1],
        };
        let (handed, poses) = request.plan()?;
        Ok(Self {
            record: IdentificationRecord {
                cell: cell.title.clone(),
                arm: cell.arms[plan.arm].name.clone(),
                rod: plan.rod.title.clone(),
                free_length_m: plan.free,
                expected_m: gravito_bending_length,
                poses,
                parameters: Vec::new(),
                remarks: Vec::new(),
            },
            held,
            handed,
            plan,
            views: Vec::new(),
        })
    }

    /// Takes pictures in a pose, counted from 1, until the rod rests.
    fn look(&mut self, number: usize, at: &Workplace<'_>) -> Result<(), WorkError> {
        let arm = WorkingArm {
            at,
            arm: self.plan.arm,
        };
        let known = at.cell.camera.as_ref();
        let camera = known.ok_or_else(|| WorkError::failed("the cell has no [camera]"))?;
        let camera = camera.seeing(at.cell.table_height());
        let hand = arm.hand()?;
        arm.rest(SWINGING[0])?;
        let mut before: Option<Vec<Point>> = None;
        for _ in 0..PICTURES {
            let picture = at.picture(&format!("look_{number}.png"))?;
            camera.check_size(picture.width(), picture.height())?;
            let (found, strand) = strand(&picture, &self.plan.colour, &camera, &hand)?;
            if before.is_some_and(|before| apart(&before, &strand) < STILL) {
                let shown = encode_picture(&overlay(&picture, &found));
                at.write(&format!("overlay_{number}.png"), &shown)?;
                self.views.push(HeldView {
                    picture: format!("look_{number}.png").into(),
                    hand,
                    camera: camera.pose,
                    points: directions(&camera, &strand),
                });
                return Ok(());
            }
            before = Some(strand);
            arm.rest(SWINGING[1])?;
        }
        Err(WorkError::Failed(format!(
            "the rod still moves after {PICTURES} pictures"
        )))
    }

    fn fit(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let (found, experiments) =
            identify_held(&self.held, &self.views, &|| true).map_err(WorkError::failed)?;
        write(at.directory, &found, &experiments).map_err(WorkError::failed)?;
        let (Some(length), true) = (found.parameters.first(), found.converged) else {
            return Err(WorkError::failed("the fit has not converged"));
        };
        // The file of the fit describes only the free part of the rod.
        let mut rod = self.plan.rod.clone();
        rod.rod.gravito_bending_length = length.value;
        at.write(ROD, rod.text().as_bytes())?;
        self.record.remarks = found.remarks;
        let undetermined = found.undetermined.into_iter().map(|one| one.words);
        self.record.remarks.extend(undetermined);
        self.record.parameters = found.parameters;
        Ok(())
    }
}

impl Task for IdentificationTask {
    type Record = IdentificationRecord;

    fn record(&self) -> &IdentificationRecord {
        &self.record
    }

    fn arms(&self) -> Vec<usize> {
        vec![self.plan.arm]
    }

    fn motion(&self, cell: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
        let mut whole: Option<JointTrajectory> = None;
        let mut from = &self.handed;
        for HeldPose { joints, .. } in &self.record.poses {
            let next = cell.approach(self.plan.arm, from, joints, self.plan.speeds[1])?;
            whole = match (whole, next) {
                (Some(whole), Some(next)) => Some(one_after_the_other(whole, next)),
                (whole, next) => whole.or(next),
            };
            from = joints;
        }
        Ok(whole)
    }

    fn steps(&self) -> Vec<Step<Self>> {
        let (arm, [alone, leading]) = (self.plan.arm, self.plan.speeds);
        let mut steps = vec![
            Step::new(&APPROACH, move |task: &mut Self, at| {
                WorkingArm { at, arm }.go("approach", &task.handed, alone)
            }),
            Step::new(&TAKE, move |_, at| WorkingArm { at, arm }.grip(Grip::Close)),
        ];
        for number in 1..=self.record.poses.len() {
            steps.push(Step::new(&HOLD, move |task: &mut Self, at| {
                let joints = &task.record.poses[number - 1].joints;
                WorkingArm { at, arm }.lead(&format!("hold_{number}"), joints, leading)
            }));
            steps.push(Step::new(&LOOK, move |task: &mut Self, at| {
                task.look(number, at)
            }));
        }
        steps.extend([
            Step::new(&GIVE, move |task: &mut Self, at| {
                let arm = WorkingArm { at, arm };
                arm.lead("give", &task.handed, leading)?;
                arm.grip(Grip::Open)
            }),
            Step::new(&FIT, Self::fit),
        ]);
        steps
    }
}

/// Appends a second motion of the same joints to a motion.
fn one_after_the_other(mut first: JointTrajectory, second: JointTrajectory) -> JointTrajectory {
    let begin = first.duration();
    let times = second.times.iter().skip(1).map(|time| begin + time);
    first.times.extend(times);
    first.points.extend(second.points.into_iter().skip(1));
    first
}

/// Mean distance of the points of a curve from those of another curve.
fn apart(one: &[Point], other: &[Point]) -> f64 {
    let nearest = |point: &Point| {
        let away = other.windows(2).map(|pair| {
            let along = pair[1] - pair[0];
            let square = along.norm_squared().max(f64::MIN_POSITIVE);
            let part = ((point - pair[0]).dot(&along) / square).clamp(0.0, 1.0);
            (point - pair[0] - along * part).norm()
        });
        away.fold(f64::INFINITY, f64::min)
    };
    one.iter().map(nearest).sum::<f64>() / one.len() as f64
}
