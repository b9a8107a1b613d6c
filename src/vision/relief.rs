//! Relief: lines that differ from the table only by their light and dark flanks, such as white rods
//! on white.

use super::averages::local_means;
use super::contrast::Contrast;
use super::mask::Mask;
use super::surroundings::grey;
use image::RgbImage;

/// Distance between the pixels used to look for relief.
const STRIDE: usize = 4;
/// Half side of the surroundings in which thin lines differ from the mean, and halos do not, in
/// steps of [`STRIDE`].
const THIN: usize = 3;
/// Least difference in brightness that is not noise, out of 255.
const LEAST_DIFFERENCE: u32 = 20;
/// Inverse of the least difference of a flank from the table, relative to the table.
const SHADED: u32 = 10;
/// Least contrast of the clearest pixel of a line, in thresholds.
const CLEAREST: usize = 2;

/// Part of a picture, per cent, in which the brightness changes over a short distance outside of a
/// mask. One pixel of [`STRIDE`]² is used.
pub(super) fn unmasked_relief(picture: &RgbImage, mask: &Mask) -> f64 {
    let size = [picture.width(), picture.height()].map(|size| (size as usize).div_ceil(STRIDE));
    let [width, height] = size;
    let places = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
    let (mut greys, mut masked) = (Vec::new(), Vec::new());
    for [column, row] in places {
        let [u, v] = [column * STRIDE, row * STRIDE];
        greys.push(grey(picture.get_pixel(u as u32, v as u32).0));
        masked.push(255 * u8::from(mask.contains(u, v)));
    }
    // Only samples without a neighbour in the mask count, and only they have a part in the means.
    let near = local_means(&masked, width, height, 1);
    let free: Vec<u8> = near.iter().map(|near| 255 * u8::from(*near == 0)).collect();
    let values: Vec<u8> = greys
        .iter()
        .zip(&free)
        .map(|(grey, free)| grey & free)
        .collect();
    let sums = local_means(&values, width, height, THIN);
    let counts = local_means(&free, width, height, THIN);
    let differs = |index: usize| {
        let mean = 255 * u32::from(sums[index]) / u32::from(counts[index]).max(1);
        free[index] > 0
            && u32::from(greys[index]).abs_diff(mean) > LEAST_DIFFERENCE.max(mean / SHADED)
    };
    let found = (0..greys.len()).filter(|index| differs(*index)).count();
    100.0 * found as f64 / greys.len().max(1) as f64
}

/// Removes the parts of the mask of a contrast that nowhere exceed its threshold clearly: stains and
/// uneven light, while the flanks of a rod are clear somewhere.
pub(super) fn without_weak_parts(contrast: &mut Contrast) {
    let clear = (CLEAREST * usize::from(contrast.threshold)).min(255);
    for part in Mask::of_contrast(contrast).parts() {
        let cells = || part.iter().map(|(u, v)| v * contrast.width + u);
        if cells().all(|cell| usize::from(contrast.values[cell]) < clear) {
            let cells: Vec<usize> = cells().collect();
            for cell in cells {
                contrast.values[cell] = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn thin_lines_outside_of_the_mask_count_and_soft_shadows_do_not() {
        // A line of three rows, and a shadow that grows over 40 rows.
        let picture = RgbImage::from_fn(200, 160, |_, v| {
            let shadow = (40 - v.abs_diff(110).min(40)) as u8;
            Rgb([if (40..43).contains(&v) {
                150
            } else {
                220 - 2 * shadow
            }; 3])
        });
        let mut mask = Mask::new(200, 160);
        let open = unmasked_relief(&picture, &mask);
        assert!((0.5..6.0).contains(&open), "{open}");
        for (u, v) in (40..43).flat_map(|v| (0..200).map(move |u| (u, v))) {
            mask.set(u, v, true);
        }
        assert_eq!(unmasked_relief(&picture, &mask), 0.0);
    }

    #[test]
    fn weak_parts_are_removed_whole_and_clear_ones_are_kept_whole() {
        let mut values = vec![0; 60 * 20];
        // Both parts are weak except for one pixel of the second one.
        values[5 * 60 + 5..5 * 60 + 25].fill(14);
        values[12 * 60 + 5..12 * 60 + 25].fill(14);
        values[12 * 60 + 9] = 20;
        let mut contrast = Contrast {
            width: 60,
            height: 20,
            values,
            threshold: 10,
        };
        without_weak_parts(&mut contrast);
        assert_eq!(Mask::of_contrast(&contrast).area(), 20);
        assert!(contrast.values[12 * 60 + 24] == 14 && contrast.values[5 * 60 + 9] == 0);
    }
}
