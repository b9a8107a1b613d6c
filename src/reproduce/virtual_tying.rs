//! A knot tied in the virtual cell, through drivers and camera, by the task of `rodlab tie`.

use super::ReproduceError;
use super::applications::Application;
use super::cases::Case;
use super::served_cell::{ANY_PORT, with_cell};
use super::virtual_laying::{MARGIN, RATE, SPEEDS, STEP, cell_beside, deployment_of};
use crate::cell::Cell;
use crate::experiment::{Deployment, Jitter};
use crate::plan::deployment::{LaidPath, Spare};
use crate::plan::tying::{TiedRod, laid_length, passages};
use crate::task::{KnotPlan, SETTLING, TieMotionRequest, TieScore, TieTask, middle_of_table};
use crate::virtual_cell::{Response, RodSupply, Settings};
use crate::vision::ColourRule;
use std::path::Path;

/// The cell.
const CELL: &str = include_str!("../../scenarios/cells/two_gantries.toml");

/// Ties the knot of a run that was simulated, with the trembling of its seed, in the virtual cell; why it came to nothing is in words.
pub(super) fn tie_in_cell(
    case: &Case<Application>,
) -> Result<Result<TieScore, String>, ReproduceError> {
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
    let rod = deployment.rod.deployed();
    let words = deployment
        .knot
        .as_ref()
        .map_or(&[][..], |knot| &knot.crossings);
    let whole = deployment.whole_pattern()?;
    let tied = TiedRod {
        rod: &rod,
        curve: &whole,
    };
    let passages = passages(&[tied], words)?;
    let laid = deployment.whole_pattern()?.shortened(laid_length(&rod));
    let way = (deployment.scheme.into(), deployment.solver.into());
    let path = LaidPath::new(laid, &rod, &Spare::HANGS, STEP, way)?;
    let last = path.poses.last().ok_or("a path without poses")?;
    let knot = KnotPlan::new(&rod, whole, passages, last);
    let request = TieMotionRequest {
        cell,
        arms: [0, 1],
        place: middle_of_table(cell, &knot.points).ok_or("the cell has a table")?,
        speed: SPEEDS[0],
        free_speed: SPEEDS[1],
        margin: MARGIN,
    };
    let motion = request.plan(&path.poses, &knot)?;
    let start = motion.frame * nalgebra::Point3::new(knot.points[0].x, knot.points[0].y, 0.0);
    let supply = RodSupply::of(deployment, friction, motion.frame)?;
    let jitter = Jitter::new(
        [deployment.jitter, deployment.jitter_angle],
        deployment.jitter_period,
        deployment.seed,
    );
    let settings = Settings {
        address: ANY_PORT.into(),
        token: None,
        rate: RATE,
        response: Response::default(),
        // As in the laboratory: a person lays the free end where the pattern begins.
        supply: Some(supply.with_free_end([start.x, start.y])),
        sheet: None,
        chucked: None,
        jitter: Some(jitter),
        faults: Vec::new(),
    };
    let colour = ColourRule::parse("auto")?;
    let (end, _) = with_cell(cell, settings, |cell| {
        let task = TieTask {
            cell,
            arms: [0, 1],
            motion: &motion,
            knot: &knot,
            free_speed: SPEEDS[1],
            rod: &rod,
            colour: &colour,
            unfinished: None,
            settling: SETTLING.div_f64(RATE),
            directory,
        };
        task.run(&|| false)
    })?;
    Ok(end.score?)
}
