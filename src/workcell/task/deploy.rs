//! A rod laid along a pattern by an arm.

use super::error::{TaskError, TaskStage};
use super::look::{Seen, next_picture};
use super::motion::DeployMotion;
use super::stage_clock::StageClock;
use super::stopped::{HandPlace, LaidAlong, Stopped};
use super::unfinished::Unfinished;
use super::working_arm::{Grip, WorkingArm};
use crate::cell::Cell;
use image::RgbImage;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, Paper, plot_to_scale};
use rodlab_files::results::{ResultsError, write_whole};
use rodlab_lab::experiment::{Fixtures, PassedPegs};
use rodlab_planning::plan::deployment::{DeployedRod, LaidPath, falls_straight};
use rodlab_robot::JointTrajectory;
use rodlab_vision::{
    ColourRule, Point, SCORE_POINTS, Score, SeenLength, VisionError, encode_picture, part_of_curve,
    pattern_csv, score, score_figure,
};
use std::path::Path;

/// What is laid where.
pub struct DeployTask<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// The motion.
    pub motion: &'a DeployMotion,
    /// Greatest speed of the hand on the way to it, m/s.
    pub approach_speed: f64,
    /// The pattern in its own frame, without lead-in and lead-out, m.
    pub pattern: &'a [Point],
    /// The path along which the rod is laid: the pattern with lead-in and lead-out.
    pub path: &'a LaidPath,
    /// The rod, as it is believed to be.
    pub rod: &'a DeployedRod,
    /// Which pixels are rod.
    pub colour: &'a ColourRule,
    /// How it is laid where its path is not followed as it was planned.
    pub laying: Option<&'a dyn LayingMethod>,
    /// Pegs between which it is laid, in the frame of the pattern, if there are any.
    pub fixtures: Option<&'a Fixtures>,
    /// What says that it was begun, if it is to be said.
    pub unfinished: Option<&'a Unfinished>,
    /// Where everything is written.
    pub directory: &'a Path,
}

/// A way to lay a rod whose path changes while it is laid.
pub trait LayingMethod {
    /// Lays the rod of a task, from the first pose of its path to the last one.
    ///
    /// # Errors
    /// Something failed, or somebody asked for the end.
    fn lay(
        &self,
        task: &DeployTask<'_>,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DeployError>;
}

/// What is done one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The arm goes to the first point.
    Approach,
    /// The gripper takes the rod.
    Take,
    /// The rod is laid.
    Lay,
    /// The gripper lets it go.
    LetGo,
    /// The arm goes out of the picture: to its posture at rest.
    Retreat,
    /// The camera looks.
    Look,
    /// What it saw is compared with the pattern.
    Score,
}

impl TaskStage for Stage {
    fn in_words(self) -> &'static str {
        match self {
            Self::Approach => "going to the first point",
            Self::Take => "taking the rod",
            Self::Lay => "laying it",
            Self::LetGo => "letting it go",
            Self::Retreat => "going out of the picture",
            Self::Look => "looking",
            Self::Score => "scoring",
        }
    }

    fn next_step(self) -> &'static str {
        match self {
            Self::Approach => {
                "no rod lies yet: look at the arm and at what is in its way, then run the command again with --checked"
            }
            Self::Take => {
                "no rod lies yet: look whether the gripper holds the rod, open it, then run the command again with --checked"
            }
            Self::Lay => {
                "the gripper may hold the rod: look at the arm, take the rod out and off the table, then run the command again \
                 with --checked; laying starts from the beginning"
            }
            Self::LetGo => {
                "the rod lies up to the gripper, which may still hold it: look at the arm and open the gripper; begin the next \
                 task with --checked"
            }
            Self::Retreat => {
                "the rod lies and is let go: look at the arm and lead it out of the picture; `rodlab trace` with the camera and \
                 `rodlab score` show how the rod lies; begin the next task with --checked"
            }
            Self::Look | Self::Score => {
                "the rod lies, and the arm is out of the way: look at the camera and at what it shows; `rodlab trace` with the \
                 camera and `rodlab score` show how the rod lies; begin the next task with --checked"
            }
        }
    }
}

/// Why a deployment ended early.
pub type DeployError = TaskError<Stage>;

/// How a rod lies.
pub struct Laid {
    /// How far from its pattern.
    pub score: Score,
    /// The pegs that it passes as its pattern does, where there are pegs.
    pub pegs: Option<PassedPegs>,
}

/// What a task came to.
pub struct DeployEnd {
    /// Stages that were done, with the time that each took, s.
    pub times: Vec<(Stage, f64)>,
    /// Length of the rod in the picture, and its own, where a picture was taken.
    pub seen_length: Option<SeenLength>,
    /// How the rod lies, or why that is not known.
    pub laid: Result<Laid, DeployError>,
    /// How the cell was left, where it ended early.
    pub stopped: Option<Stopped>,
}

