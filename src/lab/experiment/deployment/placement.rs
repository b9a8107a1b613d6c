//! A cable that is laid between pegs, read from a scenario.

use super::fixtures::Fixtures;
use super::keys::Deployment;
use super::planned::PathError;
use super::tables::DeploymentTables;
use crate::experiment::load;
use crate::scenario::ScenarioError;
use rodlab_files::finite::NotFinite;
use rodlab_files::results::SCENARIO;
use rodlab_planning::plan::deployment::{LaidPath, Spare, friction_demands, timed, times};
use rodlab_planning::plan::files::{path_files, trajectory_csv};
use rodlab_planning::plan::pattern::{PatternError, crossings};
use rodlab_planning::plan::request::DeploymentRequest;
use std::path::Path;
use thiserror::Error;

/// A cable and its pegs.
pub struct Placement {
    /// Name of the placement for readers.
    pub title: String,
    /// The resolved scenario as text.
    text: String,
    /// The cable and its pattern.
    pub deployment: Deployment,
    /// Friction of the table.
    pub friction: f64,
    /// The pegs.
    pub fixtures: Fixtures,
}

/// Reason why a scenario does not describe a cable that is laid between pegs.
#[derive(Debug, Error)]
pub enum PlacementError {
    /// It is faulty.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The pattern of the placement is invalid.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// The scenario cannot be used for placement.
    #[error("{0}")]
    Unfit(&'static str),
}

impl Placement {
    /// Reads a scenario.
    ///
    /// # Errors
    /// The scenario is faulty, or does not describe a cable that is laid between pegs.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, PlacementError> {
        let scenario = load(path, overrides)?.scenario;
        let tables: Option<&DeploymentTables> = scenario.experiment.tables();
        let deployment = &tables
            .ok_or(PlacementError::Unfit(
                "a scenario of the experiment \"deployment\" is needed, with pegs or clips",
            ))?
            .deployment;
        if deployment.pegs.is_empty() {
            return Err(PlacementError::Unfit(
                "it has neither [deployment.clips] nor [[deployment.pegs]]; `rodlab deploy` lays a \
                 rod without pegs",
            ));
        }
        if deployment.knot.is_some() || deployment.second.is_some() {
            return Err(PlacementError::Unfit(
                "only a single rod without a knot can be placed: leave out [deployment.knot] and \
                 [deployment.second]",
            ));
        }
        Ok(Self {
            title: scenario.title.clone(),
            text: scenario.to_toml(),
            friction: scenario.contact.friction(),
            deployment: deployment.clone(),
            fixtures: Fixtures::of(deployment)?,
        })
    }

    /// The path of the gripper, which keeps the part of the rod beyond the pattern within the given
    /// space.
    ///
    /// # Errors
    /// The cable cannot be laid along its pattern.
    pub fn path(&self, spare: &Spare<'_>) -> Result<LaidPath, PathError> {
        let laid = &self.deployment;
        let step = DeploymentRequest::default().step;
        let way = (laid.scheme.into(), laid.solver.into());
        let pattern = laid.whole_pattern()?;
        Ok(LaidPath::new(
            pattern,
            &laid.rod.deployed(),
            spare,
            step,
            way,
        )?)
    }

    /// The files of a plan with their names.
    ///
    /// # Errors
    /// A pose is not finite.
    pub fn files(&self, path: &LaidPath) -> Result<[(String, String); 4], NotFinite> {
        let demands = friction_demands(&self.deployment.rod.deployed(), &path.points, &path.poses);
        let crossings = crossings(&path.points);
        let friction = Some(self.friction);
        let [pattern, figure] = path_files(&self.title, path, &demands, &crossings, friction);
        let times = times(&path.poses, DeploymentRequest::default().speed);
        let trajectory = trajectory_csv(&timed(&path.poses, &times))?;
        Ok([
            (SCENARIO.to_owned(), self.text.clone()),
            ("trajectory.csv".to_owned(), trajectory),
            pattern,
            figure,
        ])
    }
}
