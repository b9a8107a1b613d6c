//! A figure of a deployed curve on its pattern.

use super::Point;
use super::score::Score;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, PlotStyle, styled_line_plots};

/// Height of the figure over the size of its letters.
const HEIGHT: f64 = 40.0;

/// Both curves to scale, with a line between corresponding points. `result` and `pattern` name the curves.
pub fn score_figure(score: &Score, result: &str, pattern: &str) -> Figure {
    let place = |point: &Point| (1e3 * point.x, Some(1e3 * point.y));
    let curve = |points: &[Point]| points.iter().map(place).collect::<Vec<_>>();
    let pairs = score.pattern.iter().zip(&score.result);
    let differences = pairs.flat_map(|(a, b)| [place(a), place(b), (1e3 * b.x, None)]);
    let [by_arc_length, by_nearest_point] =
        [score.by_arc_length, score.by_nearest_point].map(|error| 1e3 * error.mean_m);
    let differences_name = format!(
        "mean error {by_arc_length:.2} mm by arc length, {by_nearest_point:.2} mm to the nearest point"
    );
    let plot = LinePlot::new(
        "y in mm",
        [
            Curve::new(differences_name, differences.collect())
                .looking(Look::Dashed)
                .like(6),
            Curve::new(pattern, curve(&score.pattern)).like(0),
            Curve::new(result, curve(&score.result)).like(1),
        ],
    );
    let style = PlotStyle {
        is_to_scale: true,
        height: HEIGHT,
        ..PlotStyle::default()
    };
    styled_line_plots([plot], "x in mm", style)
}
