//! Curves over a common axis, one plot above the other.

use super::palette;
use plotters::prelude::*;
use plotters::style::RGBColor;
use std::ops::Range;

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
    /// The stretches of the curve between its breaks.
    fn stretches(&self) -> impl Iterator<Item = Vec<(f64, f64)>> {
        let stretches = self.points.split(|(_, y)| y.is_none());
        stretches.map(|stretch| {
            stretch
                .iter()
                .filter_map(|(x, y)| Some((*x, (*y)?)))
                .collect()
        })
    }
}

/// Size of the page and of a plot, pixels.
const WIDTH: u32 = 800;
const HEIGHT: u32 = 220;

/// Grid points per pixel: plotters rounds all coordinates to a grid, on which smooth curves would be stairs.
const FINENESS: u32 = 8;

/// Draws plots one above the other as an SVG, all over the same horizontal axis.
pub fn line_plots(plots: &[LinePlot], horizontal_label: &str) -> String {
    let mut svg = String::new();
    let rows = plots.len().max(1);
    let (width, height) = (WIDTH, HEIGHT * rows as u32);
    let (fine_width, fine_height) = (FINENESS * width, FINENESS * height);
    {
        let page = SVGBackend::with_string(&mut svg, (fine_width, fine_height)).into_drawing_area();
        page.fill(&WHITE).expect(DRAWN_IN_MEMORY);
        let horizontal = range(plots.iter().flat_map(points).map(|(x, _)| x));
        for (plot, area) in plots.iter().zip(page.split_evenly((rows, 1))) {
            draw(plot, &area, horizontal.clone(), horizontal_label);
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

/// Pixels in units of the fine grid.
fn pixels(count: u32) -> u32 {
    FINENESS * count
}

fn draw(plot: &LinePlot, area: &Area, horizontal: Range<f64>, horizontal_label: &str) {
    let font = ("sans-serif", pixels(13)).into_font();
    let (head, body) = area.split_vertically(pixels(26));
    let vertical = range(points(plot).filter_map(|(_, y)| y));
    let mut chart = ChartBuilder::on(&body)
        .margin_left(pixels(8))
        .margin_right(pixels(16))
        .x_label_area_size(pixels(44))
        .y_label_area_size(pixels(84))
        .build_cartesian_2d(horizontal, vertical)
        .expect(DRAWN_IN_MEMORY);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.1).stroke_width(pixels(1)))
        .axis_style(BLACK.stroke_width(pixels(1)))
        .label_style(font.clone())
        .set_all_tick_mark_size(pixels(4))
        .x_desc(horizontal_label)
        .y_desc(&plot.label)
        .y_labels(5)
        .x_label_formatter(&|value| number_label(*value))
        .y_label_formatter(&|value| number_label(*value))
        .draw()
        .expect(DRAWN_IN_MEMORY);
    for (index, curve) in plot.curves.iter().enumerate() {
        for stretch in curve.stretches() {
            let series = LineSeries::new(stretch, curve_style(index));
            chart.draw_series(series).expect(DRAWN_IN_MEMORY);
        }
    }
    if plot.curves.len() > 1 {
        draw_legend(plot, &head, font);
    }
}

/// Names of the curves in a row above the plot, each behind a stroke of its colour.
fn draw_legend(plot: &LinePlot, area: &Area, font: FontDesc) {
    let stroke = pixels(16) as i32;
    let (mut x, y) = (pixels(92) as i32, pixels(14) as i32);
    for (index, curve) in plot.curves.iter().enumerate() {
        let line = PathElement::new([(x, y), (x + stroke, y)], curve_style(index));
        let name = Text::new(
            curve.name.as_str(),
            (x + stroke * 3 / 2, y - pixels(6) as i32),
            font.clone(),
        );
        area.draw(&line).expect(DRAWN_IN_MEMORY);
        area.draw(&name).expect(DRAWN_IN_MEMORY);
        x += pixels(44 + 8 * curve.name.chars().count() as u32) as i32;
    }
}

fn curve_style(index: usize) -> ShapeStyle {
    let [red, green, blue] = palette::Color::of(index).bytes();
    RGBColor(red, green, blue).stroke_width(pixels(2))
}

fn points(plot: &LinePlot) -> impl Iterator<Item = (f64, Option<f64>)> {
    plot.curves
        .iter()
        .flat_map(|curve| curve.points.iter().copied())
}

/// Range of the finite values with a little room; never empty.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return 0.0..1.0;
    }
    let size = if high > low {
        high - low
    } else {
        low.abs().max(f64::MIN_POSITIVE)
    };
    low - 0.02 * size..high + 0.02 * size
}

/// Four digits at most, in scientific form where the number is small or large.
fn number_label(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) {
        let rounded = (value * 1e4).round() / 1e4;
        format!("{rounded}")
    } else {
        format!("{value:.1e}")
    }
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
        let lengths: Vec<usize> = curve.stretches().map(|stretch| stretch.len()).collect();
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
    fn labels_are_short() {
        for (value, label) in [
            (0.0, "0"),
            (0.30000000000000004, "0.3"),
            (-12.5, "-12.5"),
            (1.5e-7, "1.5e-7"),
        ] {
            assert_eq!(number_label(value), label);
        }
    }
}
