//! Contrast of every pixel: a grey image whose threshold gives the mask.

use super::VisionError;
use super::averages::{blur, local_means};
use super::colour::{ColourRule, LabBall, colour_difference, lab};
use super::pixels::around;
use super::shading::{LEAST_SHADED, shaded_contrast};
use super::surroundings::{brightness, flanks_contrast, reach};
use image::{GrayImage, RgbImage};

/// A grey image that is brighter where a pixel looks more like a rod. Pixels at or above the threshold are the mask;
/// between pixels, the contour at the threshold is the edge of the rod.
#[derive(Clone, Debug)]
pub struct Contrast {
    /// Width of the picture, pixels.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row.
    pub values: Vec<u8>,
    /// Smallest value of a rod; at least 1.
    pub threshold: u8,
}

/// Least difference of a rod from its background, out of 255, for [`ColourRule::Background`];
/// larger than sensor noise.
const LEAST_CONTRAST: f64 = 24.0;
/// Threshold of the rules with a fixed one.
pub(super) const MIDDLE: u8 = 128;
/// Least difference in brightness from the surroundings for [`ColourRule::Relief`].
const LEAST_RELIEF: u64 = 6;

impl Contrast {
    /// Applies a colour rule to a picture, after a binomial blur of 3 × 3 pixels that reduces
    /// noise.
    ///
    /// # Errors
    /// The pixel to pick is outside the picture.
    pub fn new(picture: &RgbImage, rule: &ColourRule) -> Result<Self, VisionError> {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let (mut values, threshold) = match rule {
            ColourRule::Background => background_contrast(picture),
            ColourRule::Hsv(range) => {
                let value = |rgb| 255 * u8::from(range.contains(rgb));
                (map(picture, value), MIDDLE)
            }
            ColourRule::Lab(ball) => (lab_contrast(picture, ball), MIDDLE),
            ColourRule::Pick { .. } => return Self::new(picture, &picked(picture, rule)?),
            ColourRule::Pen { offset } => (offset_contrast(picture, *offset, -1), MIDDLE),
            ColourRule::Lighter { offset } => (offset_contrast(picture, *offset, 1), MIDDLE),
            ColourRule::Tint => {
                let blurred = blurred(picture);
                let commonest = commonest_colour(&blurred);
                (shaded_contrast(&blurred, commonest), MIDDLE)
            }
            ColourRule::Relief => (flanks_contrast(picture), MIDDLE),
        };
        if !matches!(rule, ColourRule::Tint | ColourRule::Relief) {
            blur(&mut values, width, height);
        }
        let threshold = match rule {
            ColourRule::Background => otsu_threshold(&values, LEAST_CONTRAST),
            ColourRule::Tint => otsu_threshold(&values, LEAST_SHADED),
            ColourRule::Relief => relief_threshold(&values),
            _ => threshold,
        };
        Ok(Self {
            width,
            height,
            values,
            threshold,
        })
    }

    /// Uses a given mask; all nonzero pixels, white or labels, belong to rods.
    pub fn of_mask(mask: &GrayImage) -> Self {
        Self {
            width: mask.width() as usize,
            height: mask.height() as usize,
            values: mask
                .as_raw()
                .iter()
                .map(|value| 255 * u8::from(*value > 0))
                .collect(),
            threshold: MIDDLE,
        }
    }

    /// Value between pixels, by bilinear interpolation; outside of the picture, 0.
    ///
    /// Pixel (0, 0) has its centre at u = v = 0.
    pub fn at(&self, u: f64, v: f64) -> f64 {
        let inside =
            u >= 0.0 && v >= 0.0 && u + 1.0 <= self.width as f64 && v + 1.0 <= self.height as f64;
        if !inside {
            return 0.0;
        }
        let (column, row) = (
            (u as usize).min(self.width.saturating_sub(2)),
            (v as usize).min(self.height.saturating_sub(2)),
        );
        let (right, below) = (
            usize::from(self.width > 1),
            if self.height > 1 { self.width } else { 0 },
        );
        let (du, dv) = (u - column as f64, v - row as f64);
        let first = row * self.width + column;
        let value = |index: usize| f64::from(self.values[index]);
        (value(first) * (1.0 - du) + value(first + right) * du) * (1.0 - dv)
            + (value(first + below) * (1.0 - du) + value(first + below + right) * du) * dv
    }
}

/// A rule whose colour does not depend on the picture any more: the colour of a pixel becomes a
/// ball; other rules are unchanged.
///
/// # Errors
/// The pixel to pick is outside the picture.
pub(super) fn picked(picture: &RgbImage, rule: &ColourRule) -> Result<ColourRule, VisionError> {
    let ColourRule::Pick { u, v, radius } = rule else {
        return Ok(rule.clone());
    };
    let (width, height) = picture.dimensions();
    let centre = sample(picture, *u, *v).ok_or_else(|| VisionError::Colour {
        text: format!("pick:{u},{v}"),
        reason: format!("the image has {width} × {height} pixels, counted from 0"),
    })?;
    Ok(ColourRule::Lab(LabBall {
        centre,
        radius: *radius,
    }))
}

