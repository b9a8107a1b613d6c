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
    /// The points; a gap in the data is simply left out of them.
    pub points: Vec<(f64, f64)>,
}

const WIDTH: u32 = 800;
const HEIGHT: u32 = 220;

/// Draws plots one above the other as an SVG, all over the same horizontal axis.
pub fn line_plots(plots: &[LinePlot], horizontal_label: &str) -> String {
    let mut svg = String::new();
    {
        let height = HEIGHT * plots.len().max(1) as u32;
        let page = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        page.fill(&WHITE).expect(DRAWN_IN_MEMORY);
        let horizontal = range(plots.iter().flat_map(points).map(|(x, _)| *x));
        for (plot, area) in plots.iter().zip(page.split_evenly((plots.len().max(1), 1))) {
            draw(plot, &area, horizontal.clone(), horizontal_label);
        }
        page.present().expect(DRAWN_IN_MEMORY);
    }
    svg
}

const DRAWN_IN_MEMORY: &str = "an SVG drawn in memory does not fail";

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw(plot: &LinePlot, area: &Area, horizontal: Range<f64>, horizontal_label: &str) {
    let vertical = range(points(plot).map(|(_, y)| *y));
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(76)
        .build_cartesian_2d(horizontal, vertical)
        .expect(DRAWN_IN_MEMORY);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.1))
        .x_desc(horizontal_label)
        .y_desc(&plot.label)
        .y_labels(5)
        .y_label_formatter(&|value| number_label(*value))
        .draw()
        .expect(DRAWN_IN_MEMORY);
    for (index, curve) in plot.curves.iter().enumerate() {
        let [red, green, blue] = palette::Color::of(index).bytes();
        let color = RGBColor(red, green, blue);
        let series = LineSeries::new(curve.points.iter().copied(), color.stroke_width(2));
        let drawn = chart.draw_series(series).expect(DRAWN_IN_MEMORY);
        drawn
            .label(&curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
    }
    if plot.curves.len() > 1 {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.8))
            .draw()
            .expect(DRAWN_IN_MEMORY);
    }
}

fn points(plot: &LinePlot) -> impl Iterator<Item = &(f64, f64)> {
    plot.curves.iter().flat_map(|curve| &curve.points)
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
                .map(|t| (t, scale * t.sin()))
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
        let points = vec![(0.0, 3.0), (1.0, 3.0), (2.0, f64::INFINITY)];
        let constant = Curve {
            name: "constant".into(),
            points,
        };
        let zero = Curve {
            name: "zero".into(),
            points: vec![(0.0, 0.0), (1.0, 0.0)],
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
