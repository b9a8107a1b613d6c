//! The tables of a deployment, and what is planned of them.

use super::gripper_path::GripperPath;
use super::keys::Deployment;
use super::planned::PathError;
use crate::scenario::{Scenario, Step, Time};
use serde::Serialize;
use std::sync::OnceLock;

/// Everything that this experiment reads.
#[derive(Serialize)]
pub struct DeploymentTables {
    /// What is laid, and how.
    pub deployment: Deployment,
    #[serde(skip)]
    path: OnceLock<GripperPath>,
}

impl DeploymentTables {
    /// The tables of a deployment.
    pub fn new(deployment: Deployment) -> Self {
        Self {
            deployment,
            path: OnceLock::new(),
        }
    }

    /// The path of the gripper in the scenario of these tables, planned once.
    ///
    /// # Errors
    /// The pattern cannot be laid.
    pub fn path(&self, scenario: &Scenario) -> Result<&GripperPath, PathError> {
        if let Some(path) = self.path.get() {
            return Ok(path);
        }
        let (step, end) = match scenario.time {
            Time::Dynamic {
                step: Step::Fixed(step),
                end,
                ..
            } => (Some(step), end),
            Time::Dynamic { end, .. } => (None, end),
            // Refused before.
            Time::Static | Time::Continuation => (None, 1.0),
        };
        let friction = scenario.contact.friction();
        let laid_by = end - self.deployment.release.unwrap_or(0.0);
        let planned = GripperPath::new(&self.deployment, friction, laid_by, step)?;
        Ok(self.path.get_or_init(|| planned))
    }
}
