//! Means around the pixels of a grey image.

/// Mean over a square with half side `reach` around every pixel, cut off at the border.
pub(super) fn local_means(values: &[u8], width: usize, height: usize, reach: usize) -> Vec<u8> {
    let mut columns = vec![0u32; width];
    let mut means = vec![0; values.len()];
    let row = |index: usize| &values[index * width..(index + 1) * width];
    let mut rows = 0..0;
    for centre in 0..height {
        let wanted = centre.saturating_sub(reach)..(centre + reach + 1).min(height);
        for index in rows.end..wanted.end {
            for (sum, value) in columns.iter_mut().zip(row(index)) {
                *sum += u32::from(*value);
            }
        }
        for index in rows.start..wanted.start {
            for (sum, value) in columns.iter_mut().zip(row(index)) {
                *sum -= u32::from(*value);
            }
        }
        rows = wanted;
        let (mut sum, mut window) = (0u64, 0..0);
        for column in 0..width {
            let wanted = column.saturating_sub(reach)..(column + reach + 1).min(width);
            sum += (window.end..wanted.end)
                .map(|index| u64::from(columns[index]))
                .sum::<u64>();
            sum -= (window.start..wanted.start)
                .map(|index| u64::from(columns[index]))
                .sum::<u64>();
            window = wanted;
            let count = (window.len() * rows.len()) as u64;
            means[centre * width + column] = (sum / count) as u8;
        }
    }
    means
}

/// Binomial blur with weights 1, 2, 1 along rows and columns; pixels beyond the border repeat
/// those on it.
pub(super) fn blur(values: &mut [u8], width: usize, height: usize) {
    if width < 3 || height < 3 {
        return;
    }
    let mut sums = vec![0u16; 3 * width];
    let along_row = |row: &[u8], sums: &mut [u16]| {
        let value = |index: usize| u16::from(row[index]);
        sums[0] = 3 * value(0) + value(1);
        for ((sum, left), (middle, right)) in sums[1..]
            .iter_mut()
            .zip(row)
            .zip(row[1..].iter().zip(&row[2..]))
        {
            *sum = u16::from(*left) + 2 * u16::from(*middle) + u16::from(*right);
        }
        sums[width - 1] = value(width - 2) + 3 * value(width - 1);
    };
    // Three rows of sums, used cyclically: those of the row above, of the row itself, and of the
    // row below.
    let slot = |row: usize| (row % 3) * width..(row % 3 + 1) * width;
    along_row(&values[..width], &mut sums[slot(0)]);
    for row in 0..height {
        if row + 1 < height {
            let below = &values[(row + 1) * width..(row + 2) * width];
            along_row(below, &mut sums[slot(row + 1)]);
        }
        let above = &sums[slot(if row == 0 { 0 } else { row - 1 })];
        let middle = &sums[slot(row)];
        let below = &sums[slot(if row + 1 < height { row + 1 } else { row })];
        let out = &mut values[row * width..(row + 1) * width];
        for (((out, above), middle), below) in out.iter_mut().zip(above).zip(middle).zip(below) {
            *out = ((above + 2 * middle + below + 8) >> 4) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_keeps_the_mean_and_a_plateau() {
        let mut values = vec![0u8; 49];
        values[24] = 160;
        blur(&mut values, 7, 7);
        assert_eq!(values.iter().map(|v| u32::from(*v)).sum::<u32>(), 160);
        assert_eq!(values[24], 40);
        let mut flat = vec![77u8; 30];
        blur(&mut flat, 6, 5);
        assert!(flat.iter().all(|value| *value == 77));
    }

    #[test]
    fn local_means_agree_with_the_sum_over_the_window() {
        let (width, height, reach) = (9, 7, 2);
        let values: Vec<u8> = (0..width * height).map(|i| (i * 37 % 251) as u8).collect();
        let means = local_means(&values, width, height, reach);
        for row in 0..height {
            for column in 0..width {
                let mut window = Vec::new();
                for r in row.saturating_sub(reach)..(row + reach + 1).min(height) {
                    for c in column.saturating_sub(reach)..(column + reach + 1).min(width) {
                        window.push(u64::from(values[r * width + c]));
                    }
                }
                let mean = window.iter().sum::<u64>() / window.len() as u64;
                assert_eq!(u64::from(means[row * width + column]), mean);
            }
        }
    }
}
