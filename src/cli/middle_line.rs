//! Middle lines of the filled areas of an SVG drawing, traced as in a photograph.

use super::prelude::*;
use image::{Rgb, RgbImage};
use rodlab_files::figure::grey_picture;
use rodlab_planning::plan::pattern::{DrawnStroke, FilledArea, Point, SvgDrawing, bounds};
use rodlab_vision::{ColourRule, Metric, TraceOptions, pattern, trace};

/// Distance between points of a traced line, m, as in `rodlab trace --pattern`.
pub const POINT_STEP: f64 = 1e-3;
/// Width of the traced picture, pixels.
const PIXELS: u32 = 1500;
/// Margin of the picture, as a fraction of its width.
const MARGIN: f64 = 0.05;
/// Largest size of a dot, such as that of an i, in thicknesses of the letters.
const DOT: f64 = 2.0;

/// The line that a rod follows in a filled area without a line of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FilledLine {
    /// The middle line of narrow areas, such as letters, and the edge of others.
    #[default]
    MiddleOfNarrow,
    /// The middle line.
    Middle,
    /// The edge.
    Edge,
}

/// How the filled areas of a drawing are followed.
#[derive(Clone, Copy, Debug)]
pub struct Filled {
    /// The line that is followed.
    pub line: FilledLine,
    /// Length of the drawing's longer side after its later scaling, m.
    pub size: Option<f64>,
    /// Smoothing length of middle lines at that size, m.
    pub smoothing: f64,
}

impl Default for Filled {
    fn default() -> Self {
        Self {
            line: FilledLine::default(),
            size: None,
            smoothing: 2e-3,
        }
    }
}

impl Filled {
    /// The drawing with middle lines in place of edges, as selected. Dots of letters are left out.
    pub fn followed(self, path: &Path, drawing: SvgDrawing) -> Result<SvgDrawing, Failure> {
        let place = path.display();
        let areas = drawing.areas();
        let (followed, others): (Vec<_>, Vec<_>) = areas.iter().partition(|area| match self.line {
            FilledLine::MiddleOfNarrow => area.is_narrow(),
            FilledLine::Middle => true,
            FilledLine::Edge => false,
        });
        if followed.is_empty() {
            return match self.line {
                FilledLine::Middle => Err("--centreline: it has no filled areas with a middle line; without --centreline its lines are followed").at(&place),
                _ => Ok(drawing),
            };
        }
        let lines = match (self.middle_lines(&drawing, &followed), self.line) {
            (Ok(lines), _) => lines,
            (Err(error), FilledLine::Middle) => return Err(error).at(&place),
            (Err(_), _) => return Ok(drawing),
        };
        if self.line == FilledLine::MiddleOfNarrow {
            let first = followed.first().and_then(|area| area.edges.first());
            let first = first.map_or(1, |edge| drawing.strokes[*edge].line);
            let count = match followed.len() {
                1 => "a narrow filled area is".to_owned(),
                count => format!("{count} narrow filled areas are"),
            };
            tracing::warn!(
                "{place}: line {first}: {count} followed along the middle; --outline follows the edges"
            );
        }
        let thickest = followed
            .iter()
            .fold(0.0, |most: f64, area| most.max(area.thickness));
        let is_dot = |area: &&&FilledArea| area.longer_side <= DOT * thickest;
        let dots: Vec<&FilledArea> = others.iter().filter(is_dot).copied().collect();
        if !dots.is_empty() {
            tracing::warn!("{place}: filled dots are left out: {}", dots.len());
        }
        Ok(replaced(drawing, &followed, lines, &dots))
    }