/// The union of several contrasts, with a common threshold.
pub(super) fn union(contrasts: &[Contrast]) -> Option<Contrast> {
    let (first, rest) = contrasts.split_first()?;
    let mut whole = Contrast {
        values: levelled(first),
        threshold: MIDDLE,
        ..*first
    };
    for other in rest {
        for (value, other) in whole.values.iter_mut().zip(levelled(other)) {
            *value = (*value).max(other);
        }
    }
    Some(whole)
}

/// The values of a contrast, scaled so that its threshold is [`MIDDLE`].
fn levelled(contrast: &Contrast) -> Vec<u8> {
    let factor = f64::from(MIDDLE) / f64::from(contrast.threshold.max(1));
    let scaled = |value: usize| (value as f64 * factor).round().min(255.0) as u8;
    let table: Vec<u8> = (0..256).map(scaled).collect();
    contrast
        .values
        .iter()
        .map(|value| table[usize::from(*value)])
        .collect()
}

fn blurred(picture: &RgbImage) -> RgbImage {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let mut blurred = picture.clone();
    for channel in 0..3 {
        let mut values: Vec<u8> = picture.pixels().map(|pixel| pixel.0[channel]).collect();
        blur(&mut values, width, height);
        for (pixel, value) in blurred.pixels_mut().zip(values) {
            pixel.0[channel] = value;
        }
    }
    blurred
}

fn histogram(values: &[u8]) -> [u64; 256] {
    let mut histogram = [0; 256];
    for value in values {
        histogram[usize::from(*value)] += 1;
    }
    histogram
}

/// Three times the contrast that three quarters of the pixels do not exceed.
fn relief_threshold(values: &[u8]) -> u8 {
    let histogram = histogram(values);
    let mut below = 0;
    let usual = histogram.iter().position(|count| {
        below += count;
        4 * below >= 3 * values.len() as u64
    });
    (3 * usual.unwrap_or(0) as u64).clamp(LEAST_RELIEF, 255) as u8
}

/// Half-way between the background and dim parts of the rods; 255 if the rods differ from the
/// background by less than `least`.
fn otsu_threshold(values: &[u8], least: f64) -> u8 {
    let histogram = histogram(values);
    let (threshold, [dark, bright]) = otsu(&histogram);
    if bright - dark < least {
        // No colour differs enough from the background.
        return u8::MAX;
    }
    // The edge of a rod is half-way between the background and this rod. Lower the threshold so
    // that the edge of a dim rod is found, too.
    let above = usize::from(threshold);
    let count: u64 = histogram[above..].iter().sum();
    let (mut dim, mut below) = (above, histogram[above]);
    while 4 * below < count {
        dim += 1;
        below += histogram[dim];
    }
    ((dark + dim as f64) / 2.0).ceil().max(1.0) as u8
}

/// Returns the threshold that divides a histogram into two classes with the largest variance
/// between them, and the means of the classes. Values at the threshold belong to the upper class
/// (Otsu, IEEE Trans. SMC 9:62, 1979).
pub fn otsu(histogram: &[u64; 256]) -> (u8, [f64; 2]) {
    let total: u64 = histogram.iter().sum();
    let weighted = |(value, count): (usize, &u64)| value as f64 * *count as f64;
    let sum: f64 = histogram.iter().enumerate().map(weighted).sum();
    let mean = sum / (total.max(1) as f64);
    let (mut best_between, mut means) = (0.0, [mean, mean]);
    let (mut below, mut sum_below) = (0, 0.0);
    for value in 0..255 {
        below += histogram[value];
        sum_below += value as f64 * histogram[value] as f64;
        let above = total - below;
        if below == 0 || above == 0 {
            continue;
        }
        let (dark, bright) = (sum_below / below as f64, (sum - sum_below) / above as f64);
        let between = below as f64 * above as f64 * (bright - dark) * (bright - dark);
        if between > best_between {
            best_between = between;
            means = [dark, bright];
        }
    }
    // At the largest variance the threshold lies half-way between the means.
    let threshold = (means[0] + means[1]) / 2.0;
    (threshold.ceil().clamp(1.0, 255.0) as u8, means)
}

fn map(picture: &RgbImage, mut value: impl FnMut([u8; 3]) -> u8) -> Vec<u8> {
    picture.pixels().map(|pixel| value(pixel.0)).collect()
}

