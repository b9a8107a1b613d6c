//! A rod laid along a pattern in the virtual cell, through drivers and camera, by the task of `rodlab deploy`.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{FRICTIONS, Laying, RODS};
use super::served_cell::{ANY_PORT, with_cell};
use crate::cell::{Cell, PlanError};
use crate::experiment::{DeploymentTables, Jitter, from_text};
use crate::plan::deployment::{DeployedRod, DeploymentError, LaidPath};
use crate::plan::pattern::{PatternError, PatternSource};
use crate::results::{ResultsError, SCENARIO, write_whole};
use crate::task::{
    Correction, DeployError, DeployMotion, DeployTask, LayingMethod, MotionRequest, SETTLING,
    middle_of_table,
};
use crate::virtual_cell::{Response, RodError, RodSupply, ServeError, Settings};
use crate::vision::{ColourRule, Point, Score, VisionError};
use std::fs;
use std::path::Path;

/// The cell.
const CELL: &str = include_str!("../../scenarios/cells/gantry.toml");
/// How many times as fast as real time it is.
const RATE: f64 = 10.0;
/// Period of the fastest jitter, s: that of the plain simulation.
const JITTER_PERIOD: f64 = 1.0;
/// Distance of poses along the pattern, m.
const STEP: f64 = 3e-3;
/// Speeds of the hand while it lays and on its way, m/s, and least distance of the arm to anything, m: those of `rodlab deploy`.
const SPEEDS: [f64; 2] = [0.03, 0.1];
const MARGIN: f64 = 0.01;

/// Why a rod was not laid.
#[derive(Debug, thiserror::Error)]
pub(super) enum LayingError {
    /// The cell cannot be served, or not to the end.
    #[error(transparent)]
    Served(#[from] ServeError),
    /// It has no rod.
    #[error(transparent)]
    Rod(#[from] RodError),
    /// The pattern is none.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// It cannot be laid.
    #[error(transparent)]
    Path(#[from] DeploymentError),
    /// The arm cannot follow.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Something went wrong on the way.
    #[error(transparent)]
    Task(#[from] DeployError),
    /// No rod can be seen.
    #[error(transparent)]
    Vision(#[from] VisionError),
}

/// A rod that was laid.
pub(super) struct LaidInCell {
    /// How far it lies from its pattern, by the camera.
    pub score: Score,
    /// How long the arm laid it, s.
    pub duration: f64,
}

/// Lays the rod of a run that was simulated, along the same pattern and with the same disturbances, in the virtual cell. Pictures and
/// logs go into a folder beside the run.
pub(super) fn lay_in_cell(
    case: &Case<Laying>,
) -> Result<Result<LaidInCell, LayingError>, ReproduceError> {
    let scenario = fs::read_to_string(case.directory.join(SCENARIO))
        .map_err(ResultsError::io("read", &case.directory))?;
    let loaded = from_text("scenario", &scenario, Path::new(""), &[]);
    let loaded = loaded.expect("the scenario of a run");
    let tables: Option<&DeploymentTables> = loaded.scenario.experiment.tables();
    let deployment = &tables.expect("a rod that is laid").deployment;
    let mut name = case.directory.file_name().unwrap_or_default().to_owned();
    name.push("-cell");
    let directory = case.directory.with_file_name(name);
    fs::create_dir_all(&directory).map_err(ResultsError::io("create", &directory))?;
    let files = [("cell.toml", CELL), ("rod.toml", RODS[case.run.rod].file())];
    for (name, text) in files {
        write_whole(&directory.join(name), text.as_bytes())?;
    }
    let cell = Cell::read(&directory.join("cell.toml")).expect("a cell of this program");
    let supply = RodSupply::new(&directory.join("rod.toml"), FRICTIONS[case.run.friction]);
    let disturbance = case.run.disturbance;
    let rod = deployment.rod.deployed();
    let believed = DeployedRod {
        gravito_bending_length: rod.gravito_bending_length * (1.0 + disturbance.length_error),
        ..rod
    };
    let laying = Laid {
        source: &deployment.pattern.source(),
        lead_in: deployment.lead_in,
        rod: &believed,
        is_corrected: disturbance.correction.is_some(),
        directory: &directory,
    };
    let jitter = (disturbance.jitter > 0.0)
        .then(|| Jitter::new([disturbance.jitter, 0.0], JITTER_PERIOD, disturbance.seed));
    let served = || -> Result<LaidInCell, LayingError> {
        let planned = laying.plan(&cell)?;
        let start = planned.path.points[0].position;
        let start = planned.motion.frame * nalgebra::Point3::new(start.x, start.y, 0.0);
        let settings = Settings {
            address: ANY_PORT.into(),
            token: None,
            rate: RATE,
            response: Response::default(),
            // As in the laboratory: a person lays the free end where the rod is to begin.
            supply: Some(supply?.with_free_end([start.x, start.y])),
            second_supply: None,
            sheet: None,
            chucked: None,
            jitter,
            faults: Vec::new(),
        };
        let (laid, _) = with_cell(&cell, settings, |cell| laying.lay(cell, &planned))?;
        laid
    };
    Ok(served())
}

/// What is laid.
struct Laid<'a> {
    source: &'a PatternSource,
    lead_in: f64,
    /// The rod as it is believed to be.
    rod: &'a DeployedRod,
    is_corrected: bool,
    directory: &'a Path,
}

impl Laid<'_> {
    fn plan(&self, cell: &Cell) -> Result<Planned, LayingError> {
        let drawn = self.source.pattern()?.sampled(STEP);
        let outline: Vec<Point> = drawn.iter().map(|point| point.position).collect();
        let place = middle_of_table(cell, &outline).expect("the gantry has a table");
        let request = MotionRequest {
            cell,
            arm: 0,
            place,
            speed: SPEEDS[0],
            margin: MARGIN,
        };
        let ((), path, motion) = request.plan(|spare| {
            let pattern = self.source.pattern()?.with_lead_in(self.lead_in);
            Ok::<_, LayingError>(((), LaidPath::new(pattern, self.rod, spare, STEP)?))
        })?;
        Ok(Planned {
            outline,
            path,
            motion,
        })
    }

    fn lay(&self, cell: &Cell, planned: &Planned) -> Result<LaidInCell, LayingError> {
        let correction = self
            .is_corrected
            .then(|| Correction::usual(self.rod.gravito_bending_length, SPEEDS[0]));
        let task = DeployTask {
            cell,
            arm: 0,
            motion: &planned.motion,
            approach_speed: SPEEDS[1],
            pattern: &planned.outline,
            path: &planned.path,
            rod: self.rod,
            colour: &ColourRule::parse("auto")?,
            laying: correction.as_ref().map(|way| way as &dyn LayingMethod),
            unfinished: None,
            settling: SETTLING.div_f64(RATE),
            directory: self.directory,
        };
        Ok(LaidInCell {
            score: task.run(&|| false).score?,
            duration: planned.motion.report.duration_s,
        })
    }
}

/// What is known before anything moves.
struct Planned {
    outline: Vec<Point>,
    path: LaidPath,
    motion: DeployMotion,
}
