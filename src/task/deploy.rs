//! A rod laid along a pattern by an arm.

use super::look::{Seen, next_picture, score_of};
use super::motion::DeployMotion;
use super::unfinished::Unfinished;
use crate::cell::Cell;
use crate::figure::Paper;
use crate::plan::deployment::{DeployedRod, LaidPath};
use crate::results::{ResultsError, write_whole};
use crate::robot::{Ending, JointTrajectory, StreamLog, stream};
use crate::vision::{
    ColourRule, Point, SCORE_POINTS, Score, VisionError, centrelines_csv, encode_picture, overlay,
    pattern_csv, score_figure,
};
use image::RgbImage;
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest wait for a gripper.
const GRIPPER: Duration = Duration::from_secs(20);
/// How long a rod that was let go is usually left to itself.
pub const SETTLING: Duration = Duration::from_secs(3);

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
    /// What says that it was begun, if it is to be said.
    pub unfinished: Option<&'a Unfinished>,
    /// How long a rod that was let go is left to itself.
    pub settling: Duration,
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

impl Stage {
    /// In words.
    pub fn in_words(self) -> &'static str {
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
}

/// Why a task ended early.
#[derive(Debug, thiserror::Error)]
pub enum DeployError {
    /// Something failed.
    #[error("{}: {reason}", stage.in_words())]
    Failed {
        /// While this was done.
        stage: Stage,
        /// In words.
        reason: String,
    },
    /// Somebody asked for the end; the arm holds.
    #[error("interrupted; the arm holds")]
    Interrupted,
    /// A file could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// What a task came to.
pub struct DeployEnd {
    /// Stages that were done, with the time that each took, s.
    pub times: Vec<(Stage, f64)>,
    /// The score, or why there is none.
    pub score: Result<Score, DeployError>,
}

impl DeployTask<'_> {
    /// Does all of it; what was done until something fails is in the directory.
    pub fn run(&self, is_interrupted: &dyn Fn() -> bool) -> DeployEnd {
        let mut times = Vec::new();
        let score = self.stages(is_interrupted, &mut times);
        DeployEnd { times, score }
    }

