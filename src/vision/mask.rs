//! Binary images of the pixels of a rod, without specks and pinholes.

use super::contrast::Contrast;

/// A binary image with a frame of background one pixel wide, so that every pixel has eight neighbours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    height: usize,
    /// 1 inside, 0 outside, (width + 2) × (height + 2) row by row.
    cells: Vec<u8>,
}

/// Number of rounds in which labels spread.
const SPREADING_ROUNDS: usize = 12;

/// A run of pixels with one value in a row.
#[derive(Clone, Copy, Debug)]
struct Run {
    row: usize,
    /// First column, and the column after the last.
    columns: [usize; 2],
}

impl Mask {
    /// An empty mask.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            cells: vec![0; (width + 2) * (height + 2)],
        }
    }

    /// Pixels at or above the threshold.
    pub fn of_contrast(contrast: &Contrast) -> Self {
        let mut mask = Self::new(contrast.width, contrast.height);
        if contrast.width == 0 {
            return mask;
        }
        let stride = mask.stride();
        let rows = mask.cells.chunks_exact_mut(stride).skip(1);
        for (cells, values) in rows.zip(contrast.values.chunks_exact(contrast.width)) {
            for (cell, value) in cells[1..].iter_mut().zip(values) {
                *cell = u8::from(*value >= contrast.threshold);
            }
        }
        mask
    }

    /// Width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Offset in [`cells`](Self::cells) from a pixel to the one below it.
    pub(super) fn stride(&self) -> usize {
        self.width + 2
    }

    /// Index of a pixel in [`cells`](Self::cells).
    pub(super) fn index(&self, column: usize, row: usize) -> usize {
        (row + 1) * self.stride() + column + 1
    }

    /// Column and row of a cell that is not in the frame.
    pub(super) fn position(&self, index: usize) -> (usize, usize) {
        (index % self.stride() - 1, index / self.stride() - 1)
    }

    pub(super) fn cells(&self) -> &[u8] {
        &self.cells
    }

    pub(super) fn cells_mut(&mut self) -> &mut [u8] {
        &mut self.cells
    }

    /// Whether a pixel belongs to the mask; pixels outside of the image do not.
    pub fn contains(&self, column: usize, row: usize) -> bool {
        column < self.width && row < self.height && self.cells[self.index(column, row)] == 1
    }

    /// Adds or removes a pixel.
    ///
    /// # Panics
    /// The pixel lies outside of the image.
    pub fn set(&mut self, column: usize, row: usize, inside: bool) {
        assert!(
            column < self.width && row < self.height,
            "a pixel of the image"
        );
        let index = self.index(column, row);
        self.cells[index] = u8::from(inside);
    }

    /// Number of pixels.
    pub fn area(&self) -> usize {
        self.cells.iter().map(|cell| usize::from(*cell)).sum()
    }

    /// Cells of the mask, in order.
    pub(super) fn members(&self) -> Vec<usize> {
        let mut members = Vec::new();
        for (index, cell) in self.cells.iter().enumerate() {
            if *cell == 1 {
                members.push(index);
            }
        }
        members
    }

    /// The union with a mask of the same size.
    pub(super) fn with(&self, other: &Self) -> Self {
        let cells = self.cells.iter().zip(&other.cells);
        Self {
            cells: cells.map(|(a, b)| a | b).collect(),
            ..*self
        }
    }

    /// Removes parts of fewer pixels than `specks` and fills holes of fewer pixels than `holes`.
    pub fn clean(&mut self, specks: usize, holes: usize) {
        self.replace_small(1, specks, true);
        self.replace_small(0, holes, false);
    }

    /// Inverts connected parts with the given value that are smaller than `least` pixels. Parts of
    /// background that touch the border are not holes. Inside, diagonal neighbours are connected;
    /// outside, they are not.
    fn replace_small(&mut self, value: u8, least: usize, diagonal: bool) {
        let (runs, roots) = self.components(value, diagonal);
        let mut area = vec![0; runs.len()];
        for (run, root) in runs.iter().zip(&roots) {
            let at_border = run.row == 0
                || run.row + 1 == self.height
                || run.columns[0] == 0
                || run.columns[1] == self.width;
            let size = run.columns[1] - run.columns[0];
            area[*root] += if value == 0 && at_border { least } else { size };
        }
        for (run, root) in runs.iter().zip(&roots) {
            if area[*root] < least {
                let first = self.index(run.columns[0], run.row);
                let size = run.columns[1] - run.columns[0];
                self.cells[first..first + size].fill(1 - value);
            }
        }
    }

    /// Pixels, by column and row, of each connected part.
    pub(super) fn parts(&self) -> Vec<Vec<(usize, usize)>> {
        let (runs, roots) = self.components(1, true);
        let mut number = vec![usize::MAX; runs.len()];
        let mut parts: Vec<Vec<(usize, usize)>> = Vec::new();
        for (run, root) in runs.iter().zip(&roots) {
            if number[*root] == usize::MAX {
                number[*root] = parts.len();
                parts.push(Vec::new());
            }
            let pixels = (run.columns[0]..run.columns[1]).map(|column| (column, run.row));
            parts[number[*root]].extend(pixels);
        }
        parts
    }

    /// Removes all connected parts except the one with most pixels.
    pub(super) fn keep_largest(&mut self) {
        let parts = self.parts();
        let largest = parts.into_iter().max_by_key(Vec::len).unwrap_or_default();
        self.cells.fill(0);
        for (column, row) in largest {
            let index = self.index(column, row);
            self.cells[index] = 1;
        }
    }

    /// Labels unlabelled cells: `choose` returns a label for the labels of the four neighbours
    /// (left, right, above, below).
    pub(super) fn spread(&self, labels: &mut [u8], choose: impl Fn([u8; 4]) -> Option<u8>) {
        let stride = self.stride();
        let mut rest = self.members();
        rest.retain(|cell| labels[*cell] == 0);
        for _ in 0..SPREADING_ROUNDS {
            let mut reached = Vec::new();
            rest.retain(|cell| {
                let near = [cell - 1, cell + 1, cell - stride, cell + stride];
                let label = choose(near.map(|other| labels[other]));
                reached.extend(label.map(|label| (*cell, label)));
                label.is_none()
            });
            if reached.is_empty() {
                return;
            }
            for (cell, label) in reached {
                labels[cell] = label;
            }
        }
    }

    /// First and last pixel of each row, which are sufficient for a convex hull.
    pub(super) fn outline(&self) -> Vec<super::Point> {
        let mut outline = Vec::new();
        let mut runs = Vec::new();
        for row in 0..self.height {
            runs.clear();
            self.runs_of_row(row, 1, &mut runs);
            if let (Some(first), Some(last)) = (runs.first(), runs.last()) {
                for column in [first.columns[0], last.columns[1] - 1] {
                    outline.push(super::Point::new(column as f64, row as f64));
                }
            }
        }
        outline
    }

    /// Runs with the given value and, for each run, the index of the first run of its connected
    /// part.
    fn components(&self, value: u8, diagonal: bool) -> (Vec<Run>, Vec<usize>) {
        let mut runs: Vec<Run> = Vec::new();
        let mut parent: Vec<usize> = Vec::new();
        let mut above = 0..0;
        for row in 0..self.height {
            let start = runs.len();
            self.runs_of_row(row, value, &mut runs);
            parent.extend(start..runs.len());
            // The runs of both rows are ordered, so that one pass finds all pairs that touch.
            let reach = usize::from(diagonal);
            let mut first = above.start;
            for current in start..runs.len() {
                let [from, to] = runs[current].columns;
                while first < above.end && runs[first].columns[1] + reach <= from {
                    first += 1;
                }
                let mut other = first;
                while other < above.end && runs[other].columns[0] < to + reach {
                    let (a, b) = (root(&mut parent, other), root(&mut parent, current));
                    parent[a.max(b)] = a.min(b);
                    other += 1;
                }
            }
            above = start..runs.len();
        }
        let roots = (0..runs.len()).map(|run| root(&mut parent, run)).collect();
        (runs, roots)
    }

    fn runs_of_row(&self, row: usize, value: u8, runs: &mut Vec<Run>) {
        let first = self.index(0, row);
        let cells = &self.cells[first..first + self.width];
        let mut column = 0;
        while let Some(from) = cells[column..].iter().position(|cell| *cell == value) {
            let from = column + from;
            let size = cells[from..].iter().position(|cell| *cell != value);
            let to = size.map_or(self.width, |size| from + size);
            runs.push(Run {
                row,
                columns: [from, to],
            });
            column = to;
        }
    }
}

