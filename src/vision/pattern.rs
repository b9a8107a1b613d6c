//! Patterns from drawings: converts a drawn line to a smooth curve in metres.

use super::camera::Camera;
use super::centreline::Strand;
use super::smoothing::{resample, smooth};
use super::{Point, VisionError};
use std::fmt::Write;

/// Conversion of pixels to metres.
#[derive(Clone, Copy, Debug)]
pub enum Metric<'a> {
    /// Projection by a camera onto its table.
    Camera(&'a Camera),
    /// A scan with a known size of its pixels. The origin is the lower left pixel of the image.
    Scan {
        /// Side of a pixel, metres.
        pixel: f64,
        /// Rows of the image.
        height: u32,
    },
}

impl Metric<'_> {
    /// Coordinates of a pixel, metres; y points upwards.
    ///
    /// # Errors
    /// The pixel does not show a point of the table.
    pub fn locate(&self, pixel: Point) -> Result<Point, VisionError> {
        match self {
            Self::Camera(camera) => camera.on_table(pixel),
            Self::Scan {
                pixel: side,
                height,
            } => Ok(Point::new(
                side * pixel.x,
                side * (f64::from(*height) - 1.0 - pixel.y),
            )),
        }
    }
}

/// The curve of a strand in metres, smoothed: waves shorter than about 2π times `smoothing`, in
/// metres, are treated as hand tremor. The pen is assumed to be round, so that the ends of the
/// curve are half a line width inside the ink. Points are at most `step` apart. The curve of a
/// closed strand ends with its first point.
///
/// # Errors
/// A pixel does not show a point of the table; the strand has zero length in metres, or is too
/// short for the smoothing.
pub fn pattern(
    strand: &Strand,
    metric: Metric,
    smoothing: f64,
    step: f64,
) -> Result<Vec<Point>, VisionError> {
    let drawn = without_caps(strand);
    let located: Result<Vec<Point>, VisionError> =
        drawn.iter().map(|point| metric.locate(*point)).collect();
    let located = located?;
    // A step that is fine enough for the smoothing and for the points of the drawing.
    let fine = if smoothing > 0.0 {
        step.min(0.5 * smoothing)
    } else {
        step
    };
    let (points, length) = resample(&located, fine, strand.closed);
    if !(length > 0.0) || smoothing >= 0.5 * length || points.len() < 4 {
        return Err(VisionError::Undetermined {
            problem: "the pattern",
            reason: format!(
                "the drawn line is {length:.4} m long; the smoothing length must be below half of \
                 that, and the step below a third"
            ),
        });
    }
    let spacing = length / points.len() as f64;
    let lambda = (smoothing / spacing).powi(4);
    let mut smoothed = smooth(&points, &vec![1.0; points.len()], lambda, strand.closed);
    if strand.closed {
        smoothed.push(smoothed[0]);
    }
    Ok(resample(&smoothed, step, false).0)
}

/// The path of the centre of the pen; the ink extends half a line width beyond its ends.
fn without_caps(strand: &Strand) -> Vec<Point> {
    let mut points = strand.points.clone();
    if strand.closed || strand.length() < 3.0 * strand.width() {
        return points;
    }
    for _ in 0..2 {
        points.reverse();
        let mut rest = 0.5 * strand.width();
        while points.len() > 2 {
            let (end, before) = (points[points.len() - 1], points[points.len() - 2]);
            let size = (end - before).norm();
            if size > rest {
                let last = points.len() - 1;
                points[last] = end + (before - end) * (rest / size);
                break;
            }
            rest -= size;
            points.pop();
        }
    }
    points
}

