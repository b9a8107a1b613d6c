//! Straight edges of the region selected by a colour rule: edge points with sub-pixel accuracy,
//! and the line through them.

use super::contrast::Contrast;
use super::{ColourRule, Point, VisionError};
use image::RgbImage;

/// Number of points searched along an edge.
const EDGE_POINTS: usize = 120;
/// Fraction of an edge at each of its ends that is not used.
const END_PART: f64 = 0.08;
/// Sampling distance across an edge, pixels.
const STEP: f64 = 0.5;

/// A line n·x = d, and the scatter of its points.
pub(super) struct Line {
    /// Unit normal n.
    pub normal: Point,
    /// d.
    pub offset: f64,
    /// Root mean square distance of the points.
    pub deviation: f64,
}

/// A detected edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundEdge {
    /// Unit normal n of its line n·x = d, pointing outwards, in the coordinates of `locate`.
    pub normal: Point,
    /// d.
    pub offset: f64,
    /// Root mean square distance of its points from the line.
    pub deviation: f64,
    /// Start and end of the edge in the picture, pixels.
    pub pixels: [Point; 2],
}

/// Finds the outermost straight edge within `reach` pixels of its expected position. This position
/// is given by two pixels; the selected region is on the right of the direction from the first to
/// the second. `locate` maps pixels to coordinates in which the edge is straight.
///
/// # Errors
/// No edge is visible there, it is not straight, or `locate` fails.
pub fn find_edge(
    picture: &RgbImage,
    rule: &ColourRule,
    [from, to]: [Point; 2],
    reach: f64,
    locate: impl Fn(Point) -> Result<Point, VisionError>,
) -> Result<FoundEdge, VisionError> {
    let contrast = Contrast::new(picture, rule)?;
    let points = edge_points(&contrast, from, to, reach);
    let located = points.iter().map(|pixel| locate(*pixel));
    let located = located.collect::<Result<Vec<Point>, VisionError>>()?;
    let (Some(line), Some(in_picture)) = (fit_line(located), fit_line(points)) else {
        return Err(VisionError::NotFound {
            what: "the edge",
            reason: "no straight edge is visible at the expected place".into(),
        });
    };
    let across = outwards(to - from).unwrap_or(Point::x());
    let middle = locate((from + to) * 0.5)?;
    let outer = locate((from + to) * 0.5 + across)? - middle;
    let side = line.normal.dot(&outer).signum();
    let onto = |pixel: Point| {
        let away = in_picture.normal.dot(&pixel) - in_picture.offset;
        pixel - in_picture.normal * away
    };
    Ok(FoundEdge {
        normal: line.normal * side,
        offset: line.offset * side,
        deviation: line.deviation,
        pixels: [onto(from), onto(to)],
    })
}

/// The unit normal of a direction, pointing away from its right-hand side in a picture, where v
/// points down.
fn outwards(along: Point) -> Option<Point> {
    let unit = along.try_normalize(1e-9)?;
    Some(Point::new(unit.y, -unit.x))
}

/// Outermost points within `reach` pixels at which the contrast crosses its threshold from inside
/// to outside an edge. Shadows may cause further crossings inside.
pub(super) fn edge_points(contrast: &Contrast, from: Point, to: Point, reach: f64) -> Vec<Point> {
    let along = to - from;
    let Some(outwards) = outwards(along) else {
        return Vec::new();
    };
    let threshold = f64::from(contrast.threshold);
    let steps = (reach / STEP).ceil() as i32;
    let mut points = Vec::new();
    for index in 0..EDGE_POINTS {
        let part = END_PART + (1.0 - 2.0 * END_PART) * (index as f64 + 0.5) / EDGE_POINTS as f64;
        let base = from + along * part;
        let value = |t: f64| {
            let point = base + outwards * t;
            contrast.at(point.x, point.y) - threshold
        };
        let crossing = (-steps..steps).rev().find_map(|k| {
            let t = f64::from(k) * STEP;
            let (inside, outside) = (value(t), value(t + STEP));
            (inside >= 0.0 && outside < 0.0).then(|| t + STEP * inside / (inside - outside))
        });
        points.extend(crossing.map(|t| base + outwards * t));
    }
    points
}

/// Line with the least squared distances; outliers are removed in three rounds.
pub(super) fn fit_line(mut points: Vec<Point>) -> Option<Line> {
    let wanted = points.len();
    let mut line = None;
    for _ in 0..3 {
        if points.len() < EDGE_POINTS / 3 || points.len() * 2 < wanted {
            return None;
        }
        let middle = points.iter().sum::<Point>() / points.len() as f64;
        let mut covariance = nalgebra::Matrix2::zeros();
        for point in &points {
            covariance += (point - middle) * (point - middle).transpose();
        }
        let eigen = covariance.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        let normal: Point = eigen.eigenvectors.column(least).into();
        let deviation = (eigen.eigenvalues[least].max(0.0) / points.len() as f64).sqrt();
        points.retain(|point| (point - middle).dot(&normal).abs() <= 2.5 * deviation + 1e-12);
        line = Some(Line {
            normal,
            offset: normal.dot(&middle),
            deviation,
        });
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// A bright half plane below a slanted line, with mixed pixels at its border.
    fn picture(slope: f64, height: f64) -> RgbImage {
        RgbImage::from_fn(200, 160, |u, v| {
            let above = f64::from(v) - (height + slope * f64::from(u));
            let part = (above + 0.5).clamp(0.0, 1.0);
            Rgb([(40.0 + 180.0 * part).round() as u8; 3])
        })
    }

    #[test]
    fn an_edge_is_found_to_a_fraction_of_a_pixel_with_its_outer_side() {
        for (slope, height) in [(0.0, 80.3), (0.1, 70.6)] {
            let picture = picture(slope, height);
            // The bright region is below, which is on the right of a direction to the right.
            let expected = [Point::new(20.0, 84.0), Point::new(180.0, 84.0)];
            let found = find_edge(&picture, &ColourRule::Background, expected, 12.0, Ok).unwrap();
            assert!(found.normal.y < -0.99, "{found:?}");
            for pixel in found.pixels {
                let away = pixel.y - (height + slope * pixel.x);
                assert!(away.abs() < 0.1, "{found:?}");
            }
            assert!(found.deviation < 0.1);
        }
    }

    #[test]
    fn a_shadow_inside_an_edge_is_not_detected_as_the_edge() {
        let mut picture = picture(0.0, 80.0);
        for (u, v) in (0..200).flat_map(|u| (90..100).map(move |v| (u, v))) {
            picture.put_pixel(u, v, Rgb([70; 3]));
        }
        let expected = [Point::new(20.0, 84.0), Point::new(180.0, 84.0)];
        let found = find_edge(&picture, &ColourRule::Background, expected, 30.0, Ok).unwrap();
        let away = found.pixels.map(|pixel| (pixel.y - 80.0).abs());
        assert!(away[0].max(away[1]) < 0.6, "{found:?}");
    }

    #[test]
    fn an_edge_that_is_not_there_is_not_found() {
        let far = [Point::new(20.0, 120.0), Point::new(180.0, 120.0)];
        let picture = picture(0.0, 80.0);
        assert!(find_edge(&picture, &ColourRule::Background, far, 12.0, Ok).is_err());
        // Searched from the wrong side, the edge is not found.
        let turned = [Point::new(180.0, 84.0), Point::new(20.0, 84.0)];
        assert!(find_edge(&picture, &ColourRule::Background, turned, 12.0, Ok).is_err());
    }
}
