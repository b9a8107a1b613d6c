//! A sheet of paper: its corners to a fraction of a pixel, its edges on the table, and its sliding.
//!
//! Corners are intersections of the lines through the edges. The lines are fitted to many edge
//! points in coordinates of the table, so that lens distortion does not bend the edges.

use super::contrast::Contrast;
use super::mask::Mask;
use super::straight_edge::{Line, edge_points, fit_line};
use super::{ColourRule, Point, VisionError};
use image::RgbImage;

/// A sheet with four edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Corners, clockwise in the picture, starting with the one nearest to the upper left of the
    /// picture, in the coordinates of `locate`.
    pub corners: [Point; 4],
    /// Corners in the picture, pixels.
    pub corner_pixels: [Point; 4],
    /// For each edge, from corner k to k + 1, the root mean square distance of its points from the line.
    pub straightness: [f64; 4],
}

/// Position of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePose {
    /// Middle of the edge.
    pub middle: Point,
    /// Direction of the edge, radians from the x axis, from -π to π.
    pub angle: f64,
    /// Length of the edge.
    pub length: f64,
}

impl Sheet {
    /// The sheet with its corners renumbered so that they are nearest to the corners of the sheet
    /// before it moved.
    #[must_use]
    pub fn numbered_like(&self, before: &Self) -> Self {
        let away = |sheet: &Self| -> f64 {
            let pairs = sheet.corners.iter().zip(&before.corners);
            pairs.map(|(a, b)| (a - b).norm_squared()).sum()
        };
        let candidates = (1..4).map(|first| self.counted_from(first));
        candidates.fold(self.clone(), |best, other| {
            if away(&other) < away(&best) {
                other
            } else {
                best
            }
        })
    }

    /// The sheet with its corners counted from the corner with number `first`.
    fn counted_from(&self, first: usize) -> Self {
        let mut sheet = self.clone();
        sheet.corners.rotate_left(first);
        sheet.corner_pixels.rotate_left(first);
        sheet.straightness.rotate_left(first);
        sheet
    }

    /// An edge, from corner k to corner k + 1.
    ///
    /// # Panics
    /// The number is not one of the four edges, 0 to 3.
    pub fn edge(&self, edge: usize) -> EdgePose {
        let (from, to) = (self.corners[edge], self.corners[(edge + 1) % 4]);
        let along = to - from;
        EdgePose {
            middle: (from + to) * 0.5,
            angle: libm::atan2(along.y, along.x),
            length: along.norm(),
        }
    }
}

/// Displacement of an edge along a direction between two pictures: Δx of a fold.
pub fn sliding(before: &EdgePose, after: &EdgePose, direction: Point) -> f64 {
    let unit = direction.try_normalize(1e-12).unwrap_or(Point::x());
    (after.middle - before.middle).dot(&unit)
}

/// Distance from the lines between the corners within which edges are searched, pixels.
const REACH: f64 = 8.0;

/// Finds the largest sheet in the pixels that a colour rule selects. `locate` maps pixels to
/// coordinates in which edges are straight: [`Camera::on_table`](super::Camera::on_table), or the
/// identity for a lens without distortion.
///
/// # Errors
/// No part of the mask has four edges, or `locate` fails.
pub fn find_sheet(
    picture: &RgbImage,
    rule: &ColourRule,
    locate: impl Fn(Point) -> Result<Point, VisionError>,
) -> Result<Sheet, VisionError> {
    let missing = |reason: &str| VisionError::NotFound {
        what: "the sheet",
        reason: reason.into(),
    };
    let contrast = Contrast::new(picture, rule)?;
    let mut mask = Mask::of_contrast(&contrast);
    mask.keep_largest();
    let outline = convex_hull(&mask.outline());
    let corners = largest_quadrilateral(&outline)
        .ok_or_else(|| missing("no part of the picture has four corners"))?;
    let size = |k: usize| (corners[(k + 1) % 4] - corners[k]).norm();
    if (0..4).any(|k| size(k) < 20.0) {
        return Err(missing("its edges are shorter than 20 pixels"));
    }
    let mut lines = Vec::new();
    for edge in 0..4 {
        let mut points = Vec::new();
        for pixel in edge_points(&contrast, corners[edge], corners[(edge + 1) % 4], REACH) {
            points.push(locate(pixel)?);
        }
        lines.push(
            fit_line(points)
                .ok_or_else(|| missing("one of its edges is not visible or not straight"))?,
        );
    }
    let mut located = [Point::zeros(); 4];
    for (corner, located) in located.iter_mut().enumerate() {
        *located = meet(&lines[(corner + 3) % 4], &lines[corner])
            .ok_or_else(|| missing("two neighbouring edges are parallel"))?;
    }
    let mut corner_pixels = corners;
    for (pixel, corner) in corner_pixels.iter_mut().zip(&located) {
        *pixel = invert(*pixel, *corner, &locate)?;
    }
    let first = (0..4)
        .min_by(|a, b| corner_pixels[*a].sum().total_cmp(&corner_pixels[*b].sum()))
        .unwrap_or(0);
    let sheet = Sheet {
        corners: located,
        corner_pixels,
        straightness: [0, 1, 2, 3].map(|edge| lines[edge].deviation),
    };
    Ok(sheet.counted_from(first))
}

