//! Shapes side by side in panels of one scale, with a scale bar instead of axes.

use super::Figure;
use super::axis::Axis;
use super::curve::{Curve, styles};
use super::drawing::{Anchor, Drawing, Stroke, Words, number};
use super::legend::Legend;
use super::palette::Color;
use super::paper::Paper;
use super::plot_axes::{Axes, Frame};
use super::plot_curves::{draw_curve, draw_sample};
use super::scale_bar::{length_label, round_length_below};
use std::ops::Range;

/// A panel: shapes in a plane, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Title of the panel.
    pub title: String,
    /// The curves, in the order of the legend; a curve without points keeps its entry.
    pub curves: Vec<Curve>,
}

/// Panels in rows.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelsFigure {
    panels: Vec<Panel>,
    columns: usize,
}

/// Panels of shapes in rows of `columns`, all to the same scale.
pub fn panels(panels: Vec<Panel>, columns: usize) -> Figure {
    let columns = columns.max(1);
    Figure::Panels(PanelsFigure { panels, columns })
}

/// Lengths relative to the font size.
const MARGIN: f64 = 0.5;
const TITLE: f64 = 1.7;
const BETWEEN: f64 = 1.4;
/// Space below the panels, and length of the scale bar relative to the width of a panel.
const FOOT: f64 = 2.2;
const BAR: f64 = 0.4;
/// Largest height of a panel relative to its width.
const TALLEST: f64 = 1.2;

/// Bounds of the shapes of a panel, m.
#[derive(Clone)]
struct Extent {
    across: Range<f64>,
    up: Range<f64>,
}

impl Extent {
    fn of(panel: &Panel) -> Option<Self> {
        let points = panel.curves.iter().flat_map(|curve| &curve.points);
        let mut points = points.filter_map(|(x, y)| Some((*x, (*y)?)));
        let (x, y) = points.next()?;
        let begin = (x..x, y..y);
        let (across, up) = points.fold(begin, |(across, up), (x, y)| {
            (
                across.start.min(x)..across.end.max(x),
                up.start.min(y)..up.end.max(y),
            )
        });
        // Straight lines along an axis have zero extent across it, which cannot be scaled to
        // pixels.
        let size = (across.end - across.start).max(up.end - up.start);
        let widened = |range: Range<f64>| {
            let by = if range.start < range.end {
                0.0
            } else {
                1e-6 * size + 1e-12
            };
            range.start - by..range.end + by
        };
        Some(Self {
            across: widened(across),
            up: widened(up),
        })
    }

    fn width(&self) -> f64 {
        self.across.end - self.across.start
    }

    fn height(&self) -> f64 {
        self.up.end - self.up.start
    }
}

impl PanelsFigure {
    /// Draws the figure as SVG.
    pub(super) fn svg(&self, paper: &Paper) -> String {
        let em = paper.em;
        let [left, right] = [MARGIN * em, paper.width - MARGIN * em];
        let mut drawing = Drawing::new(paper.width);
        let curves = self.panels.first().map_or(&[][..], |panel| &panel.curves);
        let names = curves.iter().map(|curve| curve.name.clone()).collect();
        let legend = Legend::between(left, right, names, em);
        let legend_styles = styles(curves);
        legend.draw(em * MARGIN, &mut drawing, |index, ends, height, drawing| {
            draw_sample(&legend_styles[index], ends, height, em, drawing);
        });
        let gaps = (self.columns - 1) as f64 * BETWEEN * em;
        let width = (right - left - gaps) / self.columns as f64;
        let extents: Vec<_> = self.panels.iter().map(Extent::of).collect();
        let known = || extents.iter().flatten();
        let widest = known().map(Extent::width).fold(0.0, f64::max);
        let tallest = known().map(Extent::height).fold(0.0, f64::max);
        // Pixels per metre.
        let unit = (width / widest).min(TALLEST * width / tallest);
        let unit = if unit.is_finite() { unit } else { 1.0 };
        let mut top = em * (MARGIN + 0.6) + legend.height();
        let rows = self.panels.chunks(self.columns);
        for (panels, extents) in rows.zip(extents.chunks(self.columns)) {
            let heights = extents.iter().flatten().map(Extent::height);
            let height = unit * heights.fold(0.0, f64::max);
            for (column, (panel, extent)) in panels.iter().zip(extents).enumerate() {
                let begin = left + column as f64 * (width + BETWEEN * em);
                drawing.text(Words {
                    text: &panel.title,
                    at: [begin, top + em],
                    size: em,
                    anchor: Anchor::Start,
                    upright: false,
                });
                if let Some(extent) = extent {
                    let frame = Frame {
                        left: begin,
                        right: begin + unit * extent.width(),
                        top: top + TITLE * em + 0.5 * (height - unit * extent.height()),
                        bottom: top + TITLE * em + 0.5 * (height + unit * extent.height()),
                    };
                    draw_panel(panel, extent, frame, em, &mut drawing);
                }
            }
            top += TITLE * em + height + BETWEEN * em;
        }
        let length = round_length_below(BAR * width / unit);
        draw_scale_bar(length, unit, [right, top], em, &mut drawing);
        drawing.finish(top + FOOT * em)
    }
}

