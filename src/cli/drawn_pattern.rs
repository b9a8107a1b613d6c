//! Files of drawn patterns: SVG, and CSV files of points.

use super::prelude::*;
use rodlab_files::figure::numbered_strokes;
use rodlab_lab::experiment::svg_drawing;
use rodlab_planning::plan::pattern::{PatternError, Point, StrokeChoice, SvgDrawing};
use rodlab_vision::read_curve;

/// Selection of a part of a drawn file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part<'a> {
    /// Stroke of an SVG, or strand of a CSV file.
    pub stroke: Option<&'a StrokeChoice>,
    /// Largest gap between strokes of an SVG that are joined, m.
    pub join: Option<f64>,
}

/// Points of an SVG or CSV file, m; `None` for other file name extensions.
pub fn drawn_points(path: &Path, part: Part<'_>) -> Result<Option<Vec<Point>>, Failure> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "svg" {
        return svg_points(path, part).map(Some);
    }
    if part.join.is_some() {
        return Err(Failure::Input(format!(
            "--join is for strokes of SVG drawings; {} is not one",
            path.display()
        )));
    }
    if extension == "csv" {
        Ok(Some(read_curve(path, counted(part.stroke)?)?))
    } else {
        Ok(None)
    }
}

/// The lines of an SVG drawing, m, joined across gaps up to `join`, m; none if it has filled areas
/// without lines of their own, whose edges come in pairs.
pub fn drawn_strokes(path: &Path, join: Option<f64>) -> Result<Vec<Vec<Point>>, Failure> {
    let strokes = joined_drawing(path, join)?.strokes.into_iter();
    let strokes: Vec<_> = strokes.filter(|stroke| !stroke.is_background).collect();
    Ok(match strokes.iter().any(|stroke| stroke.is_outline) {
        true => Vec::new(),
        false => strokes.into_iter().map(|stroke| stroke.points).collect(),
    })
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

/// An SVG drawing whose strokes are joined across gaps up to `join`, m, if given.
fn joined_drawing(path: &Path, join: Option<f64>) -> Result<SvgDrawing, Failure> {
    let drawing = svg_drawing(path).map_err(Failure::Input)?;
    match join {
        Some(gap) => drawing.joined(gap).at(path.display()),
        None => Ok(drawing),
    }
}

/// A stroke of an SVG drawing. If there are several strokes and none is selected, a picture of
/// them is written.
fn svg_points(path: &Path, part: Part<'_>) -> Result<Vec<Point>, Failure> {
    let place = path.display();
    let mut drawing = joined_drawing(path, part.join)?;
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
    if stroke.is_outline {
        tracing::warn!(
            "{place}: line {}: <{}> is a filled area without a line of its own: the rod follows its edge; --centreline follows \
             its middle line",
            stroke.line,
            stroke.element
        );
    }
    if let Some(line) = drawing.text_lines.first() {
        tracing::warn!(
            "{place}: line {line}: <text> is not followed; make it into paths first (Inkscape: Path, Object to Path), then \
             --centreline follows the middle line of its letters"
        );
    }
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

/// Writes a picture of numbered strokes of a file into the current folder. Returns a line that
/// names it; empty if it cannot be written.
pub fn numbered_picture<'a>(path: &Path, strokes: impl Iterator<Item = &'a [Point]>) -> String {
    let points: Vec<Vec<[f64; 2]>> = strokes
        .map(|stroke| stroke.iter().map(|point| [point.x, point.y]).collect())
        .collect();
    let views: Vec<&[[f64; 2]]> = points.iter().map(Vec::as_slice).collect();
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let picture = PathBuf::from(format!("{name}_strokes.svg"));
    match write_file(&picture, numbered_strokes(&views).as_bytes()) {
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
