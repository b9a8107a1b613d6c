//! A torsional spring between the material frames of two rods.
//!
//! Let A and B be the rotations of the frames since they were placed, and Q₀ the rotation of the
//! second frame relative to the first at which there is no moment. The spring is at rest at B = A
//! Q₀. The rotation from there,
//!
//! ```text
//! B Q₀ᵀ Aᵀ = exp([θ]×),   ‖θ‖ ≤ π,   E = ½ c ‖θ‖²
//! ```
//!
//! turns the second frame by the excess angle ‖θ‖ about an axis in the fixed frame: the moment per
//! angle c is the same about all axes. Turning A by φ and B by ψ, also in the fixed frame, changes
//! θ by J⁻¹ ψ − J⁻ᵀ φ with the left Jacobian J(θ) of the rotation group
//! ([`rotation::left_jacobian`]; Solà et al. 2018, Eqs. 143 to 146). J maps θ to itself, J⁻¹ θ =
//! J⁻ᵀ θ = θ. So
//!
//! ```text
//! T_B = ∂E/∂ψ = c θ,      ∂T_B/∂ψ = c J⁻¹,    ∂T_B/∂φ = −c J⁻ᵀ
//! T_A = ∂E/∂φ = −c θ,     ∂T_A/∂φ = c J⁻ᵀ,    ∂T_A/∂ψ = −c J⁻¹
//! ```
//!
//! The moments are opposite, so that angular momentum is conserved. Joints need only the symmetric
//! part S of the derivative of a moment with respect to the rotation of its own frame, D = S − ½
//! [T]× ([`super::super::joints`]), which is ½ c (J⁻¹ + J⁻ᵀ).
//!
//! At half a turn, ‖θ‖ = π, the energy has a ridge: beyond it the spring turns back the shorter
//! way.

use super::super::clamps::Drive;
use super::super::joints::Joints;
use crate::linalg::{Element, ElementMatrix, UNUSED};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::add_to_node;
use crate::mechanics::{Matrix3, UnitQuaternion, Vector3, rotation};

/// Indices of the angles of both frames' hinges among the unknowns of the spring's element, after
/// the rotations.
const HINGES: [usize; 2] = [6, 7];

/// Frame with which one end turns.
#[derive(Clone, Copy, Debug)]
pub(super) enum SpringEnd {
    /// A frame of the joints, by its index.
    Frame(usize),
    /// A clamp, by its number.
    Clamp(usize),
    /// A rod at rest.
    Held,
}

/// A spring between two frames.
#[derive(Clone, Debug)]
pub(super) struct FrameSpring {
    /// Index of the spring in the scene.
    pub number: usize,
    /// Frames with the rotations A and B.
    pub ends: [SpringEnd; 2],
    /// c, N m/rad.
    pub stiffness: f64,
    /// Q₀.
    pub rest: UnitQuaternion,
    /// θ, rad.
    pub vector: Vector3,
}

impl FrameSpring {
    /// Updates the spring from frames and from clamps at a time (s).
    pub(crate) fn turn(&mut self, joints: &Joints, drives: &[Drive], time: f64) {
        let [first, second] = self.ends.map(|end| match end {
            SpringEnd::Frame(number) => joints.rotation(number),
            SpringEnd::Clamp(number) => drives[number].rotation(time),
            SpringEnd::Held => UnitQuaternion::identity(),
        });
        self.vector = rotation::to_vector(&(second * self.rest.inverse() * first.inverse()));
    }

    /// E, J.
    pub(crate) fn energy(&self) -> f64 {
        0.5 * self.stiffness * self.vector.norm_squared()
    }

    /// Derivatives of the energy with respect to rotations of both ends, N m.
    pub(crate) fn moments(&self) -> [Vector3; 2] {
        let moment = self.vector * self.stiffness;
        [-moment, moment]
    }

    /// The derivative of a moment with respect to the rotation of its own frame, except −½ [T]×,
    /// and that of the moment on the first frame with respect to the rotation of the second, N m.
    fn derivatives(&self) -> [Matrix3; 2] {
        let across = rotation::inverse_left_jacobian(&self.vector) * self.stiffness;
        [(across + across.transpose()) * 0.5, -across]
    }

    /// Adds the moments on frames, in the fixed frame, to `gradient`.
    pub(crate) fn add_gradient(&self, joints: &Joints, gradient: &mut [f64]) {
        for (end, moment) in self.ends.iter().zip(self.moments()) {
            if let SpringEnd::Frame(number) = *end {
                let place = joints.frames[number].first_unknown / STRIDE;
                add_to_node(gradient, place, &moment);
            }
        }
    }

