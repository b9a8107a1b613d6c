//! A task that ties a knot with two arms, takes a picture and scores it.

use super::motion::TieMotion;
use super::plan::KnotPlan;
use super::record::TieRecord;
use super::score::{TieScore, not_seen_whole};
use super::sight::SeenKnot;
use crate::cell::{Cell, PlanError};
use crate::task::error::WorkError;
use crate::task::look::Seen;
use crate::task::stage::Stage;
use crate::task::step::{Step, Task};
use crate::task::stopped::LaidAlong;
use crate::task::working_arm::{Grip, WorkingArm};
use crate::task::workplace::Workplace;
use image::RgbImage;
use rodlab_robot::JointTrajectory;
use rodlab_vision::{ColourRule, Point, pattern_csv};

const APPROACH: Stage = Stage::new("approach", "going to the first point", HELD);
const TAKE: Stage = Stage::new("take", "taking the rod", HELD);
const LAY: Stage = Stage::new(Stage::LAY, "laying it", HELD);
const TIE: Stage = Stage::new("tie", "tying it", HELD);
const LET_GO: Stage = Stage::new("let-go", "letting it go", HELD);
const RETREAT: Stage = Stage::new("retreat", "going out of the picture", LET_LIE);
const LOOK: Stage = Stage::new("look", "looking", LET_LIE);
const SCORE: Stage = Stage::new("score", "scoring", LET_LIE);
/// Advice after stages in which a rod is held; another one after all rods were released.
const HELD: &str = "a gripper may hold a rod: inspect both arms, open their grippers and take the rods off the table, then run the \
                    command again with --checked; tying starts from the beginning";
const LET_LIE: &str = "the rods are released: inspect both arms and the camera; `rodlab trace` with the camera shows the rods on the \
                       table; pass --checked to the next task";

/// Plan of a knot in a cell.
pub struct TiePlan {
    /// Indices of the arms: the one that lays the first rod, then the other one.
    pub arms: [usize; 2],
    /// The patterns, as given.
    pub names: Vec<String>,
    /// The motions.
    pub motion: TieMotion,
    /// The knot to tie.
    pub knot: KnotPlan,
    /// Greatest speed of a hand that holds nothing, m/s.
    pub free_speed: f64,
    /// Colour of the rod.
    pub colour: ColourRule,
}

/// A task that ties a knot, takes a picture and scores it.
pub struct TieTask {
    plan: TiePlan,
    record: TieRecord,
    /// The picture of the tied knot.
    picture: Option<RgbImage>,
}

impl TieTask {
    /// Creates the task from its plan in a cell.
    pub fn new(cell: &Cell, plan: TiePlan) -> Self {
        let TiePlan { motion, knot, .. } = &plan;
        Self {
            record: TieRecord {
                cell: cell.title.clone(),
                arms: plan.arms.map(|arm| cell.arms[arm].name.clone()),
                patterns: plan.names.clone(),
                passes: knot.passages.iter().map(|passage| passage.pass).collect(),
                drawn: knot.drawn,
                lifts: knot.lifts(),
                motion: motion.report.clone(),
                duration_s: motion.whole.duration(),
                least_clearance_m: motion.least_clearance,
                score: None,
            },
            plan,
            picture: None,
        }
    }

    /// One of the two arms.
    fn arm<'a>(&self, which: usize, at: &'a Workplace<'a>) -> WorkingArm<'a> {
        WorkingArm {
            at,
            arm: self.plan.arms[which],
        }
    }

    /// Name of the folder for a motion of a rod.
    fn named(&self, what: &str, number: usize) -> String {
        match self.plan.motion.layings.len() {
            1 => what.to_owned(),
            _ => format!("{what}_{}", number + 1),
        }
    }

    /// Moves an arm to the first point of a rod; before the first rod the other arm moves out of the way.
    fn approach(&self, number: usize, at: &Workplace<'_>) -> Result<(), WorkError> {
        let speed = self.plan.free_speed;
        if number == 0 {
            let home = &at.cell.arms[self.plan.arms[1]].home;
            self.arm(1, at).go("parking", home, speed)?;
        }
        let (name, laying) = (
            self.named("approach", number),
            &self.plan.motion.layings[number],
        );
        match &laying.approach {
            None => self
                .arm(number % 2, at)
                .go(&name, &laying.motion.points[0], speed),
            Some(approach) => self.follow(&name, approach, at),
        }
    }

