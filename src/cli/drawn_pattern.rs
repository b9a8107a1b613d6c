//! Files of drawn patterns: SVG, and CSV files of points.

use super::failure::Failure;
use rodlab_lab::scenario::read_text_file;
use rodlab_planning::plan::pattern::{Point, chosen_stroke, read_svg};
use rodlab_vision::read_curve;
use std::path::Path;

/// Points of an SVG or CSV file in metres; none where the file has another ending. `stroke` counts the strokes of an
/// SVG, or the strands of a CSV file, from 1.
pub fn drawn_points(path: &Path, stroke: Option<usize>) -> Result<Option<Vec<Point>>, Failure> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "svg" {
        stroke_of(path, stroke).map(Some)
    } else if extension == "csv" {
        Ok(Some(read_curve(path, stroke)?))
    } else {
        Ok(None)
    }
}

fn stroke_of(path: &Path, stroke: Option<usize>) -> Result<Vec<Point>, Failure> {
    let bytes = read_text_file(path).map_err(Failure::Input)?;
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::Input(format!("{} is no text in UTF-8", path.display())))?;
    read_svg(&text)
        .and_then(|strokes| chosen_stroke(strokes, stroke))
        .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}
