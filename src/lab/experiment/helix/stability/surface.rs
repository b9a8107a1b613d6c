//! The boundary as a surface: triangles between neighbouring directions.

use super::files::SURFACE;
use super::row::{BoundaryRow, Part, read_boundary};
use delaunator::{Point, triangulate};
use nalgebra::Vector3;
use rodlab_files::figure::{ColouredSurface, surface_page};
use rodlab_files::results::{PAGE, ResultsError, Surface, write_surface, write_whole};
use std::path::Path;

/// Longest edge of a triangle, as an angle between directions, over the mean distance of
/// directions. Longer edges would bridge the region without a boundary.
const LONGEST_EDGE: f64 = 4.0;

/// The part of the boundary that forms a surface.
struct Found {
    surface: Surface,
    distances: Vec<f64>,
}

fn find(rows: &[BoundaryRow]) -> Option<Found> {
    let found: Vec<(Vector3<f64>, f64)> = rows
        .iter()
        .filter(|row| row.part == Part::Surface)
        .filter_map(|row| {
            let direction = Vector3::new(row.kappa, row.tau, row.omega);
            Some((direction, row.critical?))
        })
        .collect();
    let (directions, distances): (Vec<Vector3<f64>>, Vec<f64>) = found.into_iter().unzip();
    let triangles = triangles_between(&directions);
    let points = directions.iter().zip(&distances);
    let points = points.map(|(direction, distance)| direction * *distance);
    let points = points.collect();
    (!triangles.is_empty()).then_some(Found {
        surface: Surface { points, triangles },
        distances,
    })
}

/// Writes the surface for ParaView and as an interactive page, if there is a surface.
///
/// # Errors
/// [`ResultsError::Io`] if a file cannot be written.
pub fn write_surfaces(rows: &[BoundaryRow], directory: &Path) -> Result<(), ResultsError> {
    let Some(Found { surface, distances }) = find(rows) else {
        return Ok(());
    };
    write_surface(&directory.join(SURFACE), &surface, "distance", &distances)?;
    let page = page(&surface, distances);
    write_whole(&directory.join(PAGE), page.as_bytes())
}

/// The interactive page of the boundary in a results directory; `None` if it has no surface.
///
/// # Errors
/// `boundary.csv` cannot be read.
pub fn boundary_page(directory: &Path) -> Result<Option<String>, ResultsError> {
    Ok(find(&read_boundary(directory)?).map(|found| page(&found.surface, found.distances)))
}

fn page(surface: &Surface, distances: Vec<f64>) -> String {
    surface_page(&ColouredSurface {
        title: "Boundary of the stable helices",
        subtitle: "Inside, a rod of length L with clamped ends is stable as a helix of curvature κ and torsion τ \
                   under the twisting moment ω (units 1/L and EI/L).",
        axes: ["κ", "τ", "ω"],
        quantity: "distance ‖(κ, τ, ω)‖",
        points: surface.points.iter().map(|point| (*point).into()).collect(),
        values: distances,
        triangles: surface.triangles.clone(),
    })
}

/// Delaunay triangles of unit vectors with κ ≥ 0.
///
/// The stereographic projection from the pole κ = −1 maps circles on the sphere to circles in the
/// plane, so triangles with empty circumcircles are the same in both.
fn triangles_between(directions: &[Vector3<f64>]) -> Vec<[usize; 3]> {
    let projected: Vec<Point> = directions
        .iter()
        .map(|direction| Point {
            x: direction.y / (1.0 + direction.x),
            y: direction.z / (1.0 + direction.x),
        })
        .collect();
    let corners = triangulate(&projected).triangles;
    // Mean area of the sphere per direction: 2π over their number.
    let spacing = (std::f64::consts::TAU / directions.len() as f64).sqrt();
    let short = |a: usize, b: usize| directions[a].angle(&directions[b]) < LONGEST_EDGE * spacing;
    corners
        .chunks_exact(3)
        .map(|triangle| [triangle[0], triangle[1], triangle[2]])
        .filter(|[a, b, c]| short(*a, *b) && short(*b, *c) && short(*c, *a))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::keys::Directions;
    use super::*;

    /// A surface of V corners and T triangles with one rim of B edges: T = 2V − B − 2 (Euler).
    #[test]
    fn evenly_spread_directions_are_joined_without_holes() {
        let directions: Vec<Vector3<f64>> = Directions::Fibonacci { count: 2000 }
            .unit_vectors()
            .into_iter()
            .map(Vector3::from)
            .collect();
        let triangles = triangles_between(&directions);
        let area: f64 = triangles
            .iter()
            .map(|[a, b, c]| {
                let (a, b, c) = (directions[*a], directions[*b], directions[*c]);
                0.5 * (b - a).cross(&(c - a)).norm()
            })
            .sum();
        // Flat triangles and a rim within a spacing of the equator cover a little less than the
        // hemisphere.
        let whole = std::f64::consts::TAU;
        assert!(area > 0.97 * whole && area < whole, "{area}");
        assert!((triangles.len() as f64 / directions.len() as f64 - 2.0).abs() < 0.1);
    }

    #[test]
    fn too_few_directions_make_no_surface() {
        assert!(triangles_between(&[Vector3::x(), Vector3::y()]).is_empty());
    }
}