/// A curve as a pattern file: CSV with columns `x_m,y_m`.
pub fn pattern_csv(points: &[Point]) -> String {
    let mut text = String::from("x_m,y_m\n");
    for point in points {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{:.7},{:.7}", point.x, point.y);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::camera::tests::looking_at;
    use super::super::render::{RenderOptions, render};
    use super::super::score::score;
    use super::super::{ColourRule, TraceOptions, trace};
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};
    use std::f64::consts::PI;

    fn camera() -> Camera {
        let slant = UnitQuaternion::from_euler_angles(0.15, -0.1, 0.2);
        let lens = ([910.0; 2], [639.5, 359.5], [0.06, -0.1, 0.0, 0.0, 0.0]);
        looking_at(Vector3::zeros(), 0.5, slant, [1280, 720], lens)
    }

    /// Returns a function that looks up in a raster of 0.05 mm whether a point within 0.1 m is
    /// within a radius of a curve.
    fn ink(curve: &[Point], radius: f64) -> impl Fn(Point) -> bool {
        const CELL: f64 = 0.05e-3;
        const SIDE: i32 = 4400;
        let mut raster = vec![false; (SIDE * SIDE) as usize];
        let index = |x: i32, y: i32| (y + SIDE / 2) * SIDE + x + SIDE / 2;
        let (dense, _) = resample(curve, CELL, false);
        let reach = (radius / CELL).ceil() as i32;
        let cell = |point: Point| [point.x, point.y].map(|x| (x / CELL).round() as i32);
        for [x, y] in dense.into_iter().map(cell) {
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    if f64::from(dx).hypot(f64::from(dy)) * CELL < radius {
                        raster[index(x + dx, y + dy) as usize] = true;
                    }
                }
            }
        }
        move |point| {
            let [x, y] = cell(point);
            x.abs().max(y.abs()) < SIDE / 2 && raster[index(x, y) as usize]
        }
    }

    /// Letters of a single line each, within 0.2 m.
    fn letters() -> Vec<(&'static str, Vec<Point>)> {
        let along = |curve: &dyn Fn(f64) -> Point| -> Vec<Point> {
            (0..=400)
                .map(|index| curve(f64::from(index) / 400.0))
                .collect()
        };
        vec![
            (
                "C",
                along(&|t| {
                    let angle = 0.8 + t * (2.0 * PI - 1.6);
                    Point::new(0.08 * angle.cos(), 0.08 * angle.sin())
                }),
            ),
            (
                "S",
                along(&|t| {
                    let angle = 1.5 * PI * (2.0 * t - 1.0);
                    let bend = if t < 0.5 { 1.0 } else { -1.0 };
                    let turn = angle.abs() - PI / 2.0;
                    Point::new(
                        -0.04 * turn.cos() * bend,
                        0.04 * bend + 0.04 * bend * turn.sin(),
                    )
                }),
            ),
            (
                "U",
                along(&|t| {
                    if t < 0.3 {
                        Point::new(-0.05, 0.08 - t / 0.3 * 0.08)
                    } else if t < 0.7 {
                        let angle = PI + (t - 0.3) / 0.4 * PI;
                        Point::new(0.05 * angle.cos(), 0.05 * angle.sin())
                    } else {
                        Point::new(0.05, (t - 0.7) / 0.3 * 0.08)
                    }
                }),
            ),
            (
                "loop",
                along(&|t| {
                    Point::new(
                        0.16 * (t - 0.5) + 0.03 * (4.0 * PI * t).sin(),
                        0.05 * (4.0 * PI * t).cos(),
                    )
                }),
            ),
        ]
    }

    #[test]
    fn drawn_letters_come_back_within_half_a_millimetre() {
        let camera = camera();
        for (name, letter) in letters() {
            // A pen stroke 1.6 mm wide on grey paper that is darker on one side.
            let inked = ink(&letter, 0.0008);
            let ground = |point: Point| {
                let paper = 200.0 + 150.0 * point.x;
                let light = if inked(point) { 0.3 } else { 1.0 };
                [paper * light, paper * light, 0.95 * paper * light]
            };
            let options = RenderOptions {
                noise: 4.0,
                ..RenderOptions::default()
            };
            let picture = render(&camera, &[], ground, &options);
            let rule = ColourRule::parse("pen").expect("a rule");
            let traced = trace(
                &picture,
                &TraceOptions {
                    colour: rule,
                    ..TraceOptions::default()
                },
            )
            .expect("a line");
            assert_eq!(traced.strands.len(), 1, "{name}");
            let found = pattern(&traced.strands[0], Metric::Camera(&camera), 0.002, 0.001)
                .expect("a pattern");
            let error = score(&found, &letter, 100, false).expect("a score");
            assert!(
                error.by_nearest_point.largest_m < 0.5e-3,
                "{name}: {:?}",
                error.by_nearest_point
            );
            assert!(
                error.by_arc_length.mean_m < 0.5e-3,
                "{name}: {:?}",
                error.by_arc_length
            );
        }
    }

    #[test]
    fn a_scan_has_its_origin_at_the_lower_left() {
        let scan = Metric::Scan {
            pixel: 1e-3,
            height: 100,
        };
        let place = scan.locate(Point::new(10.0, 99.0)).expect("a place");
        assert!((place - Point::new(0.01, 0.0)).norm() < 1e-15);
        let place = scan.locate(Point::new(0.0, 0.0)).expect("a place");
        assert!((place - Point::new(0.0, 0.099)).norm() < 1e-15);
    }

    #[test]
    fn too_much_smoothing_is_refused() {
        let points = (0..50).map(|index| Point::new(f64::from(index), 0.0));
        let strand = Strand::even(points.collect(), 3.0, false);
        let scan = Metric::Scan {
            pixel: 1e-3,
            height: 10,
        };
        assert!(pattern(&strand, scan, 0.002, 0.001).is_ok());
        assert!(pattern(&strand, scan, 0.1, 0.001).is_err());
    }
}
