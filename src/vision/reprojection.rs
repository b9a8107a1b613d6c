//! Reprojection of the corners of boards through a lens, and the least-squares solution for lens
//! and poses by the Levenberg–Marquardt method.

use super::Point;
use super::camera::Lens;
use super::checkerboard::Checkerboard;
use super::lens_fit::LensMisfit;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix2x3, UnitQuaternion, Vector3};

/// Number of unknowns of the lens.
pub(super) const LENS: usize = 9;
/// Number of unknowns of a pose.
pub(super) const POSE: usize = 6;

/// Unknowns: the lens and the poses of the boards.
#[derive(Clone)]
pub(super) struct State {
    pub lens: Lens,
    pub boards: Vec<Isometry3<f64>>,
}

impl State {
    pub fn residuals(&self, board: &Checkerboard, view: usize, corners: &[Point]) -> DVector<f64> {
        let mut residuals = DVector::zeros(2 * corners.len());
        for (index, corner) in corners.iter().enumerate() {
            let seen = self.seen(board, view, index);
            let found = self
                .lens
                .image(Point::new(seen.x / seen.z, seen.y / seen.z));
            residuals[2 * index] = found.x - corner.x;
            residuals[2 * index + 1] = found.y - corner.y;
        }
        residuals
    }

    /// The part of the residuals that depends on the distance from the principal point.
    pub fn misfit(&self, board: &Checkerboard, views: &[Vec<Point>]) -> Option<LensMisfit> {
        let views = views.iter().enumerate();
        let corners = views.flat_map(|(view, corners)| {
            let residuals = self.residuals(board, view, corners);
            let pairs = corners.iter().enumerate();
            let pairs = pairs
                .map(|(k, corner)| (*corner, Point::new(residuals[2 * k], residuals[2 * k + 1])));
            pairs.collect::<Vec<_>>()
        });
        LensMisfit::of(self.lens.centre.into(), &corners.collect::<Vec<_>>())
    }

    fn seen(&self, board: &Checkerboard, view: usize, corner: usize) -> Vector3<f64> {
        let place = board.corner(corner);
        (self.boards[view] * nalgebra::Point3::new(place.x, place.y, 0.0)).coords
    }

    /// Adds a view's JᵀJ and Jᵀr. The unknowns of a pose rotate the board about the camera's axes,
    /// then move it.
    fn accumulate(
        &self,
        board: &Checkerboard,
        view: usize,
        corners: &[Point],
        normal: &mut DMatrix<f64>,
        gradient: &mut DVector<f64>,
    ) -> f64 {
        let residuals = self.residuals(board, view, corners);
        let offset = LENS + POSE * view;
        for index in 0..corners.len() {
            let seen = self.seen(board, view, index);
            let z = seen.z;
            let (by_direction, by_lens) = self.lens.derivatives(Point::new(seen.x / z, seen.y / z));
            let by_seen = by_direction
                * Matrix2x3::new(
                    1.0 / z,
                    0.0,
                    -seen.x / (z * z),
                    0.0,
                    1.0 / z,
                    -seen.y / (z * z),
                );
            let turned = seen - self.boards[view].translation.vector;
            let by_turn = -by_seen * turned.cross_matrix();
            for axis in 0..2 {
                let mut row: Vec<(usize, f64)> = (0..LENS).map(|k| (k, by_lens[k][axis])).collect();
                row.extend((0..3).map(|k| (offset + k, by_turn[(axis, k)])));
                row.extend((0..3).map(|k| (offset + 3 + k, by_seen[(axis, k)])));
                let residual = residuals[2 * index + axis];
                for (i, a) in &row {
                    gradient[*i] += a * residual;
                    for (j, b) in &row {
                        normal[(*i, *j)] += a * b;
                    }
                }
            }
        }
        residuals.norm_squared()
    }

    fn moved(&self, step: &DVector<f64>) -> Self {
        let mut moved = self.clone();
        for axis in 0..2 {
            moved.lens.focal[axis] += step[axis];
            moved.lens.centre[axis] += step[2 + axis];
        }
        for (index, coefficient) in moved.lens.distortion.iter_mut().enumerate() {
            *coefficient += step[4 + index];
        }
        for (view, pose) in moved.boards.iter_mut().enumerate() {
            let part = |k: usize| step[LENS + POSE * view + k];
            let turn = UnitQuaternion::new(Vector3::new(part(0), part(1), part(2)));
            pose.rotation = turn * pose.rotation;
            pose.translation.vector += Vector3::new(part(3), part(4), part(5));
        }
        moved
    }

    pub fn minimise(&mut self, board: &Checkerboard, views: &[Vec<Point>]) -> Option<DMatrix<f64>> {
        self.levenberg_marquardt(board, views, 0)
    }

    pub fn minimise_poses(&mut self, board: &Checkerboard, views: &[Vec<Point>]) -> Option<()> {
        self.levenberg_marquardt(board, views, LENS).map(drop)
    }

    /// Minimises the sum of squares; unknowns below `first` stay fixed. Returns JᵀJ at the minimum.
    fn levenberg_marquardt(
        &mut self,
        board: &Checkerboard,
        views: &[Vec<Point>],
        first: usize,
    ) -> Option<DMatrix<f64>> {
        let unknowns = LENS + POSE * views.len();
        let assemble = |state: &Self| {
            let mut normal = DMatrix::zeros(unknowns, unknowns);
            let mut gradient = DVector::zeros(unknowns);
            let mut sum = 0.0;
            for (view, corners) in views.iter().enumerate() {
                sum += state.accumulate(board, view, corners, &mut normal, &mut gradient);
            }
            (normal, gradient, sum)
        };
        let (mut normal, mut gradient, mut sum) = assemble(self);
        let mut damping = 1e-3;
        for _ in 0..200 {
            let size = unknowns - first;
            let mut damped = normal.view((first, first), (size, size)).into_owned();
            for index in 0..size {
                damped[(index, index)] *= 1.0 + damping;
            }
            let right = gradient.rows(first, size).into_owned();
            let solved = damped.cholesky()?.solve(&right);
            let mut step = DVector::zeros(unknowns);
            step.rows_mut(first, size).copy_from(&-&solved);
            let moved = self.moved(&step);
            let in_front = (0..views.len())
                .all(|view| (0..board.corners()).all(|k| moved.seen(board, view, k).z > 1e-6));
            let (new_normal, new_gradient, new_sum) = assemble(&moved);
            if in_front && new_sum.is_finite() && new_sum <= sum {
                let gained = sum - new_sum;
                *self = moved;
                (normal, gradient, sum) = (new_normal, new_gradient, new_sum);
                damping = (damping * 0.3).max(1e-12);
                if gained <= 1e-13 * sum.max(1e-12) {
                    return Some(normal);
                }
            } else {
                damping *= 8.0;
                if damping > 1e12 {
                    return Some(normal);
                }
            }
        }
        Some(normal)
    }
}
