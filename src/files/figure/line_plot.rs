//! Curves over a common axis, one plot above the other.

use super::Figure;
use super::axis::{Axis, AxisScale, Ticks};
use super::colour_field::DrawnField;
use super::curve::{LinePlot, styles};
use super::drawing::{Anchor, Drawing, Words};
use super::legend::Legend;
use super::paper::Paper;
use super::place_names::PlaceNames;
use super::plot_axes::{
    Axes, Frame, GAP, TICK, draw_horizontal, draw_vertical, ticks_that_fit, widest_label,
};
use super::plot_curves::{draw_curve, draw_sample};

/// Options of plots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotStyle {
    /// Scale of the common horizontal axis.
    pub horizontal: AxisScale,
    /// Scales of the vertical axes, plot by plot; linear if not given.
    pub vertical: Vec<AxisScale>,
    /// Height of each plot relative to the font size; 0 for the default.
    pub height: f64,
    /// Whether both axes have the same scale, for shapes.
    pub is_to_scale: bool,
    /// Names of the positions 1, 2, 3, ... of the horizontal axis, if it has no numbers.
    pub names: Vec<String>,
}

/// Plots one above the other over the same horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct LineFigure {
    plots: Vec<LinePlot>,
    horizontal_label: String,
    style: PlotStyle,
}

/// Plots one above the other, all over the same horizontal axis, with linear axes.
pub fn line_plots(plots: impl Into<Vec<LinePlot>>, horizontal_label: &str) -> Figure {
    styled_line_plots(plots, horizontal_label, PlotStyle::default())
}

/// Plots one above the other over named positions 1, 2, 3, ...
pub fn named_plots(
    plots: impl Into<Vec<LinePlot>>,
    names: impl IntoIterator<Item = impl Into<String>>,
) -> Figure {
    let style = PlotStyle {
        names: names.into_iter().map(Into::into).collect(),
        ..PlotStyle::default()
    };
    styled_line_plots(plots, "", style)
}

/// A plot with the same scale on both axes, such as a view from above.
pub fn plot_to_scale(plot: LinePlot, horizontal_label: &str) -> Figure {
    let style = PlotStyle {
        is_to_scale: true,
        ..PlotStyle::default()
    };
    styled_line_plots([plot], horizontal_label, style)
}

/// Plots one above the other, all over the same horizontal axis. Curves are interrupted at points
/// that have no position on a logarithmic axis.
pub fn styled_line_plots(
    plots: impl Into<Vec<LinePlot>>,
    horizontal_label: &str,
    style: PlotStyle,
) -> Figure {
    Figure::Lines(LineFigure {
        plots: plots.into(),
        horizontal_label: horizontal_label.into(),
        style,
    })
}

/// Lengths relative to the font size.
const MARGIN: f64 = 0.5;
/// Height of a line of text.
const TEXT: f64 = 1.3;
/// Heights of a plot: the default, and the maximum relative to the width.
const HEIGHT: f64 = 14.0;
const HEIGHT_OVER_WIDTH: f64 = 0.5;
const TALLEST_OVER_WIDTH: f64 = 0.8;
/// Space above a plot without a legend.
const HEAD: f64 = 0.8;

impl LineFigure {
    /// The plots.
    pub fn plots(&self) -> &[LinePlot] {
        &self.plots
    }

    /// Name and unit of the horizontal axis.
    pub fn horizontal_label(&self) -> &str {
        &self.horizontal_label
    }

