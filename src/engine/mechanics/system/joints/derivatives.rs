//! Conversion of derivatives with respect to rotations of frames to those with respect to the
//! unknowns.
//!
//! Kernels compute moments T and their derivatives D = ∂T/∂ψ with respect to rotations ψ in the
//! fixed frame. For ends of a rotation this is D = S − ½ [T]× with the second derivative S along
//! exp([ψ]×). With respect to ℓφ, moment and derivative are
//!
//! ```text
//! Jᵀ T/ℓ,     (Jᵀ D J + ∂(Jᵀ T)/∂φ)/ℓ²
//! ```
//!
//! which is symmetric. For a hinge with the axis a in the fixed frame, the moment T' on its frame
//! contributes to T and to the moment a·T' on its angle; the derivative of T with respect to the
//! angle is D' a.

use super::super::Stage;
use super::Joints;
use crate::linalg::ElementMatrix;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{STRIDE, TURNING_ROTATION};
use crate::mechanics::{Matrix3, Vector3, rotation};

/// Index of the angle of a hinge among the unknowns of a half vertex, and of the element of a frame.
pub(super) const HINGE: usize = TURNING_ROTATION + 3;
pub(super) const OWN_HINGE: usize = 3;
/// Index of the position of the node in the element of a frame with a body whose centre of mass is
/// away from the node.
pub(super) const OWN_NODE: usize = 6;

impl Joints {
    /// Derivatives of the rotation of a frame, in the fixed frame, at the last evaluation, which
    /// was at `unknowns`: J/ℓ with respect to the rotation ℓφ of its group, and the axis of its
    /// hinge.
    pub(crate) fn rates_of_frame(
        &self,
        number: usize,
        unknowns: &[f64],
    ) -> (Matrix3, Option<Vector3>) {
        let frame = &self.frames[number];
        let base = frame.hinge.map_or(frame, |(base, _)| &self.frames[base]);
        let jacobian = rotation::left_jacobian(&base.rotation_vector(unknowns)) / base.length;
        let axis = frame.hinge.map(|(base, axis)| self.rotations[base] * axis);
        (jacobian, axis)
    }

    /// Rotation of a frame, in the fixed frame, for a change of the unknowns; the last evaluation
    /// was at `unknowns`.
    pub(crate) fn turn_of_frame(&self, number: usize, unknowns: &[f64], change: &[f64]) -> Vector3 {
        let (jacobian, axis) = self.rates_of_frame(number, unknowns);
        let (base, hinge) = self.unknowns_of_frame(number);
        let about_axis = hinge.zip(axis).map(|(hinge, axis)| axis * change[hinge]);
        jacobian * position(change, base / STRIDE) + about_axis.unwrap_or_else(Vector3::zeros)
    }

