//! `rodlab fold` in a robot cell.

use super::fold_arguments::FoldArguments;
use super::prelude::*;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use rodlab_lab::experiment::Crease;
use rodlab_robot::Pose;
use rodlab_vision::ColourRule;
use rodlab_workcell::cell::{Cell, Place};
use rodlab_workcell::task::{
    FoldPlan, FoldRequest, FoldTask, FoldWay, Planning, TaskCommand, Way, heading,
};
use rodlab_workcell::virtual_cell::{SheetPlace, SimulatedSheet};

/// Number of parts of a path without feedback; the camera takes a picture after each part.
const WATCHED_PARTS: u16 = 5;
/// Largest number of parts of a path; the arm starts and stops in each part.
const MOST_PARTS: u16 = 20;

impl TaskCommand for FoldArguments {
    const NAME: &'static str = "fold";
    const CAMERA: Option<&'static str> =
        Some("it locates the sheet and measures how far it slides");
    type Task = FoldTask;
    type Error = Failure;

    fn way(&self) -> Way<'_> {
        Way {
            arm: self.arm.as_deref(),
            dry_run: self.dry_run,
            checked: Some(self.checked),
            out: self.out.as_deref(),
        }
    }

    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<FoldTask, Failure> {
        let parts = self.feedback.unwrap_or(WATCHED_PARTS);
        if parts > MOST_PARTS {
            let message = format!("--feedback: {parts}; allowed in a cell: 2 to {MOST_PARTS}");
            return Err(Failure::Input(message));
        }
        let cell = planning.cell;
        let sheet = self.sheet()?;
        let paper = sheet.file.paper;
        let colour = ColourRule::parse(&self.colour)?;
        let request = FoldRequest {
            sheet: paper.sheet(self.crease),
            thickness: paper.thickness,
            target: sheet.target,
            algorithm: self.algorithm().on(sheet.friction),
            parts: usize::from(parts),
        };
        let length = request.sheet.length;
        let title = sheet.file.title;
        let way = FoldWay::new(request).at(format_args!("{title}, {length:.4} m long"))?;
        let frame = expected_frame(self, cell, &request)?;
        planning.furnish(|settings| -> Result<(), Failure> {
            let table = cell.table.map_or_else(Pose::identity, |table| table.top);
            let place = Some(place_on(&table, &frame));
            let is_diagonal = self.crease == Crease::Diagonal;
            let (file, friction) = (&self.paper, sheet.friction);
            let sheet = SimulatedSheet::new(file, friction, is_diagonal, place, &table)?;
            settings.sheet = Some(sheet);
            Ok(())
        })?;
        let plan = FoldPlan {
            arm: arms[0],
            title,
            paper,
            crease: self.crease,
            algorithm: self.algorithm.clone(),
            request,
            is_closed_loop: self.feedback.is_some(),
            frame,
            colour,
            speed: self.hand_speed,
            approach_speed: self.approach_speed,
            margin: self.margin,
        };
        let expected = plan.expected(cell, &way)?;
        Ok(FoldTask::new(cell, plan, Some(expected)))
    }
}

/// Place on a table for a sheet with a given frame.
fn place_on(table: &Pose, frame: &Pose) -> SheetPlace {
    let place = table.inverse() * frame;
    SheetPlace {
        edge: [place.translation.x, place.translation.y],
        heading: heading(&place),
    }
}

/// Expected place of the sheet; by default its middle is in the middle of the table.
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
            let message = "--place auto: a sheet is folded where it lies; give x,y,z and a turn about z in degrees";
            return Err(Failure::Input(message.into()));
        }
        (None, Some(table)) => {
            let top = table.top.translation.vector;
            [top.x - 0.5 * length, top.y, top.z, 0.0]
        }
        (None, None) => {
            let message = "--place is required: the cell has no [table]";
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
