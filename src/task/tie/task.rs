//! A knot tied by two arms, looked at and scored.

use super::motion::TieMotion;
use super::plan::KnotPlan;
use super::score::TieScore;
use super::sight::SeenRod;
use super::stage::{TieError, TieStage};
use crate::cell::Cell;
use crate::plan::deployment::DeployedRod;
use crate::results::{ResultsError, write_whole};
use crate::task::error::{TaskStage, WorkError};
use crate::task::look::{Seen, next_picture};
use crate::task::unfinished::Unfinished;
use crate::task::working_arm::{Grip, WorkingArm};
use crate::vision::{
    ColourRule, Point, VisionError, centrelines_csv, encode_picture, overlay, pattern_csv,
};
use image::RgbImage;
use std::path::Path;
use std::time::{Duration, Instant};

/// What is tied, by whom and how.
pub struct TieTask<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Indices of the arm that lays and leads, and of the one that lifts.
    pub arms: [usize; 2],
    /// The motions.
    pub motion: &'a TieMotion,
    /// What they are to come to.
    pub knot: &'a KnotPlan,
    /// Greatest speed of a hand that holds nothing, m/s.
    pub free_speed: f64,
    /// The rod, as it is believed to be.
    pub rod: &'a DeployedRod,
    /// Which pixels are rod.
    pub colour: &'a ColourRule,
    /// What says of each arm that the task was begun, if it is to be said.
    pub unfinished: Option<[&'a Unfinished; 2]>,
    /// How long a rod that was let go is left to itself.
    pub settling: Duration,
    /// Where everything is written.
    pub directory: &'a Path,
}

/// What a task came to.
pub struct TieEnd {
    /// Stages that were done, with the time that each took, s.
    pub times: Vec<(TieStage, f64)>,
    /// The score, or why there is none.
    pub score: Result<TieScore, TieError>,
}

impl TieTask<'_> {
    /// Does all of it; what was done until something fails is in the directory.
    pub fn run(&self, is_interrupted: &dyn Fn() -> bool) -> TieEnd {
        let mut times = Vec::new();
        let score = self.stages(is_interrupted, &mut times);
        TieEnd { times, score }
    }

    fn stages(
        &self,
        is_interrupted: &dyn Fn() -> bool,
        times: &mut Vec<(TieStage, f64)>,
    ) -> Result<TieScore, TieError> {
        let mut begin = Instant::now();
        let mut done = |stage: TieStage| {
            tracing::info!("done: {}", stage.in_words());
            times.push((stage, begin.elapsed().as_secs_f64()));
            begin = Instant::now();
            match is_interrupted() {
                true => Err(TieError::Interrupted),
                false => Ok(()),
            }
        };
        let [layer, lifter] = [0, 1].map(|which| WorkingArm {
            cell: self.cell,
            arm: self.arms[which],
            directory: self.directory,
            unfinished: self.unfinished.map(|marks| marks[which]),
            is_interrupted,
        });
        let work = TieError::of_work;
        let home = &self.cell.arms[self.arms[1]].home;
        let parked = lifter.go("parking", home, self.free_speed);
        parked.map_err(work(TieStage::Approach))?;
        let first = &self.motion.laying.points[0];
        let gone = layer.go("approach", first, self.free_speed);
        gone.map_err(work(TieStage::Approach))?;
        done(TieStage::Approach)?;
        layer.grip(Grip::Close).map_err(work(TieStage::Take))?;
        done(TieStage::Take)?;
        let laid = layer.carry("laying", &self.motion.laying);
        laid.map_err(work(TieStage::Lay))?;
        done(TieStage::Lay)?;
        self.tie(&layer, &lifter).map_err(work(TieStage::Tie))?;
        done(TieStage::Tie)?;
        layer.grip(Grip::Open).map_err(work(TieStage::LetGo))?;
        std::thread::sleep(self.settling);
        done(TieStage::LetGo)?;
        let risen = layer.follow("rising", &self.motion.rising);
        risen.map_err(work(TieStage::Retreat))?;
        let gone = layer.go_home("retreat", self.free_speed);
        gone.map_err(work(TieStage::Retreat))?;
        done(TieStage::Retreat)?;
        let picture = next_picture(self.cell);
        let picture = picture.map_err(|reason| TieError::failed(TieStage::Look, reason))?;
        self.write("picture.png", &encode_picture(&picture))?;
        done(TieStage::Look)?;
        let score = self.score(&picture)?;
        // It is done, whether somebody asks for the end now or not.
        let _ = done(TieStage::Score);
        Ok(score)
    }

    /// Leads the end and lifts strands.
    fn tie(&self, layer: &WorkingArm<'_>, lifter: &WorkingArm<'_>) -> Result<(), WorkError> {
        for stretch in &self.motion.stretches {
            // Both move, and the log is that of one.
            let marked = self.unfinished.map_or(Ok(()), |marks| marks[1].mark());
            marked.map_err(|error| {
                WorkError::Failed(format!("the task cannot be marked as begun: {error}"))
            })?;
            layer.carry(&stretch.name, &stretch.motion)?;
            if let Some(grip) = stretch.then {
                lifter.grip(grip)?;
            }
            if (layer.is_interrupted)() {
                return Err(WorkError::Interrupted);
            }
        }
        Ok(())
    }

    fn score(&self, picture: &RgbImage) -> Result<TieScore, TieError> {
        let failed = |error: VisionError| TieError::failed(TieStage::Score, error);
        let (frame, radius) = (&self.motion.frame, self.rod.radius);
        let seen = Seen::of(picture, self.cell, frame, radius, self.colour).map_err(failed)?;
        let shown = overlay(picture, &seen.trace);
        self.write("overlay.png", &encode_picture(&shown))?;
        let strands = centrelines_csv(&seen.trace.strands, None).map_err(failed)?;
        self.write("centrelines.csv", strands.as_bytes())?;
        let start = self.knot.points.first().copied();
        let start = start.unwrap_or_else(Point::zeros);
        let rod = SeenRod::of(picture, &seen, start).map_err(failed)?;
        self.write("rod.csv", pattern_csv(&rod.curve).as_bytes())?;
        Ok(TieScore::of(&rod, self.rod.length, self.knot.drawn))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        write_whole(&self.directory.join(name), bytes)
    }
}
