//! Bright markers on a rod, and their comparison with positions on a helix to check whether the
//! rod is still a helix.

use super::camera::Camera;
use super::contrast::Contrast;
use super::mask::Mask;
use super::{ColourRule, Point, VisionError};
use image::RgbImage;
use nalgebra::{Isometry3, Point3, Vector3};

/// Centres of gravity of all spots of a colour, pixels, from left to right. Spots of fewer than
/// `least_area` or more than `largest_area` pixels are ignored.
///
/// # Errors
/// The pixel to pick the colour from is outside the picture.
pub fn find_markers(
    picture: &RgbImage,
    rule: &ColourRule,
    least_area: usize,
    largest_area: usize,
) -> Result<Vec<Point>, VisionError> {
    let contrast = Contrast::new(picture, rule)?;
    let mask = Mask::of_contrast(&contrast);
    let mut markers = Vec::new();
    for part in mask.parts() {
        if part.len() < least_area || part.len() > largest_area {
            continue;
        }
        let (mut sum, mut weight) = (Point::zeros(), 0.0);
        for (column, row) in part {
            // Faint pixels have small weights, so that the centre moves smoothly.
            let above = contrast.values[row * contrast.width + column] - contrast.threshold;
            let value = 1.0 + f64::from(above);
            sum += Point::new(column as f64, row as f64) * value;
            weight += value;
        }
        markers.push(sum / weight);
    }
    markers.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    Ok(markers)
}

/// Points of a helix of curvature κ and torsion τ, 1/m, at arc lengths in metres.
///
/// In its own axes, the helix begins at the origin in the direction of z, with its curvature
/// vector along x. With ω = √(κ² + τ²), the position at s is (κ/ω² (1 − cos ωs), κτ/ω³ (ωs − sin
/// ωs), (κ² sin ωs + τ² ωs)/ω³).
pub fn helix_points(
    curvature: f64,
    torsion: f64,
    arc_lengths: &[f64],
    pose: &Isometry3<f64>,
) -> Vec<Vector3<f64>> {
    let omega = libm::hypot(curvature, torsion);
    let point = |s: f64| {
        if omega * s.abs() < 1e-9 {
            return Vector3::new(0.5 * curvature * s * s, 0.0, s);
        }
        let angle = omega * s;
        Vector3::new(
            curvature * (1.0 - libm::cos(angle)) / omega.powi(2),
            curvature * torsion * (angle - libm::sin(angle)) / omega.powi(3),
            (curvature.powi(2) * libm::sin(angle) + torsion.powi(2) * angle) / omega.powi(3),
        )
    };
    let moved = |s: &f64| (pose * Point3::from(point(*s))).coords;
    arc_lengths.iter().map(moved).collect()
}

/// Distances of markers from their expected positions.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerErrors {
    /// Place of each expected marker in the picture; `None` if it is behind the camera.
    pub expected: Vec<Option<Point>>,
    /// The detected marker that was assigned to each expected marker, if any.
    pub found: Vec<Option<Point>>,
    /// Distance between expected and detected marker, pixels.
    pub pixels: Vec<Option<f64>>,
    /// This distance in metres, at the distance of the expected marker from the camera.
    pub metres: Vec<Option<f64>>,
    /// Root mean square of the distances, metres. A missing marker counts as one at the gate
    /// distance.
    pub rms_metres: f64,
}