/// Pixel that `locate` maps to a point, by Newton's method with finite differences.
fn invert(
    start: Point,
    target: Point,
    locate: &impl Fn(Point) -> Result<Point, VisionError>,
) -> Result<Point, VisionError> {
    let mut pixel = start;
    for _ in 0..8 {
        let here = locate(pixel)?;
        let by_u = locate(pixel + Point::x())? - here;
        let by_v = locate(pixel + Point::y())? - here;
        let matrix = nalgebra::Matrix2::from_columns(&[by_u, by_v]);
        let Some(inverse) = matrix.try_inverse() else {
            break;
        };
        pixel += inverse * (target - here);
    }
    Ok(pixel)
}

/// Convex hull in the order of increasing angle in picture coordinates (Andrew 1979).
fn convex_hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<Point> = Vec::new();
    for pass in 0..2 {
        let floor = hull.len();
        for point in &sorted {
            while hull.len() >= floor + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp(&(point - a)) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*point);
        }
        hull.pop();
        if pass == 0 {
            sorted.reverse();
        }
    }
    hull
}

/// Four corners of a convex polygon that enclose the largest area, if this is nearly the whole
/// area.
fn largest_quadrilateral(hull: &[Point]) -> Option<[Point; 4]> {
    let area = |polygon: &[Point]| {
        let turns = (0..polygon.len()).map(|k| polygon[k].perp(&polygon[(k + 1) % polygon.len()]));
        0.5 * turns.sum::<f64>().abs()
    };
    // Remove the corner whose removal cuts off the least area, until four are left.
    let mut polygon = hull.to_vec();
    while polygon.len() > 4 {
        let count = polygon.len();
        let cut = |k: usize| {
            let (before, after) = (polygon[(k + count - 1) % count], polygon[(k + 1) % count]);
            (polygon[k] - before).perp(&(after - before)).abs()
        };
        let least = (0..count).min_by(|a, b| cut(*a).total_cmp(&cut(*b)))?;
        polygon.remove(least);
    }
    let corners: [Point; 4] = polygon.try_into().ok()?;
    (area(&corners) > 0.9 * area(hull)).then_some(corners)
}

fn meet(a: &Line, b: &Line) -> Option<Point> {
    let matrix = nalgebra::Matrix2::from_rows(&[a.normal.transpose(), b.normal.transpose()]);
    if matrix.determinant().abs() < 0.05 {
        return None;
    }
    Some(matrix.try_inverse()? * Point::new(a.offset, b.offset))
}

#[cfg(test)]
mod tests {
    use super::super::Camera;
    use super::super::camera::tests::{looking_at, slanted_camera};
    use super::super::render::{RenderOptions, render};
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    fn camera() -> Camera {
        let distortion = slanted_camera().lens.distortion;
        let slant = UnitQuaternion::from_euler_angles(0.25, -0.1, 0.3);
        let lens = ([460.0, 458.0], [322.0, 241.0], distortion);
        looking_at(Vector3::zeros(), 0.6, slant, [640, 480], lens)
    }

