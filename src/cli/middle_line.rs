//! The middle line of the filled areas of an SVG drawing, traced as in a photograph.

use super::prelude::*;
use image::{Rgb, RgbImage};
use rodlab_files::figure::grey_picture;
use rodlab_lab::experiment::svg_drawing;
use rodlab_planning::plan::pattern::{DrawnStroke, Point};
use rodlab_vision::{ColourRule, Metric, TraceOptions, pattern, trace};

/// Distance between points of a traced line, m, as in `rodlab trace --pattern`.
pub const POINT_STEP: f64 = 1e-3;
/// Width of the traced picture, pixels.
const PIXELS: u32 = 1500;
/// Margin of the picture, as a fraction of its width.
const MARGIN: f64 = 0.05;

/// The middle line of the filled areas of a drawing, m: the line with the given number, from 1, or
/// the longest. `size` is the length of the drawing's longer side after its later scaling, m. The
/// smoothing depends on it.
pub fn middle_line(
    path: &Path,
    line: Option<usize>,
    size: Option<f64>,
    smoothing: f64,
) -> Result<Vec<Point>, Failure> {
    let place = path.display();
    if !path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"))
    {
        return Err(Failure::Input(format!(
            "--centreline is for SVG drawings; {place} is not one"
        )));
    }
    let drawing = svg_drawing(path).map_err(Failure::Input)?;
    let areas: Vec<&DrawnStroke> = drawing
        .strokes
        .iter()
        .filter(|stroke| stroke.is_outline && !stroke.is_background)
        .collect();
    let points = || areas.iter().flat_map(|area| &area.points);
    let Some(first) = points().next() else {
        return Err("it has no filled areas with a middle line; without --centreline its lines are followed").at(&place);
    };
    let low = points().fold(*first, |low, point| low.inf(point));
    let high = points().fold(*first, |high, point| high.sup(point));
    let side = (high - low).max();
    let margin = MARGIN * side;
    let (low, high) = (low.add_scalar(-margin), high.add_scalar(margin));
    let extent = high - low;
    let scale = f64::from(PIXELS) / extent.max();
    let svg = filled(&areas, low, high, scale);
    let width = (scale * extent.x).round().max(1.0) as u32;
    let (width, height, grey) = grey_picture(&svg, width)
        .ok_or("its filled areas cannot be drawn")
        .at(&place)?;
    let pixels = grey.iter().flat_map(|grey| [*grey; 3]).collect();
    let picture = RgbImage::from_raw(width, height, pixels)
        .unwrap_or_else(|| RgbImage::from_pixel(1, 1, Rgb([255; 3])));
    let options = TraceOptions {
        colour: ColourRule::parse("black")?,
        ..TraceOptions::default()
    };
    let traced = trace(&picture, &options).at(&place)?;
    let strand = traced.strand(line).ok_or_else(|| {
        let count = traced.strands.len();
        format!("--stroke: its filled areas have {count} middle lines, counted from 1")
    });
    let longer = size.unwrap_or(side);
    let metric = Metric::Scan {
        pixel: longer / side / scale,
        height,
    };
    let points = pattern(strand.at(&place)?, metric, smoothing, POINT_STEP).at(&place)?;
    let corner = low * (longer / side);
    Ok(points.into_iter().map(|point| point + corner).collect())
}

/// An SVG of the areas alone, black. The edges of one element belong to one area, so that its
/// holes stay open.
fn filled(areas: &[&DrawnStroke], low: Point, high: Point, scale: f64) -> String {
    let [width, height] = [(high - low).x, (high - low).y].map(|side| scale * side);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">"
    );
    let elements = areas.chunk_by(|one, next| (one.line, &one.id) == (next.line, &next.id));
    for element in elements {
        svg += "<path fill-rule=\"evenodd\" d=\"";
        for area in element {
            for (index, point) in area.points.iter().enumerate() {
                let command = if index == 0 { 'M' } else { 'L' };
                let [x, y] = [scale * (point.x - low.x), scale * (high.y - point.y)];
                let _ = write!(svg, "{command}{x:.3} {y:.3}");
            }
            svg += "z";
        }
        svg += "\"/>";
    }
    svg + "</svg>"
}
