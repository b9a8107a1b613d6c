//! Difference of a pixel from its surroundings, lighter or darker.

use super::averages::blur;
use image::RgbImage;

/// Half side of the closing, pixels: the darker and the lighter flank of a rod that has the colour
/// of the table become one part.
const CLOSING: usize = 4;

/// Distance between the pixels of which medians are taken.
const STRIDE: usize = 4;

/// Brightness of each pixel.
pub(super) fn brightness(picture: &RgbImage) -> Vec<u8> {
    picture.pixels().map(|pixel| grey(pixel.0)).collect()
}

/// Brightness of a colour.
pub(super) fn grey([red, green, blue]: [u8; 3]) -> u8 {
    ((77 * u32::from(red) + 150 * u32::from(green) + 29 * u32::from(blue)) >> 8) as u8
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
    let mesh = (reach(picture) / 2).next_power_of_two();
    let table = table_around(&grey, width, height, mesh);
    let mut values: Vec<u8> = grey
        .iter()
        .zip(table)
        .map(|(grey, table)| grey.abs_diff(table))
        .collect();
    extreme(&mut values, width, height, u8::max);
    extreme(&mut values, width, height, u8::min);
    values
}

/// Brightness of the table around every pixel, whatever lies on it: the medians around the nodes of
/// a grid of the given mesh, a power of two, interpolated. Means would be darker beside a dark rod.
fn table_around(grey: &[u8], width: usize, height: usize, mesh: usize) -> Vec<u8> {
    let [columns, rows] = [width, height].map(|size| size.div_ceil(mesh) + 1);
    let medians: Vec<i32> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column * mesh, row * mesh)))
        .map(|(u, v)| i32::from(median_around(grey, [width, height], [u, v], mesh)))
        .collect();
    let mut table = Vec::with_capacity((width + mesh) * height);
    // The mesh is a power of two, so that shifts divide.
    let (scale, shift) = (mesh as i32, 2 * mesh.trailing_zeros());
    let mut line = vec![0; columns];
    for v in 0..height {
        let (row, below) = (v / mesh, (v % mesh) as i32);
        for (column, value) in line.iter_mut().enumerate() {
            let node = |row: usize| medians[row * columns + column];
            *value = node(row) * (scale - below) + node(row + 1) * below;
        }
        for pair in line.windows(2) {
            let step = pair[1] - pair[0];
            table.extend((0..scale).map(|right| ((pair[0] * scale + step * right) >> shift) as u8));
        }
        table.truncate((v + 1) * width);
    }
    table
}

/// Median of every fourth pixel, in each direction, of the square with half side `reach` around a
/// place.
fn median_around(grey: &[u8], [width, height]: [usize; 2], [u, v]: [usize; 2], reach: usize) -> u8 {
    let range = |centre: usize, size: usize| {
        let last = (centre + reach).min(size);
        (centre.saturating_sub(reach).min(size - 1)..last).step_by(STRIDE)
    };
    let mut values: Vec<u8> = range(v, height)
        .flat_map(|row| range(u, width).map(move |column| grey[row * width + column]))
        .collect();
    let middle = values.len() / 2;
    match values.is_empty() {
        true => 0,
        false => *values.select_nth_unstable(middle).1,
    }
}

/// Largest or smallest value in the square with half side [`CLOSING`] around each pixel.
fn extreme(values: &mut Vec<u8>, width: usize, height: usize, of: impl Fn(u8, u8) -> u8 + Copy) {
    if width == 0 || height == 0 {
        return;
    }
    let mut line = Vec::new();
    for row in values.chunks_exact_mut(width) {
        // Beyond the border, the values on it are repeated.
        line.clear();
        line.resize(CLOSING, row[0]);
        line.extend_from_slice(row);
        line.resize(width + 2 * CLOSING, row[width - 1]);
        running(&mut line, 1, of);
        row.copy_from_slice(&line[..width]);
    }
    let mut whole = Vec::with_capacity((height + 2 * CLOSING) * width);
    for _ in 0..CLOSING {
        whole.extend_from_slice(&values[..width]);
    }
    whole.extend_from_slice(values);
    for _ in 0..CLOSING {
        whole.extend_from_slice(&values[(height - 1) * width..]);
    }
    running(&mut whole, width, of);
    whole.truncate(width * height);
    *values = whole;
}

/// Replaces each value by the extreme of it and the 2 [`CLOSING`] values that follow at distances of
/// `step`, as far as there are any.
fn running(values: &mut [u8], step: usize, of: impl Fn(u8, u8) -> u8) {
    const WINDOW: usize = 2 * CLOSING + 1;
    let mut done = 1;
    while done < WINDOW {
        let shift = done.min(WINDOW - done);
        let count = values.len().saturating_sub(shift * step);
        for index in 0..count {
            values[index] = of(values[index], values[index + shift * step]);
        }
        done += shift;
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
