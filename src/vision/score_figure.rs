//! A figure of a deployed curve on its pattern.

use super::Point;
use super::score::Score;
use std::fmt::Write;

/// Width of the figure, pixels.
const WIDTH: f64 = 760.0;
const MARGIN: f64 = 40.0;
const LEGEND: f64 = 64.0;
const MOST_HEIGHT: f64 = 900.0;

/// Both curves to scale, with a line between corresponding points, as SVG. `title` names the curves.
pub fn score_figure(score: &Score, title: &str) -> String {
    let points = || score.pattern.iter().chain(&score.result);
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
        points()
            .map(|point| point[axis])
            .reduce(pick)
            .unwrap_or(0.0)
    };
    let low = Point::new(bound(0, f64::min), bound(1, f64::min));
    let high = Point::new(bound(0, f64::max), bound(1, f64::max));
    let size = (high - low).map(|side| side.max(1e-9));
    let scale =
        ((WIDTH - 2.0 * MARGIN) / size.x).min((MOST_HEIGHT - LEGEND - 2.0 * MARGIN) / size.y);
    let height = LEGEND + 2.0 * MARGIN + scale * size.y;
    let place = |point: &Point| {
        (
            MARGIN + 0.5 * (WIDTH - 2.0 * MARGIN - scale * size.x) + scale * (point.x - low.x),
            LEGEND + MARGIN + scale * (high.y - point.y),
        )
    };
    let path = |curve: &[Point]| {
        let mut text = String::new();
        for (index, point) in curve.iter().enumerate() {
            let (x, y) = place(point);
            let command = if index == 0 { 'M' } else { 'L' };
            let _ = write!(text, "{command}{x:.2} {y:.2}");
        }
        text
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    for (a, b) in score.pattern.iter().zip(&score.result) {
        let ((x1, y1), (x2, y2)) = (place(a), place(b));
        let _ = writeln!(
            svg,
            "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"#b0b0b0\"/>"
        );
    }
    let _ = writeln!(
        svg,
        "<path d=\"{}\" fill=\"none\" stroke=\"#1f4e9c\" stroke-width=\"2.5\" stroke-dasharray=\"7 5\"/>\n\
         <path d=\"{}\" fill=\"none\" stroke=\"#c8382c\" stroke-width=\"2.5\"/>",
        path(&score.pattern),
        path(&score.result)
    );
    let millimetres = |metres: f64| 1e3 * metres;
    let by = score.by_arc_length;
    let near = score.by_nearest_point;
    let escaped = title.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        svg,
        "<text x=\"{MARGIN}\" y=\"24\" font-size=\"16\">{escaped}</text>\n\
         <text x=\"{MARGIN}\" y=\"46\" fill=\"#1f4e9c\">pattern (dashed)</text>\n\
         <text x=\"{}\" y=\"46\" fill=\"#c8382c\">result</text>\n\
         <text x=\"{}\" y=\"46\">mean error {:.2} mm by arc length, {:.2} mm to the nearest point</text>",
        MARGIN + 120.0,
        MARGIN + 180.0,
        millimetres(by.mean_m),
        millimetres(near.mean_m)
    );
    // A bar of a round length, about a fifth of the width.
    let wanted = 0.2 * WIDTH / scale;
    let decade = 10f64.powf(wanted.log10().floor());
    let steps = [5.0, 2.0, 1.0];
    let bar = decade
        * steps
            .into_iter()
            .find(|step| step * decade <= wanted)
            .unwrap_or(1.0);
    let (x, y) = (WIDTH - MARGIN, height - 12.0);
    let _ = writeln!(
        svg,
        "<line x1=\"{:.2}\" y1=\"{y:.2}\" x2=\"{x:.2}\" y2=\"{y:.2}\" stroke=\"#000000\" stroke-width=\"2\"/>\n\
         <text x=\"{x:.2}\" y=\"{:.2}\" text-anchor=\"end\">{} mm</text>\n</svg>",
        x - scale * bar,
        y - 6.0,
        (millimetres(bar) * 1e6).round() / 1e6
    );
    svg
}
