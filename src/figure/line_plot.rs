//! Curves over a common axis, one plot above the other.

use super::axis::{Axis, AxisScale};
use super::palette;
use plotters::prelude::*;
use plotters::style::RGBColor;

/// A plot of one or more curves.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePlot {
    /// Name and unit of the vertical axis.
    pub label: String,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// A curve and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend; no legend is drawn for a single curve.
    pub name: String,
    /// The points; the curve is broken where there is no value.
    pub points: Vec<(f64, Option<f64>)>,
}

impl Curve {
    /// The stretches of the curve between its breaks, on axes of the given scales.
    fn stretches(
        &self,
        [horizontal, vertical]: [AxisScale; 2],
    ) -> impl Iterator<Item = Vec<(f64, f64)>> {
        let stretches = self
            .points
            .split(move |(x, y)| !(horizontal.holds(*x) && y.is_some_and(|y| vertical.holds(y))));
        stretches.map(|stretch| {
            stretch
                .iter()
                .filter_map(|(x, y)| Some((*x, (*y)?)))
                .collect()
        })
    }
}

/// Width of the page and height of a plot without its legend, pixels.
const WIDTH: u32 = 800;
const BODY: u32 = 194;

/// Grid points per pixel: plotters rounds all coordinates to a grid, on which smooth curves would be stairs.
const FINENESS: u32 = 8;

/// How plots are drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlotStyle {
    /// Scale of the common horizontal axis.
    pub horizontal: AxisScale,
    /// Scales of the vertical axes, plot by plot; linear where there is none.
    pub vertical: Vec<AxisScale>,
    /// Whether each point is marked.
    pub marks: bool,
    /// Names of curves whose points are marked and not joined: what is compared with a law.
    pub unjoined: Vec<String>,
    /// Names of curves that are dashed: predictions.
    pub dashed: Vec<String>,
    /// Height of each plot without its legend, pixels; the usual one where it is 0.
    pub height: u32,
}

/// Draws plots one above the other as an SVG, all over the same horizontal axis, with linear axes.
pub fn line_plots(plots: &[LinePlot], horizontal_label: &str) -> String {
    styled_line_plots(plots, horizontal_label, &PlotStyle::default())
}

/// Draws plots one above the other as an SVG, all over the same horizontal axis. Curves are broken where a
/// point has no place on a logarithmic axis.
pub fn styled_line_plots(plots: &[LinePlot], horizontal_label: &str, style: &PlotStyle) -> String {
    let mut svg = String::new();
    let legends: Vec<Legend> = (0..plots.len())
        .map(|index| {
            let above = index.checked_sub(1).map(|above| &plots[above]);
            Legend::of(&plots[index], above)
        })
        .collect();
    let body_height = if style.height == 0 {
        BODY
    } else {
        style.height
    };
    let heights = legends.iter().map(|legend| legend.height + body_height);
    let (width, height) = (WIDTH, heights.sum::<u32>().max(body_height));
    let (fine_width, fine_height) = (pixels(width), pixels(height));
    {
        let page = SVGBackend::with_string(&mut svg, (fine_width, fine_height)).into_drawing_area();
        page.fill(&WHITE).expect(DRAWN_IN_MEMORY);
        let across = plots.iter().flat_map(points).map(|(x, _)| x);
        let horizontal = Axis::around(style.horizontal, across);
        let mut rest = page.clone();
        for (index, (plot, legend)) in plots.iter().zip(&legends).enumerate() {
            let (head, below) = rest.split_vertically(pixels(legend.height));
            let (body, below) = below.split_vertically(pixels(body_height));
            let scale = style.vertical.get(index).copied().unwrap_or_default();
            let vertical = Axis::around(scale, points(plot).filter_map(|(_, y)| y));
            let axes = Axes {
                scales: [style.horizontal, scale],
                horizontal: horizontal.clone(),
                vertical,
                horizontal_label,
            };
            legend.draw(plot, &head);
            draw(plot, &body, axes, style);
            rest = below;
        }
        page.present().expect(DRAWN_IN_MEMORY);
    }
    // The size on the page; the view box keeps the fine grid.
    svg.replacen(
        &format!("width=\"{fine_width}\" height=\"{fine_height}\""),
        &format!("width=\"{width}\" height=\"{height}\""),
        1,
    )
}

const DRAWN_IN_MEMORY: &str = "an SVG drawn in memory does not fail";

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// The axes of one plot.
struct Axes<'a> {
    scales: [AxisScale; 2],
    horizontal: Axis,
    vertical: Axis,
    horizontal_label: &'a str,
}

