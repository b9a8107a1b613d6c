//! `rodlab fold` in a robot cell.

use super::cell_task::CellTask;
use super::chosen_cell::FULL_SPEED;
use super::fold_arguments::FoldArguments;
use super::prelude::*;
use super::solve_arm::arm_named;
use super::task_arguments::GANTRY;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use rodlab_lab::experiment::{Crease, PaperFile};
use rodlab_robot::Pose;
use rodlab_vision::ColourRule;
use rodlab_workcell::cell::{Cell, Place};
use rodlab_workcell::task::{
    FoldMotionRequest, FoldRecord, FoldRequest, FoldTask, FoldWay, TaskHead, heading,
};
use rodlab_workcell::virtual_cell::{Settings, SheetPlace, SimulatedSheet};

/// Parts of a way that is not planned anew: after each the camera looks.
const WATCHED_PARTS: u16 = 5;
/// Most parts of a way: in each the arm starts and stops.
const MOST_PARTS: u16 = 20;
/// Frames of the page of the arm in motion.
const FRAMES: usize = 400;

/// Folds a sheet with an arm, or shows how it would.
pub fn fold_in_cell(
    arguments: &FoldArguments,
    file: &PaperFile,
    target: f64,
    friction: f64,
) -> Result<(), Failure> {
    let parts = arguments.feedback.unwrap_or(WATCHED_PARTS);
    if parts > MOST_PARTS {
        let message = format!("--feedback: {parts}; allowed in a cell: 2 to {MOST_PARTS}");
        return Err(Failure::Input(message));
    }
    let chosen = arguments.choice.read(GANTRY, arguments.dry_run)?;
    let cell = &chosen.cell;
    let arm = arm_named(cell, "--arm", arguments.arm.as_deref(), &chosen.file)?;
    if !arguments.dry_run {
        let camera = "it looks where the sheet lies and how far it slides";
        chosen.refuse_unready(&[arm], arguments.checked, camera)?;
    }
    let colour = ColourRule::parse(&arguments.colour)?;
    let request = FoldRequest {
        sheet: file.paper.sheet(arguments.crease),
        thickness: file.paper.thickness,
        target,
        algorithm: arguments.algorithm().on(friction),
        parts: usize::from(parts),
    };
    let length = request.sheet.length;
    let way = FoldWay::new(request).at(format_args!("{}, {length:.4} m long", file.title))?;
    let frame = expected_frame(arguments, cell, &request)?;
    let planned = FoldMotionRequest {
        cell,
        arm,
        frame,
        speed: arguments.hand_speed,
        margin: arguments.margin,
    };
    let motion = planned.plan(&way)?;
    let task = CellTask::new(
        "fold",
        arguments.out.as_deref(),
        &chosen,
        &[arm],
        &arguments.choice,
    )?;
    task.write_motion(&motion.whole(), FRAMES)?;
    let record = FoldRecord {
        head: TaskHead::planned(std::env::args().collect()),
        cell: cell.title.clone(),
        arm: cell.arms[arm].name.clone(),
        paper: file.title.clone(),
        target_m: target,
        algorithm: arguments.algorithm.clone(),
        parts: request.parts,
        closed_loop: arguments.feedback.is_some(),
        motion: motion.report,
        sheet_place: None,
        times_s: Vec::new(),
        looks: Vec::new(),
        score: None,
    };
    let settings = || {
        let table = cell.table.map_or_else(Pose::identity, |table| table.top);
        let place = place_on(&table, &frame);
        let is_diagonal = arguments.crease == Crease::Diagonal;
        let sheet =
            SimulatedSheet::new(&arguments.paper, friction, is_diagonal, Some(place), &table)?;
        Ok(Settings {
            sheet: Some(sheet),
            ..Settings::empty(FULL_SPEED)
        })
    };
    chosen.work(settings, |cell| {
        let folding = FoldTask {
            cell,
            arm,
            paper: file.paper,
            crease: arguments.crease,
            request,
            is_closed_loop: arguments.feedback.is_some(),
            heading: heading(&frame),
            colour: &colour,
            speed: arguments.hand_speed,
            approach_speed: arguments.approach_speed,
            margin: arguments.margin,
            unfinished: task.unfinished.first(),
            directory: &task.directory,
        };
        task.carry_out(record, arguments.dry_run, |record, is_interrupted| {
            let end = folding.run(is_interrupted);
            record.times_s = end.times;
            record.head.stopped = end.stopped;
            record.looks = end.looks;
            record.sheet_place = end.frame.map(|frame| {
                let place = frame.translation.vector;
                [place.x, place.y, heading(&frame).to_degrees()]
            });
            record.score = Some(end.score?);
            Ok(())
        })
    })
}

/// Where a sheet with a frame lies on a table.
fn place_on(table: &Pose, frame: &Pose) -> SheetPlace {
    let place = table.inverse() * frame;
    SheetPlace {
        edge: [place.translation.x, place.translation.y],
        heading: heading(&place),
    }
}

/// Where the sheet is expected: its middle in that of the table where nobody says.
fn expected_frame(
    arguments: &FoldArguments,
    cell: &Cell,
    request: &FoldRequest,
) -> Result<Pose, Failure> {
    let rise = 0.5 * request.thickness;
    let length = request.sheet.length;
    let [x, y, z, turn] = match (arguments.place, cell.table) {
        (Some(Place::At(place)), _) => place,
        (Some(Place::Auto), _) => {
            let message = "--place auto: a sheet is folded where it lies; needed: x,y,z and a turn about z in degrees";
            return Err(Failure::Input(message.into()));
        }
        (None, Some(table)) => {
            let top = table.top.translation.vector;
            [top.x - 0.5 * length, top.y, top.z, 0.0]
        }
        (None, None) => {
            let message = "--place is needed: the cell has no [table]";
            return Err(Failure::Input(message.into()));
        }
    };
    let frame = Pose::from_parts(
        Translation3::new(x, y, z + rise),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn),
    );
    if let Some(table) = cell.table {
        let [long, wide, _] = table.size.map(|side| 0.5 * side);
        let is_on = |along: f64| {
            let place = table.top.inverse() * frame * Point3::new(along, 0.0, 0.0);
            place.x.abs() <= long && place.y.abs() <= wide
        };
        if !(is_on(0.0) && is_on(length)) {
            return Err(Failure::Input(format!(
                "--place: the sheet, {length:.3} m long, does not lie on the table, {:.3} m by {:.3} m",
                table.size[0], table.size[1]
            )));
        }
    }
    Ok(frame)
}
