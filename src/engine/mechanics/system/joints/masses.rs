//! Mass matrices and Jacobians of joined nodes, frames and bodies, as dense matrices.

use super::Joints;
use super::border::constraint;
use crate::linalg::SharedUnknown;
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::add_to_node;

impl Joints {
    /// Converts a mass matrix of all nodes and tips of bodies to one over the free unknowns, Pᵀ M
    /// P, with frames as placed.
    pub(crate) fn gather_masses(&self, unknowns: &[f64], matrix: &mut nalgebra::DMatrix<f64>) {
        for (number, frame) in self.frames.iter().enumerate() {
            let Some((first, tips)) = frame.tips(&self.rotations[number]) else {
                continue;
            };
            // ṗ = ω × p for the rotation of the base, and of the hinge about its axis.
            let (jacobian, axis) = self.rates_of_frame(number, unknowns);
            let (of_base, hinge) = self.unknowns_of_frame(number);
            let rates_of = |arm: &Vector3| -> Vec<(usize, Vector3)> {
                let turned = -arm.cross_matrix() * jacobian;
                let rates = (0..3).map(|i| (of_base + i, turned.column(i).into_owned()));
                let about_axis = hinge
                    .zip(axis)
                    .map(|(hinge, axis)| (hinge, axis.cross(arm)));
                rates.chain(about_axis).collect()
            };
            let add =
                |matrix: &mut nalgebra::DMatrix<f64>, mass: f64, rates: &[(usize, Vector3)]| {
                    for (i, one) in rates {
                        for (j, other) in rates {
                            matrix[(*i, *j)] += mass * one.dot(other);
                        }
                    }
                };
            for (k, tip) in tips.iter().enumerate() {
                let mass = matrix[(first + STRIDE * k, first + STRIDE * k)];
                add(matrix, mass, &rates_of(tip));
            }
            if let Some(eccentric) = &frame.eccentric {
                let rates = rates_of(&eccentric.arm_of(&tips));
                add(matrix, eccentric.mass, &rates);
                for (unknown, rate) in &rates {
                    for axis in 0..3 {
                        let node = STRIDE * eccentric.node + axis;
                        matrix[(node, *unknown)] += eccentric.mass * rate[axis];
                        matrix[(*unknown, node)] += eccentric.mass * rate[axis];
                    }
                }
            }
        }
        for SharedUnknown { unknown, owner } in self.shared() {
            let row = matrix.row(unknown).clone_owned();
            let mut owners = matrix.row_mut(owner);
            owners += row;
            let column = matrix.column(unknown).clone_owned();
            let mut owners = matrix.column_mut(owner);
            owners += column;
            matrix.row_mut(unknown).fill(0.0);
            matrix.column_mut(unknown).fill(0.0);
        }
        self.reduce(matrix);
    }

    /// Converts a Jacobian over the owners of all positions, with some `held` unknowns, to one
    /// over the free unknowns.
    pub(crate) fn reduce_jacobian(&self, matrix: &mut nalgebra::DMatrix<f64>, held: &[bool]) {
        self.reduce(matrix);
        for slide in &self.slides {
            let weights = &slide.grip.weights;
            matrix[(slide.unknown, slide.unknown)] += slide.over_parameter();
            let turning = [slide.over_tangent(), slide.residual].map(|force| {
                let mut turning = vec![0.0; held.len()];
                for (node, slope) in weights.nodes.iter().zip(&weights.slopes) {
                    add_to_node(&mut turning, *node, &(force * *slope));
                }
                self.gather_points(&mut turning);
                turning
            });
            for k in 0..held.len() {
                matrix[(slide.unknown, k)] += turning[0][k];
                matrix[(k, slide.unknown)] += turning[1][k];
            }
            if let Some(stiffness) = slide.stiffness {
                for axis in 0..3 {
                    let [mut apart, mut pull] =
                        [slide.follow.tangent, slide.along()].map(|along| {
                            let mut column = constraint(slide, weights, axis, held.len());
                            self.gather_points(&mut column);
                            column[slide.unknown] = along[axis];
                            nalgebra::DVector::from_vec(column)
                        });
                    if slide.is_stopped {
                        (apart[slide.unknown], pull[slide.unknown]) = (0.0, 0.0);
                    }
                    *matrix += pull * apart.transpose() * stiffness;
                }
            }
        }
        for node in self.carried_nodes() {
            for own in STRIDE * node..STRIDE * node + 3 {
                matrix[(own, own)] = 1.0;
            }
        }
        if self.slides.is_empty() && self.pins.is_empty() {
            return;
        }
        for k in (0..held.len()).filter(|k| held[*k]) {
            matrix.row_mut(k).fill(0.0);
            matrix.column_mut(k).fill(0.0);
            matrix[(k, k)] = 1.0;
        }
    }

    /// Converts a matrix over the owners of all positions to one over the free unknowns: Pᵀ M P
    /// over the unknowns that sliding nodes follow.
    fn reduce(&self, matrix: &mut nalgebra::DMatrix<f64>) {
        for slide in (self.slides.iter()).filter(|slide| slide.stiffness.is_none()) {
            let own = STRIDE * slide.node;
            let mut rates = nalgebra::DMatrix::zeros(matrix.nrows(), 3);
            for axis in 0..3 {
                let mut column = vec![0.0; matrix.nrows()];
                column[own + axis] = 1.0;
                slide.gather(&mut column);
                self.gather_points(&mut column);
                rates.column_mut(axis).copy_from_slice(&column);
            }
            // Friction acts on s, but does not move the node.
            let mut moves = rates.clone();
            if let Some(rubbing) = slide.rubbing.as_ref().filter(|_| !slide.is_stopped) {
                let mut along = moves.row_mut(slide.unknown);
                along -= rubbing.over_force.transpose();
            }
            let block = matrix.fixed_view::<3, 3>(own, own).clone_owned();
            let mut rows = matrix.rows(own, 3).clone_owned();
            let mut columns = matrix.columns(own, 3).clone_owned();
            rows.columns_mut(own, 3).fill(0.0);
            columns.rows_mut(own, 3).fill(0.0);
            matrix.rows_mut(own, 3).fill(0.0);
            matrix.columns_mut(own, 3).fill(0.0);
            *matrix += &rates * rows + columns * moves.transpose();
            *matrix += &rates * block * moves.transpose();
        }
        for pin in &self.pins {
            for axis in 0..3 {
                let own = STRIDE * pin.node + axis;
                for (unknown, rate) in pin.rates(axis) {
                    let row = matrix.row(own) * rate;
                    let mut rows = matrix.row_mut(unknown);
                    rows += row;
                }
                matrix.row_mut(own).fill(0.0);
                for (unknown, rate) in pin.rates(axis) {
                    let column = matrix.column(own) * rate;
                    let mut columns = matrix.column_mut(unknown);
                    columns += column;
                }
                matrix.column_mut(own).fill(0.0);
            }
        }
    }
}
