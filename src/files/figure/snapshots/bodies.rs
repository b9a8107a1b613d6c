//! Rigid bodies among rods: pale faces, darker if they turn away from the light.

use super::super::drawing::number;
use super::super::palette::Color;
use super::super::tube::{Piece, Placement};
use super::super::view::View;
use nalgebra::Vector3;

/// Shades of faces.
const SHADES: usize = 12;

/// A rigid body beside rods.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The triangles of its surface, m.
    pub triangles: Vec<[Vector3<f64>; 3]>,
    /// Whether rods are inside: it is then drawn behind all of them.
    pub hollow: bool,
    /// Whether it is convex with triangles that face outwards: those that face away from the
    /// viewer are then not drawn.
    pub convex: bool,
}

/// The faces of a body, sorted by their farthest corners, so that a rod on a face is painted over
/// it.
pub(super) fn faces(body: &Body, view: &View, placement: &Placement) -> Vec<Piece> {
    let light = (view.eye() + Vector3::new(-0.3, 0.2, 0.8)).normalize();
    let face = |corners: &[Vector3<f64>; 3]| {
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
        if body.convex && normal.dot(&view.eye()) < 0.0 {
            return None;
        }
        let shade = (normal.dot(&light).abs() * SHADES as f64).floor() / SHADES as f64;
        let color = Color::BLACK.towards(Color::WHITE, 0.5 + 0.32 * shade).hex();
        let seen = corners.map(|corner| view.project(&corner));
        let nearness = seen.iter().map(|corner| corner.nearness);
        let nearness = nearness.fold(f64::INFINITY, f64::min);
        let [a, b, c] = seen.map(|corner| {
            let at = placement.pixels(&corner);
            format!("{} {}", number(at.x), number(at.y))
        });
        // A line of the same colour hides the seams.
        Some(Piece {
            nearness: if body.hollow {
                f64::NEG_INFINITY
            } else {
                nearness
            },
            svg: format!(
                "<path d=\"M{a}L{b}L{c}Z\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.4\"/>\n"
            ),
        })
    };
    body.triangles.iter().filter_map(face).collect()
}
