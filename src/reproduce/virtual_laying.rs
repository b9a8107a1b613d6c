//! A rod laid along a pattern in the virtual cell, with drivers and camera, by the task of `rodlab
//! deploy`.

use super::Result;
use super::applications::Application;
use super::cases::Case;
use super::laying::{FRICTIONS, Laying, RODS};
use rodlab_files::results::{ResultsError, SCENARIO, write_whole};
use rodlab_lab::experiment::{
    Deployment, DeploymentTables, Fixtures, Jitter, PassedPegs, from_text,
};
use rodlab_planning::plan::deployment::{
    DeployedRod, DeploymentError, LaidPath, OptimalGrasps, Scheme,
};
use rodlab_planning::plan::pattern::{PatternError, PatternSource};
use rodlab_robot::Pose;
use rodlab_vision::{ColourRule, Point, Score, VisionError};
use rodlab_workcell::cell::{Cell, PlanError};
use rodlab_workcell::task::{
    Correction, DeployPlan, DeployTask, MotionRequest, Task, TaskError, TaskRun, Workplace,
    middle_of_table,
};
use rodlab_workcell::virtual_cell::{RodError, RodSupply, ServeError, Settings, with_cell};
use std::fs;
use std::path::{Path, PathBuf};

/// The cell.
const CELL: &str = include_str!("../../scenarios/cells/gantry.toml");
/// Speed of the cell relative to real time.
pub(super) const RATE: f64 = 10.0;
/// Period of the fastest jitter, s, as in the plain simulation.
const JITTER_PERIOD: f64 = 1.0;
/// Distance between poses along the pattern, m.
pub(super) const STEP: f64 = 3e-3;
/// Speed of the hand during laying and otherwise, m/s, as in `rodlab deploy`.
pub(super) const SPEEDS: [f64; 2] = [0.03, 0.1];
/// Smallest distance of the arm to obstacles, m, as in `rodlab deploy`.
pub(super) const MARGIN: f64 = 0.01;

