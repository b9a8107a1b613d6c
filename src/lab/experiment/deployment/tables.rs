//! The tables of a deployment, and the plan made from them.

use super::keys::Deployment;
use super::paths::DeploymentPaths;
use super::planned::PathError;
use crate::scenario::Scenario;
use serde::Serialize;
use std::sync::OnceLock;

/// Keys that this experiment reads.
#[derive(Serialize)]
pub struct DeploymentTables {
    /// Rods, patterns and grippers.
    pub deployment: Deployment,
    #[serde(skip)]
    paths: OnceLock<DeploymentPaths>,
}

impl DeploymentTables {
    /// The tables of a deployment.
    pub fn new(deployment: Deployment) -> Self {
        Self {
            deployment,
            paths: OnceLock::new(),
        }
    }

    /// The paths of the grippers in the scenario of these tables, planned only once.
    ///
    /// # Errors
    /// A pattern cannot be laid.
    pub fn paths(&self, scenario: &Scenario) -> Result<&DeploymentPaths, PathError> {
        if let Some(paths) = self.paths.get() {
            return Ok(paths);
        }
        // Patterns for which planning fails were rejected earlier.
        let (step, end) = scenario.time.steps().unwrap_or((None, 1.0));
        let friction = scenario.contact.friction();
        let laid_by = end - self.deployment.release.unwrap_or(0.0);
        let planned = DeploymentPaths::new(&self.deployment, friction, laid_by, step)?;
        Ok(self.paths.get_or_init(|| planned))
    }
}