/// Pixels in units of the fine grid.
fn pixels(count: u32) -> u32 {
    FINENESS * count
}

fn font() -> FontDesc<'static> {
    ("sans-serif", pixels(13)).into_font()
}

fn draw(plot: &LinePlot, area: &Area, axes: Axes, style: &PlotStyle) {
    let font = font();
    let mut chart = ChartBuilder::on(area)
        .margin_left(pixels(8))
        .margin_right(pixels(16))
        .x_label_area_size(pixels(44))
        .y_label_area_size(pixels(84))
        .build_cartesian_2d(axes.horizontal, axes.vertical)
        .expect(DRAWN_IN_MEMORY);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.1).stroke_width(pixels(1)))
        .axis_style(BLACK.stroke_width(pixels(1)))
        .label_style(font)
        .set_all_tick_mark_size(pixels(4))
        .x_desc(axes.horizontal_label)
        .y_desc(&plot.label)
        .y_labels(5)
        .draw()
        .expect(DRAWN_IN_MEMORY);
    for (index, curve) in plot.curves.iter().enumerate() {
        let joined = !style.unjoined.contains(&curve.name);
        for stretch in curve.stretches(axes.scales) {
            if style.marks || !joined {
                let mark =
                    |point: &(f64, f64)| Circle::new(*point, pixels(3), color(index).filled());
                let marks: Vec<_> = stretch.iter().map(mark).collect();
                chart.draw_series(marks).expect(DRAWN_IN_MEMORY);
            }
            // A single point is no line.
            if joined && stretch.len() > 1 {
                let line = color(index).stroke_width(pixels(2));
                if style.dashed.contains(&curve.name) {
                    let series = DashedLineSeries::new(stretch, pixels(6), pixels(5), line);
                    chart.draw_series(series).expect(DRAWN_IN_MEMORY);
                } else {
                    let series = LineSeries::new(stretch, line);
                    chart.draw_series(series).expect(DRAWN_IN_MEMORY);
                }
            }
        }
    }
}

/// Names of the curves above a plot, each behind a stroke of its colour, in as many rows as they need.
struct Legend {
    /// Left ends of the strokes and the rows they stand in, pixels.
    places: Vec<(u32, u32)>,
    /// Height of all rows, pixels.
    height: u32,
}

impl Legend {
    /// Height of a row, and of the space above a plot without a legend, pixels.
    const ROW: u32 = 26;
    /// Where rows begin, pixels: above the vertical axis.
    const LEFT: u32 = 92;

    /// No names stand over a single curve, nor where they are those of the plot above.
    fn of(plot: &LinePlot, above: Option<&LinePlot>) -> Self {
        let names = |plot: &LinePlot| -> Vec<String> {
            plot.curves.iter().map(|curve| curve.name.clone()).collect()
        };
        let repeats = above.is_some_and(|above| names(above) == names(plot));
        let named = if plot.curves.len() > 1 && !repeats {
            plot.curves.as_slice()
        } else {
            &[]
        };
        let (mut x, mut row) = (Self::LEFT, 0);
        let mut places = Vec::new();
        for curve in named {
            let width = 44 + 8 * curve.name.chars().count() as u32;
            if x + width > WIDTH && x > Self::LEFT {
                (x, row) = (Self::LEFT, row + 1);
            }
            places.push((x, row));
            x += width;
        }
        Self {
            places,
            height: Self::ROW * (row + 1),
        }
    }

    fn draw(&self, plot: &LinePlot, area: &Area) {
        let stroke = pixels(16) as i32;
        for (index, (curve, &(x, row))) in plot.curves.iter().zip(&self.places).enumerate() {
            let (x, y) = (pixels(x) as i32, pixels(14 + Self::ROW * row) as i32);
            let style = color(index).stroke_width(pixels(2));
            let line = PathElement::new([(x, y), (x + stroke, y)], style);
            let beside = (x + stroke * 3 / 2, y - pixels(6) as i32);
            let name = Text::new(curve.name.as_str(), beside, font());
            area.draw(&line).expect(DRAWN_IN_MEMORY);
            area.draw(&name).expect(DRAWN_IN_MEMORY);
        }
    }
}

fn color(index: usize) -> RGBColor {
    let [red, green, blue] = palette::Color::of(index).bytes();
    RGBColor(red, green, blue)
}

