//! Files of drawn patterns: SVG, and CSV files of points.

use super::middle_line::{Filled, FilledLine};
use super::prelude::*;
use rodlab_files::figure::numbered_strokes;
use rodlab_lab::experiment::svg_drawing;
use rodlab_planning::plan::pattern::{DrawnStroke, PatternError, Point, StrokeChoice, SvgDrawing};
use rodlab_vision::read_curve;

/// Selection of a part of a drawn file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part<'a> {
    /// Stroke of an SVG, or strand of a CSV file.
    pub stroke: Option<&'a StrokeChoice>,
    /// Largest gap between strokes of an SVG that are joined, m.
    pub join: Option<f64>,
    /// How filled areas of an SVG are followed.
    pub filled: Filled,
}

/// Points of an SVG or CSV file, m; `None` for other file name extensions.
pub fn drawn_points(path: &Path, part: Part<'_>) -> Result<Option<Vec<Point>>, Failure> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "svg" {
        return chosen(path, joined_drawing(path, part)?, part).map(Some);
    }
    let given = [
        ("--join", part.join.is_some()),
        ("--centreline", part.filled.line == FilledLine::Middle),
        ("--outline", part.filled.line == FilledLine::Edge),
    ];
    if let Some((flag, _)) = given.iter().find(|(_, given)| *given) {
        return Err(Failure::Input(format!(
            "{flag} is for SVG drawings; {} is not one",
            path.display()
        )));
    }
    if extension == "csv" {
        Ok(Some(read_curve(path, counted(part.stroke)?)?))
    } else {
        Ok(None)
    }
}

/// The lines of an SVG drawing, m, joined as requested. If there are more than `most`, or filled
/// areas whose edges come in pairs, only the line that the user chooses.
pub fn drawn_strokes(path: &Path, part: Part<'_>, most: usize) -> Result<Vec<Vec<Point>>, Failure> {
    let drawing = joined_drawing(path, part)?;
    let has_pairs = drawing.areas().iter().any(|area| area.edges.len() > 1);
    let drawn = || {
        drawing
            .strokes
            .iter()
            .filter(|stroke| !stroke.is_background)
    };
    if has_pairs || !(1..=most).contains(&drawn().count()) {
        return Ok(vec![chosen(path, drawing, part)?]);
    }
    let strokes = drawn().inspect(|stroke| warn_of_edge(path, stroke));
    Ok(strokes.map(|stroke| stroke.points.clone()).collect())
}

/// Number of a strand or a line, if given; `None` for `longest`, which is the default for
/// photographs.
pub fn counted(stroke: Option<&StrokeChoice>) -> Result<Option<usize>, Failure> {
    match stroke {
        None | Some(StrokeChoice::Only | StrokeChoice::Longest) => Ok(None),
        Some(StrokeChoice::Number(number)) => Ok(Some(*number)),
        Some(StrokeChoice::Id(id)) => Err(Failure::Input(format!(
            "--stroke {id}: expected a number from 1; only strokes of SVG drawings have an id"
        ))),
    }
}

/// An SVG drawing with the lines that are followed, joined across gaps as requested.
fn joined_drawing(path: &Path, part: Part<'_>) -> Result<SvgDrawing, Failure> {
    let drawing = svg_drawing(path).map_err(Failure::Input)?;
    let drawing = part.filled.followed(path, drawing)?;
    match part.join {
        Some(gap) => drawing.joined(gap).at(path.display()),
        None => Ok(drawing),
    }
}

/// Warns if a stroke is the edge of a filled area.
fn warn_of_edge(path: &Path, stroke: &DrawnStroke) {
    if stroke.is_outline {
        tracing::warn!(
            "{}: line {}: <{}> is a filled area without a line of its own: the rod follows its edge; --centreline follows \
             its middle line",
            path.display(),
            stroke.line,
            stroke.element
        );
    }
}

/// A stroke of an SVG drawing. If there are several strokes and none is selected, a picture of
/// them is written.
fn chosen(path: &Path, mut drawing: SvgDrawing, part: Part<'_>) -> Result<Vec<Point>, Failure> {
    let place = path.display();
    let choice = part.stroke.cloned().unwrap_or_default();
    let number = match drawing.choose(&choice) {
        Ok(number) => number,
        Err(error @ PatternError::SeveralStrokes { .. }) => {
            return Err(Failure::Input(format!(
                "{place}: {error}\n{}",
                ways_out(path, &drawing)
            )));
        }
        Err(error) => return Err(error).at(&place),
    };
    let stroke = drawing.strokes.swap_remove(number - 1);
    warn_of_edge(path, &stroke);
    Ok(stroke.points)
}

/// Message about the options that select one of several strokes. Writes a picture of them into the current folder.
fn ways_out(path: &Path, drawing: &SvgDrawing) -> String {
    let join = match drawing.gap_that_joins() {
        Some(gap) => format!("; --join \"{:.3} mm\" joins all of them to one", 1e3 * gap),
        None => "; --join GAP joins strokes whose ends are at most GAP apart".into(),
    };
    let mut text = format!("--stroke takes a number, an id, or `longest`{join}");
    text += &numbered_picture(
        path,
        drawing.strokes.iter().map(|stroke| &stroke.points[..]),
    );
    text
}

/// An SVG of numbered strokes.
pub fn stroke_picture<'a>(strokes: impl Iterator<Item = &'a [Point]>) -> String {
    let points: Vec<Vec<[f64; 2]>> = strokes
        .map(|stroke| stroke.iter().map(|point| [point.x, point.y]).collect())
        .collect();
    let views: Vec<&[[f64; 2]]> = points.iter().map(Vec::as_slice).collect();
    numbered_strokes(&views)
}

/// Writes a picture of numbered strokes of a file into the current folder. Returns a line that
/// names it; empty if it cannot be written.
fn numbered_picture<'a>(path: &Path, strokes: impl Iterator<Item = &'a [Point]>) -> String {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let picture = PathBuf::from(format!("{name}_strokes.svg"));
    match write_file(&picture, stroke_picture(strokes).as_bytes()) {
        Ok(()) => format!(
            "\na picture of them with their numbers: {}",
            picture.display()
        ),
        Err(_) => {
            tracing::warn!(
                "{} cannot be written: no picture of the strokes",
                picture.display()
            );
            String::new()
        }
    }
}
