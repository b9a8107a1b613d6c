//! Files of drawn patterns: SVG, and CSV files of points.

use super::prelude::*;
use rodlab_lab::experiment::stroke_of_svg;
use rodlab_planning::plan::pattern::Point;
use rodlab_vision::read_curve;

/// Points of an SVG or CSV file in metres; none where the file has another ending. `stroke` counts the strokes of an
/// SVG, or the strands of a CSV file, from 1.
pub fn drawn_points(path: &Path, stroke: Option<usize>) -> Result<Option<Vec<Point>>, Failure> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "svg" {
        let points = stroke_of_svg(path, stroke);
        points.map(Some).map_err(Failure::Input)
    } else if extension == "csv" {
        Ok(Some(read_curve(path, stroke)?))
    } else {
        Ok(None)
    }
}
