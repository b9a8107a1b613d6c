//! Rods at several times, side by side on one scale.

mod bodies;
mod ground;
mod layout;

pub use bodies::Body;
pub use ground::Plane;

use super::Figure;
use super::drawing::{Anchor, Drawing, Stroke, Words, number};
use super::legend::Legend;
use super::palette::Color;
use super::paper::Paper;
use super::scale_bar::{length_label, round_length_below};
use super::tube::{Placement, RodCurve, rod_color, tubes};
use super::view::View;
use bodies::faces;
use ground::draw_plane;
use layout::{Extent, Grid};
use nalgebra::{Vector2, Vector3};

/// Rods at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Title of the picture.
    pub title: String,
    /// The rods, in the order of their colours.
    pub rods: Vec<RodCurve>,
}

/// Rods at several times, side by side: same view, same scale, tubes of true radius.
#[derive(Clone, Debug, PartialEq)]
pub struct RodsFigure {
    /// The pictures.
    pub snapshots: Vec<Snapshot>,
    /// View of the rods.
    pub view: View,
    /// Names of the rods for the legend; empty for no legend.
    pub names: Vec<String>,
    /// Planes that the rods may rest on.
    pub planes: Vec<Plane>,
    /// Rigid bodies in each picture; empty if there are none.
    pub bodies: Vec<Vec<Body>>,
    /// A sentence below the pictures; empty for none.
    pub note: String,
}

/// Snapshots side by side, without planes and names.
pub fn snapshots(snapshots: Vec<Snapshot>, view: View) -> Figure {
    Figure::Rods(RodsFigure {
        snapshots,
        view,
        names: Vec::new(),
        planes: Vec::new(),
        bodies: Vec::new(),
        note: String::new(),
    })
}

/// Lengths relative to the font size.
const MARGIN: f64 = 1.0;
/// Space for the title above each picture, and for the scale bar and the axes below all.
const HEAD: f64 = 2.0;
const FOOT: f64 = 4.8;

impl RodsFigure {
    /// Draws the figure as SVG.
    ///
    /// Wide scenes are placed in several rows if that makes them larger. Lengths across the view
    /// are true; distant parts are paler. The scale bar and the axes of the scene are below the
    /// pictures.
    pub(super) fn svg(&self, paper: &Paper) -> String {
        let em = paper.em;
        let mut drawing = Drawing::new(paper.width);
        let mut extent = Extent::of(&self.snapshots, &self.view);
        let patches: Vec<_> = self
            .planes
            .iter()
            .filter_map(|plane| plane.patch(&self.snapshots, &self.view))
            .collect();
        for patch in &patches {
            extent.include(patch.iter().map(|corner| self.view.project(corner)));
        }
        for body in self.bodies.iter().flatten() {
            let corners = body.triangles.iter().flatten();
            extent.include(corners.map(|corner| self.view.project(corner)));
        }
        let margin = MARGIN * em;
        let legend = Legend::between(margin, paper.width - margin, self.names.clone(), em);
        let top = if self.names.is_empty() {
            0.0
        } else {
            0.3 * em + legend.height()
        };
        legend.draw(0.3 * em, &mut drawing, |index, [from, to], y, drawing| {
            let held = self.snapshots.iter().any(|one| one.rods[index].held);
            let line = format!("M{} {}H{}", number(from), number(y), number(to));
            let width = 0.45 * em;
            drawing.path(&line, &Stroke::solid(rod_color(index, held), width), None);
        });
        let grid = Grid::largest(self.snapshots.len().max(1), &extent, paper, HEAD * em);
        for (index, snapshot) in self.snapshots.iter().enumerate() {
            let corner = grid.corner(index) + Vector2::new(0.0, top);
            let middle = Vector2::new(0.5 * grid.cell.x, 0.5 * (HEAD * em + grid.cell.y));
            let centre = extent.centre();
            let origin = corner + middle - grid.scale * Vector2::new(centre.x, -centre.y);
            let placement = Placement {
                origin,
                scale: grid.scale,
            };
            drawing.text(Words {
                text: &snapshot.title,
                at: [corner.x + middle.x, corner.y + 1.4 * em],
                size: em,
                anchor: Anchor::Middle,
                upright: false,
            });
            for (plane, patch) in self.planes.iter().zip(&patches) {
                draw_plane(plane, patch, &self.view, &placement, em, &mut drawing);
            }
            let bodies = self.bodies.get(index).into_iter().flatten();
            let among = bodies.flat_map(|body| faces(body, &self.view, &placement));
            let among = among.collect();
            drawing.raw("<g fill=\"none\">\n");
            drawing.raw(&tubes(&snapshot.rods, among, &self.view, &placement));
            drawing.raw("</g>\n");
        }
        let height = top + grid.rows as f64 * grid.cell.y + FOOT * em;
        let bar = Vector2::new(margin, height - em);
        draw_scale_bar(bar, grid.scale, em, &mut drawing);
        let axes = Vector2::new(paper.width - 3.2 * em, height - 1.9 * em);
        draw_axes(axes, &self.view, em, &mut drawing);
        if !self.note.is_empty() {
            drawing.text(Words {
                text: &self.note,
                at: [0.5 * paper.width, height - em],
                size: em,
                anchor: Anchor::Middle,
                upright: false,
            });
        }
        drawing.finish(height)
    }
}

