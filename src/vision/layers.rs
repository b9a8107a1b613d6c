//! Layers: a mask divided by the hues of its strands.
//!
//! Strands side by side are one connected part of the mask. If their hues differ, each hue has its
//! own mask, in which the strands are separate. A strand below others then has gaps, which are
//! closed later.

use super::colour::lab;
use super::mask::{Mask, chamfer_distances};
use super::pixels::around;
use image::RgbImage;

/// Bins of the histogram of hues, 5° each.
const BINS: usize = 72;
/// Smallest chroma √(a*² + b*²) of a pixel with a meaningful hue.
const LEAST_CHROMA: f64 = 10.0;
/// Fraction of the mask that must have a meaningful hue.
const COLOURED_PART: f64 = 0.6;
/// Smallest difference of the hues of two strands, in bins: 25°.
const LEAST_APART: usize = 5;
/// Smallest fraction of the mask with one hue.
const LEAST_PART: f64 = 0.04;
/// Maximum number of hues.
const MOST_LAYERS: usize = 6;
/// Thickness of a part of a layer relative to the usual half width, below which the part is a
/// border with mixed colours.
const THINNEST: f64 = 0.45;

/// The masks of the hues of a picture; empty unless there are several distinct ones.
pub(super) fn layers(
    picture: &RgbImage,
    mask: &Mask,
    least_area: usize,
    largest_hole: usize,
) -> Option<Vec<Mask>> {
    let members = mask.members();
    let hues: Vec<Option<f64>> = members
        .iter()
        .map(|index| {
            let (column, row) = mask.position(*index);
            hue_at(picture, column, row)
        })
        .collect();
    let peaks = peaks(&hues)?;
    let mut labels = vec![0u8; mask.cells().len()];
    for (index, hue) in members.iter().zip(&hues) {
        labels[*index] = hue.map_or(0, |hue| nearest(&peaks, hue) as u8 + 1);
    }
    // If several labels meet, the highest one is used.
    let highest = |near: [u8; 4]| near.into_iter().max().filter(|label| *label > 0);
    mask.spread(&mut labels, highest);
    remove_borders(mask, &members, &mut labels, peaks.len());
    mask.spread(&mut labels, highest);
    let masks = (1..=peaks.len()).map(|label| {
        let mut layer = layer(mask, &members, &labels, label as u8);
        layer.clean(least_area, largest_hole);
        layer
    });
    let masks: Vec<Mask> = masks.filter(|layer| layer.area() > 0).collect();
    (masks.len() > 1).then_some(masks)
}

/// Hue of a pixel in bins, from the mean colour of 3 × 3 pixels; `None` if it is grey.
pub(super) fn hue_at(picture: &RgbImage, column: usize, row: usize) -> Option<f64> {
    hue(mean_colour(picture, column, row))
}

/// Mean colour of 3 × 3 pixels, which reduces noise.
fn mean_colour(picture: &RgbImage, column: usize, row: usize) -> [u8; 3] {
    let (mut sum, mut count) = ([0u32; 3], 0);
    for pixel in around(picture, column, row) {
        for (sum, value) in sum.iter_mut().zip(pixel) {
            *sum += u32::from(value);
        }
        count += 1;
    }
    sum.map(|sum| (sum / count) as u8)
}

/// Hue angle in bins, from 0 to [`BINS`].
fn hue(rgb: [u8; 3]) -> Option<f64> {
    let [_, a, b] = lab(rgb);
    let turn = libm::atan2(b, a) / std::f64::consts::TAU;
    (libm::hypot(a, b) >= LEAST_CHROMA).then(|| turn.rem_euclid(1.0) * BINS as f64)
}

/// Difference of two hues, in bins.
pub(super) fn hue_apart(a: f64, b: f64) -> f64 {
    let away = (a - b).abs();
    away.min(BINS as f64 - away)
}

fn nearest(peaks: &[f64], hue: f64) -> usize {
    (0..peaks.len())
        .min_by(|a, b| hue_apart(peaks[*a], hue).total_cmp(&hue_apart(peaks[*b], hue)))
        .unwrap_or(0)
}

/// The frequent hues, if there are at least two.
fn peaks(hues: &[Option<f64>]) -> Option<Vec<f64>> {
    let mut histogram = [0.0f64; BINS];
    for hue in hues.iter().flatten() {
        histogram[(*hue as usize).min(BINS - 1)] += 1.0;
    }
    let total: f64 = histogram.iter().sum();
    if total < COLOURED_PART * hues.len() as f64 {
        return None;
    }
    let at = |bin: usize| histogram[bin % BINS];
    // Number of pixels within 12.5° of the middle of a bin.
    let mass = |bin: usize| {
        (0..LEAST_APART)
            .map(|k| at(bin + BINS + k - LEAST_APART / 2))
            .sum::<f64>()
    };
    let mut order: Vec<usize> = (0..BINS).collect();
    order.sort_by(|a, b| mass(*b).total_cmp(&mass(*a)).then(a.cmp(b)));
    let mut peaks: Vec<f64> = Vec::new();
    for bin in order {
        let middle = bin as f64 + 0.5;
        let is_highest = mass(bin) >= mass(bin + 1) && mass(bin) >= mass(bin + BINS - 1);
        let is_free = peaks
            .iter()
            .all(|peak| hue_apart(*peak, middle) >= LEAST_APART as f64);
        if is_highest && is_free && mass(bin) >= LEAST_PART * total && peaks.len() < MOST_LAYERS {
            peaks.push(middle);
        }
    }
    (peaks.len() > 1).then_some(peaks)
}

