//! The middle line of the filled areas of an SVG drawing, traced as in a photograph.

use super::drawn_pattern::{counted, numbered_picture};
use super::prelude::*;
use image::{Rgb, RgbImage};
use rodlab_files::figure::grey_picture;
use rodlab_lab::experiment::svg_drawing;
use rodlab_planning::plan::pattern::{DrawnStroke, Point, StrokeChoice};
use rodlab_vision::{ColourRule, Metric, Strand, TraceOptions, VisionError, pattern, trace};

/// Distance between points of a traced line, m, as in `rodlab trace --pattern`.
pub const POINT_STEP: f64 = 1e-3;
/// Width of the traced picture, pixels.
const PIXELS: u32 = 1500;
/// Margin of the picture, as a fraction of its width.
const MARGIN: f64 = 0.05;
/// Maximum number of listed lines.
const LISTED: usize = 10;

/// The middle line of the filled areas of a drawing, m: the selected one, or the only one. If there
/// are several and none is selected, a picture of them is written. `size` is the length of the
/// drawing's longer side after its later scaling, m. The smoothing depends on it.
pub fn middle_line(
    path: &Path,
    choice: Option<&StrokeChoice>,
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
    let number = counted(choice)?;
    let longer = size.unwrap_or(side);
    let metric = Metric::Scan {
        pixel: longer / side / scale,
        height,
    };
    let corner = low * (longer / side);
    let is_open = matches!(choice, None | Some(StrokeChoice::Only));
    if is_open && traced.strands.len() > 1 {
        let lines = located(&traced.strands, metric, corner).at(&place)?;
        return Err(several(path, &lines)).at(&place);
    }
    let strand = traced.strand(number).ok_or_else(|| {
        let count = traced.strands.len();
        format!("--stroke: its filled areas have {count} middle lines, counted from 1")
    });
    let points = pattern(strand.at(&place)?, metric, smoothing, POINT_STEP).at(&place)?;
    Ok(points.into_iter().map(|point| point + corner).collect())
}

/// The points of lines in the final size of the drawing, m. A closed line ends with its first point.
fn located(
    strands: &[Strand],
    metric: Metric,
    corner: Point,
) -> Result<Vec<Vec<Point>>, VisionError> {
    let line = |strand: &Strand| {
        let first = strand.points.first().filter(|_| strand.closed);
        let points = strand.points.iter().chain(first);
        points
            .map(|point| Ok(metric.locate(*point)? + corner))
            .collect()
    };
    strands.iter().map(line).collect()
}

/// Message about several middle lines: number, length and place of the longest, with a picture.
fn several(path: &Path, lines: &[Vec<Point>]) -> String {
    let length =
        |line: &[Point]| -> f64 { line.windows(2).map(|two| (two[1] - two[0]).norm()).sum() };
    let mut longest: Vec<(f64, usize)> = lines.iter().map(|line| length(line)).zip(1..).collect();
    longest.sort_by(|one, other| other.0.total_cmp(&one.0));
    let count = lines.len();
    let mut text = format!(
        "its filled areas have {count} middle lines; choose one, --stroke 1 to {count}, or `longest`"
    );
    for (length, number) in longest.iter().take(LISTED) {
        let line = &lines[number - 1];
        let [from, to] = [line.first(), line.last()].map(|end| {
            let end = 1e3 * end.copied().unwrap_or_default();
            format!("({:.1}, {:.1})", end.x, end.y)
        });
        let length = 1e3 * length;
        let _ = write!(
            text,
            "\n  {number}: {length:.1} mm long, from {from} to {to} mm"
        );
    }
    if count > LISTED {
        let _ = write!(
            text,
            "\n  and {} more, each at most as long as these",
            count - LISTED
        );
    }
    text + &numbered_picture(path, lines.iter().map(Vec::as_slice))
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
