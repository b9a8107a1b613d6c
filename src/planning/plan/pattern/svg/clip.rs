//! Clipping of strokes.

use super::Stroke;
use crate::plan::pattern::Point;
use kurbo::BezPath;

/// Maximum number of pairs of a chord of a stroke with a chord of a clip.
const MOST_PAIRS: usize = 50_000_000;

/// A chord of the border of an area, m.
type Border = [Point; 2];

/// Cuts a stroke at the borders of areas, m, and returns the pieces inside one of them; `None` if
/// there are too many pairs of chords.
pub fn clipped(stroke: &Stroke, areas: &[BezPath], flatness: f64) -> Option<Vec<Stroke>> {
    let areas: Vec<Vec<Border>> = areas.iter().map(|path| borders(path, flatness)).collect();
    let count: usize = areas.iter().map(Vec::len).sum();
    if count.saturating_mul(stroke.len()) > MOST_PAIRS {
        return None;
    }
    let is_inside = |at: Point| areas.iter().any(|area| winding(area, at) != 0);
    let mut pieces: Vec<Stroke> = Vec::new();
    let mut piece: Stroke = Vec::new();
    for chord in stroke.windows(2) {
        let along = chord[1] - chord[0];
        let mut parts: Vec<f64> = areas
            .iter()
            .flatten()
            .filter_map(|border| crossing(chord[0], along, border))
            .chain([0.0, 1.0])
            .collect();
        parts.sort_by(f64::total_cmp);
        for pair in parts.windows(2).filter(|pair| pair[1] > pair[0]) {
            let at = |part: f64| match part {
                1.0 => chord[1],
                _ => chord[0] + part * along,
            };
            if !is_inside(at(0.5 * (pair[0] + pair[1]))) {
                pieces.extend(Some(std::mem::take(&mut piece)).filter(|piece| piece.len() > 1));
                continue;
            }
            if piece.is_empty() {
                piece.push(at(pair[0]));
            }
            piece.push(at(pair[1]));
        }
    }
    pieces.extend(Some(piece).filter(|piece| piece.len() > 1));
    Some(pieces)
}

/// The chords of a path, closed if necessary.
fn borders(path: &BezPath, flatness: f64) -> Vec<Border> {
    let mut borders = Vec::new();
    let [mut at, mut start] = [Point::zeros(); 2];
    kurbo::flatten(path, flatness, |element| match element {
        kurbo::PathEl::MoveTo(to) => {
            borders.push([at, start]);
            at = Point::new(to.x, to.y);
            start = at;
        }
        kurbo::PathEl::LineTo(to) => {
            let to = Point::new(to.x, to.y);
            borders.push([at, to]);
            at = to;
        }
        _ => {
            borders.push([at, start]);
            at = start;
        }
    });
    borders.push([at, start]);
    borders.retain(|[from, to]| from != to);
    borders
}

/// Winding number of closed chords around a point.
fn winding(borders: &[Border], at: Point) -> i32 {
    let turns = borders.iter().map(|[from, to]| {
        let side = (to - from).perp(&(at - from));
        match (from.y <= at.y, to.y <= at.y) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    });
    turns.sum()
}

/// Intersections of a chord with a border, as fractions of the chord.
fn crossing(from: Point, along: Point, [start, end]: &Border) -> Option<f64> {
    let across = end - start;
    let determinant = along.perp(&across);
    let part = (start - from).perp(&across) / determinant;
    let other = (start - from).perp(&along) / determinant;
    ((0.0..1.0).contains(&part) && (0.0..=1.0).contains(&other)).then_some(part)
}
