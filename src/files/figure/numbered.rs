//! A picture of numbered strokes, to choose from.

use super::drawing::{Anchor, Drawing, Stroke, Words, number};
use super::palette::Color;
use std::fmt::Write;

/// Width of the picture, pixels, and its margin.
const WIDTH: f64 = 800.0;
const MARGIN: f64 = 20.0;
/// Height of the numbers, pixels.
const LETTERS: f64 = 12.0;
/// Maximum number of drawn strokes, and of points of each.
const MOST_STROKES: usize = 2000;
const MOST_POINTS: usize = 2000;

/// Draws strokes, y upwards, as SVG. Each has its number, counted from 1, at its middle. If there
/// are very many, only the first are drawn.
pub fn numbered_strokes(strokes: &[&[[f64; 2]]]) -> String {
    let all = || strokes.iter().copied().flatten();
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for point in all() {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let [across, up] = [high[0] - low[0], high[1] - low[1]];
    let side = across.max(up);
    let scale = match side > 0.0 {
        true => (WIDTH - 2.0 * MARGIN) / side,
        false => 1.0,
    };
    let place = |point: &[f64; 2]| {
        [
            MARGIN + scale * (point[0] - low[0]),
            MARGIN + scale * (high[1] - point[1]),
        ]
    };
    let mut drawing = Drawing::new(WIDTH);
    let drawn = || strokes.iter().take(MOST_STROKES).enumerate();
    for (index, stroke) in drawn() {
        let step = stroke.len().div_ceil(MOST_POINTS).max(1);
        let mut data = String::new();
        let last = stroke.len().saturating_sub(1);
        let points = stroke.iter().enumerate();
        for (at, point) in points.filter(|(at, _)| at % step == 0 || *at == last) {
            let [x, y] = place(point).map(number);
            let command = if at == 0 { 'M' } else { 'L' };
            let _ = write!(data, "{command}{x} {y}");
        }
        drawing.path(&data, &Stroke::solid(Color::of(index), 1.5), None);
    }
    for (index, stroke) in drawn() {
        if let Some(middle) = stroke.get(stroke.len() / 2) {
            let [x, y] = place(middle);
            drawing.text(Words {
                text: &(index + 1).to_string(),
                at: [x, y - 3.0],
                size: LETTERS,
                anchor: Anchor::Middle,
                upright: false,
            });
        }
    }
    drawing.finish(2.0 * MARGIN + scale * up.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stroke_has_its_number() {
        let [one, other] = [[[0.0, 0.0], [1.0, 0.0]], [[0.0, 2.0], [1.0, 1.0]]];
        let svg = numbered_strokes(&[&one, &other]);
        assert!(svg.contains("aria-label=\"1\"") && svg.contains("aria-label=\"2\""));
        assert!(svg.contains("M20 780L400 780"), "{svg}");
        assert!(numbered_strokes(&[]).contains("</svg>"));
    }
}
