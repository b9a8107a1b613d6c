//! Agreement of two label images.

use super::VisionError;
use image::GrayImage;

/// Agreement of a label image with the true one.
#[derive(Clone, Debug, PartialEq)]
pub struct InstanceDice {
    /// Mean Dice coefficient 2 |A ∩ B|/(|A| + |B|) over the strands. Strands are matched one to
    /// one so that the sum is largest. A missing or spurious strand has the coefficient 0.
    pub mean: f64,
    /// For each true label, in order: the label, the label matched with it, and their coefficient.
    pub pairs: Vec<(u8, Option<u8>, f64)>,
    /// Number of labels in the compared image.
    pub found: usize,
    /// Number of true labels.
    pub expected: usize,
}

/// Compares a label image with the true one.
///
/// # Errors
/// The sizes differ, or one has more than 16 labels.
pub fn instance_dice(found: &GrayImage, truth: &GrayImage) -> Result<InstanceDice, VisionError> {
    if found.dimensions() != truth.dimensions() {
        return Err(VisionError::Size {
            what: "the label image".into(),
            found_width: found.width() as usize,
            found_height: found.height() as usize,
            width: truth.width() as usize,
            height: truth.height() as usize,
        });
    }
    let mut overlap = vec![[0u64; 256]; 256];
    for (a, b) in found.as_raw().iter().zip(truth.as_raw()) {
        overlap[usize::from(*b)][usize::from(*a)] += 1;
    }
    let area_of_truth = |label: usize| overlap[label].iter().sum::<u64>();
    let area_of_found = |label: usize| overlap.iter().map(|row| row[label]).sum::<u64>();
    let labels = |area: &dyn Fn(usize) -> u64| -> Vec<usize> {
        (1..256).filter(|label| area(*label) > 0).collect()
    };
    let (true_labels, found_labels) = (labels(&area_of_truth), labels(&area_of_found));
    const MOST: usize = 16;
    if true_labels.len().max(found_labels.len()) > MOST {
        return Err(VisionError::Undetermined {
            problem: "the matching of labels",
            reason: format!("an image has more than {MOST} labels"),
        });
    }
    let coefficient = |row: usize, column: usize| {
        let (b, a) = (true_labels[row], found_labels[column]);
        2.0 * overlap[b][a] as f64 / (area_of_truth(b) + area_of_found(a)) as f64
    };
    let scores: Vec<Vec<f64>> = (0..true_labels.len())
        .map(|row| {
            (0..found_labels.len())
                .map(|column| coefficient(row, column))
                .collect()
        })
        .collect();
    let matching = best_matching(&scores, found_labels.len());
    let pairs: Vec<(u8, Option<u8>, f64)> = matching
        .iter()
        .enumerate()
        .map(|(row, column)| {
            let label = true_labels[row] as u8;
            column.map_or((label, None, 0.0), |column| {
                (label, Some(found_labels[column] as u8), scores[row][column])
            })
        })
        .collect();
    let instances = true_labels.len().max(found_labels.len());
    let sum: f64 = pairs.iter().map(|pair| pair.2).sum();
    Ok(InstanceDice {
        mean: if instances == 0 {
            1.0
        } else {
            sum / instances as f64
        },
        pairs,
        found: found_labels.len(),
        expected: true_labels.len(),
    })
}

/// Assigns a column to each row so that the sum of scores is largest and no column is used twice,
/// by dynamic programming over sets of columns.
fn best_matching(scores: &[Vec<f64>], columns: usize) -> Vec<Option<usize>> {
    let sets = 1usize << columns;
    // best[row][set]: the largest sum of the rows from `row` on if the columns in `set` are
    // already used.
    let mut best = vec![vec![0.0f64; sets]; scores.len() + 1];
    for row in (0..scores.len()).rev() {
        for set in 0..sets {
            let mut most = best[row + 1][set];
            for column in (0..columns).filter(|column| set >> column & 1 == 0) {
                most = most.max(scores[row][column] + best[row + 1][set | 1 << column]);
            }
            best[row][set] = most;
        }
    }
    let mut set = 0;
    (0..scores.len())
        .map(|row| {
            let chosen = (0..columns).find(|column| {
                set >> column & 1 == 0
                    && scores[row][*column] > 0.0
                    && scores[row][*column] + best[row + 1][set | 1 << column] >= best[row][set]
            })?;
            set |= 1 << chosen;
            Some(chosen)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Luma;

    fn stripes(columns: &[(u32, u8)]) -> GrayImage {
        let mut image = GrayImage::new(20, 10);
        for (column, label) in columns {
            for row in 0..10 {
                image.put_pixel(*column, row, Luma([*label]));
            }
        }
        image
    }

    #[test]
    fn names_of_labels_do_not_matter() {
        let truth = stripes(&[(1, 1), (2, 1), (5, 2), (9, 3)]);
        let found = stripes(&[(1, 7), (2, 7), (5, 9), (9, 4)]);
        let dice = instance_dice(&found, &truth).expect("a score");
        assert_eq!(dice.mean, 1.0);
        assert_eq!(dice.pairs[1], (2, Some(9), 1.0));
    }

    #[test]
    fn a_label_is_used_once_and_strays_count_nothing() {
        let truth = stripes(&[(1, 1), (2, 1), (5, 2), (6, 2)]);
        // Both strands have one label: 2·2/(2 + 4) for one strand, 0 for the other.
        let merged = stripes(&[(1, 1), (2, 1), (5, 1), (6, 1)]);
        let dice = instance_dice(&merged, &truth).expect("a score");
        assert!((dice.mean - (2.0 / 3.0) / 2.0).abs() < 1e-12, "{dice:?}");
        // A third label without a true counterpart.
        let stray = stripes(&[(1, 1), (2, 1), (5, 2), (6, 2), (15, 3)]);
        let dice = instance_dice(&stray, &truth).expect("a score");
        assert!((dice.mean - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!((dice.found, dice.expected), (3, 2));
    }

    #[test]
    fn the_matching_is_the_best_of_all() {
        // A greedy choice of 0.9 leaves only 0 for the second row.
        let scores = vec![vec![0.9, 0.8], vec![0.85, 0.0]];
        assert_eq!(best_matching(&scores, 2), [Some(1), Some(0)]);
    }

    #[test]
    fn sizes_must_agree() {
        let error = instance_dice(&GrayImage::new(3, 4), &GrayImage::new(4, 3))
            .expect_err("sizes differ")
            .to_string();
        assert!(error.contains("3 × 4"), "{error}");
    }
}