/// Draws a bar of round length, at most twelve letters long, that starts at `start`.
fn draw_scale_bar(start: Vector2<f64>, scale: f64, em: f64, drawing: &mut Drawing) {
    let length = round_length_below(12.0 * em / scale);
    let end = start.x + scale * length;
    let (half, whole) = (number(0.3 * em), number(0.6 * em));
    let path = format!(
        "M{} {}v{whole}m0 -{half}H{}m0 -{half}v{whole}",
        number(start.x),
        number(start.y - 0.3 * em),
        number(end)
    );
    drawing.path(&path, &Stroke::solid(Color::BLACK, 0.11 * em), None);
    drawing.text(Words {
        text: &length_label(length),
        at: [0.5 * (start.x + end), start.y - 0.6 * em],
        size: em,
        anchor: Anchor::Middle,
        upright: false,
    });
}

/// Draws the three axes as seen, each named at its tip; an axis that points at the eye is omitted.
fn draw_axes(centre: Vector2<f64>, view: &View, em: f64, drawing: &mut Drawing) {
    let length = 1.5 * em;
    let placement = Placement {
        origin: centre,
        scale: length,
    };
    let grey = Color::BLACK.towards(Color::WHITE, 0.33);
    for (axis, name) in [
        (Vector3::x(), "x"),
        (Vector3::y(), "y"),
        (Vector3::z(), "z"),
    ] {
        let tip = placement.pixels(&view.project(&axis));
        let seen = tip - centre;
        if seen.norm() < 0.2 * length {
            continue;
        }
        let [from, to] = [centre, tip].map(|end| format!("{} {}", number(end.x), number(end.y)));
        drawing.path(
            &format!("M{from}L{to}"),
            &Stroke::solid(grey, 0.09 * em),
            None,
        );
        let label = centre + seen * (1.0 + 0.65 * em / seen.norm());
        drawing.text(Words {
            text: name,
            at: [label.x, label.y + 0.3 * em],
            size: em,
            anchor: Anchor::Middle,
            upright: false,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn helix(phase: f64, held: bool) -> RodCurve {
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
            radii: Vec::new(),
            held,
        }
    }

    fn figure(planes: Vec<Plane>) -> RodsFigure {
        let snapshot = |title: &str, phase| Snapshot {
            title: title.into(),
            rods: vec![helix(phase, false), helix(phase + 2.0, true)],
        };
        RodsFigure {
            snapshots: vec![snapshot("t < 1 s", 0.0), snapshot("t = 1 s", 1.0)],
            view: View::oblique(),
            names: vec!["rope".into(), "post (held)".into()],
            planes,
            bodies: Vec::new(),
            note: String::new(),
        }
    }

    #[test]
    fn everything_is_on_the_page_at_any_size() {
        for (width, font_size) in [(0.085, 8.0), (0.2, 10.0), (0.5, 30.0)] {
            let paper = Paper::new(width, font_size).unwrap();
            let svg = figure(vec![]).svg(&paper);
            let (_, rest) = svg.split_once("viewBox=\"0 0 ").unwrap();
            let mut size = rest
                .split(['"', ' '])
                .map(|word| word.parse::<f64>().unwrap());
            let (width, height) = (size.next().unwrap(), size.next().unwrap());
            let (_, drawn) = svg.split_once("</defs>").unwrap();
            for path in drawn.split("<path d=\"M").skip(1) {
                let mut words = path.split([' ', 'c', 'l', 'L', 'v', 'H', '"']);
                let mut number = || words.next().unwrap().parse::<f64>().unwrap();
                let (x, y) = (number(), number());
                assert!(
                    (0.0..=width).contains(&x) && (0.0..=height).contains(&y),
                    "{path}"
                );
            }
        }
    }

    #[test]
    fn titles_are_escaped_and_all_elements_closed() {
        let svg = figure(vec![]).svg(&Paper::default());
        assert!(svg.contains("t &lt; 1 s") && svg.contains("t = 1 s"));
        for name in ["svg", "g", "defs"] {
            let opened = svg.matches(&format!("<{name}>")).count()
                + svg.matches(&format!("<{name} ")).count();
            assert_eq!(opened, svg.matches(&format!("</{name}>")).count(), "{name}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn rods_are_named_and_held_ones_are_grey() {
        let svg = figure(vec![]).svg(&Paper::default());
        assert!(svg.contains("aria-label=\"rope\"") && svg.contains("aria-label=\"post (held)\""));
        assert!(
            svg.contains(&rod_color(0, false).hex()) && svg.contains(&rod_color(1, true).hex())
        );
        assert!(!svg.contains(&rod_color(1, false).hex()));
    }

    #[test]
    fn a_picture_of_nothing_is_still_a_picture() {
        let svg = snapshots(vec![], View::oblique()).svg(&Paper::default());
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