    /// Converts the elements of half vertices, which contain second derivatives with respect to
    /// rotations in the fixed frame, and those of the frames themselves to derivatives of the
    /// residual with respect to the unknowns. In a stage, inertia and drag of the tips of bodies
    /// are 1/(h hₐ) times the masses of all unknowns and 1/h times the resistance. Call this after
    /// [`Self::gather_moments`].
    pub(crate) fn transform(
        &self,
        unknowns: &[f64],
        stage: Option<&Stage>,
        masses: &[f64],
        matrices: &mut [ElementMatrix],
    ) {
        let mut vertex_forces = self.vertex_forces.iter();
        for (number, frame) in self.frames.iter().enumerate() {
            let (jacobian, axis) = self.rates_of_frame(number, unknowns);
            for &element in &frame.elements {
                turn_with_hinge(&mut matrices[element], axis.as_ref());
                over_vector(&mut matrices[element], &jacobian);
            }
            let mut own = Matrix3::zeros();
            let moment = self.moments[number];
            if frame.hinge.is_none() {
                let bent = jacobian.transpose() * moment.cross_matrix() * jacobian * -0.5;
                let vector = frame.rotation_vector(unknowns);
                let curved = rotation::left_jacobian_derivative(&vector, &moment);
                own += bent + curved / (frame.length * frame.length);
            }
            // Of a constant force at the end of an arm.
            let turned = |arm: &Vector3, force: &Vector3| {
                let product = arm * force.transpose();
                (product + product.transpose()) * 0.5 - Matrix3::identity() * arm.dot(force)
            };
            let mut second = Matrix3::zeros();
            if let Some(vertices) = &frame.vertices {
                let pins = self.pins.iter().filter(|pin| pin.frame == number);
                let arms = vertices.arms.iter().chain(pins.map(|pin| &pin.arm));
                for (arm, force) in arms.zip(vertex_forces.by_ref()) {
                    second += turned(&(self.rotations[number] * arm), force);
                }
            }
            if let Some((first, tips)) = frame.tips(&self.rotations[number]) {
                let per_square =
                    stage.map_or(0.0, |stage| 1.0 / (stage.step * stage.acceleration_step));
                let of_force = |arm: &Vector3, per_move: f64| {
                    let square = Matrix3::identity() * arm.norm_squared();
                    (square - arm * arm.transpose()) * per_move
                };
                // Equal along all axes, as for a sphere.
                let resistance = stage
                    .and_then(|stage| Some(stage.resistance.get(first / STRIDE)?.m11 / stage.step));
                let of_drag = resistance.unwrap_or(0.0);
                for (k, tip) in tips.iter().enumerate() {
                    second += turned(tip, &self.tip_forces[number][k])
                        + of_force(tip, masses[first + STRIDE * k] * per_square + of_drag);
                }
                if let Some(stage) = stage.filter(|_| frame.vertices.is_some()) {
                    second += over_turns(stage, first, &tips, masses);
                }
                if let Some(eccentric) = &frame.eccentric {
                    let arm = eccentric.arm_of(&tips);
                    second += of_force(&arm, eccentric.mass * per_square);
                    let over = -arm.cross_matrix() * (eccentric.mass * per_square);
                    let to = &mut matrices[frame.element];
                    let mut add = |column: usize, force: Vector3| {
                        for axis in 0..3 {
                            to[OWN_NODE + axis][column] += force[axis];
                            to[column][OWN_NODE + axis] += force[axis];
                        }
                    };
                    let over_vector = over * jacobian;
                    (0..3).for_each(|column| add(column, over_vector.column(column).into_owned()));
                    axis.into_iter()
                        .for_each(|axis| add(OWN_HINGE, over * axis));
                }
            }
            if frame.body.is_some() || frame.vertices.is_some() {
                let mut whole: ElementMatrix = [[0.0; 12]; 12];
                for i in 0..3 {
                    for j in 0..3 {
                        whole[TURNING_ROTATION + i][TURNING_ROTATION + j] = second[(i, j)];
                    }
                }
                turn_with_hinge(&mut whole, axis.as_ref());
                over_vector(&mut whole, &jacobian);
                let (from, to) = (TURNING_ROTATION, &mut matrices[frame.element]);
                for i in 0..4 {
                    for j in 0..4 {
                        to[i][j] += whole[from + i][from + j];
                    }
                }
            }
            let to = &mut matrices[frame.element];
            for i in 0..3 {
                for j in 0..3 {
                    to[i][j] += own[(i, j)];
                }
            }
            if let Some(axis) = axis {
                let mixed = jacobian.transpose() * moment.cross(&axis) * -0.5;
                for i in 0..3 {
                    to[i][OWN_HINGE] += mixed[i];
                    to[OWN_HINGE][i] += mixed[i];
                }
            }
        }
    }
}

/// Fills the row and column of the angle of a hinge with those of a rotation about its axis.
fn turn_with_hinge(matrix: &mut ElementMatrix, axis: Option<&Vector3>) {
    let Some(axis) = axis else { return };
    let along = |values: [f64; 3]| Vector3::from(values).dot(axis);
    for row in matrix.iter_mut().take(HINGE) {
        row[HINGE] = along([row[HINGE - 3], row[HINGE - 2], row[HINGE - 1]]);
    }
    for column in 0..=HINGE {
        let rotation = [3, 2, 1].map(|before| matrix[HINGE - before][column]);
        matrix[HINGE][column] = along(rotation);
    }
}

/// Converts derivatives with respect to a rotation in the fixed frame to those with respect to ℓφ:
/// rows by Jᵀ, columns by J.
fn over_vector(matrix: &mut ElementMatrix, jacobian: &Matrix3) {
    let places: [usize; 3] = std::array::from_fn(|axis| TURNING_ROTATION + axis);
    for row in matrix.iter_mut() {
        let turned = jacobian.transpose() * Vector3::from(places.map(|place| row[place]));
        places
            .iter()
            .zip(turned.iter())
            .for_each(|(place, value)| row[*place] = *value);
    }
    for column in 0..12 {
        let turned =
            jacobian.transpose() * Vector3::from(places.map(|place| matrix[place][column]));
        places
            .iter()
            .zip(turned.iter())
            .for_each(|(place, value)| matrix[*place][column] = *value);
    }
}

/// Second derivative S of the moment of the spin of a free body ([`super::super::spin`]), N m: its
/// `tips` begin at an unknown.
fn over_turns(stage: &Stage, first: usize, tips: &[Vector3; 3], masses: &[f64]) -> Matrix3 {
    if !stage.keeps_spin {
        return Matrix3::zeros();
    }
    let of_tip = |(tip, p): (usize, &Vector3)| {
        let place = first / STRIDE + tip;
        let [start, velocity] = stage.tip_at_start(place);
        let moment = (p - start).cross(&velocity);
        let over = velocity.cross_matrix() * p.cross_matrix() + moment.cross_matrix() * 0.5;
        over * masses[STRIDE * place]
    };
    let sum: Matrix3 = tips.iter().enumerate().map(of_tip).sum();
    sum / stage.acceleration_step
}
