//! The tables of a fold, and the plan made from them.

use super::gripper_path::GripperPath;
use super::keys::Folding;
use crate::experiment::load;
use crate::scenario::Scenario;
use rodlab_files::results::SCENARIO;
use rodlab_planning::plan::fold::{FoldError, FoldPlanner, Sheet};
use serde::Serialize;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Keys that this experiment reads.
#[derive(Serialize)]
pub struct FoldingTables {
    /// Sheet, crease and gripper.
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

    /// The path of the gripper in the scenario of these tables, planned only once.
    ///
    /// # Errors
    /// The crease target cannot be reached.
    pub fn path(&self, scenario: &Scenario) -> Result<&GripperPath, FoldError> {
        if let Some(path) = self.path.get() {
            return Ok(path);
        }
        // Targets for which planning fails were rejected earlier.
        let (step, end) = scenario.time.steps().unwrap_or((None, 1.0));
        let planner = planner(&self.folding, scenario.contact.friction());
        let tolerance = scenario.contact.distance_tolerance().unwrap_or(0.0);
        let planned = GripperPath::new(&self.folding, &planner, tolerance, end, step)?;
        Ok(self.path.get_or_init(|| planned))
    }
}

/// Dimensionless planning problem of the fold in a results directory: the sheet as the planner
/// assumes it, and the crease target. `None` if it is not a fold.
pub fn planned_fold(directory: &Path) -> Option<(Sheet, f64)> {
    let scenario = load(&directory.join(SCENARIO), &[]).ok()?.scenario;
    let FoldingTables { folding, .. } = scenario.experiment.tables()?;
    let sheet = folding.believed();
    let target = folding.target() / sheet.gravito_bending_length;
    Some((sheet.dimensionless(), target))
}

/// Planner of a fold on a table.
pub fn planner(folding: &Folding, friction: f64) -> Arc<FoldPlanner> {
    let sheet = folding.believed().dimensionless();
    FoldPlanner::shared(sheet, folding.algorithm.on(friction))
}
