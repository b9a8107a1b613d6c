//! A knot tied by two arms, looked at and scored.

use super::motion::TieMotion;
use super::plan::KnotPlan;
use super::score::{TieScore, not_seen_whole};
use super::sight::SeenKnot;
use super::stage::{TieError, TieStage};
use crate::cell::Cell;
use crate::task::error::WorkError;
use crate::task::look::{Seen, next_picture};
use crate::task::stage_clock::StageClock;
use crate::task::stopped::{HandPlace, LaidAlong, Stopped};
use crate::task::unfinished::Unfinished;
use crate::task::working_arm::{Grip, WorkingArm};
use image::RgbImage;
use rodlab_files::results::{ResultsError, write_whole};
use rodlab_robot::JointTrajectory;
use rodlab_vision::{ColourRule, Point, VisionError, encode_picture, pattern_csv};
use std::path::Path;

/// What is tied, by whom and how.
pub struct TieTask<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Indices of the arm that lays the first rod, and of the other one.
    pub arms: [usize; 2],
    /// The motions.
    pub motion: &'a TieMotion,
    /// What they are to come to.
    pub knot: &'a KnotPlan,
    /// Greatest speed of a hand that holds nothing, m/s.
    pub free_speed: f64,
    /// Which pixels are rod.
    pub colour: &'a ColourRule,
    /// What says of each arm that the task was begun, if it is to be said.
    pub unfinished: Option<[&'a Unfinished; 2]>,
    /// Where everything is written.
    pub directory: &'a Path,
}

/// What a task came to.
pub struct TieEnd {
    /// Stages that were done, with the time that each took, s.
    pub times: Vec<(TieStage, f64)>,
    /// The score, or why there is none.
    pub score: Result<TieScore, TieError>,
    /// How the cell was left, where it ended early.
    pub stopped: Option<Stopped>,
}

impl TieTask<'_> {
    /// Does all of it; what was done until something fails is in the directory.
    pub fn run(&self, is_interrupted: &dyn Fn() -> bool) -> TieEnd {
        let mut clock = StageClock::new(is_interrupted);
        let score = self.stages(&mut clock);
        let error = score.as_ref().err();
        let stopped = error.and_then(|error| self.left_by(error, &clock.times));
        TieEnd {
            times: clock.times,
            score,
            stopped,
        }
    }

    /// How an error left the cell after some stages were done; `None` where the arms did all of their work.
    fn left_by(&self, error: &TieError, times: &[(TieStage, f64)]) -> Option<Stopped> {
        let stage = error.stage()?;
        let hands = self.arms.map(|arm| HandPlace::of(self.cell, arm));
        let done = times.iter().filter(|(stage, _)| *stage == TieStage::Lay);
        let done = done.count();
        let laid = self.knot.rods.iter().enumerate().map(|(number, planned)| {
            let along = LaidAlong {
                poses: &planned.laying,
                frame: self.motion.frame,
                unit: planned.rod.gravito_bending_length,
            };
            match stage == TieStage::Lay && number == done {
                true => along.until(&hands[number % 2]),
                false => along.whole(number < done),
            }
        });
        let laid = laid.collect();
        Stopped::by(error, hands.into(), laid)
    }

    fn stages(&self, clock: &mut StageClock<'_, TieStage>) -> Result<TieScore, TieError> {
        let is_interrupted = clock.is_interrupted;
        let arms = [0, 1].map(|which| WorkingArm {
            cell: self.cell,
            arm: self.arms[which],
            directory: self.directory,
            unfinished: self.unfinished.map(|marks| marks[which]),
            is_interrupted,
        });
        let home = &self.cell.arms[self.arms[1]].home;
        let parked = arms[1].go("parking", home, self.free_speed);
        parked.map_err(TieError::of_work(TieStage::Approach))?;
        let named = |what: &str, number: usize| match self.motion.layings.len() {
            1 => what.to_owned(),
            _ => format!("{what}_{}", number + 1),
        };
        for (number, laying) in self.motion.layings.iter().enumerate() {
            let layer = &arms[number % 2];
            let name = named("approach", number);
            let gone = match &laying.approach {
                None => layer.go(&name, &laying.motion.points[0], self.free_speed),
                Some(approach) => self.follow(&arms, &name, approach),
            };
            clock.finish(TieStage::Approach, gone)?;
            clock.finish(TieStage::Take, layer.grip(Grip::Close))?;
            let laid = layer.carry(&named("laying", number), &laying.motion);
            clock.finish(TieStage::Lay, laid)?;
            if let Some(parting) = &laying.parting {
                clock.finish(TieStage::LetGo, layer.let_go())?;
                let gone = self.follow(&arms, &named("parting", number), parting);
                clock.finish(TieStage::Retreat, gone)?;
            }
        }
        clock.finish(TieStage::Tie, self.tie(&arms))?;
        clock.finish(TieStage::LetGo, arms[self.motion.last].let_go())?;
        let gone = self.follow(&arms, "retreat", &self.motion.retreat);
        clock.finish(TieStage::Retreat, gone)?;
        let picture = next_picture(self.cell);
        let picture = picture.map_err(|reason| TieError::failed(TieStage::Look, reason))?;
        self.write("picture.png", &encode_picture(&picture))?;
        clock.finish(TieStage::Look, Ok(()))?;
        let score = self.score(&picture)?;
        // It is done, whether an interruption is requested now or not.
        clock.note(TieStage::Score);
        Ok(score)
    }

    /// Leads ends and lifts strands.
    fn tie(&self, arms: &[WorkingArm<'_>; 2]) -> Result<(), WorkError> {
        for stretch in &self.motion.stretches {
            self.follow(arms, &stretch.name, &stretch.motion)?;
            if let Some((which, grip)) = stretch.then {
                arms[which].grip(grip)?;
            }
            if (arms[0].is_interrupted)() {
                return Err(WorkError::Interrupted);
            }
        }
        Ok(())
    }

    /// Streams a motion of both arms.
    fn follow(
        &self,
        arms: &[WorkingArm<'_>; 2],
        name: &str,
        motion: &JointTrajectory,
    ) -> Result<(), WorkError> {
        // The first arm marks itself.
        self.unfinished.map_or(Ok(()), |marks| marks[1].mark())?;
        arms[0].follow(name, motion)
    }

    fn score(&self, picture: &RgbImage) -> Result<TieScore, TieError> {
        let failed = |error: VisionError| TieError::failed(TieStage::Score, error);
        let rods = &self.knot.rods;
        // Of rods of several radii the picture is located on the middle of the first.
        let (frame, radius) = (&self.motion.frame, rods[0].rod.radius);
        let seen = Seen::of(picture, self.cell, frame, radius, self.colour).map_err(failed)?;
        seen.write(picture, self.directory, TieStage::Score)?;
        let starts = rods.iter().map(|planned| planned.pattern.at(0.0).position);
        let starts: Vec<Point> = starts.collect();
        let knot = SeenKnot::of(picture, &seen, &starts).map_err(failed)?;
        for (number, curve) in knot.curves.iter().enumerate() {
            let name = match knot.curves.len() {
                1 => "rod.csv".to_owned(),
                _ => format!("rod_{}.csv", number + 1),
            };
            self.write(&name, pattern_csv(curve).as_bytes())?;
        }
        let lengths: Vec<f64> = rods.iter().map(|planned| planned.rod.length).collect();
        if let Some(words) = not_seen_whole(&knot, &lengths) {
            return Err(TieError::NotSeenWhole(words));
        }
        Ok(TieScore::of(&knot, self.knot.drawn))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        write_whole(&self.directory.join(name), bytes)
    }
}