    /// Draws the figure as SVG.
    pub(super) fn svg(&self, paper: &Paper) -> String {
        let em = paper.em;
        let across = self.plots.iter().flat_map(points);
        let across = across.filter_map(|(x, y)| y.map(|_| x));
        let places = self.style.names.len();
        let horizontal = if places > 0 {
            Axis::over(0.5..places as f64 + 0.5)
        } else {
            Axis::around(self.style.horizontal, across)
        };
        let scale = |index: usize| self.style.vertical.get(index).copied().unwrap_or_default();
        let verticals: Vec<Axis> = self
            .plots
            .iter()
            .enumerate()
            .map(|(index, plot)| {
                // Marks at named positions are compared by their height above zero, so the axis
                // includes zero.
                let zero = (places > 0 && scale(index) == AxisScale::Linear).then_some(0.0);
                let values = points(plot).filter_map(|(_, y)| y);
                Axis::around(scale(index), values.chain(zero))
            })
            .collect();
        let height = self.height_of_a_plot(paper);
        let ticks: Vec<Ticks> = verticals
            .iter()
            .map(|axis| axis.ticks((height / (2.2 * em)) as usize))
            .collect();
        let widest = ticks.iter().map(widest_label).fold(0.0, f64::max);
        let left = em * (MARGIN + TEXT + GAP + widest + GAP + TICK);
        let fields: Vec<Option<DrawnField>> = (self.plots.iter())
            .map(|plot| plot.field.as_ref().map(|field| DrawnField::new(field, em)))
            .collect();
        let bars = fields.iter().flatten().map(DrawnField::room);
        let mut right = paper.width - em * (MARGIN + 0.8) - bars.fold(0.0, f64::max);
        let mut height = height;
        if self.style.is_to_scale
            && let [vertical] = &verticals[..]
        {
            let size = |axis: &Axis| axis.range.end - axis.range.start;
            let most = TALLEST_OVER_WIDTH * paper.width;
            let unit = ((right - left) / size(&horizontal)).min(most / size(vertical));
            (right, height) = (left + unit * size(&horizontal), unit * size(vertical));
        }
        let names = PlaceNames::within(right - left, &self.style.names, em);
        let below = if places > 0 {
            let between = (1..places).map(|place| (place as f64 + 0.5, String::new()));
            Ticks {
                labelled: between.collect(),
                ..Ticks::default()
            }
        } else {
            ticks_that_fit(&horizontal, right - left, em)
        };
        let mut drawing = Drawing::new(paper.width);
        let mut top = em * MARGIN;
        for (index, plot) in self.plots.iter().enumerate() {
            let above = index.checked_sub(1).map(|above| &self.plots[above]);
            let (listed, names): (Vec<usize>, _) = names_in_legend(plot, above).into_iter().unzip();
            let legend = Legend::between(left, paper.width - em * MARGIN, names, em);
            let styles = styles(&plot.curves);
            legend.draw(top, &mut drawing, |index, ends, height, drawing| {
                draw_sample(&styles[listed[index]], ends, height, em, drawing);
            });
            let room = if ticks[index].factor.is_some() {
                TEXT
            } else {
                HEAD
            };
            top += legend.height() + em * room;
            let frame = Frame {
                left,
                right,
                top,
                bottom: top + height,
            };
            let axes = Axes {
                frame,
                horizontal: &horizontal,
                vertical: &verticals[index],
            };
            draw_vertical(&axes, &ticks[index], &plot.label, em, &mut drawing);
            let is_last = index + 1 == self.plots.len();
            draw_horizontal(&axes, &below, is_last, em, &mut drawing);
            if let Some(field) = &fields[index] {
                field.draw(&axes, &mut drawing);
                field.draw_bar(frame, &mut drawing);
            }
            for (curve, style) in plot.curves.iter().zip(&styles) {
                if fields[index].is_some() {
                    draw_curve(curve, &style.casing(), &axes, em, &mut drawing);
                }
                draw_curve(curve, style, &axes, em, &mut drawing);
            }
            top += height + em * TICK;
        }
        if places > 0 {
            let axis = top - em * TICK;
            let at = |place: f64| left + (right - left) * horizontal.part(place);
            names.draw(axis, at, &mut drawing);
            return drawing.finish(axis + names.height() + em * MARGIN);
        }
        let words = [
            (&self.horizontal_label, 0.5 * (left + right), Anchor::Middle),
            (
                &below.factor.clone().unwrap_or_default(),
                right,
                Anchor::End,
            ),
        ];
        for (text, x, anchor) in words {
            let base = top + em * (GAP + 2.0 * TEXT);
            drawing.text(Words {
                text,
                at: [x, base],
                size: em,
                anchor,
                upright: false,
            });
        }
        drawing.finish(top + em * (GAP + 2.0 * TEXT + 0.3 + MARGIN))
    }

    fn height_of_a_plot(&self, paper: &Paper) -> f64 {
        let asked = if self.style.height > 0.0 {
            self.style.height
        } else {
            HEIGHT
        };
        (asked * paper.em).min(HEIGHT_OVER_WIDTH * paper.width)
    }
}

/// The indices and names of the named curves, if there are several and they differ from those of
/// the plot above.
fn names_in_legend(plot: &LinePlot, above: Option<&LinePlot>) -> Vec<(usize, String)> {
    let of = |plot: &LinePlot| -> Vec<(usize, String)> {
        let names = plot.curves.iter().map(|curve| curve.name.clone());
        names
            .enumerate()
            .filter(|(_, name)| !name.is_empty())
            .collect()
    };
    let names = of(plot);
    if names.len() < 2 || above.is_some_and(|above| of(above) == names) {
        return Vec::new();
    }
    names
}

fn points(plot: &LinePlot) -> impl Iterator<Item = (f64, Option<f64>)> + Clone {
    let of_curves = plot.curves.iter().flat_map(|curve| curve.points.iter());
    let values = plot.field.iter().flat_map(|field| &field.values);
    (of_curves.copied()).chain(values.map(|&[x, y, _]| (x, Some(y))))
}

#[cfg(test)]
mod tests {
    use super::super::colour_field::ColourField;
    use super::super::curve::{Curve, Look};
    use super::super::palette::Color;
    use super::*;

    fn curve(name: &str, scale: f64) -> Curve {
        let points = (0..50).map(|k| 0.1 * f64::from(k));
        let points = points.map(|t| (t, Some(scale * t.sin())));
        Curve::new(name, points.collect())
    }