/// Removes the label from parts that are too thin for a strand, since hues mix between two strands
/// and may resemble that of a third one.
fn remove_borders(mask: &Mask, members: &[usize], labels: &mut [u8], count: usize) {
    let whole = chamfer_distances(mask, members);
    let mut widths: Vec<u16> = members.iter().map(|cell| whole[*cell]).collect();
    widths.sort_unstable();
    // Nine of ten pixels of a stripe are nearer to its edge than nine tenths of its half width.
    let Some(usual) = widths.get(widths.len() * 9 / 10) else {
        return;
    };
    let least = (THINNEST * f64::from(*usual)) as u16;
    for label in 1..=count as u8 {
        let layer = layer(mask, members, labels, label);
        let inside = layer.members();
        let distances = chamfer_distances(&layer, &inside);
        for part in layer.parts() {
            let cells = || part.iter().map(|(column, row)| mask.index(*column, *row));
            let thickest = cells().map(|cell| distances[cell]).max().unwrap_or(0);
            if thickest < least {
                for cell in cells() {
                    labels[cell] = 0;
                }
            }
        }
        // An opening also removes thin seams with their own hue along a strand.
        open(&layer, &inside, &distances, least, labels);
    }
}

/// Removes the label from pixels that are not within reach of an inner pixel, in octagons.
fn open(layer: &Mask, inside: &[usize], distances: &[u16], least: u16, labels: &mut [u8]) {
    let stride = layer.stride();
    let mut kept = vec![false; labels.len()];
    let mut front = Vec::new();
    for cell in inside {
        if distances[*cell] >= least {
            kept[*cell] = true;
            front.push(*cell);
        }
    }
    for round in 0..usize::from(least).div_ceil(5) + 1 {
        let used = if round % 2 == 0 { 4 } else { 8 };
        let mut reached = Vec::new();
        for cell in &front {
            let straight = [cell - 1, cell + 1, cell - stride, cell + stride];
            let diagonal = [
                cell - stride - 1,
                cell - stride + 1,
                cell + stride - 1,
                cell + stride + 1,
            ];
            for other in straight.into_iter().chain(diagonal).take(used) {
                if layer.cells()[other] == 1 && !kept[other] {
                    kept[other] = true;
                    reached.push(other);
                }
            }
        }
        front = reached;
    }
    for cell in inside {
        if !kept[*cell] {
            labels[*cell] = 0;
        }
    }
}

fn layer(mask: &Mask, members: &[usize], labels: &[u8], label: u8) -> Mask {
    let mut layer = Mask::new(mask.width(), mask.height());
    for cell in members {
        layer.cells_mut()[*cell] = u8::from(labels[*cell] == label);
    }
    layer
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::drawn;
    use super::*;
    use image::Rgb;

    /// Two stripes of 8 rows that touch, with a mixed seam between them.
    fn stripes(colours: [[u8; 3]; 3]) -> (RgbImage, Mask) {
        let picture = RgbImage::from_fn(80, 40, |_, v| {
            Rgb(match v {
                10..18 => colours[0],
                18..20 => colours[1],
                20..28 => colours[2],
                _ => [10, 10, 10],
            })
        });
        let mask = drawn(80, 40, |pixel| (10.0..28.0).contains(&pixel.y));
        (picture, mask)
    }

    #[test]
    fn strands_of_two_hues_are_separated_without_a_mixed_one() {
        // Half red and half green is yellow.
        let (picture, mask) = stripes([[205, 70, 60], [150, 130, 60], [60, 170, 90]]);
        let masks = layers(&picture, &mask, 20, 5).expect("two layers");
        assert_eq!(masks.len(), 2);
        for row in [13, 24] {
            let of = masks.iter().filter(|layer| layer.contains(40, row));
            assert_eq!(of.count(), 1);
        }
        let area: usize = masks.iter().map(Mask::area).sum();
        assert_eq!(area, mask.area());
    }

    #[test]
    fn shades_of_one_hue_and_grey_are_one_layer() {
        for colours in [
            [[205, 70, 60], [160, 55, 47], [110, 38, 32]],
            [[90; 3], [140; 3], [200; 3]],
        ] {
            let (picture, mask) = stripes(colours);
            assert!(layers(&picture, &mask, 20, 5).is_none());
        }
    }
}