    fn stages(
        &self,
        is_interrupted: &dyn Fn() -> bool,
        times: &mut Vec<(Stage, f64)>,
    ) -> Result<Score, DeployError> {
        let mut begin = Instant::now();
        let mut done = |stage: Stage| {
            tracing::info!("done: {}", stage.in_words());
            times.push((stage, begin.elapsed().as_secs_f64()));
            begin = Instant::now();
        };
        let stopped = || {
            is_interrupted()
                .then_some(DeployError::Interrupted)
                .map_or(Ok(()), Err)
        };
        self.approach(is_interrupted)?;
        done(Stage::Approach);
        stopped()?;
        self.grip(Stage::Take, is_interrupted)?;
        done(Stage::Take);
        stopped()?;
        match self.laying {
            None => self.follow(Stage::Lay, "laying", &self.motion.laying, is_interrupted)?,
            Some(laying) => laying.lay(self, is_interrupted)?,
        }
        done(Stage::Lay);
        stopped()?;
        self.grip(Stage::LetGo, is_interrupted)?;
        std::thread::sleep(self.settling);
        done(Stage::LetGo);
        stopped()?;
        self.retreat(is_interrupted)?;
        done(Stage::Retreat);
        stopped()?;
        let failed = |stage: Stage, reason: String| DeployError::Failed { stage, reason };
        let picture = next_picture(self.cell).map_err(|reason| failed(Stage::Look, reason))?;
        self.write("picture.png", &encode_picture(&picture))?;
        done(Stage::Look);
        let seen = |error: VisionError| failed(Stage::Score, error.to_string());
        let found = self.seen(&picture).map_err(seen)?;
        let shown = overlay(&picture, &found.trace);
        self.write("overlay.png", &encode_picture(&shown))?;
        let strands = centrelines_csv(&found.trace.strands, None).map_err(seen)?;
        self.write("centrelines.csv", strands.as_bytes())?;
        let rod = found.longest(self.start()).map_err(seen)?;
        self.write("rod.csv", pattern_csv(&rod).as_bytes())?;
        let lead_in = self.path.lead_in;
        let score = score_of(&rod, self.pattern, lead_in, SCORE_POINTS).map_err(seen)?;
        let figure = score_figure(&score, "the rod", "the pattern");
        self.write("score.svg", figure.svg(&Paper::default()).as_bytes())?;
        done(Stage::Score);
        Ok(score)
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

    fn approach(&self, is_interrupted: &dyn Fn() -> bool) -> Result<(), DeployError> {
        let failed = |reason: String| DeployError::Failed {
            stage: Stage::Approach,
            reason,
        };
        let way = self
            .straight(&self.motion.laying.points[0])
            .map_err(failed)?;
        way.map_or(Ok(()), |way| {
            self.follow(Stage::Approach, "approach", &way, is_interrupted)
        })
    }

    /// To the posture at rest, so that the camera sees the rod. Where something is in the way the arm stays: the rod lies already.
    fn retreat(&self, is_interrupted: &dyn Fn() -> bool) -> Result<(), DeployError> {
        let failed = |reason: String| DeployError::Failed {
            stage: Stage::Retreat,
            reason,
        };
        let home = &self.cell.arms[self.arm].home;
        let Some(way) = self.straight(home).map_err(failed)? else {
            return Ok(());
        };
        if let Err(reason) = self.cell.prepare_stream(std::slice::from_ref(&way)) {
            tracing::warn!("the arm stays where it is, perhaps in the picture: {reason}");
            return Ok(());
        }
        self.follow(Stage::Retreat, "retreat", &way, is_interrupted)
    }

    /// From where the arm stands to some joints, each straight; `None` where it is there already.
    fn straight(&self, to: &[f64]) -> Result<Option<JointTrajectory>, String> {
        let from = self.cell.stands(self.arm)?;
        let way = self.cell.approach(self.arm, &from, to, self.approach_speed);
        way.map_err(|error| error.to_string())
    }

    /// Streams a motion; its log is a folder of the results.
    pub(super) fn follow(
        &self,
        stage: Stage,
        folder: &str,
        trajectory: &JointTrajectory,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DeployError> {
        let failed = |reason: String| DeployError::Failed { stage, reason };
        let folder = self.directory.join(folder);
        let made = std::fs::create_dir_all(&folder);
        made.map_err(|error| failed(format!("{} cannot be made: {error}", folder.display())))?;
        write_whole(
            &folder.join("trajectory.csv"),
            trajectory.to_csv().as_bytes(),
        )?;
        let prepared = self.cell.prepare_stream(std::slice::from_ref(trajectory));
        let (mut parts, _) = prepared.map_err(failed)?;
        let unwritable = |error: std::io::Error| {
            failed(format!("{} cannot be written: {error}", folder.display()))
        };
        let mut log = StreamLog::open(&folder).map_err(unwritable)?;
        if let Some(unfinished) = self.unfinished {
            let marked = unfinished.mark();
            marked
                .map_err(|error| failed(format!("the task cannot be marked as begun: {error}")))?;
        }
        let bounds = self.cell.stream_bounds();
        let ending = stream(&mut parts, &bounds, is_interrupted, &mut log);
        let logged = log.finish();
        match ending {
            Ending::Finished => logged.map_err(unwritable),
            Ending::Interrupted => Err(DeployError::Interrupted),
            Ending::Failed(reason) => Err(failed(reason)),
        }
    }

    fn grip(&self, stage: Stage, is_interrupted: &dyn Fn() -> bool) -> Result<(), DeployError> {
        let failed = |reason: String| DeployError::Failed { stage, reason };
        let Some((gripper, [open, closed])) = self.cell.gripper(self.arm) else {
            return Err(failed("the arm has no gripper in the cell file".into()));
        };
        let opening = if stage == Stage::Take { closed } else { open };
        let moved = gripper.command(opening, GRIPPER, is_interrupted);
        moved.map_err(|error| {
            if is_interrupted() {
                DeployError::Interrupted
            } else {
                failed(error.to_string())
            }
        })
    }

    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        write_whole(&self.directory.join(name), bytes)
    }
}