    fn plot(label: &str, curves: Vec<Curve>) -> LinePlot {
        LinePlot::new(label, curves)
    }

    fn svg(plots: Vec<LinePlot>) -> String {
        line_plots(plots, "Time in s").svg(&Paper::default())
    }

    fn count(svg: &str, words: &str) -> usize {
        svg.matches(&format!("aria-label=\"{words}\"")).count()
    }

    #[test]
    fn the_horizontal_axis_is_labelled_once_below_all_plots() {
        let two = || vec![curve("kinetic", 1.0), curve("bending", 2.0)];
        let svg = svg(vec![
            plot("Energy in J", two()),
            plot("Power in W", two()),
            plot("Contacts", vec![curve("contacts", 3.0)]),
        ]);
        for words in ["Energy in J", "Power in W", "Contacts", "Time in s"] {
            assert_eq!(count(&svg, words), 1, "{words}");
        }
        // This tick is not on the vertical axes.
        assert_eq!(count(&svg, "4"), 1);
        // A legend is drawn above the first of two plots with the same names, and not for a single
        // curve.
        assert_eq!((count(&svg, "kinetic"), count(&svg, "contacts")), (1, 0));
        for index in 0..2 {
            assert!(svg.contains(&Color::of(index).hex()));
        }
    }

    #[test]
    fn constant_empty_and_infinite_data_are_drawn() {
        let points = vec![
            (0.0, Some(3.0)),
            (1.0, Some(3.0)),
            (2.0, Some(f64::INFINITY)),
            (3.0, None),
        ];
        let zero = vec![(0.0, Some(0.0)), (1.0, Some(0.0))];
        for points in [points, zero, vec![]] {
            let svg = svg(vec![plot("y", vec![Curve::new("one", points)])]);
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
        }
        assert!(svg(vec![]).ends_with("</svg>\n"));
    }

    #[test]
    fn points_without_a_value_take_no_room() {
        let points = vec![(0.0, Some(0.0)), (1.0, Some(1.0)), (1000.0, None)];
        let svg = svg(vec![plot("y", vec![Curve::new("one", points)])]);
        assert_eq!((count(&svg, "0.8"), count(&svg, "1000")), (2, 0));
    }

    #[test]
    fn places_have_names_instead_of_numbers() {
        let marks = [(1.0, Some(1.0)), (2.0, Some(4.0)), (3.0, None)];
        let marks = Curve::new("found", marks.to_vec()).looking(Look::Marks);
        let figure = named_plots([plot("y", vec![marks])], ["circle", "long name", "third"]);
        let svg = figure.svg(&Paper::default());
        for words in ["circle", "long name", "third"] {
            assert_eq!(count(&svg, words), 1, "{words}");
        }
        assert_eq!(count(&svg, "1.5"), 0);
    }

    #[test]
    fn values_are_colours_with_a_bar_beside_the_plot() {
        let field = ColourField {
            label: "force".into(),
            values: vec![
                [0.0, 0.0, 1.0],
                [1.0, 0.0, 2.0],
                [0.0, 1.0, 3.0],
                [1.0, 1.0, 9.0],
            ],
            cell: Some([1.0, 1.0]),
            most: Some(3.0),
            ..ColourField::default()
        };
        let with_field = LinePlot {
            field: Some(field),
            ..plot("y", vec![curve("way", 0.5)])
        };
        let svg = plot_to_scale(with_field, "x").svg(&Paper::default());
        assert_eq!((count(&svg, "force"), count(&svg, "and above")), (1, 1));
        // A value above the largest has the colour of the largest.
        let highest = Color::of_part(1.0 / 1.06 + 0.03 / 1.06).hex();
        let cells = svg.lines().filter(|line| line.contains(&highest));
        assert_eq!(cells.count(), 2, "{highest}");
    }

    #[test]
    fn shapes_are_drawn_to_scale() {
        let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0)];
        let points = points.map(|(x, y)| (x, Some(y))).to_vec();
        let style = PlotStyle {
            is_to_scale: true,
            ..PlotStyle::default()
        };
        let plots = [plot("y", vec![Curve::new("corner", points)])];
        let svg = styled_line_plots(plots, "x", style).svg(&Paper::default());
        let stroke = format!("stroke=\"{}\"", Color::of(0).hex());
        let line = svg.lines().find(|line| line.contains(&stroke)).unwrap();
        let (_, data) = line.split_once("d=\"M").unwrap();
        let numbers: Vec<f64> = data
            .split('"')
            .next()
            .unwrap()
            .split(['L', ' '])
            .map(|number| number.parse().unwrap())
            .collect();
        let [along, up] = [numbers[2] - numbers[0], numbers[3] - numbers[5]];
        assert!((along / up - 4.0).abs() < 1e-3, "{numbers:?}");
    }
}