    fn lay(&self, number: usize, at: &Workplace<'_>) -> Result<(), WorkError> {
        let motion = &self.plan.motion.layings[number].motion;
        let along = &self.paths()[number];
        let arm = self.arm(number % 2, at);
        arm.lay(&self.named("laying", number), motion, along)
    }

    /// Leads the ends and lifts the strands.
    fn tie(&self, at: &Workplace<'_>) -> Result<(), WorkError> {
        for stretch in &self.plan.motion.stretches {
            self.follow(&stretch.name, &stretch.motion, at)?;
            if let Some((which, grip)) = stretch.then {
                self.arm(which, at).grip(grip)?;
            }
            at.check()?;
        }
        Ok(())
    }

    /// Streams a motion of both arms.
    fn follow(
        &self,
        name: &str,
        motion: &JointTrajectory,
        at: &Workplace<'_>,
    ) -> Result<(), WorkError> {
        // The call below marks the first arm.
        at.mark(self.plan.arms[1])?;
        self.arm(0, at).follow(name, motion)
    }

    fn score(&mut self, at: &Workplace<'_>) -> Result<(), WorkError> {
        let TiePlan {
            motion,
            knot: drawn,
            colour,
            ..
        } = &self.plan;
        let picture = self.picture.take().expect("a picture was taken");
        let rods = &drawn.rods;
        // With rods of different radii, pixels are located at the height of the first rod's
        // centreline.
        let radius = rods[0].rod.radius;
        let seen = Seen::of(&picture, at.cell, &motion.frame, radius, colour)?;
        seen.write(&picture, at)?;
        let starts = rods.iter().map(|planned| planned.pattern.at(0.0).position);
        let starts: Vec<Point> = starts.collect();
        let knot = SeenKnot::of(&picture, &seen, &starts)?;
        for (number, curve) in knot.curves.iter().enumerate() {
            let name = match knot.curves.len() {
                1 => "rod.csv".to_owned(),
                _ => format!("rod_{}.csv", number + 1),
            };
            at.write(&name, pattern_csv(curve).as_bytes())?;
        }
        let lengths: Vec<f64> = rods.iter().map(|planned| planned.rod.length).collect();
        if let Some(words) = not_seen_whole(&knot, &lengths) {
            return Err(WorkError::NotSeenWhole(words));
        }
        self.record.score = Some(TieScore::of(&knot, drawn.drawn));
        Ok(())
    }
}

impl Task for TieTask {
    type Record = TieRecord;

    const FRAMES: usize = 600;

    fn record(&self) -> &TieRecord {
        &self.record
    }

    fn arms(&self) -> Vec<usize> {
        self.plan.arms.into()
    }

    fn motion(&self, _: &Cell) -> Result<Option<JointTrajectory>, PlanError> {
        Ok(Some(self.plan.motion.whole.clone()))
    }

    fn paths(&self) -> Vec<LaidAlong<'_>> {
        let rods = self.plan.knot.rods.iter();
        let along = rods.map(|planned| LaidAlong {
            poses: &planned.laying,
            frame: self.plan.motion.frame,
            unit: planned.rod.gravito_bending_length,
        });
        along.collect()
    }

    fn steps(&self) -> Vec<Step<Self>> {
        let mut steps = Vec::new();
        for (number, laying) in self.plan.motion.layings.iter().enumerate() {
            let layer = number % 2;
            steps.extend([
                Step::new(&APPROACH, move |task: &mut Self, at| {
                    task.approach(number, at)
                }),
                Step::new(&TAKE, move |task: &mut Self, at| {
                    task.arm(layer, at).grip(Grip::Close)
                }),
                Step::new(&LAY, move |task: &mut Self, at| task.lay(number, at)),
            ]);
            if let Some(parting) = laying.parting.clone() {
                steps.extend([
                    Step::new(&LET_GO, move |task: &mut Self, at| {
                        task.arm(layer, at).let_go()
                    }),
                    Step::new(&RETREAT, move |task: &mut Self, at| {
                        task.follow(&task.named("parting", number), &parting, at)
                    }),
                ]);
            }
        }
        steps.extend([
            Step::new(&TIE, |task: &mut Self, at| task.tie(at)),
            Step::new(&LET_GO, |task: &mut Self, at| {
                task.arm(task.plan.motion.last, at).let_go()
            }),
            Step::new(&RETREAT, |task: &mut Self, at| {
                task.follow("retreat", &task.plan.motion.retreat, at)
            }),
            Step::new(&LOOK, |task: &mut Self, at| {
                task.picture = Some(at.picture("picture.png")?);
                Ok(())
            }),
            Step::new(&SCORE, Self::score),
        ]);
        steps
    }
}