/// First run of the part to which a run belongs, by union–find with path halving.
fn root(parent: &mut [usize], mut run: usize) -> usize {
    while parent[run] != run {
        parent[run] = parent[parent[run]];
        run = parent[run];
    }
    run
}

/// Distance of every cell of the mask from the background in pixels, times 5: chamfer distances of
/// 5, 7 and 11 for straight, diagonal and knight's steps, with an error of at most 2 % (Borgefors,
/// CVGIP 34:344, 1986). Cells outside hold 0.
pub(super) fn chamfer_distances(mask: &Mask, members: &[usize]) -> Vec<u16> {
    let stride = mask.stride();
    let mut distances = vec![0u16; mask.cells.len()];
    for index in members {
        distances[*index] = u16::MAX / 2;
    }
    // A knight's step may pass the frame; cells beyond it are background as well.
    let at = |distances: &[u16], index: Option<usize>| {
        index
            .and_then(|index| distances.get(index).copied())
            .unwrap_or(0)
    };
    let mut relax = |index: usize, sign: bool| {
        let to = |back: usize| {
            if sign {
                index.checked_add(back)
            } else {
                index.checked_sub(back)
            }
        };
        let steps = [
            (1, 5),
            (stride, 5),
            (stride - 1, 7),
            (stride + 1, 7),
            (stride + 2, 11),
            (stride.saturating_sub(2), 11),
            (2 * stride - 1, 11),
            (2 * stride + 1, 11),
        ];
        let nearest = steps
            .iter()
            .map(|(back, cost)| at(&distances, to(*back)) + cost)
            .min()
            .unwrap_or(0);
        distances[index] = distances[index].min(nearest);
    };
    for index in members {
        relax(*index, false);
    }
    for index in members.iter().rev() {
        relax(*index, true);
    }
    distances
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::Point;
    use super::*;

    /// The mask of the pixels that satisfy a predicate.
    pub fn drawn(width: usize, height: usize, is_inside: impl Fn(Point) -> bool) -> Mask {
        let mut mask = Mask::new(width, height);
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |k| (row, k))) {
            mask.set(
                column,
                row,
                is_inside(Point::new(column as f64, row as f64)),
            );
        }
        mask
    }

    /// Strokes with a given thickness along lines.
    pub fn strokes(width: usize, height: usize, thickness: f64, lines: &[&[[f64; 2]]]) -> Mask {
        drawn(width, height, |pixel| {
            let mut pairs = lines.iter().flat_map(|line| line.windows(2));
            pairs.any(|pair| distance([pair[0], pair[1]], pixel) < thickness / 2.0)
        })
    }

    /// The contrast image of a mask.
    pub fn contrast_of(mask: &Mask) -> Contrast {
        let (width, height) = (mask.width(), mask.height());
        let pixels = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
        let value = |(u, v)| 255 * u8::from(mask.contains(u, v));
        Contrast {
            width,
            height,
            values: pixels.map(value).collect(),
            threshold: 128,
        }
    }

    /// Distance of a point from the line between two ends.
    pub fn distance(ends: [[f64; 2]; 2], point: Point) -> f64 {
        let [from, to] = ends.map(Point::from);
        let t = (point - from).dot(&(to - from)) / (to - from).norm_squared();
        (point - from - (to - from) * t.clamp(0.0, 1.0)).norm()
    }

    fn mask(rows: &[&str]) -> Mask {
        drawn(rows[0].len(), rows.len(), |pixel| {
            rows[pixel.y as usize].as_bytes()[pixel.x as usize] == b'#'
        })
    }

    #[test]
    fn specks_go_and_pinholes_fill() {
        let mut found = mask(&[
            "#..........", //
            "...#####...",
            "...#.###..#",
            "...#####...",
            ".....#.....",
            "......#....",
            "#####......",
        ]);
        found.clean(2, 3);
        let expected = mask(&[
            "...........", //
            "...#####...",
            "...#####...",
            "...#####...",
            ".....#.....",
            "......#....",
            "#####......",
        ]);
        assert_eq!(found, expected);
    }

    #[test]
    fn a_notch_at_the_border_is_not_a_hole() {
        let rows = ["##.##", "#####", "#.#.#", "#####"];
        let mut found = mask(&rows);
        found.clean(1, 2);
        assert_eq!(found, mask(&["##.##", "#####", "#####", "#####"]));
    }

    #[test]
    fn parts_that_meet_late_are_one() {
        // A spiral's arms are joined only in the last row.
        let mut found = mask(&["#.#.#", "#.#.#", "#.#.#", "#####"]);
        let before = found.clone();
        found.clean(14, 0);
        assert_eq!(found, before);
        found.clean(15, 0);
        assert_eq!(found.area(), 0);
    }

    #[test]
    fn chamfer_distances_are_near_euclid() {
        let disc = drawn(61, 61, |pixel| {
            (pixel - Point::new(30.0, 30.0)).norm() < 25.0
        });
        let members = disc.members();
        let distances = chamfer_distances(&disc, &members);
        let centre = f64::from(distances[disc.index(30, 30)]) / 5.0;
        assert!((centre - 25.0).abs() < 1.0, "{centre}");
    }
}
