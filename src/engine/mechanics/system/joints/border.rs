//! The Newton system with sliding nodes: the system of the rods without slides, with a border.
//!
//! Let δ be the moves of all nodes, which are free as if without the joints, η the change of the
//! force of each joint, and σ the change of its parameter. Then
//!
//! ```text
//! ⎡ K    L ⎤ ⎡ δ ⎤     ⎡ r ⎤      L = [ W − E | w' R ],      D = ⎡ 0      X'    ⎤
//! ⎣ Nᵀ   D ⎦ ⎣ z ⎦  =  ⎣ s ⎦ ,    z = (η, σ),                    ⎣ X'ᵀ    R·X'' ⎦
//! ```
//!
//! where E selects the sliding node and W the nodes that carry it: the first rows of the border
//! are δx = W δq + X' σ. For a joint that yields, they are δx + η/k = W δq + X' σ, with −1/k in D. A
//! node that is a point of a free body has these rows alone, with the unknowns of the body and
//! without σ. N is L except in the middle of a step, where the node moves by weights other than
//! those of its force ([`super::slide`]), and with friction, which adds to the last row
//! ([`super::rubbing`]). So K keeps its pattern wherever a node slides, and a band remains a band.
//! The price is four additional solutions per joint and a small dense matrix, S = D − Nᵀ K⁻¹ L. The
//! numbers of negative eigenvalues of K and S add up to that of the whole matrix (Haynsworth 1968);
//! three of them per joint belong to the constraints.

use super::Joints;
use super::slide::Slide;
use super::track::Weights;
use crate::linalg::{Inertia, SingularMatrix};
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Unknowns of a slide in the border: its force, and its parameter.
const OWN: usize = 4;
/// Unknowns of a point of a free body: its force.
const OF_PIN: usize = 3;

/// Factors of the border; empty without sliding nodes and points of free bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Border {
    /// Values of the border when it was factored.
    slides: Vec<Slide>,
    /// Number of points of free bodies.
    pins: usize,
    /// Entries of Nᵀ and their unknowns: a row for each unknown of the border.
    rows: Vec<Vec<(usize, f64)>>,
    /// Columns of K⁻¹ L.
    solutions: Vec<Vec<f64>>,
    /// S.
    schur: Option<LU<f64, Dyn, Dyn>>,
}

type Solved = Result<(), SingularMatrix>;

impl Border {
    /// Factors the border of `joints` over unknowns, some of which are `held`. `diagonals` are the
    /// diagonal entries of the matrix at the parameters, and `solve` solves with K. Converts the
    /// inertia of K to that of the whole matrix.
    ///
    /// # Errors
    /// The errors of `solve`, and a singular matrix S.
    pub(crate) fn factor(
        &mut self,
        joints: &Joints,
        held: &[bool],
        diagonals: &[f64],
        inertia: Option<Inertia>,
        mut solve: impl FnMut(&mut [f64]) -> Solved,
    ) -> Result<Option<Inertia>, SingularMatrix> {
        self.slides.clone_from(&joints.slides);
        self.pins = joints.pins.len();
        let size = OWN * self.slides.len() + OF_PIN * self.pins;
        let (mut columns, mut rows) = (Vec::with_capacity(size), Vec::with_capacity(size));
        let mut schur = DMatrix::zeros(size, size);
        for (number, slide) in self.slides.iter().enumerate() {
            let first = OWN * number;
            for axis in 0..3 {
                columns.push(constraint(slide, &slide.grip.weights, axis, held.len()));
                rows.push(constraint(slide, &slide.follow.weights, axis, held.len()));
                if let Some(stiffness) = slide.stiffness {
                    schur[(first + axis, first + axis)] = -1.0 / stiffness;
                }
                if !slide.is_stopped {
                    schur[(first + axis, first + 3)] = slide.follow.tangent[axis];
                    schur[(first + 3, first + axis)] = slide.along()[axis];
                }
            }
            columns.push(turning(slide, &slide.residual, held.len()));
            rows.push(turning(slide, &slide.over_tangent(), held.len()));
            schur[(first + 3, first + 3)] = if slide.is_stopped {
                1.0
            } else {
                slide.over_parameter() + diagonals[number]
            };
        }
        for pin in &joints.pins {
            for axis in 0..OF_PIN {
                columns.push(pin.constraint(axis, held.len()));
                rows.push(pin.constraint(axis, held.len()));
            }
        }
        for column in columns.iter_mut().chain(&mut rows) {
            joints.gather_points(column);
            for (entry, _) in column.iter_mut().zip(held).filter(|(_, held)| **held) {
                *entry = 0.0;
            }
        }
        self.rows = rows.iter().map(|row| entries(row)).collect();
        for column in &mut columns {
            solve(column)?;
        }
        for (i, row) in self.rows.iter().enumerate() {
            for (j, column) in columns.iter().enumerate() {
                schur[(i, j)] -= dot(row, column);
            }
        }
        self.solutions = columns;
        let inertia = inertia.map(|inertia| self.whole(inertia, &schur));
        let factors = schur.lu();
        if !factors.is_invertible() {
            let of_slide = self.slides.first().map(|slide| slide.unknown);
            let of_pin = joints.pins.first().map(|pin| STRIDE * pin.node);
            return Err(SingularMatrix {
                unknown: of_slide.or(of_pin).unwrap_or_default(),
                pivot: 0.0,
            });
        }
        self.schur = Some(factors);
        Ok(inertia)
    }

