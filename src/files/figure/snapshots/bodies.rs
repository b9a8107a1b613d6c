//! Rigid bodies among rods: pale faces, darker if they turn away from the light.

use super::super::drawing::number;
use super::super::palette::Color;
use super::super::tube::{Piece, Placement};
use super::super::view::View;
use nalgebra::Vector3;
use std::borrow::Cow;

/// Shades of faces.
const SHADES: usize = 12;
/// Longest side of a triangle of a convex body, relative to the size of the body.
const SMALL: f64 = 0.15;

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
    pieces(body).iter().filter_map(face).collect()
}

/// The triangles of a body. Those of a convex one are halved until they are small compared with
/// it, since the order in which large ones are painted beside rods may be wrong.
fn pieces(body: &Body) -> Cow<'_, [[Vector3<f64>; 3]]> {
    if !body.convex {
        return Cow::Borrowed(&body.triangles);
    }
    let corners = || body.triangles.iter().flatten();
    let corner = |pick: fn(f64, f64) -> f64, start: f64| {
        corners().fold(Vector3::repeat(start), |found, x| found.zip_map(x, pick))
    };
    let extent = corner(f64::max, f64::NEG_INFINITY) - corner(f64::min, f64::INFINITY);
    let longest = SMALL * extent.norm();
    let mut rest = body.triangles.clone();
    let mut small = Vec::new();
    while let Some([a, b, c]) = rest.pop() {
        // The longest side first.
        let sides = [(a, b, c), (b, c, a), (c, a, b)];
        let length =
            |(from, to, _): &(Vector3<f64>, Vector3<f64>, Vector3<f64>)| (to - from).norm();
        let widest = sides
            .into_iter()
            .max_by(|one, other| length(one).total_cmp(&length(other)));
        match widest.filter(|side| length(side) > longest) {
            Some((from, to, other)) => {
                let middle = (from + to) * 0.5;
                rest.extend([[from, middle, other], [middle, to, other]]);
            }
            None => small.push([a, b, c]),
        }
    }
    Cow::Owned(small)
}
