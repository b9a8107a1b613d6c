//! Positions and sizes of the pictures of a figure.

use super::super::paper::Paper;
use super::super::view::{Projected, View};
use super::Snapshot;
use nalgebra::Vector2;

/// Largest total height of the pictures relative to the width of the page.
const HEIGHT_OVER_WIDTH: f64 = 0.54;
/// Space beside and between pictures relative to the font size.
const MARGIN: f64 = 1.2;

/// Layout of the pictures.
pub(super) struct Grid {
    pub columns: usize,
    pub rows: usize,
    /// Size of a picture with its margins and title, pixels.
    pub cell: Vector2<f64>,
    /// Pixels per metre.
    pub scale: f64,
    margin: f64,
}

impl Grid {
    /// The grid with the largest pictures; if several are equal, the one with the fewest rows.
    /// `head`: space for the title of each picture, pixels.
    pub fn largest(pictures: usize, extent: &Extent, paper: &Paper, head: f64) -> Self {
        let with_rows = |rows| Self::with_rows(rows, pictures, extent, paper, head);
        let grids = (1..=pictures).map(with_rows);
        grids
            .reduce(|best, grid| {
                if grid.scale > 1.001 * best.scale {
                    grid
                } else {
                    best
                }
            })
            .expect("there is at least one row")
    }

    fn with_rows(rows: usize, pictures: usize, extent: &Extent, paper: &Paper, head: f64) -> Self {
        let columns = pictures.div_ceil(rows);
        let (size, margin) = (extent.size(), MARGIN * paper.em);
        let width = (paper.width - margin) / columns as f64;
        // The titles of many rows do not shrink the pictures.
        let height = (HEIGHT_OVER_WIDTH * paper.width / rows as f64 - head).max(2.0 * head);
        let scale = ((width - margin) / size.x).min(height / size.y);
        Self {
            columns,
            rows,
            cell: Vector2::new(width, head + scale * size.y),
            scale,
            margin,
        }
    }

    /// Top left corner of a picture.
    pub fn corner(&self, index: usize) -> Vector2<f64> {
        let (row, column) = (index / self.columns, index % self.columns);
        Vector2::new(
            0.5 * self.margin + column as f64 * self.cell.x,
            row as f64 * self.cell.y,
        )
    }
}

/// Smallest rectangle on the picture plane that holds all rods with their thickness, m.
pub(super) struct Extent {
    pub low: Vector2<f64>,
    pub high: Vector2<f64>,
}

impl Extent {
    pub fn of(snapshots: &[Snapshot], view: &View) -> Self {
        let mut extent = Self {
            low: Vector2::repeat(f64::INFINITY),
            high: Vector2::repeat(f64::NEG_INFINITY),
        };
        for rod in snapshots.iter().flat_map(|snapshot| &snapshot.rods) {
            // The margin beyond the surface allows for the bulge of the spline.
            let reach = Vector2::repeat(1.5 * rod.radius);
            for point in &rod.points {
                let point = view.project(point);
                let point = Vector2::new(point.x, point.y);
                extent.low = extent.low.inf(&(point - reach));
                extent.high = extent.high.sup(&(point + reach));
            }
        }
        if extent
            .size()
            .iter()
            .all(|side| side.is_finite() && *side > 0.0)
        {
            extent
        } else {
            Self {
                low: Vector2::repeat(-0.5),
                high: Vector2::repeat(0.5),
            }
        }
    }

    /// Extends it to include points.
    pub fn include(&mut self, points: impl Iterator<Item = Projected>) {
        for point in points {
            let point = Vector2::new(point.x, point.y);
            self.low = self.low.inf(&point);
            self.high = self.high.sup(&point);
        }
    }

    pub fn size(&self) -> Vector2<f64> {
        self.high - self.low
    }

    pub fn centre(&self) -> Vector2<f64> {
        0.5 * (self.low + self.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_scenes_are_stacked_and_tall_ones_stand_side_by_side() {
        let extent = |x: f64, y: f64| Extent {
            low: Vector2::zeros(),
            high: Vector2::new(x, y),
        };
        let paper = Paper::default();
        let columns = |x, y| Grid::largest(4, &extent(x, y), &paper, 26.0).columns;
        assert_eq!(
            [columns(1.0, 3.0), columns(1.5, 1.0), columns(9.0, 1.0)],
            [4, 2, 1]
        );
    }
}