    /// Solves in place with the factors of the last [`Self::factor`], first for the unknowns
    /// without joints, then for the parameters; `solve` solves with K.
    ///
    /// # Errors
    /// The errors of `solve`.
    pub(crate) fn solve(
        &self,
        right_hand_side: &mut [f64],
        solve: impl FnOnce(&mut [f64]) -> Solved,
    ) -> Solved {
        let Some(schur) = &self.schur else {
            return solve(right_hand_side);
        };
        let mut own = DVector::zeros(OWN * self.slides.len() + OF_PIN * self.pins);
        for (number, slide) in self.slides.iter().enumerate() {
            let along = std::mem::take(&mut right_hand_side[slide.unknown]);
            if !slide.is_stopped {
                own[OWN * number + 3] = along;
            }
        }
        solve(right_hand_side)?;
        for (row, entry) in self.rows.iter().zip(own.iter_mut()) {
            *entry -= dot(row, right_hand_side);
        }
        // `factor` has rejected singular matrices.
        schur.solve_mut(&mut own);
        for (solution, part) in self.solutions.iter().zip(own.iter()) {
            for (entry, solution) in right_hand_side.iter_mut().zip(solution) {
                *entry -= part * solution;
            }
        }
        for (number, slide) in self.slides.iter().enumerate() {
            right_hand_side[slide.unknown] = own[OWN * number + 3];
        }
        Ok(())
    }

    /// Transfers the forces on sliding nodes to the nodes that carry them, as when the border was factored.
    pub(crate) fn gather(&self, forces: &mut [f64]) {
        self.slides.iter().for_each(|slide| slide.gather(forces));
    }

    /// Moves the sliding nodes, as when the border was factored.
    pub(crate) fn spread(&self, moves: &mut [f64]) {
        self.slides.iter().for_each(|slide| slide.spread(moves));
    }

    /// The inertia of the Newton system of the free unknowns from that of K, which counts each
    /// parameter as a positive eigenvalue and each sliding node as free.
    fn whole(&self, of_rods: Inertia, schur: &DMatrix<f64>) -> Inertia {
        let (mut forces, mut along) = (Vec::new(), Vec::new());
        for (number, slide) in self.slides.iter().enumerate() {
            forces.extend(OWN * number..OWN * number + 3);
            if !slide.is_stopped {
                along.push(OWN * number + 3);
            }
        }
        let of_pins = OWN * self.slides.len()..schur.nrows();
        forces.extend(of_pins);
        let part = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| {
                schur[(rows[i], columns[j])]
            })
        };
        let negative = |matrix: DMatrix<f64>| {
            if matrix.is_empty() {
                return 0;
            }
            let eigenvalues = matrix.symmetric_eigenvalues();
            eigenvalues.iter().filter(|value| **value < 0.0).count()
        };
        // Each in turn, since they have different units.
        let between = part(&forces, &along);
        let of_forces = part(&forces, &forces);
        let carried = of_forces.clone().lu().solve(&between);
        let of_parameters = carried.map(|carried| {
            let own = part(&along, &along);
            own - between.transpose() * carried
        });
        let negative = of_rods.negative + negative(of_forces) + of_parameters.map_or(0, negative);
        let constraints = forces.len();
        let all = of_rods.positive + of_rods.negative;
        let negative = negative.saturating_sub(constraints);
        Inertia {
            negative,
            positive: all - constraints - negative,
            ..of_rods
        }
    }
}

/// A column of W − E.
pub(super) fn constraint(slide: &Slide, weights: &Weights, axis: usize, size: usize) -> Vec<f64> {
    let mut column = vec![0.0; size];
    for (node, weight) in weights.nodes.iter().zip(&weights.values) {
        column[STRIDE * node + axis] += weight;
    }
    column[STRIDE * slide.node + axis] -= 1.0;
    column
}

/// w' R with a force R; zero if a stop holds the node.
fn turning(slide: &Slide, residual: &Vector3, size: usize) -> Vec<f64> {
    let mut column = vec![0.0; size];
    if !slide.is_stopped {
        let weights = &slide.grip.weights;
        for (node, slope) in weights.nodes.iter().zip(&weights.slopes) {
            let force: Vector3 = residual * *slope;
            for axis in 0..3 {
                column[STRIDE * node + axis] += force[axis];
            }
        }
    }
    column
}

/// The nonzero entries of a vector.
fn entries(row: &[f64]) -> Vec<(usize, f64)> {
    let all = row.iter().copied().enumerate();
    all.filter(|(_, entry)| *entry != 0.0).collect()
}

fn dot(row: &[(usize, f64)], column: &[f64]) -> f64 {
    row.iter().map(|(k, entry)| entry * column[*k]).sum()
}
