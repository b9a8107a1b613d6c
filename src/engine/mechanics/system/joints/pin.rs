//! A node of a rod that is a point of a free body.
//!
//! Its position follows the centre of mass X and the rotation R of the body, and the force f on it
//! acts on both:
//!
//! ```text
//! x = X + R d,     δx = δX + δψ × R d,     F = f,     T = R d × f
//! ```
//!
//! As that of a sliding node, its position is eliminated by the border of the matrix
//! ([`super::border`]), so that the matrix keeps the pattern of a rod.

use super::Joints;
use crate::linalg::UNUSED;
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;

/// A node that is a point of a free body.
#[derive(Clone, Debug)]
pub struct Pin {
    /// The node.
    pub node: usize,
    /// Index of the frame of the body, which has vertices.
    pub frame: usize,
    /// d, as placed, m.
    pub arm: Vector3,
    /// ∂x over the unknowns of the body at the last evaluation: an unknown and its factor for each
    /// axis of x.
    rates: [[(usize, f64); 4]; 3],
}

impl Pin {
    /// The pin of a node at the vector `arm` (m) from the centre of mass.
    pub(crate) fn new(node: usize, frame: usize, arm: Vector3) -> Self {
        Self {
            node,
            frame,
            arm,
            rates: [[(UNUSED, 0.0); 4]; 3],
        }
    }

    /// ∂x over the unknowns of the body along an axis.
    pub(super) fn rates(&self, axis: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let entries = self.rates[axis].iter().copied();
        entries.filter(|(unknown, _)| *unknown != UNUSED)
    }

    /// A row of the constraint x(X, R) − x = 0.
    pub(super) fn constraint(&self, axis: usize, size: usize) -> Vec<f64> {
        let mut row = vec![0.0; size];
        for (unknown, rate) in self.rates(axis) {
            row[unknown] += rate;
        }
        row[STRIDE * self.node + axis] -= 1.0;
        row
    }
}

impl Joints {
    /// Sets the motion of all pins to that at the last evaluation, which was at `unknowns`.
    pub(super) fn turn_pins(&mut self, unknowns: &[f64]) {
        for index in 0..self.pins.len() {
            let Pin { frame, arm, .. } = self.pins[index];
            let Some(vertices) = &self.frames[frame].vertices else {
                continue;
            };
            let centre = STRIDE * vertices.centre;
            let arm = self.rotation(frame) * arm;
            let (jacobian, axle) = self.rates_of_frame(frame, unknowns);
            let (first, angle) = self.unknowns_of_frame(frame);
            let turned = -arm.cross_matrix() * jacobian;
            for axis in 0..3 {
                let own = &mut self.pins[index].rates[axis];
                *own = [(UNUSED, 0.0); 4];
                own[0] = (centre + axis, 1.0);
                match angle.zip(axle) {
                    Some((angle, axle)) => own[1] = (angle, axle.cross(&arm)[axis]),
                    None => (0..3).for_each(|k| own[1 + k] = (first + k, turned[(axis, k)])),
                }
            }
        }
    }
}