fn draw_panel(panel: &Panel, extent: &Extent, frame: Frame, em: f64, drawing: &mut Drawing) {
    let axes = Axes {
        frame,
        horizontal: &Axis::over(extent.across.clone()),
        vertical: &Axis::over(extent.up.clone()),
    };
    let styles = styles(&panel.curves);
    // Lower items are drawn first.
    let mut order: Vec<usize> = (0..panel.curves.len()).collect();
    order.sort_by_key(|index| !styles[*index].is_broad());
    for index in order {
        draw_curve(&panel.curves[index], &styles[index], &axes, em, drawing);
    }
}

/// A bar of a length (m) that ends at a point, with its label above it.
fn draw_scale_bar(length: f64, unit: f64, [right, y]: [f64; 2], em: f64, drawing: &mut Drawing) {
    let left = right - unit * length;
    let base = y + 1.2 * em;
    let bar = format!("M{} {}H{}", number(left), number(base), number(right));
    drawing.path(&bar, &Stroke::solid(Color::BLACK, 0.16 * em), None);
    drawing.text(Words {
        text: &length_label(length),
        at: [0.5 * (left + right), base - 0.4 * em],
        size: em,
        anchor: Anchor::Middle,
        upright: false,
    });
}

#[cfg(test)]
mod tests {
    use super::super::curve::Look;
    use super::*;

    fn square(size: f64) -> Curve {
        let corners = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)];
        let points = corners.map(|(x, y)| (x, Some(y)));
        Curve::new("rod", points.to_vec()).looking(Look::Bare)
    }

    #[test]
    fn lines_along_an_axis_are_drawn() {
        let line = |points: [(f64, f64); 2]| Panel {
            title: "line".into(),
            curves: vec![
                Curve::new("rod", points.map(|(x, y)| (x, Some(y))).to_vec()).looking(Look::Bare),
            ],
        };
        for ends in [
            [(0.0, 0.3), (0.5, 0.3)],
            [(0.3, 0.0), (0.3, 0.5)],
            [(0.3, 0.3); 2],
        ] {
            let svg = panels(vec![line(ends)], 2).svg(&Paper::default());
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }

    #[test]
    fn panels_have_one_scale_and_one_bar() {
        let titles = ["small", "large", "none"];
        let shapes = [vec![square(0.1)], vec![square(0.2)], vec![]];
        let all = titles.into_iter().zip(shapes);
        let all = all.map(|(title, curves)| Panel {
            title: title.into(),
            curves,
        });
        let figure = panels(all.collect(), 2);
        let svg = figure.svg(&Paper::default());
        for words in titles.iter().chain(&["rod", "5 cm"]) {
            assert_eq!(
                svg.matches(&format!("aria-label=\"{words}\"")).count(),
                1,
                "{words}"
            );
        }
        let sides = svg.lines().filter(|line| line.contains("fill=\"none\""));
        let width = |line: &str| -> Option<f64> {
            let (_, data) = line.split_once("d=\"M")?;
            let (first, rest) = data.split_once(['L', 'H'])?;
            let next = rest.split(['L', '"']).next()?;
            let x = |point: &str| point.split(' ').next()?.parse::<f64>().ok();
            Some(x(next)? - x(first)?)
        };
        let widths: Vec<f64> = sides.filter_map(width).collect();
        // Widths of the sample in the legend, the two sides and the bar.
        assert_eq!(widths.len(), 4, "{widths:?}");
        assert!((widths[2] / widths[1] - 2.0).abs() < 1e-2, "{widths:?}");
        assert!((widths[3] / widths[2] - 0.25).abs() < 1e-2, "{widths:?}");
    }
}
