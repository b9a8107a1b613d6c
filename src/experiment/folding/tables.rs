//! The tables of a fold, and what is planned of them.

use super::gripper_path::GripperPath;
use super::keys::Folding;
use crate::plan::fold::{FoldError, FoldPlanner};
use crate::scenario::{Scenario, Step, Time};
use serde::Serialize;
use std::sync::OnceLock;

/// Everything that this experiment reads.
#[derive(Serialize)]
pub struct FoldingTables {
    /// What is folded, and how.
    pub folding: Folding,
    #[serde(skip)]
    path: OnceLock<GripperPath>,
}

impl FoldingTables {
    /// The tables of a fold.
    pub fn new(folding: Folding) -> Self {
        Self {
            folding,
            path: OnceLock::new(),
        }
    }

    /// The path of the gripper in the scenario of these tables, planned once.
    ///
    /// # Errors
    /// The crease target cannot be reached.
    pub fn path(&self, scenario: &Scenario) -> Result<&GripperPath, FoldError> {
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
        let planner = planner(&self.folding, scenario.contact.friction());
        let tolerance = scenario.contact.distance_tolerance().unwrap_or(0.0);
        let planned = GripperPath::new(&self.folding, &planner, tolerance, end, step)?;
        Ok(self.path.get_or_init(|| planned))
    }
}

/// What plans a fold on a table.
pub fn planner(folding: &Folding, friction: f64) -> FoldPlanner {
    let sheet = folding.believed().dimensionless();
    FoldPlanner::new(sheet, folding.algorithm.on(friction))
}
