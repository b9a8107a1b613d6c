//! Rods at several times, side by side on one scale.

use super::markup::escape;
use super::tube::{Placement, RodCurve, tubes};
use super::view::View;
use nalgebra::{Vector2, Vector3};

/// Rods at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// What stands above the picture.
    pub title: String,
    /// The rods, in the order of their colours.
    pub rods: Vec<RodCurve>,
}

/// Width of the page and greatest height of all drawings on it together, pixels.
const PAGE_WIDTH: f64 = 960.0;
const MAXIMUM_HEIGHT: f64 = 520.0;
const MARGIN: f64 = 16.0;
/// Room for the title above each drawing, and for the scale bar and the axes below all.
const HEAD: f64 = 30.0;
const FOOT: f64 = 56.0;

/// Draws snapshots side by side as an SVG: same view, same scale, tubes of true radius.
///
/// Wide scenes stand in several rows, whatever makes them largest. Lengths across the view are true; what
/// lies farther from the eye is paler. The scale bar and the axes of the scene stand below.
pub fn snapshots(snapshots: &[Snapshot], view: &View) -> String {
    let extent = Extent::of(snapshots, view);
    let grid = Grid::largest(snapshots.len().max(1), &extent);
    let height = grid.rows as f64 * grid.cell.y + FOOT;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {PAGE_WIDTH} {height:.0}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"14\" text-anchor=\"middle\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    for (index, snapshot) in snapshots.iter().enumerate() {
        let corner = grid.corner(index);
        let middle = Vector2::new(0.5 * grid.cell.x, 0.5 * (HEAD + grid.cell.y));
        let centre = extent.centre();
        let origin = corner + middle - grid.scale * Vector2::new(centre.x, -centre.y);
        let placement = Placement {
            origin,
            scale: grid.scale,
        };
        svg += &text(
            corner + Vector2::new(middle.x, 20.0),
            &escape(&snapshot.title),
        );
        svg += "<g fill=\"none\">\n";
        svg += &tubes(&snapshot.rods, view, &placement);
        svg += "</g>\n";
    }
    svg += &scale_bar(Vector2::new(MARGIN, height - 14.0), grid.scale);
    svg += &axes(Vector2::new(PAGE_WIDTH - 44.0, height - 26.0), view);
    svg + "</svg>\n"
}

/// How the drawings are laid out.
struct Grid {
    columns: usize,
    rows: usize,
    /// Size of a drawing with its margins and title, pixels.
    cell: Vector2<f64>,
    /// Pixels per metre.
    scale: f64,
}

impl Grid {
    /// The grid on which the drawings are largest, and of equals the one with the fewest rows.
    fn largest(drawings: usize, extent: &Extent) -> Self {
        let grids = (1..=drawings).map(|rows| Self::with_rows(rows, drawings, extent));
        grids
            .reduce(|best, grid| {
                if grid.scale > 1.001 * best.scale {
                    grid
                } else {
                    best
                }
            })
            .expect("there is at least one row")
    }

    fn with_rows(rows: usize, drawings: usize, extent: &Extent) -> Self {
        let columns = drawings.div_ceil(rows);
        let size = extent.size();
        let width = (PAGE_WIDTH - MARGIN) / columns as f64;
        let height = MAXIMUM_HEIGHT / rows as f64 - HEAD;
        let scale = ((width - MARGIN) / size.x).min(height / size.y);
        Self {
            columns,
            rows,
            cell: Vector2::new(width, HEAD + scale * size.y),
            scale,
        }
    }

    /// Top left corner of a drawing.
    fn corner(&self, index: usize) -> Vector2<f64> {
        let (row, column) = (index / self.columns, index % self.columns);
        Vector2::new(
            0.5 * MARGIN + column as f64 * self.cell.x,
            row as f64 * self.cell.y,
        )
    }
}

/// Smallest rectangle on the picture plane that holds all rods with their thickness, m.
struct Extent {
    low: Vector2<f64>,
    high: Vector2<f64>,
}

impl Extent {
    fn of(snapshots: &[Snapshot], view: &View) -> Self {
        let mut extent = Self {
            low: Vector2::repeat(f64::INFINITY),
            high: Vector2::repeat(f64::NEG_INFINITY),
        };
        for rod in snapshots.iter().flat_map(|snapshot| &snapshot.rods) {
            // A margin beyond the surface leaves room for the bulge of the spline.
            let reach = Vector2::repeat(1.5 * rod.radius);
            for point in &rod.points {
                let point = view.project(point);
                let point = Vector2::new(point.x, point.y);
                extent.low = extent.low.inf(&(point - reach));
                extent.high = extent.high.sup(&(point + reach));
            }
        }
        if extent
            .size()
            .iter()
            .all(|side| side.is_finite() && *side > 0.0)
        {
            extent
        } else {
            Self {
                low: Vector2::repeat(-0.5),
                high: Vector2::repeat(0.5),
            }
        }
    }

    fn size(&self) -> Vector2<f64> {
        self.high - self.low
    }

    fn centre(&self) -> Vector2<f64> {
        0.5 * (self.low + self.high)
    }
}