impl DeployTask<'_> {
    /// Does all of it; what was done until something fails is in the directory.
    pub fn run(&self, is_interrupted: &dyn Fn() -> bool) -> DeployEnd {
        let mut clock = StageClock::new(is_interrupted);
        let mut seen_length = None;
        let laid = self.stages(&mut clock, &mut seen_length);
        let stopped = laid.as_ref().err().and_then(|error| self.left_by(error));
        DeployEnd {
            times: clock.times,
            seen_length,
            laid,
            stopped,
        }
    }

    fn stages(
        &self,
        clock: &mut StageClock<'_, Stage>,
        seen_length: &mut Option<SeenLength>,
    ) -> Result<Laid, DeployError> {
        let is_interrupted = clock.is_interrupted;
        let arm = self.arm(is_interrupted);
        let (first, speed) = (&self.motion.laying.points[0], self.approach_speed);
        clock.done(Stage::Approach, arm.go("approach", first, speed))?;
        clock.check(Stage::Take)?;
        clock.done(Stage::Take, arm.grip(Grip::Close))?;
        clock.check(Stage::Lay)?;
        match self.laying {
            None => self.lay("laying", &self.motion.laying, is_interrupted)?,
            Some(laying) => laying.lay(self, is_interrupted)?,
        }
        clock.note(Stage::Lay);
        clock.check(Stage::LetGo)?;
        clock.done(Stage::LetGo, arm.let_go())?;
        clock.check(Stage::Retreat)?;
        clock.done(Stage::Retreat, arm.go_home("retreat", speed))?;
        clock.check(Stage::Look)?;
        let picture = next_picture(self.cell);
        let picture = picture.map_err(|reason| DeployError::failed(Stage::Look, reason))?;
        self.write("picture.png", &encode_picture(&picture))?;
        clock.note(Stage::Look);
        let seen = |error: VisionError| DeployError::failed(Stage::Score, error);
        let found = self.seen(&picture).map_err(seen)?;
        found.write(&picture, self.directory, Stage::Score)?;
        let rod = found.longest(self.start()).map_err(seen)?;
        self.write("rod.csv", pattern_csv(&rod).as_bytes())?;
        let length = seen_length.insert(self.seen_length(&found, &rod).map_err(seen)?);
        if !length.is_whole() {
            return Err(DeployError::NotSeenWhole(length.to_string()));
        }
        let part = part_of_curve(&rod, self.path.lead_in, self.pattern).map_err(seen)?;
        let score = score(&part, self.pattern, SCORE_POINTS, false).map_err(seen)?;
        let figure = score_figure(&score, "the rod", "the pattern");
        self.write("score.svg", figure.svg(&Paper::default()).as_bytes())?;
        let pegs = self.fixtures.map(|fixtures| fixtures.passed(&part));
        if let Some(fixtures) = self.fixtures {
            let figure = peg_figure(&rod, fixtures);
            self.write("pegs.svg", figure.svg(&Paper::default()).as_bytes())?;
        }
        clock.note(Stage::Score);
        Ok(Laid { score, pegs })
    }

    /// How an error left the cell; `None` where the arm did all of its work.
    fn left_by(&self, error: &DeployError) -> Option<Stopped> {
        let stage = error.stage()?;
        let along = LaidAlong {
            poses: &self.path.poses,
            frame: self.motion.frame,
            unit: self.rod.gravito_bending_length,
        };
        let hand = HandPlace::of(self.cell, self.arm);
        let laid = match stage {
            Stage::Approach | Stage::Take => along.whole(false),
            Stage::Lay => along.until(&hand),
            Stage::LetGo | Stage::Retreat | Stage::Look | Stage::Score => along.whole(true),
        };
        Stopped::by(error, vec![hand], vec![laid])
    }

    /// How much of the rod the picture shows. Where its end runs out of the picture, or a long rest fell from the gripper, perhaps upon
    /// itself, only the path along which it was laid must be seen.
    fn seen_length(&self, seen: &Seen, rod: &[Point]) -> Result<SeenLength, VisionError> {
        let length = SeenLength::of(rod, self.rod.length);
        let laid = self.path.points.last().map_or(0.0, |point| point.s);
        if falls_straight(self.rod, laid) && !seen.leaves_picture(self.start())? {
            return Ok(length);
        }
        Ok(length.with_least(laid))
    }

    /// Where the rod begins, in the frame of the pattern, m.
    pub(super) fn start(&self) -> Point {
        self.path.points[0].position
    }

    /// What a picture shows of the rod.
    pub(super) fn seen(&self, picture: &RgbImage) -> Result<Seen, VisionError> {
        let (frame, radius) = (&self.motion.frame, self.rod.radius);
        Seen::of(picture, self.cell, frame, radius, self.colour)
    }

    /// The arm that does it.
    fn arm<'a>(&'a self, is_interrupted: &'a dyn Fn() -> bool) -> WorkingArm<'a> {
        WorkingArm {
            cell: self.cell,
            arm: self.arm,
            directory: self.directory,
            unfinished: self.unfinished,
            is_interrupted,
        }
    }

    /// Lays the rod along a motion; its log is a folder of the results.
    pub(super) fn lay(
        &self,
        folder: &str,
        motion: &JointTrajectory,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DeployError> {
        let laid = self.arm(is_interrupted).carry(folder, motion);
        laid.map_err(DeployError::of_work(Stage::Lay))
    }

    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        write_whole(&self.directory.join(name), bytes)
    }
}

/// The rod between its pegs, from above.
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