/// Compares detected markers with the expected positions of all markers, in the world. Markers are
/// assigned one to one, nearest pairs first, up to `gate` pixels apart.
///
/// # Errors
/// No expected marker lies in front of the camera.
pub fn compare_markers(
    camera: &Camera,
    expected: &[Vector3<f64>],
    found: &[Point],
    gate: f64,
) -> Result<MarkerErrors, VisionError> {
    let places: Vec<Option<Point>> = expected
        .iter()
        .map(|point| camera.project(*point))
        .collect();
    let mut pairs = Vec::new();
    for (index, place) in places.iter().enumerate() {
        for (marker, position) in found.iter().enumerate() {
            if let Some(place) = place {
                let distance = (position - place).norm();
                if distance <= gate {
                    pairs.push((distance, index, marker));
                }
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pixels = vec![None; expected.len()];
    let mut matched = vec![None; expected.len()];
    let mut used = vec![false; found.len()];
    for (distance, index, marker) in pairs {
        if pixels[index].is_none() && !used[marker] {
            pixels[index] = Some(distance);
            matched[index] = Some(found[marker]);
            used[marker] = true;
        }
    }
    let focal = 0.5 * (camera.lens.focal[0] + camera.lens.focal[1]);
    let per_pixel =
        |point: &Vector3<f64>| camera.pose.inverse_transform_point(&(*point).into()).z / focal;
    let metres: Vec<Option<f64>> = pixels
        .iter()
        .zip(expected)
        .map(|(pixels, point)| pixels.map(|pixels: f64| pixels * per_pixel(point)))
        .collect();
    let seen = expected
        .iter()
        .zip(&places)
        .zip(&metres)
        .filter(|((_, place), _)| place.is_some());
    let squares: Vec<f64> = seen
        .map(|((point, _), metres)| metres.unwrap_or(gate * per_pixel(point)).powi(2))
        .collect();
    if squares.is_empty() {
        return Err(VisionError::NotFound {
            what: "the helix",
            reason: "none of its markers is in front of the camera".into(),
        });
    }
    Ok(MarkerErrors {
        expected: places,
        found: matched,
        pixels,
        metres,
        rms_metres: (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
    })
}

/// The rule for the loss of stability.
///
/// The rod is unstable once its error is above `upper` in `frames` consecutive pictures, and
/// stable again once it is below `lower` in as many. Between the bounds the state is kept, so that
/// noise around one bound has no effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstabilityRule {
    /// Error above which the rod is not a helix, metres.
    pub upper: f64,
    /// Error below which the rod is a helix again, metres; less than `upper`.
    pub lower: f64,
    /// Number of consecutive pictures needed for a change of state.
    pub frames: usize,
}

/// Applies an [`InstabilityRule`] to picture after picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstabilityWatch {
    rule: InstabilityRule,
    unstable: bool,
    against: usize,
}

impl InstabilityWatch {
    /// Starts with a stable rod.
    ///
    /// # Errors
    /// The bounds are not positive and in order, or the number of frames is zero.
    pub fn new(rule: InstabilityRule) -> Result<Self, VisionError> {
        if !(rule.lower > 0.0 && rule.lower < rule.upper && rule.upper.is_finite())
            || rule.frames == 0
        {
            return Err(VisionError::Undetermined {
                problem: "the rule for instability",
                reason: format!(
                    "expected 0 < lower < upper and at least one picture, found {} m, {} m and {}",
                    rule.lower, rule.upper, rule.frames
                ),
            });
        }
        Ok(Self {
            rule,
            unstable: false,
            against: 0,
        })
    }

    /// Processes the error of the next picture, metres, and returns whether the rod is unstable
    /// now. An error that is not a number counts as large.
    pub fn observe(&mut self, error: f64) -> bool {
        let speaks_against = if self.unstable {
            error < self.rule.lower
        } else {
            !(error <= self.rule.upper)
        };
        self.against = if speaks_against { self.against + 1 } else { 0 };
        if self.against >= self.rule.frames {
            self.unstable = !self.unstable;
            self.against = 0;
        }
        self.unstable
    }
}

#[cfg(test)]
mod tests {
    use super::super::camera::tests::slanted_camera;
    use super::*;

    #[test]
    fn a_helix_has_its_curvature_and_torsion() {
        let (curvature, torsion, h) = (6.0, 4.0, 1e-3);
        let lengths: Vec<f64> = (0..4).map(|k| 0.1 + h * f64::from(k)).collect();
        let p = helix_points(curvature, torsion, &lengths, &Isometry3::identity());
        let (a, b, c) = (p[1] - p[0], p[2] - p[1], p[3] - p[2]);
        assert!((a.norm() / h - 1.0).abs() < 1e-5);
        let bend = a.cross(&b).norm() / h.powi(3);
        assert!((bend / curvature - 1.0).abs() < 1e-4, "{bend}");
        let twist = a.cross(&b).dot(&c) / a.cross(&b).norm_squared() / h * h.powi(1);
        assert!(
            (twist / torsion / h - 1.0).abs() < 0.01 || (twist / torsion - 1.0).abs() < 0.01,
            "{twist}"
        );
        let straight = helix_points(0.0, 0.0, &[0.2], &Isometry3::identity());
        assert!((straight[0] - Vector3::new(0.0, 0.0, 0.2)).norm() < 1e-12);
    }

    #[test]
    fn markers_are_found_and_measured() {
        let camera = slanted_camera();
        let pose = Isometry3::new(Vector3::new(0.02, 0.25, 0.05), Vector3::new(0.0, 1.3, 0.0));
        let lengths: Vec<f64> = (0..8).map(|k| 0.02 + 0.025 * f64::from(k)).collect();
        let expected = helix_points(9.0, 5.0, &lengths, &pose);
        let shift = Point::new(1.5, -2.0);
        let spots: Vec<Point> = expected
            .iter()
            .map(|point| camera.project(*point).expect("in front") + shift)
            .collect();
        let picture = RgbImage::from_fn(camera.width, camera.height, |u, v| {
            let pixel = Point::new(f64::from(u), f64::from(v));
            let cover = spots
                .iter()
                .map(|spot| (5.0 - (spot - pixel).norm()).clamp(0.0, 1.0))
                .fold(0.0, f64::max);
            let mix = |from: f64, to: f64| (from + cover * (to - from)) as u8;
            image::Rgb([mix(60.0, 40.0), mix(60.0, 90.0), mix(60.0, 230.0)])
        });
        let rule = ColourRule::parse("blue").expect("a rule");
        let found = find_markers(&picture, &rule, 20, 400).expect("markers");
        assert_eq!(found.len(), 8, "{spots:?}");
        let errors = compare_markers(&camera, &expected, &found, 20.0).expect("errors");
        for pixels in &errors.pixels {
            assert!((pixels.expect("a marker") - 2.5).abs() < 0.15, "{pixels:?}");
        }
        let depth = 0.6;
        assert!((errors.rms_metres / (2.5 * depth / 907.0) - 1.0).abs() < 0.3);
        // A missing marker does not count as stable.
        let fewer = compare_markers(&camera, &expected, &found[1..], 20.0).expect("errors");
        assert_eq!(
            fewer
                .pixels
                .iter()
                .filter(|pixels| pixels.is_none())
                .count(),
            1
        );
        assert!(fewer.rms_metres > errors.rms_metres);
    }

    #[test]
    fn noise_about_a_bound_does_not_trigger_the_rule() {
        let rule = InstabilityRule {
            upper: 0.01,
            lower: 0.004,
            frames: 3,
        };
        let mut watch = InstabilityWatch::new(rule).expect("a rule");
        for index in 0..100 {
            // The error is above the bound in two of three pictures.
            let error = if index % 3 == 0 { 0.009 } else { 0.011 };
            assert!(!watch.observe(error));
        }
        let decisions: Vec<bool> = (0..4).map(|_| watch.observe(0.03)).collect();
        assert_eq!(decisions, [false, false, true, true]);
        for _ in 0..50 {
            assert!(watch.observe(0.006), "between the bounds nothing changes");
        }
        assert!(watch.observe(0.003) && watch.observe(0.003));
        assert!(!watch.observe(0.003));
        assert!(
            InstabilityWatch::new(InstabilityRule {
                lower: 0.02,
                ..rule
            })
            .is_err()
        );
        assert!(InstabilityWatch::new(InstabilityRule { frames: 0, ..rule }).is_err());
    }
}
