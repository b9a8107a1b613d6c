//! A figure of a deployed curve on its pattern.

use super::Point;
use super::score::Score;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, PlotStyle, styled_line_plots};

/// Height of the figure relative to the size of its letters.
const HEIGHT: f64 = 40.0;

/// Largest drawn deviation, relative to the extent of the pattern.
const DRAWN_DEVIATION: f64 = 0.1;

/// Draws both curves to scale, with the pattern as a broad line below. Deviations of the result
/// are magnified to be visible. `result` and `pattern` name the curves.
pub fn score_figure(score: &Score, result: &str, pattern: &str) -> Figure {
    let place = |point: &Point| (1e3 * point.x, Some(1e3 * point.y));
    let curve = |points: &[Point]| points.iter().map(place).collect::<Vec<_>>();
    let magnification = magnification(score);
    let pairs = score.pattern.iter().zip(&score.result);
    let magnified = pairs.map(|(drawn, laid)| place(&(drawn + magnification * (laid - drawn))));
    let [by_arc_length, by_nearest_point] =
        [score.by_arc_length, score.by_nearest_point].map(|error| 1e3 * error.mean_m);
    let means = format!(
        "mean error {by_arc_length:.2} mm by arc length, {by_nearest_point:.2} mm to the nearest point"
    );
    let mut curves = vec![
        Curve::new(pattern, curve(&score.pattern)).looking(Look::Ground),
        Curve::new(result, curve(&score.result))
            .looking(Look::Bare)
            .like(0),
    ];
    let name = if magnification > 1.0 {
        format!("its deviations × {magnification}; {means}")
    } else {
        means
    };
    curves.push(
        Curve::new(name, magnified.collect())
            .looking(Look::Dashed)
            .like(1),
    );
    let plot = LinePlot::new("y in mm", curves);
    let style = PlotStyle {
        is_to_scale: true,
        height: HEIGHT,
        ..PlotStyle::default()
    };
    styled_line_plots([plot], "x in mm", style)
}

/// The largest of 1, 2, 5 times a power of ten by which deviations may be magnified.
fn magnification(score: &Score) -> f64 {
    let pairs = score.pattern.iter().zip(&score.result);
    let largest = pairs
        .map(|(drawn, laid)| (laid - drawn).norm())
        .fold(0.0, f64::max);
    let distances = score
        .pattern
        .iter()
        .zip(score.pattern.first().into_iter().cycle());
    let extent = distances
        .map(|(point, first)| (point - first).norm())
        .fold(0.0, f64::max);
    let most = DRAWN_DEVIATION * extent / largest;
    let steps = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];
    let fitting = steps.into_iter().rev().find(|step| *step <= most);
    fitting.unwrap_or(1.0)
}
