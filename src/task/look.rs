//! The camera's picture of a rod that lies, as a curve in the frame of its pattern.

use crate::cell::Cell;
use crate::robot::{CameraPicture, Pose, open_camera};
use crate::vision::{
    ColourRule, Point, Score, Trace, TraceOptions, VisionError, decode_picture, part_of_curve,
    score, trace,
};
use image::RgbImage;
use std::time::Duration;

/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(10);

/// The next picture of the camera of a cell.
///
/// # Errors
/// In words: there is no camera, it has no source, or no picture comes.
pub fn next_picture(cell: &Cell) -> Result<RgbImage, String> {
    let camera = cell.camera.as_ref().ok_or("the cell has no [camera]")?;
    let source = camera.source.as_deref();
    let source = source.ok_or("camera.source is missing: where its pictures come from")?;
    let opened = open_camera(source).ok_or_else(|| {
        format!("camera.source: {source:?} is no camera; needed: ros1://, rosbridge:// or ros2://")
    })?;
    let mut camera = opened.map_err(|error| error.to_string())?;
    match camera
        .picture(PATIENCE)
        .map_err(|error| error.to_string())?
    {
        CameraPicture::Pixels(picture) => Ok(picture),
        CameraPicture::File(bytes) => decode_picture(&bytes),
    }
}

/// The longest strand of a picture in the frame of the pattern, m, from the end that is nearer to `start`; with the strands.
///
/// # Errors
/// No strand is seen, or the picture has another size than the camera.
pub fn lying_rod(
    picture: &RgbImage,
    cell: &Cell,
    frame: &Pose,
    radius: f64,
    colour: &ColourRule,
    start: Point,
) -> Result<(Vec<Point>, Trace), VisionError> {
    let missing = VisionError::Undetermined {
        problem: "the rod",
        reason: "the cell has no [camera]".into(),
    };
    let camera = cell.camera.as_ref().ok_or(missing)?;
    // The centreline lies a radius above the table.
    let height = frame.translation.z + radius;
    let camera = camera.seeing(height);
    camera.check_size(picture.width(), picture.height())?;
    let options = TraceOptions {
        colour: colour.clone(),
        ..TraceOptions::default()
    };
    let found = trace(picture, &options)?;
    let strands = found.strands.iter();
    let longest = strands.max_by(|a, b| a.length().total_cmp(&b.length()));
    let longest = longest.expect("a trace has strands");
    let back = frame.inverse();
    let places = longest.points.iter().map(|pixel| {
        let place = camera.on_table(*pixel)?;
        let place = back * nalgebra::Point3::new(place.x, place.y, height);
        Ok(Point::new(place.x, place.y))
    });
    let mut curve = places.collect::<Result<Vec<Point>, VisionError>>()?;
    let away = |point: Option<&Point>| point.map_or(0.0, |point| (point - start).norm());
    if away(curve.last()) < away(curve.first()) {
        curve.reverse();
    }
    Ok((curve, found))
}

/// How far a lying rod is from its pattern, whose start lies `lead_in` behind that of the rod, all in m, with `points` points.
///
/// # Errors
/// What is seen of it is shorter than the pattern.
pub fn score_of(
    rod: &[Point],
    pattern: &[Point],
    lead_in: f64,
    points: usize,
) -> Result<Score, VisionError> {
    let part = part_of_curve(rod, lead_in, pattern)?;
    score(&part, pattern, points, false)
}