/// Difference from the most common colour, in the channel where it is largest.
fn background_contrast(picture: &RgbImage) -> (Vec<u8>, u8) {
    let [red, green, blue] = commonest_colour(picture);
    let value = |rgb: [u8; 3]| {
        let difference = rgb[0].abs_diff(red).max(rgb[1].abs_diff(green));
        difference.max(rgb[2].abs_diff(blue))
    };
    (map(picture, value), u8::MAX)
}

/// Mean of the colours in the fullest cell of a histogram with 16 levels per channel, over every fourth pixel.
fn commonest_colour(picture: &RgbImage) -> [u8; 3] {
    let mut cells = vec![[0u32; 4]; 1 << 12];
    let stride = if picture.width() * picture.height() > 4096 {
        4
    } else {
        1
    };
    for pixel in picture.pixels().step_by(stride) {
        let [red, green, blue] = pixel.0.map(|channel| usize::from(channel >> 4));
        let cell = &mut cells[red << 8 | green << 4 | blue];
        cell[0] += 1;
        for (sum, channel) in cell[1..].iter_mut().zip(pixel.0) {
            *sum += u32::from(channel);
        }
    }
    let [count, red, green, blue] = cells
        .into_iter()
        .max_by_key(|cell| cell[0])
        .unwrap_or([0; 4]);
    [red, green, blue].map(|sum| (sum / count.max(1)) as u8)
}

/// Contrast that is 255 at the centre of a ball, [`MIDDLE`] at its surface, and less outside.
fn lab_contrast(picture: &RgbImage, ball: &LabBall) -> Vec<u8> {
    // Neighbouring pixels often have the same colour, and conversion is expensive.
    let mut last = ([0; 3], ball_value(ball, [0; 3]));
    map(picture, |rgb| {
        if rgb != last.0 {
            last = (rgb, ball_value(ball, rgb));
        }
        last.1
    })
}

fn ball_value(ball: &LabBall, rgb: [u8; 3]) -> u8 {
    let distance = colour_difference(ball.centre, lab(rgb)) / ball.radius;
    (255.0 - 127.0 * distance).max(0.0) as u8
}

/// Mean L\*a\*b\* of the 3 × 3 pixels around a pixel.
fn sample(picture: &RgbImage, u: u32, v: u32) -> Option<[f64; 3]> {
    if u >= picture.width() || v >= picture.height() {
        return None;
    }
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for pixel in around(picture, u as usize, v as usize) {
        for (sum, value) in sum.iter_mut().zip(lab(pixel)) {
            *sum += value;
        }
        count += 1.0;
    }
    Some(sum.map(|sum| sum / count))
}

/// Difference in brightness of a pixel from the mean of its surroundings, lighter for `sign` 1 and
/// darker for −1, scaled so that `offset` gives [`MIDDLE`].
fn offset_contrast(picture: &RgbImage, offset: u8, sign: i32) -> Vec<u8> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let grey = brightness(picture);
    let means = local_means(&grey, width, height, reach(picture));
    grey.iter()
        .zip(means)
        .map(|(grey, mean)| {
            let more = sign * (i32::from(*grey) - i32::from(mean)) - i32::from(offset);
            (i32::from(MIDDLE) + more).clamp(0, 255) as u8
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn otsu_separates_two_peaks() {
        let mut histogram = [0; 256];
        histogram[10] = 900;
        histogram[12] = 900;
        histogram[150] = 50;
        histogram[160] = 50;
        let (threshold, [dark, bright]) = otsu(&histogram);
        assert!((13..=150).contains(&threshold), "{threshold}");
        assert_eq!((dark, bright), (11.0, 155.0));
    }

    #[test]
    fn interpolation_is_exact_on_planes_and_zero_outside() {
        let contrast = Contrast {
            width: 4,
            height: 3,
            values: (0..12)
                .map(|i| (10 * (i % 4) + 20 * (i / 4)) as u8)
                .collect(),
            threshold: 1,
        };
        assert!((contrast.at(1.25, 0.5) - 22.5).abs() < 1e-12);
        assert!((contrast.at(3.0, 2.0) - 70.0).abs() < 1e-12);
        assert_eq!(contrast.at(3.1, 1.0), 0.0);
        assert_eq!(contrast.at(f64::NAN, 1.0), 0.0);
    }

    #[test]
    fn a_picture_of_one_colour_has_no_mask() {
        let picture = RgbImage::from_fn(40, 30, |u, v| {
            Rgb([100 + ((u * 7 + v * 13) % 9) as u8, 90, 80])
        });
        let contrast = Contrast::new(&picture, &ColourRule::Background).expect("a contrast");
        let threshold = contrast.threshold;
        assert!(contrast.values.iter().all(|value| *value < threshold));
    }
}
