//! Laying a rod by an arm of a cell, common to `rodlab deploy` and `rodlab place`.

use super::prelude::*;
use rodlab_lab::experiment::Fixtures;
use rodlab_planning::plan::deployment::{DeployedRod, LaidPath, Spare};
use rodlab_robot::Pose;
use rodlab_vision::{ColourRule, Point};
use rodlab_workcell::cell::Place;
use rodlab_workcell::task::{
    Correction, DeployPlan, DeployTask, MotionRequest, Planning, TaskArguments, Way,
};
use rodlab_workcell::virtual_cell::RodSupply;

/// Choice of the arm, and its motion.
#[derive(Debug, Args)]
pub struct LayingArguments {
    /// Name of the arm; optional if the cell has only one
    #[arg(long, value_name = "NAME")]
    pub arm: Option<String>,
    #[command(flatten)]
    pub task: TaskArguments,
}

/// Rod and pattern to lay.
pub struct Laying<'a> {
    /// Name of the pattern in reports.
    pub name: &'a str,
    /// The pattern without lead-in and lead-out, m.
    pub outline: Vec<Point>,
    /// Place of its frame; `None` for that of the arguments.
    pub place: Option<Place>,
    /// Folder of the results for the plan.
    pub folder: &'a str,
    /// Pegs between which the rod is laid.
    pub fixtures: Option<Fixtures>,
    /// Whether the path is replanned from pictures of the rod.
    pub is_corrected: bool,
    /// Supplies the rod for the gripper of a virtual cell, given the pose of the pattern in the cell.
    pub supply: &'a dyn Fn(Pose) -> Result<RodSupply, Failure>,
}

impl LayingArguments {
    /// Returns the options of the run.
    pub fn way(&self) -> Way<'_> {
        Way {
            arm: self.arm.as_deref(),
            ..self.task.way()
        }
    }

    /// Plans how to lay a rod along the path that `plan` returns for the available room. `plan`
    /// also writes the path to a directory.
    pub fn plan(
        &self,
        planning: &Planning<'_>,
        arm: usize,
        laying: Laying<'_>,
        plan: impl Fn(&Spare<'_>, &Path) -> Result<(DeployedRod, LaidPath), Failure>,
    ) -> Result<DeployTask, Failure> {
        let colour = ColourRule::parse(&self.task.colour)?;
        let request = MotionRequest {
            cell: planning.cell,
            arm,
            place: match laying.place {
                Some(place) => place,
                None => self.task.place(planning.cell, &laying.outline)?,
            },
            speed: self.task.hand_speed,
            margin: self.task.margin,
        };
        let directory = planning.directory()?.join(laying.folder).join("plan");
        let (rod, path, motion) = request.plan(|spare| plan(spare, &directory))?;
        planning.furnish(|settings| -> Result<(), Failure> {
            let supply = (laying.supply)(motion.frame)?;
            let supply = supply.beginning_at(&motion.frame, path.points[0].position);
            match settings.supply {
                Some(_) => settings.further.push(supply),
                None => settings.supply = Some(supply),
            }
            settings.rods_stay = !settings.further.is_empty();
            Ok(())
        })?;
        let speed = self.task.hand_speed;
        let correction = laying
            .is_corrected
            .then(|| Correction::usual(rod.gravito_bending_length, speed));
        let plan = DeployPlan {
            arm,
            motion,
            approach_speed: self.task.approach_speed,
            name: laying.name.to_owned(),
            pattern: laying.outline,
            path,
            rod,
            colour,
            fixtures: laying.fixtures,
        };
        Ok(DeployTask::new(planning.cell, plan, correction))
    }
}