fn points(plot: &LinePlot) -> impl Iterator<Item = (f64, Option<f64>)> {
    plot.curves
        .iter()
        .flat_map(|curve| curve.points.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(name: &str, scale: f64) -> Curve {
        Curve {
            name: name.into(),
            points: (0..50)
                .map(|k| 0.1 * f64::from(k))
                .map(|t| (t, Some(scale * t.sin())))
                .collect(),
        }
    }

    #[test]
    fn every_curve_is_drawn_and_legends_stand_where_there_are_several() {
        let several = LinePlot {
            label: "Energy in J".into(),
            curves: vec![curve("kinetic", 1.0), curve("bending", 2.0)],
        };
        let single = LinePlot {
            label: "Contacts".into(),
            curves: vec![curve("contacts", 3.0)],
        };
        let svg = line_plots(&[several, single], "Time in s");
        for word in ["Energy in J", "kinetic", "bending", "Contacts", "Time in s"] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("contacts"));
        for index in 0..2 {
            let [red, green, blue] = palette::Color::of(index).bytes();
            let color = format!("#{red:02X}{green:02X}{blue:02X}");
            assert!(svg.contains(&color), "{color}");
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
        let constant = Curve {
            name: "constant".into(),
            points,
        };
        let zero = Curve {
            name: "zero".into(),
            points: vec![(0.0, Some(0.0)), (1.0, Some(0.0))],
        };
        let empty = Curve {
            name: "empty".into(),
            points: vec![],
        };
        for curve in [constant, zero, empty] {
            let svg = line_plots(
                &[LinePlot {
                    label: "y".into(),
                    curves: vec![curve],
                }],
                "x",
            );
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"));
        }
    }

    #[test]
    fn a_curve_is_broken_where_there_is_no_value() {
        let values = [Some(1.0), Some(2.0), None, Some(3.0), Some(4.0), Some(5.0)];
        let points = values
            .into_iter()
            .enumerate()
            .map(|(k, y)| (k as f64, y))
            .collect();
        let curve = Curve {
            name: "broken".into(),
            points,
        };
        let lengths: Vec<usize> = curve
            .stretches([AxisScale::Linear; 2])
            .map(|stretch| stretch.len())
            .collect();
        assert_eq!(lengths, [2, 3]);
        let svg = line_plots(
            &[LinePlot {
                label: "y".into(),
                curves: vec![curve],
            }],
            "x",
        );
        let [red, green, blue] = palette::Color::of(0).bytes();
        assert_eq!(
            svg.matches(&format!("stroke=\"#{red:02X}{green:02X}{blue:02X}\""))
                .count(),
            2
        );
    }

    #[test]
    fn what_has_no_place_on_a_logarithmic_axis_breaks_the_curve() {
        let values = [1.0, 10.0, 0.0, -3.0, 100.0];
        let curve = Curve {
            name: "broken".into(),
            points: (1..).map(f64::from).zip(values.map(Some)).collect(),
        };
        let scales = [AxisScale::Linear, AxisScale::Logarithmic];
        let stretches: Vec<usize> = curve.stretches(scales).map(|one| one.len()).collect();
        assert_eq!(stretches.iter().filter(|length| **length > 0).count(), 2);
        let plot = LinePlot {
            label: "y".into(),
            curves: vec![curve],
        };
        let style = PlotStyle {
            vertical: vec![AxisScale::Logarithmic],
            marks: true,
            ..PlotStyle::default()
        };
        let svg = styled_line_plots(&[plot], "x", &style);
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn a_dashed_curve_is_drawn_in_many_strokes() {
        let plot = LinePlot {
            label: "y".into(),
            curves: vec![Curve {
                name: "predicted".into(),
                points: vec![(1.0, Some(0.0)), (1.0, Some(2.0))],
            }],
        };
        let strokes = |dashed: &[&str]| {
            let style = PlotStyle {
                dashed: dashed.iter().map(|name| (*name).to_owned()).collect(),
                ..PlotStyle::default()
            };
            let svg = styled_line_plots(std::slice::from_ref(&plot), "x", &style);
            let [red, green, blue] = palette::Color::of(0).bytes();
            svg.matches(&format!("stroke=\"#{red:02X}{green:02X}{blue:02X}\""))
                .count()
        };
        assert_eq!(strokes(&[]), 1);
        assert!(strokes(&["predicted"]) > 5);
    }

    #[test]
    fn many_names_stand_in_several_rows() {
        let plot = LinePlot {
            label: "y".into(),
            curves: (0..20)
                .map(|k| curve(&format!("curve number {k}"), 1.0))
                .collect(),
        };
        assert!(Legend::of(&plot, Some(&plot)).places.is_empty());
        let legend = Legend::of(&plot, None);
        assert!(legend.height >= 4 * Legend::ROW, "{}", legend.height);
        assert!(legend.places.iter().all(|(x, _)| *x < WIDTH - 100));
    }
}
