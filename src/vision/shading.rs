//! Difference of colours from those of the background and its shades.
//!
//! The colours of the background are a normal distribution with mean m and covariance C, fitted to
//! the frequent colours. A shadow or a highlight multiplies a colour by a factor k, which adds
//! σ² m mᵀ to the covariance if k has the standard deviation σ (chromatic and brightness distortion
//! are separated in this way by Horprasert, Harwood and Davis, ICCV Frame-Rate Workshop, 1999). The
//! contrast is the Mahalanobis distance d = √((p − m)ᵀ (C + σ² m mᵀ + n² I)⁻¹ (p − m)).

use image::RgbImage;
use nalgebra::{Matrix3, Vector3};

/// Standard deviation σ of the brightness of the background, relative to its mean.
const SHADE: f64 = 0.3;
/// Least noise n of a channel, out of 255, after the blur.
const LEAST_NOISE: f64 = 1.5;
/// Distance within which a colour belongs to the background, for the fit.
const BACKGROUND_DISTANCE: f64 = 3.0;
/// Rounds of the fit.
const ROUNDS: usize = 5;
/// Largest number of pixels used for the fit.
const MOST_SAMPLES: usize = 20_000;
/// Contrast of a distance of one standard deviation.
pub(super) const SCALE: f64 = 10.0;
/// Distance at which a rod may be distinguished from noise, as a contrast.
pub(super) const LEAST_SHADED: f64 = 5.0 * SCALE;

/// Distances of a blurred picture from its background with the most frequent colour `commonest`,
/// as contrasts.
pub(super) fn shaded_contrast(picture: &RgbImage, commonest: [u8; 3]) -> Vec<u8> {
    let (mean, inverse) = background(picture, commonest);
    let m = mean;
    let [xx, yy, zz] = [inverse[(0, 0)], inverse[(1, 1)], inverse[(2, 2)]];
    let [xy, xz, yz] = [inverse[(0, 1)], inverse[(0, 2)], inverse[(1, 2)]];
    let value = |rgb: [u8; 3]| {
        let [x, y, z] = [0, 1, 2].map(|k| f64::from(rgb[k]) - m[k]);
        let square =
            xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z);
        (SCALE * square.max(0.0).sqrt()).min(255.0) as u8
    };
    picture.pixels().map(|pixel| value(pixel.0)).collect()
}

/// Mean and inverse covariance of the background.
fn background(picture: &RgbImage, commonest: [u8; 3]) -> (Vector3<f64>, Matrix3<f64>) {
    let stride = (picture.width() as usize * picture.height() as usize / MOST_SAMPLES).max(1);
    // An odd stride does not fall on the same columns in each row of most images.
    let samples: Vec<Vector3<f64>> = picture
        .pixels()
        .step_by(stride | 1)
        .map(|pixel| Vector3::from(pixel.0.map(f64::from)))
        .collect();
    let mut mean = Vector3::from(commonest.map(f64::from));
    let inverse = |mean: Vector3<f64>, covariance: Matrix3<f64>| {
        let noise = Matrix3::from_diagonal_element(LEAST_NOISE * LEAST_NOISE);
        let shades = mean * mean.transpose() * (SHADE * SHADE);
        let whole = covariance + shades + noise;
        whole.try_inverse().unwrap_or_else(Matrix3::identity)
    };
    // The first guess is wide enough for one cell of the histogram.
    let mut precision = inverse(mean, Matrix3::from_diagonal_element(64.0));
    for _ in 0..ROUNDS {
        let (mut count, mut sum, mut squares) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for sample in &samples {
            let away = sample - mean;
            if away.dot(&(precision * away)) < BACKGROUND_DISTANCE * BACKGROUND_DISTANCE {
                count += 1.0;
                sum += away;
                squares += away * away.transpose();
            }
        }
        if count < 10.0 {
            break;
        }
        let shift = sum / count;
        mean += shift;
        precision = inverse(mean, squares / count - shift * shift.transpose());
    }
    (mean, precision)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn shades_of_the_background_have_little_contrast_and_hues_much() {
        let table = [160u8, 150, 130];
        let shade = |rgb: [u8; 3], factor: f64| rgb.map(|x| (f64::from(x) * factor) as u8);
        let picture = RgbImage::from_fn(100, 100, |u, v| {
            Rgb(match (u, v) {
                (0..10, 0..10) => shade(table, 0.6),
                (20..25, _) => [180, 60, 60],
                _ => shade(table, 0.95 + 0.01 * f64::from((7 * u + 3 * v) % 11)),
            })
        });
        let values = shaded_contrast(&picture, table);
        let at = |u: usize, v: usize| f64::from(values[v * 100 + u]);
        assert!(at(5, 5) < 0.5 * LEAST_SHADED, "{}", at(5, 5));
        assert!(at(22, 50) > 2.0 * LEAST_SHADED, "{}", at(22, 50));
        assert!(at(60, 60) < 0.5 * LEAST_SHADED, "{}", at(60, 60));
    }
}
