//! Corners of a checkerboard in a picture, to a fraction of a pixel.
//!
//! Inner corners are saddles of the brightness. They are ordered by growing a grid from one of
//! them.

use super::saddle::Grey;
use super::{Point, VisionError};
use image::RgbImage;
use nalgebra::Vector2;

/// A checkerboard: its inner corners and the side of its squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkerboard {
    /// Inner corners along x.
    pub columns: usize,
    /// Inner corners along y.
    pub rows: usize,
    /// Side of a square, metres.
    pub square: f64,
}

impl Checkerboard {
    /// A corner's position on the board, metres. Seen from the front, x points to the right and y upwards when the
    /// first corner is at the top left; z points to the viewer.
    pub fn corner(&self, index: usize) -> Point {
        let (column, row) = (index % self.columns, index / self.columns);
        Point::new(
            column as f64 * self.square,
            (self.rows - 1 - row) as f64 * self.square,
        )
    }

    /// Number of corners.
    pub fn corners(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether a picture shows the orientation of the board, since a half turn swaps dark and
    /// bright squares.
    pub fn is_directed(&self) -> bool {
        (self.columns + self.rows) % 2 == 1
    }

    /// Finds all inner corners in a picture, row by row. The square to the lower right of the
    /// first corner is dark if the board is [directed](Self::is_directed).
    ///
    /// # Errors
    /// The board is not completely visible.
    pub fn find(&self, picture: &RgbImage) -> Result<Vec<Point>, VisionError> {
        let missing = |reason: String| VisionError::NotFound {
            what: "the checkerboard",
            reason,
        };
        let grey = Grey::new(picture);
        let saddles = grey.saddles();
        let wanted = self.corners();
        if saddles.len() < wanted {
            return Err(missing(format!(
                "{} corners were detected, but a board has {wanted} inner corners with {} × {} squares",
                saddles.len(),
                self.columns,
                self.rows
            )));
        }
        let mut most = 0;
        for seed in (0..saddles.len()).take(40) {
            let grid = grow_grid(&saddles, seed);
            most = most.max(grid.len());
            if let Some(corners) = self.in_order(&grid, &saddles) {
                let refined: Vec<Point> = self.refine_all(&grey, &corners);
                return Ok(self.directed(&grey, refined));
            }
        }
        Err(missing(format!(
            "the largest grid has {most} corners, expected {} × {} inner corners; the whole board must be visible",
            self.columns, self.rows
        )))
    }

    /// The corners row by row, if the grid has the size of the board.
    fn in_order(&self, grid: &[([i32; 2], usize)], saddles: &[Point]) -> Option<Vec<Point>> {
        let range = |axis: usize| {
            let places = || grid.iter().map(|(place, _)| place[axis]);
            Some((places().min()?, places().max()?))
        };
        let ((x0, x1), (y0, y1)) = (range(0)?, range(1)?);
        let size = [(x1 - x0 + 1) as usize, (y1 - y0 + 1) as usize];
        let turned = size == [self.rows, self.columns] && self.rows != self.columns;
        if (size != [self.columns, self.rows] && !turned) || grid.len() != self.corners() {
            return None;
        }
        let mut corners = vec![Point::zeros(); self.corners()];
        for (place, saddle) in grid {
            let (x, y) = ((place[0] - x0) as usize, (place[1] - y0) as usize);
            let (column, row) = if turned { (y, x) } else { (x, y) };
            corners[row * self.columns + column] = saddles[*saddle];
        }
        // Columns to the right, rows downwards: seen from the front, this gives a positive area.
        let along = corners[self.columns - 1] - corners[0];
        let down = corners[(self.rows - 1) * self.columns] - corners[0];
        if along.perp(&down) < 0.0 {
            for row in corners.chunks_exact_mut(self.columns) {
                row.reverse();
            }
        }
        Some(corners)
    }

    fn refine_all(&self, grey: &Grey, corners: &[Point]) -> Vec<Point> {
        let rows = corners.chunks_exact(self.columns);
        let along = rows.flat_map(|row| row.windows(2).map(|pair| (pair[1] - pair[0]).norm()));
        let below = corners.iter().zip(&corners[self.columns..]);
        let down = below.map(|(here, below)| (below - here).norm());
        let nearest = along.chain(down).fold(f64::INFINITY, f64::min);
        let reach = (nearest / 3.0).clamp(2.0, 9.0) as i32;
        corners
            .iter()
            .map(|corner| grey.refine(*corner, reach))
            .collect()
    }

    fn directed(&self, grey: &Grey, mut corners: Vec<Point>) -> Vec<Point> {
        if !self.is_directed() || self.columns < 2 || self.rows < 2 {
            // Of the two orientations, use the one whose first corner is nearer to the top left.
            let last = corners[corners.len() - 1];
            if corners[0].sum() > last.sum() {
                corners.reverse();
            }
            return corners;
        }
        let mut balance = 0.0;
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                let first = row * self.columns + column;
                let middle = (corners[first]
                    + corners[first + 1]
                    + corners[first + self.columns]
                    + corners[first + self.columns + 1])
                    / 4.0;
                let sign = if (row + column) % 2 == 0 { 1.0 } else { -1.0 };
                balance += sign * grey.at(middle);
            }
        }
        if balance > 0.0 {
            corners.reverse();
        }
        corners
    }
}