    /// The unknowns of the spring: the rotations of the groups of both frames, then the angles of
    /// their hinges.
    pub(crate) fn element(&self, joints: &Joints) -> Element {
        let mut element = [UNUSED; 12];
        for (end, side) in self.ends.iter().enumerate() {
            if let SpringEnd::Frame(number) = *side {
                let (first, hinge) = joints.unknowns_of_frame(number);
                for axis in 0..3 {
                    element[3 * end + axis] = first + axis;
                }
                element[HINGES[end]] = hinge.unwrap_or(UNUSED);
            }
        }
        element
    }

    /// Adds second derivatives at `unknowns` to the matrix of the element. The contribution of the
    /// moments as rotation vectors change is added by the frames.
    pub(crate) fn add_hessian(
        &self,
        joints: &Joints,
        unknowns: &[f64],
        matrix: &mut ElementMatrix,
    ) {
        let [own, across] = self.derivatives();
        let blocks = [[own, across], [across.transpose(), own]];
        // Rotations of the ends per unknown, one column each.
        let mut rates = [[Vector3::zeros(); 8]; 2];
        for (end, side) in self.ends.iter().enumerate() {
            if let SpringEnd::Frame(number) = *side {
                let (jacobian, axis) = joints.rates_of_frame(number, unknowns);
                for column in 0..3 {
                    rates[end][3 * end + column] = jacobian.column(column).into_owned();
                }
                rates[end][HINGES[end]] = axis.unwrap_or_else(Vector3::zeros);
            }
        }
        for (of_row, blocks) in rates.iter().zip(&blocks) {
            for (of_column, block) in rates.iter().zip(blocks) {
                for (row, by_row) in matrix.iter_mut().zip(of_row) {
                    for (entry, by_column) in row.iter_mut().zip(of_column) {
                        *entry += by_row.dot(&(block * by_column));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring at rest at a given rotation, with its ends turned from there.
    fn turned(rest: Vector3, first: &UnitQuaternion, second: &UnitQuaternion) -> FrameSpring {
        let rest = rotation::from_vector(rest);
        let vector = rotation::to_vector(&(second * rest.inverse() * first.inverse()));
        FrameSpring {
            number: 0,
            ends: [SpringEnd::Held; 2],
            stiffness: 0.7,
            rest,
            vector,
        }
    }

    #[test]
    fn moments_and_their_derivatives_are_those_of_the_energy_up_to_half_a_turn() {
        let rest = Vector3::new(0.3, -1.2, 0.5);
        let first = rotation::from_vector(Vector3::new(-0.9, 0.4, 1.1));
        let direction = Vector3::new(0.48, -0.6, 0.64);
        for angle in [0.0, 1e-4, 0.0999, 0.1001, 1.0, 2.5, 3.1] {
            let over = rotation::from_vector(direction * angle);
            let second = over * first * rotation::from_vector(rest);
            let here = turned(rest, &first, &second);
            assert!((here.vector.norm() - angle).abs() < 1e-14);
            let step = 1e-3;
            for (end, moment) in here.moments().iter().enumerate() {
                for axis in 0..3 {
                    let moved = |by: f64| {
                        let turn = rotation::from_vector(Vector3::ith(axis, by * step));
                        match end {
                            0 => turned(rest, &(turn * first), &second),
                            _ => turned(rest, &first, &(turn * second)),
                        }
                    };
                    let slope = |value: &dyn Fn(FrameSpring) -> f64| {
                        let [near, far] = [1.0, 2.0].map(|by| value(moved(by)) - value(moved(-by)));
                        (8.0 * near - far) / (12.0 * step)
                    };
                    let error = slope(&|spring| spring.energy()) - moment[axis];
                    assert!(error.abs() < 1e-9, "{angle}: {error:e}");
                    let [own, across] = here.derivatives();
                    let own = own - moment.cross_matrix() * 0.5;
                    let across = if end == 0 { across.transpose() } else { across };
                    for row in 0..3 {
                        let error = slope(&|spring| spring.moments()[end][row]) - own[(row, axis)];
                        assert!(error.abs() < 1e-9, "{angle}: {error:e}");
                        let other = slope(&|spring| spring.moments()[1 - end][row]);
                        let error = other - across[(row, axis)];
                        assert!(error.abs() < 1e-9, "{angle}: {error:e}");
                    }
                }
            }
        }
    }
}