/// A bar of round length, at most 160 pixels long, that starts at `start`.
fn scale_bar(start: Vector2<f64>, scale: f64) -> String {
    let length = round_length_below(160.0 / scale);
    let end = start + Vector2::new(scale * length, 0.0);
    let label = text(
        0.5 * (start + end) - Vector2::new(0.0, 8.0),
        &length_label(length),
    );
    format!(
        "<path d=\"M{:.1} {:.1}v8m0 -4H{:.1}m0 -4v8\" stroke=\"#000000\" stroke-width=\"1.5\" fill=\"none\"/>\n{label}",
        start.x,
        start.y - 4.0,
        end.x
    )
}

/// The largest of 1, 2, 5 times a power of ten that is not above `limit`.
fn round_length_below(limit: f64) -> f64 {
    let power = 10f64.powf(limit.log10().floor());
    let factor = [5.0, 2.0]
        .into_iter()
        .find(|factor| factor * power <= limit)
        .unwrap_or(1.0);
    factor * power
}

fn length_label(length: f64) -> String {
    let (factor, unit) = match length {
        length if length >= 1.0 => (1.0, "m"),
        length if length >= 0.01 => (100.0, "cm"),
        length if length >= 1e-3 => (1e3, "mm"),
        _ => (1e6, "µm"),
    };
    // Round lengths have one digit; the rest is round-off.
    format!("{} {unit}", (length * factor * 1e3).round() / 1e3)
}

/// The three axes as seen, each named at its tip; one that points at the eye is a dot.
fn axes(centre: Vector2<f64>, view: &View) -> String {
    const LENGTH: f64 = 20.0;
    let mut svg = String::new();
    let placement = Placement {
        origin: centre,
        scale: LENGTH,
    };
    for (axis, name) in [
        (Vector3::x(), "x"),
        (Vector3::y(), "y"),
        (Vector3::z(), "z"),
    ] {
        let tip = placement.pixels(&view.project(&axis));
        let seen = tip - centre;
        if seen.norm() < 0.2 * LENGTH {
            continue;
        }
        let label = centre + seen * (1.0 + 9.0 / seen.norm()) + Vector2::new(0.0, 4.5);
        svg += &format!(
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#555555\" stroke-width=\"1.2\"/>\n",
            centre.x, centre.y, tip.x, tip.y
        );
        svg += &text(label, name);
    }
    svg
}

fn text(at: Vector2<f64>, words: &str) -> String {
    format!("<text x=\"{:.1}\" y=\"{:.1}\">{words}</text>\n", at.x, at.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn helix(phase: f64) -> RodCurve {
        let point = |s: f64| {
            Vector3::new(
                0.01 * (s + phase).cos(),
                0.01 * (s + phase).sin(),
                0.008 * s,
            )
        };
        RodCurve {
            points: (0..=60).map(|k| point(0.4 * f64::from(k))).collect(),
            closed: false,
            radius: 1e-3,
        }
    }

    fn picture() -> String {
        let snapshot = |title: &str, phase| Snapshot {
            title: title.into(),
            rods: vec![helix(phase)],
        };
        snapshots(
            &[snapshot("t < 1 s", 0.0), snapshot("t = 1 s", 1.0)],
            &View::oblique(),
        )
    }

    #[test]
    fn everything_lies_on_the_page() {
        let svg = picture();
        let height: f64 = svg
            .split("viewBox=\"0 0 960 ")
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap()
            .parse()
            .unwrap();
        for path in svg.split("<path d=\"M").skip(1) {
            let mut words = path.split([' ', 'c', 'l', 'L', 'v', '"']);
            let mut number = || words.next().unwrap().parse::<f64>().unwrap();
            let (x, y) = (number(), number());
            assert!(
                (0.0..=960.0).contains(&x) && (0.0..=height).contains(&y),
                "{path}"
            );
        }
    }

    #[test]
    fn titles_are_escaped_and_all_elements_closed() {
        let svg = picture();
        assert!(svg.contains("t &lt; 1 s") && svg.contains("t = 1 s"));
        for name in ["svg", "g", "text"] {
            let opened = svg.matches(&format!("<{name}")).count();
            assert_eq!(opened, svg.matches(&format!("</{name}>")).count(), "{name}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn wide_scenes_are_stacked_and_tall_ones_stand_side_by_side() {
        let extent = |x: f64, y: f64| Extent {
            low: Vector2::zeros(),
            high: Vector2::new(x, y),
        };
        let columns = |x, y| Grid::largest(4, &extent(x, y)).columns;
        assert_eq!(
            [columns(1.0, 3.0), columns(1.5, 1.0), columns(9.0, 1.0)],
            [4, 2, 1]
        );
    }

    #[test]
    fn scale_bars_have_round_lengths() {
        for (limit, length, label) in [
            (0.073, 0.05, "5 cm"),
            (0.0021, 0.002, "2 mm"),
            (1.7, 1.0, "1 m"),
            (4.9e-4, 2e-4, "200 µm"),
        ] {
            let round = round_length_below(limit);
            assert!((round - length).abs() < 1e-12 * length);
            assert_eq!(length_label(round), label);
        }
    }

    #[test]
    fn a_picture_of_nothing_is_still_a_picture() {
        let svg = snapshots(&[], &View::oblique());
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
