//! Distance of a deployed curve from its pattern.

use super::{Point, VisionError, smoothing};
use nalgebra::{Isometry2, Rotation2, Translation2, UnitComplex};
use serde::{Deserialize, Serialize};

/// Distances of corresponding points, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveError {
    /// Mean distance, e_mean of Eq. 5.11.
    pub mean_m: f64,
    /// Standard deviation: σ of Eq. 5.11 with the deviation squared, since it is zero as printed,
    /// without the square.
    pub deviation_m: f64,
    /// Largest distance.
    pub largest_m: f64,
}

impl CurveError {
    fn of(distances: &[f64]) -> Self {
        let count = distances.len() as f64;
        let mean_m = distances.iter().sum::<f64>() / count;
        let square: f64 = distances.iter().map(|d| (d - mean_m).powi(2)).sum();
        Self {
            mean_m,
            deviation_m: (square / count).sqrt(),
            largest_m: distances.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// Eq. 5.11 for both correspondences of points. Points of the pattern are at equal distances along
/// it.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Each point of the pattern with the point at the same fraction of the result's length.
    pub by_arc_length: CurveError,
    /// Each point of the pattern with the nearest point of the result.
    pub by_nearest_point: CurveError,
    /// Rigid motion that was applied to the result first; the identity if none was requested.
    pub alignment: Isometry2<f64>,
    /// Whether the result runs in the opposite direction to the pattern.
    pub reversed: bool,
    /// The points of the pattern.
    pub pattern: Vec<Point>,
    /// The result's points with the same index, after the alignment.
    pub result: Vec<Point>,
    /// Length of the pattern, metres.
    pub pattern_length: f64,
    /// Length of the result, metres.
    pub result_length: f64,
}

/// Number of points in the thesis.
pub const SCORE_POINTS: usize = 50;
/// Number of starts that are tried between two points of a closed result.
const STARTS: usize = 8;

/// Scores a curve against a pattern, both in metres, with `points` points.
///
/// The direction of the result is the one that fits better; if both curves are closed, its start
/// is also the one that fits best. With `align`, the result is first rotated and moved so that the
/// sum of squared distances by arc length is least.
///
/// # Errors
/// A curve has no length, or there are fewer than two points to compare.
pub fn score(
    result: &[Point],
    pattern: &[Point],
    points: usize,
    align: bool,
) -> Result<Score, VisionError> {
    let undetermined = |reason: &str| VisionError::Undetermined {
        problem: "the score",
        reason: reason.into(),
    };
    if points < 2 {
        return Err(undetermined("at least two points are needed"));
    }
    let (pattern_points, pattern_length) = equidistant(pattern, points)
        .ok_or_else(|| undetermined("the pattern has fewer than two different points"))?;
    let of_result = |points| {
        equidistant(result, points)
            .ok_or_else(|| undetermined("the result has fewer than two different points"))
    };
    let (result_points, result_length) = of_result(points)?;
    let closed =
        is_closed(&pattern_points, pattern_length) && is_closed(&result_points, result_length);
    // The start of a closed result is searched at a fraction of the distance between points.
    let fine = if closed { STARTS } else { 1 };
    let (result_points, _) = of_result(fine * (points - 1) + 1)?;
    let mut best: Option<(f64, bool, Vec<Point>, Isometry2<f64>)> = None;
    for reversed in [false, true] {
        let shifts = if closed { fine * (points - 1) } else { 1 };
        for shift in 0..shifts {
            let candidate = reordered(&result_points, reversed, shift, closed, fine);
            let alignment = if align {
                rigid_alignment(&candidate, &pattern_points)
            } else {
                Isometry2::identity()
            };
            let moved = moved(&candidate, &alignment);
            let pairs = moved.iter().zip(&pattern_points);
            let square: f64 = pairs.map(|(a, b)| (a - b).norm_squared()).sum();
            // The direction of tracing is kept if both fit equally.
            if best
                .as_ref()
                .is_none_or(|best| square < best.0 * (1.0 - 1e-9))
            {
                best = Some((square, reversed, moved, alignment));
            }
        }
    }
    let (_, reversed, moved, alignment) =
        best.ok_or_else(|| undetermined("there is nothing to compare"))?;
    let distances: Vec<f64> = moved
        .iter()
        .zip(&pattern_points)
        .map(|(a, b)| (a - b).norm())
        .collect();
    let whole = self::moved(result, &alignment);
    let nearest: Vec<f64> = pattern_points
        .iter()
        .map(|point| distance_to(&whole, *point))
        .collect();
    Ok(Score {
        by_arc_length: CurveError::of(&distances),
        by_nearest_point: CurveError::of(&nearest),
        alignment,
        reversed,
        pattern: pattern_points,
        result: moved,
        pattern_length,
        result_length,
    })
}

fn moved(points: &[Point], motion: &Isometry2<f64>) -> Vec<Point> {
    let points = points.iter();
    points
        .map(|point| motion.transform_point(&(*point).into()).coords)
        .collect()
}

/// The part of a curve with the length of a pattern that begins at the arc length `begin`, all in
/// metres. For a laid rod, the part before it is the lead-in, and the part after it was not laid.
///
/// # Errors
/// The curve is too short for the pattern.
pub fn part_of_curve(
    curve: &[Point],
    begin: f64,
    pattern: &[Point],
) -> Result<Vec<Point>, VisionError> {
    let wanted = polyline_length(pattern);
    let whole = polyline_length(curve);
    // The polyline of a curve is slightly shorter than the curve itself.
    const SLACK: f64 = 0.01;
    if !(begin + wanted <= whole + SLACK * wanted) {
        return Err(VisionError::Undetermined {
            problem: "the score",
            reason: format!(
                "the result is {whole:.4} m long: too short for a pattern of {wanted:.4} m that begins at {begin:.4} m"
            ),
        });
    }
    let end = begin + wanted;
    let mut part = Vec::new();
    let mut along = 0.0;
    for pair in curve.windows(2) {
        let size = (pair[1] - pair[0]).norm();
        let place = |s: f64| pair[0] + (pair[1] - pair[0]) * ((s - along) / size);
        if part.is_empty() && along <= begin && begin < along + size {
            part.push(place(begin));
        }
        if !part.is_empty() && along + size >= end {
            part.push(place(end));
            break;
        }
        along += size;
        if !part.is_empty() {
            part.push(pair[1]);
        }
    }
    Ok(part)
}

/// Length of a polyline, in the unit of its points.
pub(super) fn polyline_length(curve: &[Point]) -> f64 {
    let steps = curve.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    steps.sum()
}

/// Exactly `points` points at equal distances.
fn equidistant(curve: &[Point], points: usize) -> Option<(Vec<Point>, f64)> {
    let finite = curve
        .iter()
        .all(|point| point.iter().all(|x| x.is_finite()));
    let length = polyline_length(curve);
    if !finite || !(length > 0.0) {
        return None;
    }
    // The step is slightly longer than needed, so that rounding does not add a point.
    let step = length / (points as f64 - 1.0) * (1.0 + 1e-9);
    let (resampled, length) = smoothing::resample(curve, step, false);
    (resampled.len() == points).then_some((resampled, length))
}

fn is_closed(points: &[Point], length: f64) -> bool {
    (points[0] - points[points.len() - 1]).norm() < 1e-3 * length
}

fn reordered(
    points: &[Point],
    reversed: bool,
    shift: usize,
    closed: bool,
    every: usize,
) -> Vec<Point> {
    let mut points = points.to_vec();
    if closed {
        points.pop();
        points.rotate_left(shift);
        points.push(points[0]);
    }
    if reversed {
        points.reverse();
    }
    points.into_iter().step_by(every).collect()
}

/// Rotation and shift that bring points nearest to others (Umeyama, IEEE TPAMI 13:376, 1991, for
/// the plane).
pub fn rigid_alignment(from: &[Point], to: &[Point]) -> Isometry2<f64> {
    let count = from.len().max(1) as f64;
    let (a, b) = (
        from.iter().sum::<Point>() / count,
        to.iter().sum::<Point>() / count,
    );
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (p, q) in from.iter().zip(to) {
        cosine += (p - a).dot(&(q - b));
        sine += (p - a).perp(&(q - b));
    }
    let rotation = UnitComplex::from_rotation_matrix(&Rotation2::new(libm::atan2(sine, cosine)));
    Isometry2::from_parts(Translation2::from(b - rotation * a), rotation)
}

/// Distance of a point from a polyline.
pub fn distance_to(line: &[Point], point: Point) -> f64 {
    let distance = |from: Point, to: Point| {
        let along = to - from;
        let t = (point - from).dot(&along) / along.norm_squared().max(1e-300);
        (from + along * t.clamp(0.0, 1.0) - point).norm()
    };
    let distances = line.windows(2).map(|pair| distance(pair[0], pair[1]));
    distances.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn wave(count: usize, shift: Point) -> Vec<Point> {
        (0..count)
            .map(|index| {
                let x = index as f64 / (count - 1) as f64;
                Point::new(x, 0.2 * (TAU * x).sin()) + shift
            })
            .collect()
    }

    #[test]
    fn a_shifted_straight_line_is_off_by_the_shift() {
        let line = |y: f64| vec![Point::new(0.0, y), Point::new(0.3, y), Point::new(1.0, y)];
        let found = score(&line(0.01), &line(0.0), SCORE_POINTS, false).expect("a score");
        for error in [found.by_arc_length, found.by_nearest_point] {
            assert!((error.mean_m - 0.01).abs() < 1e-12, "{error:?}");
            assert!(error.deviation_m < 1e-12);
        }
    }

    #[test]
    fn both_correspondences_differ_for_a_stretched_line() {
        // Errors by arc length are 0 to 10 % along the line; errors at right angles are zero
        // except beyond the end.
        let pattern = [Point::new(0.0, 0.0), Point::new(1.0, 0.0)];
        let result = [Point::new(0.0, 0.0), Point::new(1.1, 0.0)];
        let found = score(&result, &pattern, 101, false).expect("a score");
        assert!((found.by_arc_length.mean_m - 0.05).abs() < 1e-9);
        // The errors are equidistant from 0 to 0.1, so that their standard deviation is that of
        // the discrete uniform distribution.
        let expected = 0.1 * ((101.0f64 * 101.0 - 1.0) / 12.0).sqrt() / 100.0;
        assert!((found.by_arc_length.deviation_m - expected).abs() < 1e-9);
        assert!(found.by_nearest_point.mean_m < 1e-12);
    }

    #[test]
    fn direction_and_sampling_do_not_matter() {
        let pattern = wave(400, Point::zeros());
        let mut result = wave(317, Point::zeros());
        result.reverse();
        let found = score(&result, &pattern, SCORE_POINTS, false).expect("a score");
        assert!(found.reversed);
        assert!(found.by_arc_length.mean_m < 1e-4, "{found:?}");
    }

    #[test]
    fn alignment_undoes_a_motion() {
        let pattern = wave(200, Point::zeros());
        let motion = Isometry2::new(Point::new(0.3, -0.2), 0.7);
        let result = moved(&pattern, &motion);
        let found = score(&result, &pattern, SCORE_POINTS, true).expect("a score");
        assert!(found.by_arc_length.largest_m < 1e-9);
        assert!((found.alignment * motion).rotation.angle().abs() < 1e-9);
        let as_is = score(&result, &pattern, SCORE_POINTS, false).expect("a score");
        assert!(as_is.by_arc_length.mean_m > 0.1);
    }

    #[test]
    fn closed_curves_may_begin_anywhere() {
        let circle = |start: f64| -> Vec<Point> {
            (0..=98)
                .map(|index| {
                    let angle = start + TAU * f64::from(index) / 98.0;
                    Point::new(angle.cos(), angle.sin())
                })
                .collect()
        };
        let found = score(&circle(PI), &circle(0.0), SCORE_POINTS, false).expect("a score");
        assert!(
            found.by_arc_length.largest_m < 0.01,
            "{:?}",
            found.by_arc_length
        );
    }

    #[test]
    fn a_part_begins_and_ends_between_points() {
        // The curve has a corner at 1 m; the pattern is 0.8 m long.
        let curve = [Point::zeros(), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        let pattern = [Point::zeros(), Point::new(0.8, 0.0)];
        let part = part_of_curve(&curve, 0.7, &pattern).expect("a part");
        let expected = [[0.7, 0.0], [1.0, 0.0], [1.0, 0.5]].map(Point::from);
        assert_eq!(part.len(), 3);
        for (found, expected) in part.iter().zip(expected) {
            assert!((found - expected).norm() < 1e-12, "{found}");
        }
        let error = part_of_curve(&curve, 1.5, &pattern).expect_err("too short");
        assert!(error.to_string().contains("2.0000 m long"), "{error}");
    }

    #[test]
    fn curves_without_length_are_refused() {
        let point = [Point::zeros(), Point::zeros()];
        let line = [Point::zeros(), Point::x()];
        assert!(score(&point, &line, 50, false).is_err());
        assert!(score(&line, &point, 50, false).is_err());
        assert!(score(&line, &line, 1, false).is_err());
        let wrong = [Point::zeros(), Point::new(f64::NAN, 0.0)];
        assert!(score(&wrong, &line, 50, false).is_err());
    }
}
