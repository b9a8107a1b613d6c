//! The motions of a fold, planned and checked before anything moves.

use super::way::FoldWay;
use crate::cell::{Cell, Place, PlanError, PlanReport, PlanRequest};
use nalgebra::{Translation3, Vector3};
use rodlab_robot::{JointTrajectory, Pose};

/// Place of the hand before the edge, in the frame of the sheet, m: behind the edge and above it.
const READY: [f64; 2] = [-0.04, 0.02];
/// Height by which the hand rises after it has released the edge, m.
const RISE: f64 = 0.05;
/// Points per second of the plan.
const RATE: u32 = 100;

/// Request for a plan.
#[derive(Clone, Copy)]
pub struct FoldMotionRequest<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// Frame of the sheet in the cell.
    pub frame: Pose,
    /// Greatest speed of the hand, m/s.
    pub speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
}

/// The planned motions.
#[derive(Clone, Debug)]
pub struct FoldMotion {
    /// Motion to the edge, from in front of it.
    pub reaching: JointTrajectory,
    /// The parts of the fold.
    pub parts: Vec<JointTrajectory>,
    /// Numbers of the whole motion.
    pub report: PlanReport,
}

impl FoldMotionRequest<'_> {
    /// Plans the motions along a path.
    ///
    /// # Errors
    /// The arm cannot follow the path.
    pub fn plan(&self, way: &FoldWay) -> Result<FoldMotion, PlanError> {
        let edge = way.hands(0)[0];
        let [behind, above] = READY;
        let reaching = vec![Translation3::new(behind, 0.0, above) * edge, edge];
        let parts = (0..way.parts()).map(|part| way.hands(part));
        let parts: Vec<Vec<Pose>> = parts.collect();
        let turn = heading(&self.frame);
        let place = self.frame.translation.vector;
        let whole = self.cell.plan(&PlanRequest {
            arm: self.arm,
            path: reaching
                .iter()
                .chain(parts.iter().flatten())
                .copied()
                .collect(),
            place: Place::At([place.x, place.y, place.z, turn]),
            margin: self.margin,
            speed: self.speed,
            rate: RATE,
        })?;
        let reaching = self.onwards(&whole.trajectory.points[0], &reaching)?;
        let mut last = reaching.points[reaching.points.len() - 1].clone();
        let mut planned = Vec::new();
        for part in &parts {
            let motion = self.onwards(&last, part)?;
            last.clone_from(&motion.points[motion.points.len() - 1]);
            planned.push(motion);
        }
        Ok(FoldMotion {
            reaching,
            parts: planned,
            report: whole.report,
        })
    }

    /// A motion along poses of the hand in the frame of the sheet, from joint positions at the
    /// first pose.
    ///
    /// # Errors
    /// The arm cannot follow the poses.
    pub fn onwards(&self, from: &[f64], hands: &[Pose]) -> Result<JointTrajectory, PlanError> {
        let path: Vec<Pose> = hands.iter().map(|hand| self.frame * hand).collect();
        self.cell
            .continuation(self.arm, &path, from, self.speed, RATE)
    }

    /// The motion by which the hand rises after the release.
    ///
    /// # Errors
    /// The hand cannot rise.
    pub fn rising(&self, from: &[f64]) -> Result<JointTrajectory, PlanError> {
        self.cell.rising(self.arm, RISE, from, self.speed, RATE)
    }
}

/// Angle from the x axis of the cell to the x axis of the sheet, rad.
pub fn heading(frame: &Pose) -> f64 {
    let over = frame.rotation * Vector3::x();
    libm::atan2(over.y, over.x)
}

impl FoldMotion {
    /// The whole motion: all parts in sequence.
    pub fn whole(&self) -> JointTrajectory {
        let mut whole = self.reaching.clone();
        for part in &self.parts {
            let end = whole.times[whole.times.len() - 1];
            let later = part.times.iter().skip(1).map(|time| end + time);
            whole.times.extend(later);
            whole.points.extend(part.points.iter().skip(1).cloned());
        }
        whole
    }
}
