//! An interactive page of a surface in three dimensions: one HTML file that works without a network.

use super::markup::{escape, fill, json_in_script};
use crate::origin::version;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

const PAGE: &str = include_str!("page.html");

/// The program of the page; camera, gestures and colours are the same as on the page of rods in
/// motion.
const SCRIPTS: [&str; 4] = [
    include_str!("../viewer/page/colours.js"),
    include_str!("../viewer/page/camera.js"),
    include_str!("../viewer/page/gestures.js"),
    include_str!("surface.js"),
];

/// A surface of triangles with a number at each corner.
#[derive(Clone, Debug)]
pub struct ColouredSurface<'a> {
    /// Heading.
    pub title: &'a str,
    /// A line below it.
    pub subtitle: &'a str,
    /// Names of the axes.
    pub axes: [&'a str; 3],
    /// Name and unit of the numbers.
    pub quantity: &'a str,
    /// The corners.
    pub points: Vec<[f64; 3]>,
    /// The numbers, one for each corner.
    pub values: Vec<f64>,
    /// Three indices of corners for each triangle.
    pub triangles: Vec<[usize; 3]>,
}

/// Returns the page as HTML. Browsers need WebGL 2, which all have had since 2021.
pub fn surface_page(surface: &ColouredSurface<'_>) -> String {
    let (low, high) = surface
        .values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
    let extent = if high > low { high - low } else { 1.0 };
    let mut points = Vec::with_capacity(16 * surface.points.len());
    for (point, value) in surface.points.iter().zip(&surface.values) {
        let colour = (value - low) / extent;
        for number in point.iter().chain([&colour]) {
            points.extend((*number as f32).to_le_bytes());
        }
    }
    let corners = surface.triangles.iter().flatten();
    let triangles: Vec<u8> = corners
        .flat_map(|corner| (*corner as u32).to_le_bytes())
        .collect();
    let header = json!({
        "axes": surface.axes,
        "quantity": surface.quantity,
        "low": low,
        "high": high,
    });
    let parts = [
        ("version", version()),
        ("title", escape(surface.title)),
        ("subtitle", escape(surface.subtitle)),
        ("script", SCRIPTS.concat()),
        ("header", json_in_script(&header)),
        ("points", STANDARD.encode(points)),
        ("triangles", STANDARD.encode(triangles)),
    ];
    fill(
        PAGE,
        &parts.each_ref().map(|(name, text)| (*name, &text[..])),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_the_surface_and_nothing_from_elsewhere() {
        let page = surface_page(&ColouredSurface {
            title: "A < B",
            subtitle: "three corners",
            axes: ["κ", "τ", "ω"],
            quantity: "distance",
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]],
            values: vec![1.0, 2.0, 3.0],
            triangles: vec![[0, 1, 2]],
        });
        assert!(page.contains("<h1>A &lt; B</h1>") && page.contains("class Camera"));
        assert!(!page.contains("{{") && !page.contains("http"));
        let (_, rest) = page.split_once("id=\"triangles\">").unwrap();
        let (encoded, _) = rest.split_once('<').unwrap();
        let bytes = STANDARD.decode(encoded).unwrap();
        assert_eq!(bytes, [0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    }
}
