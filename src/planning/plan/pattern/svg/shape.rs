//! Outlines of the shapes of a drawing (SVG 1.1, chapters 8 and 9), each in its own units and
//! coordinates.

use super::path_data::bezier_path;
use super::units::{Side, length};
use super::{FLATNESS, Fault, LARGEST, fault};
use kurbo::{BezPath, Ellipse, Rect, Shape};
use roxmltree::Node;

/// The elements that are drawn as a path.
pub const SHAPES: [&str; 7] = [
    "path", "line", "polyline", "polygon", "circle", "ellipse", "rect",
];

/// The outline of a shape; `None` if it is not drawn. Invalid path data is drawn up to the error.
///
/// # Errors
/// An attribute that cannot be read, with the outline up to there.
pub fn outline(node: Node) -> Result<Option<BezPath>, (Fault, BezPath)> {
    let data = match node.tag_name().name() {
        "path" => node.attribute("d").unwrap_or_default().to_owned(),
        name @ ("polyline" | "polygon") => {
            let points = node.attribute("points").unwrap_or_default().trim();
            let close = if name == "polygon" { " z" } else { "" };
            match points.is_empty() {
                true => return Ok(None),
                false => format!("M {points}{close}"),
            }
        }
        _ => return measured(node).map_err(|fault| (fault, BezPath::new())),
    };
    match bezier_path(&data) {
        (path, None) => Ok(Some(path)),
        (path, Some(error)) => {
            let attribute = match node.has_attribute("points") {
                true => "points",
                false => "d",
            };
            Err((fault(node, attribute, error), path))
        }
    }
}

/// A shape that is given by lengths.
fn measured(node: Node) -> Result<Option<BezPath>, Fault> {
    let or_zero = |name, side| Ok(length(node, name, side)?.unwrap_or(0.0));
    let (across, up) = (Side::Across, Side::Up);
    Ok(Some(match node.tag_name().name() {
        "line" => {
            let mut path = BezPath::new();
            path.move_to((or_zero("x1", across)?, or_zero("y1", up)?));
            path.line_to((or_zero("x2", across)?, or_zero("y2", up)?));
            path
        }
        name @ ("circle" | "ellipse") => {
            let radii = match name {
                "circle" => [or_zero("r", Side::Both)?; 2],
                _ => {
                    let (rx, ry) = (length(node, "rx", across)?, length(node, "ry", up)?);
                    [rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0)]
                }
            };
            if !has_size(node, &radii)? {
                return Ok(None);
            }
            let centre = (or_zero("cx", across)?, or_zero("cy", up)?);
            let size = radii[0].max(radii[1]);
            Ellipse::new(centre, (radii[0], radii[1]), 0.0).to_path(FLATNESS * size)
        }
        "rect" => {
            let (x, y) = (or_zero("x", across)?, or_zero("y", up)?);
            let (width, height) = (or_zero("width", across)?, or_zero("height", up)?);
            if !(width > 0.0 && height > 0.0) {
                return Ok(None);
            }
            // A missing radius equals the other radius; both are at most half of their side.
            let stated = |name, side| {
                let radius = length(node, name, side)?;
                Ok::<_, Fault>(radius.filter(|radius| *radius >= 0.0))
            };
            let (rx, ry) = (stated("rx", across)?, stated("ry", up)?);
            let rx_used = rx.or(ry).unwrap_or(0.0).min(0.5 * width);
            let ry_used = ry.or(rx).unwrap_or(0.0).min(0.5 * height);
            match rx_used > 0.0 && ry_used > 0.0 {
                true => rounded([x, y], [width, height], [rx_used, ry_used]),
                false => Rect::new(x, y, x + width, y + height).to_path(FLATNESS),
            }
        }
        _ => return Ok(None),
    }))
}

/// A rectangle with round corners, in the order of SVG 1.1, sec. 9.2.
fn rounded([x, y]: [f64; 2], [width, height]: [f64; 2], [rx, ry]: [f64; 2]) -> BezPath {
    let (right, bottom) = (x + width, y + height);
    let arc = |to_x: f64, to_y: f64| format!("A{rx} {ry} 0 0 1 {to_x} {to_y}");
    let data = format!(
        "M{} {y}H{}{}V{}{}H{}{}V{}{}z",
        x + rx,
        right - rx,
        arc(right, y + ry),
        bottom - ry,
        arc(right - rx, bottom),
        x + rx,
        arc(x, bottom - ry),
        y + ry,
        arc(x + rx, y),
    );
    bezier_path(&data).0
}

/// Whether a circle or ellipse with these radii is drawn; it is not if a radius is zero.
fn has_size(node: Node, radii: &[f64]) -> Result<bool, Fault> {
    // Squares of larger radii overflow.
    if !radii.iter().all(|radius| *radius < 1e100) {
        return Err(fault(node, "r", format!("it is larger than {LARGEST} m")));
    }
    Ok(radii.iter().all(|radius| *radius > 1e-100))
}
