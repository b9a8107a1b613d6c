//! Difference of a pixel from its surroundings, lighter or darker.

use super::averages::{blur, local_means};
use image::RgbImage;

/// Half side of the closing, pixels: the darker and the lighter flank of a rod that has the colour
/// of the table become one part.
const CLOSING: usize = 4;

/// Brightness of each pixel.
pub(super) fn brightness(picture: &RgbImage) -> Vec<u8> {
    let grey = |[red, green, blue]: [u8; 3]| {
        (77 * u32::from(red) + 150 * u32::from(green) + 29 * u32::from(blue)) >> 8
    };
    picture.pixels().map(|pixel| grey(pixel.0) as u8).collect()
}

/// Half side of the surroundings: wider than any stroke, narrower than shadows.
pub(super) fn reach(picture: &RgbImage) -> usize {
    (picture.width().max(picture.height()) as usize / 16).max(8)
}

/// Difference in brightness from the surroundings in both directions, after a closing that fills
/// the middle between two flanks.
pub(super) fn flanks_contrast(picture: &RgbImage) -> Vec<u8> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let mut grey = brightness(picture);
    blur(&mut grey, width, height);
    let means = local_means(&grey, width, height, reach(picture));
    let mut values: Vec<u8> = grey
        .iter()
        .zip(means)
        .map(|(grey, mean)| grey.abs_diff(mean))
        .collect();
    extreme(&mut values, width, height, u8::max);
    extreme(&mut values, width, height, u8::min);
    values
}

/// Largest or smallest value in the square with half side [`CLOSING`] around each pixel.
fn extreme(values: &mut [u8], width: usize, height: usize, of: fn(u8, u8) -> u8) {
    let mut line = Vec::new();
    for row in values.chunks_exact_mut(width.max(1)) {
        line.clear();
        line.extend_from_slice(row);
        for shift in 1..=CLOSING.min(width - 1) {
            for (value, other) in row.iter_mut().zip(&line[shift..]) {
                *value = of(*value, *other);
            }
            for (value, other) in row[shift..].iter_mut().zip(&line) {
                *value = of(*value, *other);
            }
        }
    }
    let whole = values.to_vec();
    for shift in 1..=CLOSING.min(height - 1) {
        let offset = shift * width;
        for (value, other) in values.iter_mut().zip(&whole[offset..]) {
            *value = of(*value, *other);
        }
        for (value, other) in values[offset..].iter_mut().zip(&whole) {
            *value = of(*value, *other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn a_rod_between_two_flanks_is_one_part() {
        // A rod of the table's colour with a lighter and a darker flank.
        let picture = RgbImage::from_fn(120, 80, |_, v| match v {
            38 | 39 => Rgb([250; 3]),
            44 | 45 => Rgb([120; 3]),
            _ => Rgb([200; 3]),
        });
        let values = flanks_contrast(&picture);
        let column: Vec<u8> = (36..48).map(|v| values[v * 120 + 60]).collect();
        assert!(column[2..10].iter().all(|value| *value > 25), "{column:?}");
        assert!(values[20 * 120 + 60] < 10 && values[60 * 120 + 60] < 10);
    }

    #[test]
    fn a_closing_keeps_a_lone_line_as_it_is() {
        let (width, height) = (30, 20);
        let mut values = vec![0u8; width * height];
        values[10 * width..11 * width].fill(90);
        let before = values.clone();
        extreme(&mut values, width, height, u8::max);
        assert_eq!(
            values.iter().filter(|value| **value == 90).count(),
            9 * width
        );
        extreme(&mut values, width, height, u8::min);
        assert_eq!(values, before);
    }
}