    /// The middle lines of areas, m, each with the number of its area.
    fn middle_lines(
        self,
        drawing: &SvgDrawing,
        areas: &[&FilledArea],
    ) -> Result<Vec<(usize, Vec<Point>)>, String> {
        let edges = areas.iter().flat_map(|area| &area.edges);
        let [low, high] = bounds(edges.flat_map(|edge| &drawing.strokes[*edge].points));
        let side = (high - low).max();
        let (low, high) = (
            low.add_scalar(-MARGIN * side),
            high.add_scalar(MARGIN * side),
        );
        let scale = f64::from(PIXELS) / (high - low).max();
        let picture = picture(drawing, areas, low, high, scale)?;
        let options = TraceOptions {
            colour: ColourRule::parse("black").map_err(|error| error.to_string())?,
            has_corners: true,
            ..TraceOptions::default()
        };
        let traced = trace(&picture, &options).map_err(|error| error.to_string())?;
        let metric = Metric::Scan {
            pixel: 1.0 / scale,
            height: picture.height(),
        };
        // Lengths in the drawing, whose size changes later.
        let [smoothing, step] = [self.smoothing, POINT_STEP]
            .map(|length| length * self.size.map_or(1.0, |size| side / size));
        let mut lines: Vec<(usize, Vec<Point>)> = Vec::new();
        for strand in &traced.strands {
            // A part that is too short to be smoothed is not a line.
            let Ok(line) = pattern(strand, metric, smoothing, step) else {
                continue;
            };
            let line: Vec<Point> = line.into_iter().map(|point| point + low).collect();
            let is_in = |area: &&FilledArea| line.iter().any(|at| area.contains(drawing, *at));
            lines.push((areas.iter().position(is_in).unwrap_or_default(), line));
        }
        match lines.is_empty() {
            true => Err("its filled areas have no middle line".into()),
            false => Ok(lines),
        }
    }
}

/// The drawing with lines in place of the edges of areas that have any, without dots.
fn replaced(
    mut drawing: SvgDrawing,
    areas: &[&FilledArea],
    mut lines: Vec<(usize, Vec<Point>)>,
    dots: &[&FilledArea],
) -> SvgDrawing {
    let strokes = std::mem::take(&mut drawing.strokes);
    let is_in = |area: &&FilledArea, index: usize| area.edges.contains(&index);
    for (index, stroke) in strokes.into_iter().enumerate() {
        if dots.iter().any(|dot| is_in(dot, index)) {
            continue;
        }
        let around = areas.iter().position(|area| is_in(area, index));
        let Some(area) = around.filter(|area| lines.iter().any(|(of, _)| of == area)) else {
            drawing.strokes.push(stroke);
            continue;
        };
        // The lines take the place of the outer edge, which is the first one.
        if areas[area].edges.first() == Some(&index) {
            let own = lines.iter_mut().filter(|(of, _)| *of == area);
            drawing.strokes.extend(own.map(|(_, line)| DrawnStroke {
                points: std::mem::take(line),
                is_outline: false,
                id: stroke.id.clone(),
                element: stroke.element.clone(),
                ..stroke
            }));
        }
    }
    drawing
}

/// A picture of areas alone, black on white.
fn picture(
    drawing: &SvgDrawing,
    areas: &[&FilledArea],
    low: Point,
    high: Point,
    scale: f64,
) -> Result<RgbImage, String> {
    let [width, height] = [(high - low).x, (high - low).y].map(|side| scale * side);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">"
    );
    for area in areas {
        // The edges of an area belong to one path, so that its holes stay open.
        svg += "<path fill-rule=\"evenodd\" d=\"";
        for edge in &area.edges {
            for (index, point) in drawing.strokes[*edge].points.iter().enumerate() {
                let command = if index == 0 { 'M' } else { 'L' };
                let [x, y] = [scale * (point.x - low.x), scale * (high.y - point.y)];
                let _ = write!(svg, "{command}{x:.3} {y:.3}");
            }
            svg += "z";
        }
        svg += "\"/>";
    }
    svg += "</svg>";
    let (width, height, grey) = grey_picture(&svg, width.round().max(1.0) as u32)
        .ok_or_else(|| "its filled areas cannot be drawn".to_owned())?;
    let pixels = grey.iter().flat_map(|grey| [*grey; 3]).collect();
    Ok(RgbImage::from_raw(width, height, pixels)
        .unwrap_or_else(|| RgbImage::from_pixel(1, 1, Rgb([255; 3]))))
}
