//! The curves of a plot: lines and marks.

use super::curve::{Curve, Marked, Style};
use super::drawing::{Drawing, Stroke, number};
use super::plot_axes::Axes;

/// Lengths relative to the font size.
const MARK: f64 = 0.26;
/// Number of marks along a curve with few marks.
const FEW: usize = 8;

fn stroke(style: &Style, em: f64) -> Stroke {
    Stroke {
        color: style.color,
        width: style.width * em,
        dashes: style.dashes.iter().map(|dash| dash * em).collect(),
    }
}

fn draw_mark(style: &Style, at: [f64; 2], em: f64, drawing: &mut Drawing) {
    let path = style.mark.path(at, MARK * em);
    if style.is_open {
        let edge = Stroke::solid(style.color, 0.09 * em);
        // The mark is not filled, because another one may be below it.
        drawing.path(&path, &edge, None);
    } else {
        drawing.area(&path, style.color);
    }
}

/// Draws the sample before the name of a curve in the legend.
pub(super) fn draw_sample(
    style: &Style,
    [from, to]: [f64; 2],
    y: f64,
    em: f64,
    drawing: &mut Drawing,
) {
    if style.is_joined {
        let line = format!("M{} {}H{}", number(from), number(y), number(to));
        drawing.path(&line, &stroke(style, em), None);
    }
    if style.marked != Marked::None {
        draw_mark(style, [0.5 * (from + to), y], em, drawing);
    }
}

/// Draws a curve.
pub(super) fn draw_curve(
    curve: &Curve,
    style: &Style,
    axes: &Axes,
    em: f64,
    drawing: &mut Drawing,
) {
    let scales = [axes.horizontal.scale, axes.vertical.scale];
    let stretches: Vec<Vec<[f64; 2]>> = curve
        .stretches(scales)
        .map(|stretch| {
            stretch
                .iter()
                .map(|(x, y)| [axes.x(*x), axes.y(*y)])
                .collect()
        })
        .collect();
    // A single point is not a line.
    for stretch in stretches
        .iter()
        .filter(|stretch| style.is_joined && stretch.len() > 1)
    {
        drawing.path(&path_through(stretch), &stroke(style, em), None);
    }
    let points = stretches.into_iter().flatten();
    match style.marked {
        Marked::None => {}
        Marked::All => points.for_each(|at| draw_mark(style, at, em, drawing)),
        Marked::Few => {
            for at in few(&points.collect::<Vec<_>>()) {
                draw_mark(style, at, em, drawing);
            }
        }
    }
}

/// Path data through points, without points that would not be visible.
fn path_through(points: &[[f64; 2]]) -> String {
    const SEEN: f64 = 0.1;
    let mut path = String::new();
    let mut drawn = [f64::NEG_INFINITY; 2];
    for (index, point) in points.iter().enumerate() {
        let moved = libm::hypot(point[0] - drawn[0], point[1] - drawn[1]);
        if index == 0 || index + 1 == points.len() || moved > SEEN {
            let command = if index == 0 { 'M' } else { 'L' };
            path += &format!("{command}{} {}", number(point[0]), number(point[1]));
            drawn = *point;
        }
    }
    path
}

/// A few of the points, at equal distances along the curve.
fn few(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let distance =
        |pair: &[[f64; 2]]| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
    let whole: f64 = points.windows(2).map(distance).sum();
    let mut way = 0.0;
    let mut chosen = Vec::new();
    for (index, point) in points.iter().enumerate() {
        if index > 0 {
            way += distance(&points[index - 1..=index]);
        }
        let wanted = whole * (chosen.len() as f64 + 0.5) / FEW as f64;
        if way >= wanted && chosen.len() < FEW {
            chosen.push(*point);
        }
    }
    chosen
}
