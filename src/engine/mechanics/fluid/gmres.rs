//! The generalised minimal residual method with right preconditioning (Saad 2003, Alg. 9.5).

use super::flow::Flow;
use super::preconditioner::Preconditioner;
use crate::linalg::instruction_set::{LANES, Lanes};

/// Directions kept before a restart. A solve takes 1 to 20 iterations, so restarts are rare.
const RESTART: usize = 40;

/// Scratch of the method.
pub(super) struct Gmres {
    /// Orthonormal Krylov basis.
    basis: Vec<Vec<f64>>,
    /// Columns of the Hessenberg matrix, made triangular by the rotations.
    columns: Vec<[f64; RESTART]>,
    /// Givens rotations (cosine, sine).
    rotations: [(f64, f64); RESTART],
    /// Rotated right-hand side of the small least-squares problem.
    rotated: [f64; RESTART + 1],
    combination: Vec<f64>,
    /// A preconditioned vector: the newest direction, at the end the combination of all.
    preconditioned: Vec<f64>,
}

/// Result of a solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Convergence {
    pub iterations: usize,
    /// ‖b − A x‖.
    pub residual: f64,
}

impl Gmres {
    /// Scratch for `unknowns` unknowns.
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            basis: vec![vec![0.0; unknowns]; RESTART + 1],
            columns: vec![[0.0; RESTART]; RESTART],
            rotations: [(1.0, 0.0); RESTART],
            rotated: [0.0; RESTART + 1],
            combination: vec![0.0; unknowns],
            preconditioned: vec![0.0; unknowns],
        }
    }

    /// Improves `solution`, whose residual b − A x is `residual`, until ‖b − A x‖ ≤ `tolerance`,
    /// `most` iterations have been spent, or a NaN occurs.
    pub(crate) fn solve(
        &mut self,
        operator: &mut Flow,
        preconditioner: &mut Preconditioner,
        residual: &mut [f64],
        solution: &mut [f64],
        tolerance: f64,
        most: usize,
    ) -> Convergence {
        let mut iterations = 0;
        let mut norm = dot(residual, residual).sqrt();
        while norm > tolerance && iterations < most {
            self.begin(residual, norm);
            let mut size = 0;
            while size < RESTART && iterations < most && norm > tolerance {
                norm = self.extend(size, operator, preconditioner);
                size += 1;
                iterations += 1;
            }
            self.combine(size);
            preconditioner.apply(&self.combination, &mut self.preconditioned);
            add_multiple(1.0, &self.preconditioned, solution);
            if norm > tolerance {
                let image = &mut self.combination;
                operator.multiply(&self.preconditioned, image);
                add_multiple(-1.0, image, residual);
                norm = dot(residual, residual).sqrt();
            }
        }
        Convergence {
            iterations,
            residual: norm,
        }
    }

    fn begin(&mut self, residual: &[f64], norm: f64) {
        self.basis[0].copy_from_slice(residual);
        scale(1.0 / norm, &mut self.basis[0]);
        self.rotated = [0.0; RESTART + 1];
        self.rotated[0] = norm;
    }

    /// Adds direction j + 1 to the basis. Returns the residual of the best combination so far.
    fn extend(
        &mut self,
        j: usize,
        operator: &mut Flow,
        preconditioner: &mut Preconditioner,
    ) -> f64 {
        let (known, rest) = self.basis.split_at_mut(j + 1);
        let new = &mut rest[0];
        preconditioner.apply(&known[j], &mut self.preconditioned);
        operator.multiply(&self.preconditioned, new);
        let column = &mut self.columns[j];
        for (direction, entry) in known.iter().zip(column.iter_mut()) {
            *entry = dot(direction, new);
            add_multiple(-*entry, direction, new);
        }
        let length = dot(new, new).sqrt();
        if length > 0.0 {
            scale(1.0 / length, new);
        }
        for (i, &(cosine, sine)) in self.rotations[..j].iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            column[i] = cosine * a + sine * b;
            column[i + 1] = cosine * b - sine * a;
        }
        let radius = (column[j] * column[j] + length * length).sqrt();
        let (cosine, sine) = (column[j] / radius, length / radius);
        self.rotations[j] = (cosine, sine);
        column[j] = radius;
        self.rotated[j + 1] = -sine * self.rotated[j];
        self.rotated[j] *= cosine;
        self.rotated[j + 1].abs()
    }

    /// The combination of the first `size` directions with the smallest residual.
    fn combine(&mut self, size: usize) {
        let coordinates = &mut self.rotated;
        for i in (0..size).rev() {
            for j in i + 1..size {
                coordinates[i] -= self.columns[j][i] * coordinates[j];
            }
            coordinates[i] /= self.columns[i][i];
        }
        self.combination.fill(0.0);
        for (direction, &coordinate) in self.basis[..size].iter().zip(&*coordinates) {
            add_multiple(coordinate, direction, &mut self.combination);
        }
    }
}

/// Scalar product, summed in a fixed order that vectorises.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums: Lanes = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a
        .remainder()
        .iter()
        .zip(b.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a.zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// `y` += `factor` `x`.
pub(super) fn add_multiple(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// `x` *= `factor`.
pub(super) fn scale(factor: f64, x: &mut [f64]) {
    for x in x {
        *x *= factor;
    }
}
