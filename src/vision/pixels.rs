//! Pixels around a place in an image.

use image::RgbImage;
use std::ops::Range;

/// Indices of pixels between two coordinates in a row or column of `size` pixels.
pub(super) fn between(low: f64, high: f64, size: usize) -> Range<usize> {
    let bounded = |end: f64| end.clamp(0.0, size as f64) as usize;
    bounded(low.ceil())..bounded((high + 1.0).floor())
}

/// The 3 × 3 pixels around a pixel, cut off at the border.
pub(super) fn around(
    picture: &RgbImage,
    column: usize,
    row: usize,
) -> impl Iterator<Item = [u8; 3]> {
    let near =
        |middle: usize, size: u32| middle.saturating_sub(1) as u32..(middle as u32 + 2).min(size);
    let (columns, rows) = (near(column, picture.width()), near(row, picture.height()));
    rows.flat_map(move |v| columns.clone().map(move |u| picture.get_pixel(u, v).0))
}
