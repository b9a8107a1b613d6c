//! The force manifold: folds at the points of a grid, with interpolation.

use super::atlas::{FoldAtlas, solve_from};
use super::equilibrium::Fold;
use rayon::prelude::*;

/// Grid in the plane of the gripper (thesis sec. 4.4.1): (x̄, z̄) = ((column + ½) δ̄, (row + ½) δ̄).
#[derive(Clone, Debug)]
pub struct ForceManifold {
    spacing: f64,
    columns: usize,
    rows: usize,
    /// Row by row; `None` without a fold.
    folds: Vec<Option<Fold>>,
}

/// Number of folds of the atlas from which a row is started.
const STARTS: usize = 8;
/// Largest pull H l̄_s² of the starting folds.
const MOST_PULL: f64 = 5.0;

/// Values of the manifold at a position: λ = |H|/|V|, α (rad) and l̄_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManifoldPoint {
    /// λ.
    pub force_ratio: f64,
    /// α.
    pub angle: f64,
    /// l̄_s.
    pub suspended_length: f64,
}

impl ForceManifold {
    /// The thesis' δ̄ (sec. 4.6.5).
    pub const SPACING: f64 = 0.0548;
    /// The thesis' longest suspended length, in L_gb (sec. 4.3.3).
    pub const LONGEST: f64 = 6.84;

    /// Exact folds with suspended lengths up to `longest`, at every cell of the grid that the
    /// gripper can reach. Each row starts from the atlas and continues from cell to cell.
    pub fn new(atlas: &FoldAtlas, spacing: f64, longest: f64) -> Self {
        let reach = |k: usize| {
            let within = atlas
                .folds()
                .iter()
                .filter(|fold| fold.suspended_length <= 1.1 * longest);
            within.fold(0.0, |reach: f64, fold| reach.max(fold.gripper[k]))
        };
        let [columns, rows] = [0, 1].map(|k| (reach(k) / spacing).ceil() as usize);
        let rows_of_folds = (0..rows).into_par_iter().map(|row| {
            let z = (row as f64 + 0.5) * spacing;
            row_of_folds(atlas, z, spacing, columns, longest)
        });
        Self {
            spacing,
            columns,
            rows,
            folds: rows_of_folds.flatten_iter().collect(),
        }
    }

    /// A manifold of folds that were computed elsewhere, row by row.
    pub(super) fn of(spacing: f64, [columns, rows]: [usize; 2], folds: Vec<Option<Fold>>) -> Self {
        assert_eq!(folds.len(), columns * rows);
        Self {
            spacing,
            columns,
            rows,
            folds,
        }
    }

    /// A grid without folds.
    pub(super) fn without_folds(spacing: f64, [columns, rows]: [usize; 2]) -> Self {
        Self::of(spacing, [columns, rows], vec![None; columns * rows])
    }

    /// Whether the grid contains a cell.
    pub(super) fn has(&self, [column, row]: [usize; 2]) -> bool {
        column < self.columns && row < self.rows
    }

    /// The middle of a cell.
    pub(super) fn place(&self, cell: [usize; 2]) -> [f64; 2] {
        cell.map(|index| (index as f64 + 0.5) * self.spacing)
    }

    /// The middles of all cells, row by row.
    pub(super) fn places(&self) -> impl Iterator<Item = [f64; 2]> {
        (0..self.rows)
            .flat_map(move |row| (0..self.columns).map(move |column| self.place([column, row])))
    }

    /// The available folds, row by row.
    pub(super) fn folds(&self) -> impl Iterator<Item = &Fold> {
        self.folds.iter().flatten()
    }

    /// Stores the fold of a cell.
    pub(super) fn set(&mut self, [column, row]: [usize; 2], fold: Fold) {
        self.folds[row * self.columns + column] = Some(fold);
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// δ̄.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The fold of a cell.
    pub fn fold(&self, cell: [usize; 2]) -> Option<&Fold> {
        let [column, row] = cell;
        self.has(cell)
            .then(|| self.folds[row * self.columns + column].as_ref())
            .flatten()
    }

    /// The cell that contains a position.
    pub fn cell(&self, gripper: [f64; 2]) -> [usize; 2] {
        gripper.map(|value| (value / self.spacing).max(0.0) as usize)
    }

    /// Bilinear interpolation of H, V, α and l̄_s between the four cells around a position; `None`
    /// if one of them is out of reach.
    pub fn at(&self, gripper: [f64; 2]) -> Option<ManifoldPoint> {
        let grid = gripper.map(|value| value / self.spacing - 0.5);
        if !(grid[0] >= 0.0 && grid[1] >= 0.0) {
            return None;
        }
        let [column, row] = grid.map(|value| value as usize);
        let [u, v] = [grid[0] - column as f64, grid[1] - row as f64];
        let corners = [
            ([column, row], (1.0 - u) * (1.0 - v)),
            ([column + 1, row], u * (1.0 - v)),
            ([column, row + 1], (1.0 - u) * v),
            ([column + 1, row + 1], u * v),
        ];
        let mut sums = [0.0; 4];
        for (cell, weight) in corners {
            let fold = self.fold(cell)?;
            let values = [
                fold.forces.horizontal,
                fold.forces.vertical,
                fold.angle,
                fold.suspended_length,
            ];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
        let [horizontal, vertical, angle, suspended_length] = sums;
        Some(ManifoldPoint {
            force_ratio: (horizontal / vertical).abs(),
            angle,
            suspended_length,
        })
    }
}

/// Whether a sheet is not pulled taut, so that nearby folds are similar.
fn is_slack(fold: &Fold) -> bool {
    fold.forces.horizontal * fold.suspended_length.powi(2) < MOST_PULL
}

/// A row of the grid, which starts at the fold of the atlas with the nearest height and continues
/// to both sides as far as there are folds.
fn row_of_folds(
    atlas: &FoldAtlas,
    z: f64,
    spacing: f64,
    columns: usize,
    longest: f64,
) -> Vec<Option<Fold>> {
    let mut row = vec![None; columns];
    let place = |column: usize| [(column as f64 + 0.5) * spacing, z];
    let column_of = |fold: &Fold| ((fold.gripper[0] / spacing) as usize).min(columns - 1);
    let mut starts: Vec<&Fold> = atlas
        .folds()
        .iter()
        .filter(|fold| fold.suspended_length <= longest && is_slack(fold))
        .collect();
    let distance = |fold: &Fold| {
        let [x, _] = place(column_of(fold));
        let [other_x, other_z] = fold.gripper;
        libm::hypot(other_x - x, other_z - z) / libm::hypot(other_x, other_z)
    };
    starts.sort_by(|one, other| distance(one).total_cmp(&distance(other)));
    let first = starts.iter().take(STARTS).find_map(|start| {
        let column = column_of(start);
        Some((column, solve_from(start, place(column))?))
    });
    let Some((column, first)) = first else {
        return row;
    };
    row[column] = Some(first);
    let mut march = |columns: &mut dyn Iterator<Item = usize>| {
        let mut last = first;
        for column in columns {
            match solve_from(&last, place(column)) {
                Some(fold) if fold.suspended_length <= longest => last = fold,
                _ => break,
            }
            row[column] = Some(last);
        }
    };
    march(&mut (0..column).rev());
    march(&mut (column + 1..columns));
    row
}
