//! A knot tied in the virtual cell, with drivers and camera, by the task of `rodlab tie`.

use super::Result;
use super::applications::Application;
use super::cases::Case;
use super::virtual_laying::{MARGIN, RATE, SPEEDS, STEP, cell_beside, deployment_of};
use rodlab_lab::experiment::{Deployment, Jitter};
use rodlab_planning::plan::deployment::{LaidPath, Spare};
use rodlab_planning::plan::tying::{TiedRod, passages};
use rodlab_vision::ColourRule;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{
    KnotPlan, PlannedRod, Task, TaskRun, TieMotion, TieMotionRequest, TiePlan, TieScore, TieTask,
    Workplace, middle_of_table,
};
use rodlab_workcell::virtual_cell::{RodError, RodSupply, Settings, with_cell};
use std::path::Path;

/// The cell.
const CELL: &str = include_str!("../../scenarios/cells/two_gantries.toml");

/// Ties the knot of a simulated run, with the jitter of its seed, in the virtual cell. Errors are
/// messages.
pub(super) fn tie_in_cell(case: &Case<Application>) -> Result<Result<TieScore, String>> {
    let (deployment, friction) = deployment_of(&case.directory)?;
    let (cell, directory) = cell_beside(&case.directory, CELL, &[])?;
    let tied = tied(&deployment, friction, &cell, &directory);
    Ok(tied.map_err(|error| error.to_string()))
}

fn tied(
    deployment: &Deployment,
    friction: f64,
    cell: &Cell,
    directory: &Path,
) -> Result<TieScore, Box<dyn std::error::Error>> {
    let layings = deployment.layings();
    let mut rods = Vec::new();
    for laying in &layings {
        let rod = laying.rod.deployed();
        let way = (laying.scheme.into(), laying.solver.into());
        let path = LaidPath::new(laying.laid_pattern()?, &rod, &Spare::HANGS, STEP, way)?;
        rods.push(PlannedRod {
            rod,
            pattern: laying.whole_pattern()?,
            laying: path.poses,
        });
    }
    let words = deployment.knot.as_ref();
    let words = words.map_or(&[][..], |knot| &knot.crossings);
    let tied = rods.iter().map(|planned| TiedRod {
        rod: &planned.rod,
        curve: &planned.pattern,
    });
    let passages = passages(&tied.collect::<Vec<_>>(), words)?;
    let knot = KnotPlan::new(rods, passages);
    let outline = knot.rods.iter().flat_map(PlannedRod::points);
    let request = TieMotionRequest {
        cell,
        arms: [0, 1],
        place: middle_of_table(cell, &outline.collect::<Vec<_>>()).ok_or("the cell has a table")?,
        speed: SPEEDS[0],
        free_speed: SPEEDS[1],
        margin: MARGIN,
    };
    let motion = TieMotion::plan(&request, &knot)?;
    let supply = |number: usize| {
        let start = knot.rods[number].pattern.at(0.0).position;
        let supply = RodSupply::of(&layings[number], friction, motion.frame)?;
        Ok::<_, RodError>(supply.beginning_at(&motion.frame, start))
    };
    let second = (layings.len() > 1).then(|| supply(1));
    let jitter = Jitter::new(
        [deployment.jitter, deployment.jitter_angle],
        deployment.jitter_period,
        deployment.seed,
    );
    let settings = Settings {
        supply: Some(supply(0)?),
        second_supply: second.transpose()?,
        jitter: Some(jitter),
        ..Settings::empty(RATE)
    };
    let colour = ColourRule::parse("auto")?;
    let plan = TiePlan {
        arms: [0, 1],
        names: Vec::new(),
        motion,
        knot,
        free_speed: SPEEDS[1],
        colour,
    };
    let mut run = TaskRun::planned(TieTask::new(cell, plan), Vec::new());
    with_cell(cell, settings, |cell| {
        run.carry_out(&Workplace::alone(cell, directory))
    })?
    .0?;
    let score = run.task.record().score.clone();
    Ok(score.ok_or("a knot that was tied is scored")?)
}