/// Reason why laying a rod failed.
#[derive(Debug, thiserror::Error)]
pub(super) enum LayingError {
    /// The cell cannot be served, or stopped early.
    #[error(transparent)]
    Served(#[from] ServeError),
    /// The cell has no rod.
    #[error(transparent)]
    Rod(#[from] RodError),
    /// The pattern is invalid.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// The pattern cannot be laid.
    #[error(transparent)]
    Path(#[from] DeploymentError),
    /// The arm cannot follow the path.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The motion failed.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// No rod was detected.
    #[error(transparent)]
    Vision(#[from] VisionError),
}

/// A laid rod.
pub(super) struct LaidInCell {
    /// Distance of the rod from its pattern, according to the camera.
    pub score: Score,
    /// The pegs that the rod passes, according to the camera.
    pub pegs: Option<PassedPegs>,
    /// Duration of laying, s.
    pub duration: f64,
}

/// Lays the rod of a simulated run, along the same pattern and with the same disturbances, in the
/// virtual cell. Pictures and logs are written to a folder next to the run.
pub(super) fn lay_in_cell(case: &Case<Laying>) -> Result<Result<LaidInCell, LayingError>> {
    let disturbance = case.run.disturbance;
    let (deployment, _) = deployment_of(&case.directory)?;
    let files = [("rod.toml", RODS[case.run.rod].file())];
    let (cell, directory) = cell_beside(&case.directory, CELL, &files)?;
    let rod = deployment.rod.deployed();
    let laying = LayingInCell {
        source: &deployment.pattern.source(),
        lead_in: deployment.lead_in,
        // The rod as assumed in the plan.
        rod: &DeployedRod {
            gravito_bending_length: rod.gravito_bending_length * (1.0 + disturbance.length_error),
            ..rod
        },
        way: (Scheme::Optimal, OptimalGrasps::Exact),
        fixtures: None,
        is_corrected: disturbance.correction.is_some(),
        directory: &directory,
    };
    let jitter = (disturbance.jitter > 0.0)
        .then(|| Jitter::new([disturbance.jitter, 0.0], JITTER_PERIOD, disturbance.seed));
    let file = directory.join("rod.toml");
    let friction = FRICTIONS[case.run.friction];
    Ok(laying.in_cell(&cell, jitter, |_| Ok(RodSupply::new(&file, friction)?)))
}

/// Lays the cable of a simulated run between its pegs, with the jitter of its seed, in the virtual
/// cell.
pub(super) fn place_in_cell(case: &Case<Application>) -> Result<Result<LaidInCell, LayingError>> {
    let (deployment, friction) = deployment_of(&case.directory)?;
    let (cell, directory) = cell_beside(&case.directory, CELL, &[])?;
    let fixtures = Fixtures::of(&deployment).expect("a pattern that was laid");
    let laying = LayingInCell {
        source: &deployment.pattern.source(),
        lead_in: deployment.lead_in,
        rod: &deployment.rod.deployed(),
        way: (deployment.scheme.into(), deployment.solver.into()),
        fixtures: Some(&fixtures),
        is_corrected: false,
        directory: &directory,
    };
    let jitter = Jitter::new(
        [deployment.jitter, deployment.jitter_angle],
        deployment.jitter_period,
        deployment.seed,
    );
    Ok(laying.in_cell(&cell, Some(jitter), |frame| {
        Ok(RodSupply::of(&deployment, friction, *frame)?)
    }))
}

/// The task of a simulated run, and the friction of its table.
pub(super) fn deployment_of(run: &Path) -> Result<(Deployment, f64)> {
    let scenario = fs::read_to_string(run.join(SCENARIO)).map_err(ResultsError::io("read", run))?;
    let loaded = from_text("scenario", &scenario, Path::new(""), &[]);
    let loaded = loaded.expect("the scenario of a run");
    let tables: Option<&DeploymentTables> = loaded.scenario.experiment.tables();
    let deployment = tables.expect("a rod that is laid").deployment.clone();
    Ok((deployment, loaded.scenario.contact.friction()))
}

/// Reads a cell whose file, with other files, is written to a folder next to a run.
pub(super) fn cell_beside(
    run: &Path,
    file: &str,
    files: &[(&str, &str)],
) -> Result<(Cell, PathBuf)> {
    let mut name = run.file_name().unwrap_or_default().to_owned();
    name.push("-cell");
    let directory = run.with_file_name(name);
    fs::create_dir_all(&directory).map_err(ResultsError::io("create", &directory))?;
    for (name, text) in [("cell.toml", file)].iter().chain(files) {
        write_whole(&directory.join(name), text.as_bytes())?;
    }
    let cell = Cell::read(&directory.join("cell.toml")).expect("a cell of this program");
    Ok((cell, directory))
}

/// The task of laying.
struct LayingInCell<'a> {
    source: &'a PatternSource,
    lead_in: f64,
    /// The rod as assumed in the plan.
    rod: &'a DeployedRod,
    /// Scheme of the gripper, and solver for the grasps.
    way: (Scheme, OptimalGrasps<'a>),
    fixtures: Option<&'a Fixtures>,
    is_corrected: bool,
    directory: &'a Path,
}

impl LayingInCell<'_> {
    /// Lays the rod in a served cell with jitter of the hands. The rods of the cell are defined in
    /// the frame of the pattern.
    fn in_cell(
        &self,
        cell: &Cell,
        jitter: Option<Jitter>,
        supply: impl Fn(&Pose) -> Result<RodSupply, LayingError>,
    ) -> Result<LaidInCell, LayingError> {
        let plan = self.plan(cell)?;
        let frame = plan.motion.frame;
        let supply = supply(&frame)?.beginning_at(&frame, plan.path.points[0].position);
        let settings = Settings {
            supply: Some(supply),
            jitter,
            ..Settings::empty(RATE)
        };
        let duration = plan.motion.report.duration_s;
        let correction = self
            .is_corrected
            .then(|| Correction::usual(self.rod.gravito_bending_length, SPEEDS[0]));
        let mut run = TaskRun::planned(DeployTask::new(cell, plan, correction), Vec::new());
        with_cell(cell, settings, |cell| {
            run.carry_out(&Workplace::alone(cell, self.directory))
        })?
        .0?;
        Ok(LaidInCell {
            score: run.task.laid().expect("it is scored").clone(),
            pegs: run.task.record().pegs,
            duration,
        })
    }

    fn plan(&self, cell: &Cell) -> Result<DeployPlan, LayingError> {
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
            let path = LaidPath::new(pattern, self.rod, spare, STEP, self.way)?;
            Ok::<_, LayingError>(((), path))
        })?;
        Ok(DeployPlan {
            arm: 0,
            motion,
            approach_speed: SPEEDS[1],
            name: String::new(),
            pattern: outline,
            path,
            rod: *self.rod,
            colour: ColourRule::parse("auto")?,
            fixtures: self.fixtures.cloned(),
        })
    }
}
