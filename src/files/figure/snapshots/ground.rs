//! Planes below and beside rods: a pale patch, or a hatched line if seen edge-on.

use super::super::drawing::{Drawing, Stroke, number};
use super::super::palette::Color;
use super::super::tube::Placement;
use super::super::view::View;
use super::Snapshot;
use nalgebra::{Vector2, Vector3};

/// A rigid half space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Any point of its surface, m.
    pub point: Vector3<f64>,
    /// Unit normal, away from the solid.
    pub normal: Vector3<f64>,
}

/// Margin of a patch beyond the rods, as a share of their extent.
const ROOM: f64 = 0.06;
/// Sine of the angle of view below which a plane is drawn as a line.
const EDGE_ON: f64 = 0.04;

impl Plane {
    /// The corners of the part of the plane below all rods; `None` if none is near it.
    pub(super) fn patch(&self, snapshots: &[Snapshot], view: &View) -> Option<[Vector3<f64>; 4]> {
        let rods = snapshots.iter().flat_map(|snapshot| &snapshot.rods);
        let points: Vec<Vector3<f64>> = rods.flat_map(|rod| rod.points.iter().copied()).collect();
        // Project along the axis with the smallest angle to the plane.
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let flattest = axes.into_iter().min_by(|a, b| {
            let slope = |axis: &Vector3<f64>| axis.dot(&self.normal).abs();
            slope(a).total_cmp(&slope(b))
        })?;
        let u = (flattest - self.normal * flattest.dot(&self.normal)).normalize();
        let v = self.normal.cross(&u);
        let range = |direction: &Vector3<f64>| {
            let places = points
                .iter()
                .map(|point| direction.dot(&(point - self.point)));
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
                (low.min(place), high.max(place))
            })
        };
        let ((u_low, u_high), (v_low, v_high)) = (range(&u), range(&v));
        let (nearest, farthest) = range(&self.normal);
        let size = (u_high - u_low).max(v_high - v_low).max(farthest - nearest);
        if points.is_empty() || nearest > size {
            return None;
        }
        let room = ROOM * size;
        let corner = |a: f64, b: f64| self.point + u * a + v * b;
        let is_line = self.normal.dot(&view.eye()).abs() < EDGE_ON;
        // Seen edge-on, the patch has no visible depth.
        let depth = if is_line { 0.0 } else { room };
        let ([a, b], [c, d]) = (
            [u_low - room, u_high + room],
            [v_low - depth.max(room), v_high + depth.max(room)],
        );
        Some([corner(a, c), corner(b, c), corner(b, d), corner(a, d)])
    }
}

/// Draws the patch of a plane; the rods are painted over it.
pub(super) fn draw_plane(
    plane: &Plane,
    patch: &[Vector3<f64>; 4],
    view: &View,
    placement: &Placement,
    em: f64,
    drawing: &mut Drawing,
) {
    let corners = patch.map(|corner| placement.pixels(&view.project(&corner)));
    let edge = Stroke::solid(Color::BLACK.towards(Color::WHITE, 0.55), 0.07 * em);
    let facing = plane.normal.dot(&view.eye());
    if facing.abs() < EDGE_ON {
        return draw_line(plane, &corners, view, em, &edge, drawing);
    }
    let corner = |corner: &Vector2<f64>| format!("{} {}", number(corner.x), number(corner.y));
    let path = format!("M{}Z", corners.each_ref().map(corner).join("L"));
    // Viewed from behind, a plane would hide the rods on it.
    let fill = (facing > 0.0).then(|| Color::BLACK.towards(Color::WHITE, 0.93));
    drawing.path(&path, &edge, fill);
}

/// Draws a line with hatches on the side of the solid.
fn draw_line(
    plane: &Plane,
    corners: &[Vector2<f64>; 4],
    view: &View,
    em: f64,
    edge: &Stroke,
    drawing: &mut Drawing,
) {
    let normal = view.project(&plane.normal);
    let outward = Vector2::new(normal.x, -normal.y).normalize();
    let along = Vector2::new(-outward.y, outward.x);
    let places = corners.map(|corner| along.dot(&corner));
    let low = places.into_iter().fold(f64::INFINITY, f64::min);
    let high = places.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let height = outward.dot(&corners[0]);
    let at = |place: f64| along * place + outward * height;
    let line = |a: Vector2<f64>, b: Vector2<f64>| {
        let [a, b] = [a, b].map(|end| format!("{} {}", number(end.x), number(end.y)));
        format!("M{a}L{b}")
    };
    let mut path = line(at(low), at(high));
    let (spacing, reach) = (0.8 * em, 0.55 * em);
    let hatches = ((high - low) / spacing) as usize;
    for hatch in 1..=hatches {
        let from = at(low + spacing * hatch as f64);
        path += &line(from, from - reach * (outward + along));
    }
    drawing.path(&path, edge, None);
}

#[cfg(test)]
mod tests {
    use super::super::super::tube::RodCurve;
    use super::*;

    fn snapshot(height: f64) -> [Snapshot; 1] {
        [Snapshot {
            title: String::new(),
            rods: vec![RodCurve {
                points: vec![
                    Vector3::new(0.0, 0.0, height),
                    Vector3::new(1.0, 0.2, height),
                ],
                closed: false,
                radius: 0.01,
                radii: Vec::new(),
                held: false,
            }],
        }]
    }

    const FLOOR: Plane = Plane {
        point: Vector3::new(5.0, 5.0, 0.0),
        normal: Vector3::new(0.0, 0.0, 1.0),
    };

    #[test]
    fn a_patch_lies_in_its_plane_below_the_rods() {
        let patch = FLOOR.patch(&snapshot(0.3), &View::oblique()).unwrap();
        for corner in patch {
            assert!(corner.z.abs() < 1e-12);
            assert!((-0.1..=1.1).contains(&corner.x) && (-0.1..=0.3).contains(&corner.y));
        }
        assert_eq!(FLOOR.patch(&snapshot(30.0), &View::oblique()), None);
    }

    #[test]
    fn from_its_edge_a_plane_is_a_hatched_line() {
        let placement = Placement {
            origin: Vector2::new(10.0, 50.0),
            scale: 100.0,
        };
        let draw = |view: View| {
            let patch = FLOOR.patch(&snapshot(0.0), &view).unwrap();
            let mut drawing = Drawing::new(200.0);
            draw_plane(&FLOOR, &patch, &view, &placement, 10.0, &mut drawing);
            drawing.finish(100.0)
        };
        let from_the_front = draw(View::from(-Vector3::y()));
        assert_eq!(from_the_front.matches("fill=\"none\"").count(), 1);
        assert!(from_the_front.matches('M').count() > 10, "{from_the_front}");
        assert!(draw(View::oblique()).contains("fill=\"#ededed\""));
    }
}