    /// A sheet of 0.2 m × 0.15 m with a given centre and rotation.
    fn picture(camera: &Camera, centre: Point, angle: f64, seed: u64) -> RgbImage {
        let ground = |point: Point| {
            let (sine, cosine) = angle.sin_cos();
            let way = point - centre;
            let (x, y) = (
                way.x * cosine + way.y * sine,
                -way.x * sine + way.y * cosine,
            );
            let inside = x.abs() < 0.1 && y.abs() < 0.075;
            if inside {
                [225.0, 222.0, 210.0]
            } else {
                [60.0, 70.0, 85.0]
            }
        };
        let options = RenderOptions {
            noise: 4.0,
            seed,
            ..RenderOptions::default()
        };
        render(camera, &[], ground, &options)
    }

    #[test]
    fn rendered_sheets_are_found_on_the_table() {
        let camera = camera();
        let locate = |pixel: Point| camera.on_table(pixel);
        let mut edges = Vec::new();
        for (seed, (centre, angle)) in [
            (Point::new(0.01, -0.02), 0.3),
            (Point::new(0.013, -0.024), 0.3),
            (Point::new(-0.02, 0.0), -0.9),
        ]
        .into_iter()
        .enumerate()
        {
            let picture = picture(&camera, centre, angle, seed as u64);
            let sheet = find_sheet(&picture, &ColourRule::Background, locate).expect("a sheet");
            let middle = sheet.corners.iter().sum::<Point>() / 4.0;
            assert!((middle - centre).norm() < 0.3e-3, "{middle}");
            for edge in 0..4 {
                let pose = sheet.edge(edge);
                let turn = (pose.angle - angle).rem_euclid(std::f64::consts::FRAC_PI_2);
                let off = turn.min(std::f64::consts::FRAC_PI_2 - turn).to_degrees();
                assert!(off < 0.1, "edge {edge} is {off} degrees off");
                let side = (pose.length - 0.2).abs().min((pose.length - 0.15).abs());
                assert!(side < 0.3e-3, "edge {edge} is {} m long", pose.length);
                let away = (pose.middle - centre).norm();
                let expected = if pose.length > 0.17 { 0.075 } else { 0.1 };
                assert!((away - expected).abs() < 0.3e-3, "edge {edge}");
            }
            for (corner, pixel) in sheet.corners.iter().zip(&sheet.corner_pixels) {
                assert!((camera.on_table(*pixel).expect("a point") - corner).norm() < 1e-9);
            }
            edges.push(sheet.edge(0));
        }
        let slid = sliding(&edges[0], &edges[1], Point::new(0.6, -0.8));
        assert!((slid - 0.005).abs() < 0.3e-3, "{slid}");
    }

    #[test]
    fn corners_keep_their_numbers_when_a_sheet_turns() {
        let sheet = |angle: f64| {
            let corner = |x: f64, y: f64| {
                let (sine, cosine) = angle.sin_cos();
                Point::new(x * cosine - y * sine, x * sine + y * cosine)
            };
            let corners = [
                corner(-2.0, -1.0),
                corner(2.0, -1.0),
                corner(2.0, 1.0),
                corner(-2.0, 1.0),
            ];
            Sheet {
                corners,
                corner_pixels: corners,
                straightness: [1.0, 2.0, 3.0, 4.0],
            }
        };
        let (before, after) = (sheet(0.0), sheet(0.4).counted_from(3));
        assert_eq!(after.numbered_like(&before), sheet(0.4));
    }

    #[test]
    fn a_disc_is_not_a_sheet() {
        let picture = RgbImage::from_fn(200, 200, |u, v| {
            let inside = (f64::from(u) - 100.0).hypot(f64::from(v) - 100.0) < 60.0;
            image::Rgb(if inside { [220; 3] } else { [20; 3] })
        });
        let error = find_sheet(&picture, &ColourRule::Background, Ok).expect_err("a disc");
        assert!(
            error.to_string().contains("the sheet was not found"),
            "{error}"
        );
    }
}
