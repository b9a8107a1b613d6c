//! Thinning: reduces a mask to lines one pixel wide with the same connectivity.
//!
//! Two sub-iterations in turn remove contour pixels of opposite sides (Guo and Hall, Comm. ACM
//! 32:359, 1989; their lines are thinner on diagonals than Zhang and Suen's). The removal of a
//! pixel depends on its eight neighbours only, so that the rule is a table of 256 entries, and
//! only pixels with changed neighbours are examined again.

use super::mask::Mask;

/// Bits of the neighbours, clockwise from the one above: N, NE, E, SE, S, SW, W, NW.
pub(super) fn neighbourhood(cells: &[u8], index: usize, stride: usize) -> u8 {
    cells[index - stride]
        | cells[index - stride + 1] << 1
        | cells[index + 1] << 2
        | cells[index + stride + 1] << 3
        | cells[index + stride] << 4
        | cells[index + stride - 1] << 5
        | cells[index - 1] << 6
        | cells[index - stride - 1] << 7
}

/// The eight neighbours of a cell, in the order of [`neighbourhood`].
pub(super) fn neighbours(index: usize, stride: usize) -> [usize; 8] {
    [
        index - stride,
        index - stride + 1,
        index + 1,
        index + stride + 1,
        index + stride,
        index + stride - 1,
        index - 1,
        index - stride - 1,
    ]
}

/// 1 where the `k`-th neighbour, counted cyclically, is in the mask, else 0.
const fn bit(bits: u8, k: u32) -> u32 {
    (bits >> (k % 8)) as u32 & 1
}

/// Number of 8-connected parts of the neighbours in the mask, without the pixel itself: Hilditch's
/// crossing number, counted from one straight neighbour to the next.
const fn parts(bits: u8) -> u32 {
    let (mut count, mut k) = (0, 0);
    while k < 8 {
        count += (1 - bit(bits, k)) & (bit(bits, k + 1) | bit(bits, k + 2));
        k += 2;
    }
    count
}

/// Number of pairs of neighbours, starting with neighbour `first`, of which at least one is in the
/// mask.
const fn pairs(bits: u8, first: u32) -> u32 {
    let (mut count, mut k) = (0, first);
    while k < first + 8 {
        count += bit(bits, k) | bit(bits, k + 1);
        k += 2;
    }
    count
}

/// Whether Guo and Hall's first (or second) sub-iteration removes a pixel.
const fn guo_hall_removes(bits: u8, second: bool) -> bool {
    let (one, other) = (pairs(bits, 0), pairs(bits, 7));
    let fewest = if one < other { one } else { other };
    let turn = if second { 4 } else { 0 };
    let (straight, diagonal) = (bit(bits, turn), bit(bits, turn + 1));
    let side = (straight | diagonal | (1 - bit(bits, turn + 3))) & bit(bits, turn + 2);
    parts(bits) == 1 && fewest >= 2 && fewest <= 3 && side == 0
}

const fn table(second: bool) -> [bool; 256] {
    let (mut table, mut bits) = ([false; 256], 0);
    while bits < 256 {
        table[bits] = guo_hall_removes(bits as u8, second);
        bits += 1;
    }
    table
}

/// Whether a pixel of a line is superfluous: its two or more neighbours stay connected without it.
const fn superfluous() -> [bool; 256] {
    let (mut table, mut bits) = ([false; 256], 0usize);
    while bits < 256 {
        table[bits] = parts(bits as u8) == 1 && (bits as u8).count_ones() >= 2;
        bits += 1;
    }
    table
}

const REMOVES: [[bool; 256]; 2] = [table(false), table(true)];
const SUPERFLUOUS: [bool; 256] = superfluous();