/// Grows a grid from a seed: returns positions in the grid with the indices of their points. Empty
/// if the seed has no neighbours.
fn grow_grid(points: &[Point], seed: usize) -> Vec<([i32; 2], usize)> {
    let Some([right, down]) = first_steps(points, seed) else {
        return Vec::new();
    };
    let mut grid = vec![([0, 0], seed)];
    let mut used = vec![false; points.len()];
    used[seed] = true;
    let at = |grid: &[([i32; 2], usize)], place: [i32; 2]| {
        let found = grid.iter().find(|(other, _)| *other == place);
        found.map(|(_, point)| points[*point])
    };
    let mut next = 0;
    while next < grid.len() {
        let ([x, y], point) = grid[next];
        let here = points[point];
        next += 1;
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let place = [x + dx, y + dy];
            if at(&grid, place).is_some() {
                continue;
            }
            // Use the step from the opposite side, otherwise a parallel step beside it, otherwise
            // the first step.
            let step = at(&grid, [x - dx, y - dy])
                .map(|before| here - before)
                .or_else(|| {
                    [(dy, dx), (-dy, -dx)].into_iter().find_map(|(sx, sy)| {
                        let beside = at(&grid, [x + sx, y + sy])?;
                        let beyond = at(&grid, [x + sx + dx, y + sy + dy])?;
                        Some(beyond - beside)
                    })
                })
                .unwrap_or(right * f64::from(dx) + down * f64::from(dy));
            let guess = here + step;
            let nearest = (0..points.len())
                .filter(|other| !used[*other])
                .min_by(|a, b| {
                    (points[*a] - guess)
                        .norm_squared()
                        .total_cmp(&(points[*b] - guess).norm_squared())
                });
            if let Some(found) = nearest
                && (points[found] - guess).norm() < 0.25 * step.norm()
            {
                used[found] = true;
                grid.push((place, found));
            }
        }
    }
    grid
}

/// Steps to a neighbour along a row and along a column: the two nearest ones that are not opposite.
fn first_steps(points: &[Point], seed: usize) -> Option<[Vector2<f64>; 2]> {
    let mut ways: Vec<Vector2<f64>> = points.iter().map(|point| point - points[seed]).collect();
    ways.retain(|way| way.norm() > 1.0);
    ways.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    let right = *ways.first()?;
    let down = ways
        .iter()
        .take(6)
        .find(|way| right.perp(way).abs() > 0.6 * right.norm() * way.norm())?;
    Some([right, *down])
}
