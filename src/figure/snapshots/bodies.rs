//! Rigid bodies beside rods: pale faces, darker where they turn from the light, below the rods.

use super::super::drawing::{Drawing, number};
use super::super::palette::Color;
use super::super::tube::Placement;
use super::super::view::View;
use nalgebra::Vector3;
use std::fmt::Write;

/// Shades of faces.
const SHADES: usize = 12;

/// Draws the faces that are turned to the eye, from the farthest to the nearest.
pub(super) fn draw_bodies(
    triangles: &[[Vector3<f64>; 3]],
    view: &View,
    placement: &Placement,
    drawing: &mut Drawing,
) {
    let eye = view.eye();
    let light = (eye + Vector3::new(-0.3, 0.2, 0.8)).normalize();
    let mut faces: Vec<(f64, usize, &[Vector3<f64>; 3])> = triangles
        .iter()
        .filter_map(|corners| {
            let [a, b, c] = corners;
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
            let shade = (normal.dot(&light).abs() * SHADES as f64) as usize;
            Some(((a + b + c).dot(&eye), shade.min(SHADES - 1), corners))
        })
        .collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Faces of one shade that follow each other are one path.
    let mut rest = faces.as_slice();
    while let Some((_, shade, _)) = rest.first() {
        let same = rest.iter().take_while(|face| face.1 == *shade).count();
        let mut path = String::new();
        for (_, _, corners) in &rest[..same] {
            let [a, b, c] = corners.map(|corner| {
                let at = placement.pixels(&view.project(&corner));
                format!("{} {}", number(at.x), number(at.y))
            });
            let _ = write!(path, "M{a}L{b}L{c}Z");
        }
        let pale = 0.93 - 0.25 * (1.0 - *shade as f64 / SHADES as f64);
        let color = Color::BLACK.towards(Color::WHITE, pale).hex();
        // A line of the same colour hides the seams.
        drawing.raw(&format!(
            "<path d=\"{path}\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.4\"/>\n"
        ));
        rest = &rest[same..];
    }
}
