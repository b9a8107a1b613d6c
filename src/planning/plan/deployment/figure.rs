//! A figure of pattern, path of the gripper and friction demand.

use super::GripperPose;
use crate::plan::pattern::{Crossing, PatternPoint, Point};
use std::fmt::Write;

/// Width of the figure and its margin, pixels.
const WIDTH: f64 = 760.0;
const MARGIN: f64 = 48.0;
/// Heights of the title, of the view from above (maximum), and of the plot of the friction demand.
const TITLE: f64 = 64.0;
const LARGEST_VIEW: f64 = 640.0;
const PLOT: f64 = 200.0;

/// View from above to scale, and below it a plot of the friction demand over the arc length, as
/// SVG.
pub fn deployment_figure(
    title: &str,
    points: &[PatternPoint],
    poses: &[GripperPose],
    demands: &[f64],
    friction: Option<f64>,
    crossings: &[Crossing],
) -> String {
    let gripper: Vec<Point> = poses
        .iter()
        .map(|pose| Point::new(pose.position.x, pose.position.y))
        .collect();
    let pattern: Vec<Point> = points.iter().map(|point| point.position).collect();
    let all = || pattern.iter().chain(&gripper);
    let low = all().fold(pattern[0], |low, point| low.inf(point));
    let high = all().fold(pattern[0], |high, point| high.sup(point));
    let size = (high - low).map(|side| side.max(1e-3));
    let inner = WIDTH - 2.0 * MARGIN;
    let scale = (inner / size.x).min(LARGEST_VIEW / size.y);
    let view = scale * size.y;
    let place = |point: &Point| {
        (
            MARGIN + 0.5 * (inner - scale * size.x) + scale * (point.x - low.x),
            TITLE + MARGIN + scale * (high.y - point.y),
        )
    };
    let height = TITLE + 3.0 * MARGIN + view + PLOT;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    let escaped = title.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        svg,
        "<text x=\"{MARGIN}\" y=\"26\" font-size=\"16\">{escaped}</text>\n\
         <text x=\"{MARGIN}\" y=\"50\" fill=\"#1f4e9c\">pattern</text>\n\
         <text x=\"{}\" y=\"50\" fill=\"#c8382c\">gripper, from above</text>\n\
         <text x=\"{}\" y=\"50\" fill=\"#606060\">grey: contact node to gripper</text>",
        MARGIN + 80.0,
        MARGIN + 230.0
    );
    // About forty lines between contact node and gripper are drawn.
    let every = points.len().div_ceil(40).max(1);
    for (from, to) in pattern.iter().zip(&gripper).step_by(every) {
        let ((x1, y1), (x2, y2)) = (place(from), place(to));
        let _ = writeln!(
            svg,
            "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"#c0c0c0\"/>"
        );
    }
    let line = |points: &mut dyn Iterator<Item = (f64, f64)>| {
        let mut text = String::new();
        for (index, (x, y)) in points.enumerate() {
            let command = if index == 0 { 'M' } else { 'L' };
            let _ = write!(text, "{command}{x:.2} {y:.2}");
        }
        text
    };
    for (curve, colour) in [(&pattern, "#1f4e9c"), (&gripper, "#c8382c")] {
        let _ = writeln!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\"/>",
            line(&mut curve.iter().map(place))
        );
    }
    for crossing in crossings {
        let (x, y) = place(&crossing.position);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"9\" fill=\"none\" stroke=\"#606060\"/>"
        );
    }
    let bottom = height - MARGIN;
    let length = points.last().map_or(1.0, |point| point.s).max(1e-9);
    let most = demands.iter().copied().chain(friction).fold(0.0, f64::max);
    let top = if most > 0.0 { 1.1 * most } else { 1.0 };
    let at = |s: f64, demand: f64| (MARGIN + inner * s / length, bottom - PLOT * demand / top);
    let plotted = points
        .iter()
        .zip(demands)
        .map(|(point, demand)| at(point.s, *demand));
    let _ = writeln!(
        svg,
        "<path d=\"M{MARGIN} {:.2}V{bottom:.2}H{:.2}\" fill=\"none\" stroke=\"#404040\"/>\n\
         <path d=\"{}\" fill=\"none\" stroke=\"#1f4e9c\" stroke-width=\"2\"/>\n\
         <text x=\"{MARGIN}\" y=\"{:.2}\">friction that the pattern needs, at most {most:.3}</text>\n\
         <text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"end\">arc length, to {length:.3} m</text>",
        bottom - PLOT,
        MARGIN + inner,
        line(&mut { plotted }),
        bottom - PLOT - 10.0,
        MARGIN + inner,
        bottom + 24.0
    );
    if let Some(friction) = friction {
        let (x, y) = at(length, friction);
        let _ = writeln!(
            svg,
            "<path d=\"M{MARGIN} {y:.2}H{x:.2}\" stroke=\"#c8382c\" stroke-dasharray=\"6 5\"/>\n\
             <text x=\"{x:.2}\" y=\"{:.2}\" text-anchor=\"end\" fill=\"#c8382c\">friction of the table, {friction}</text>",
            y - 6.0
        );
    }
    svg.push_str("</svg>\n");
    svg
}
