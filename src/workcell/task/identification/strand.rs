//! A rod that a hand holds, traced in a picture.

use crate::cell::sums;
use crate::task::error::WorkError;
use image::RgbImage;
use rodlab_robot::Pose;
use rodlab_vision::{Camera, ColourRule, Point, Trace, TraceOptions, trace};

/// Largest distance of the end of the rod from the hand in the picture, in widths of the rod.
const AT_HAND: f64 = 6.0;

/// Traces the rod in a picture; its centreline starts at the hand, pixels.
pub fn strand(
    picture: &RgbImage,
    colour: &ColourRule,
    camera: &Camera,
    hand: &Pose,
) -> Result<(Trace, Vec<Point>), WorkError> {
    let options = TraceOptions {
        colour: colour.clone(),
        ..TraceOptions::default()
    };
    let found = trace(picture, &options)?;
    let strand = found.strand(None).filter(|strand| !strand.closed);
    let strand = strand.ok_or_else(|| WorkError::failed("no rod with two ends is seen"))?;
    let (mut points, width) = (strand.points.clone(), strand.width());
    let place = camera.project(hand.translation.vector);
    let place = place.ok_or_else(|| WorkError::failed("the camera does not see the hand"))?;
    let away = |point: Option<&Point>| point.map_or(f64::INFINITY, |at| (at - place).norm());
    if away(points.last()) < away(points.first()) {
        points.reverse();
    }
    if away(points.first()) > AT_HAND * width {
        return Err(WorkError::failed(
            "the longest strand in the picture does not begin at the hand; --colour selects the rod",
        ));
    }
    // The ends are seen less exactly than the middle part.
    let lengths = sums(points.windows(2).map(|pair| (pair[1] - pair[0]).norm()));
    let whole = lengths[lengths.len() - 1];
    let inner = points.into_iter().zip(&lengths);
    let inner = inner.filter(|(_, at)| (width..=whole - width).contains(*at));
    Ok((found, inner.map(|(point, _)| point).collect()))
}

/// Returns directions of pixels, X/Z and Y/Z in the axes of the camera.
pub fn directions(camera: &Camera, pixels: &[Point]) -> Vec<[f64; 2]> {
    let directions = pixels
        .iter()
        .filter_map(|pixel| camera.lens.direction(*pixel));
    directions
        .map(|direction| [direction.x, direction.y])
        .collect()
}