/// Thins a mask; returns its cells in order.
pub(super) fn thin(mask: &mut Mask, members: &[usize]) -> Vec<usize> {
    let stride = mask.stride();
    let cells = mask.cells_mut();
    let mut candidates: Vec<usize> = members
        .iter()
        .copied()
        .filter(|index| neighbourhood(cells, *index, stride) != u8::MAX)
        .collect();
    let mut queued = vec![false; cells.len()];
    let mut removed = Vec::new();
    let mut idle = 0;
    let mut half = 0;
    // The second sub-iteration may remove a pixel that the first keeps, so that candidates are
    // kept for two sub-iterations.
    let mut fresh = Vec::new();
    while idle < 2 {
        removed.clear();
        removed.extend(
            candidates
                .iter()
                .copied()
                .filter(|index| REMOVES[half][usize::from(neighbourhood(cells, *index, stride))]),
        );
        for index in &removed {
            cells[*index] = 0;
        }
        fresh.clear();
        for index in &removed {
            for other in neighbours(*index, stride) {
                if cells[other] == 1 && !queued[other] {
                    queued[other] = true;
                    fresh.push(other);
                }
            }
        }
        candidates.retain(|index| cells[*index] == 1 && !queued[*index]);
        candidates.extend(&fresh);
        for index in &fresh {
            queued[*index] = false;
        }
        idle = if removed.is_empty() { idle + 1 } else { 0 };
        half = 1 - half;
    }
    let mut line: Vec<usize> = members
        .iter()
        .copied()
        .filter(|index| cells[*index] == 1)
        .collect();
    straighten(mask, &mut line);
    line
}

/// Removes superfluous pixels of lines one by one, such as those inside of corners.
pub(super) fn straighten(mask: &mut Mask, line: &mut Vec<usize>) {
    let stride = mask.stride();
    let cells = mask.cells_mut();
    line.retain(|index| {
        let goes = SUPERFLUOUS[usize::from(neighbourhood(cells, *index, stride))];
        if goes {
            cells[*index] = 0;
        }
        !goes
    });
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::drawn;
    use super::*;

    /// Number of 8-connected parts of the mask and of 4-connected parts outside.
    fn topology(mask: &Mask) -> (usize, usize) {
        let count = |value: u8, steps: &[(isize, isize)]| {
            let (width, height) = (mask.width() as isize + 2, mask.height() as isize + 2);
            let mut seen = vec![false; (width * height) as usize];
            let mut parts = 0;
            for start in 0..seen.len() {
                if seen[start] || mask.cells()[start] != value {
                    continue;
                }
                parts += 1;
                let mut stack = vec![start];
                seen[start] = true;
                while let Some(index) = stack.pop() {
                    let (x, y) = (index as isize % width, index as isize / width);
                    for (dx, dy) in steps {
                        let (x, y) = (x + dx, y + dy);
                        if x < 0 || y < 0 || x >= width || y >= height {
                            continue;
                        }
                        let next = (y * width + x) as usize;
                        if !seen[next] && mask.cells()[next] == value {
                            seen[next] = true;
                            stack.push(next);
                        }
                    }
                }
            }
            parts
        };
        let straight = [(1, 0), (-1, 0), (0, 1), (0, -1)];
        let diagonal = [(1, 1), (-1, 1), (1, -1), (-1, -1)];
        let all = [straight, diagonal].concat();
        (count(1, &all), count(0, &straight))
    }

    proptest::proptest! {
        #[test]
        fn thinning_keeps_parts_and_holes(bits in proptest::collection::vec(0u8..3, 20 * 15)) {
            let mut mask = Mask::new(20, 15);
            for (index, bit) in bits.iter().enumerate() {
                mask.set(index % 20, index / 20, *bit > 0);
            }
            let before = topology(&mask);
            let members = mask.members();
            let line = thin(&mut mask, &members);
            proptest::prop_assert_eq!(topology(&mask), before);
            proptest::prop_assert_eq!(line, mask.members());
        }
    }

    #[test]
    fn a_bar_becomes_its_middle_line() {
        let mut bar = drawn(60, 21, |pixel| {
            (5.0..55.0).contains(&pixel.x) && (5.0..14.0).contains(&pixel.y)
        });
        let members = bar.members();
        let line = thin(&mut bar, &members);
        let middle = line.iter().filter(|index| bar.position(**index).1 == 9);
        let middle = middle.count();
        assert!(middle >= 40, "{middle} of {}", line.len());
    }
}
