//! Half vertices between a rod and a joint or body, whose ghost edge rotates with the joint or
//! body.
//!
//! The energy of a vertex is a function of two edges and of the spins of their frames. The ghost
//! edge is a unit vector t with a material frame. Both rotate by the rotation ψ of the joint:
//! along t(s) = exp(s[ψ]×) t the frame spins by s ψ·t relative to parallel transport, up to terms
//! of third order. So with g = ∂E/∂t and the spin moment m
//!
//! ```text
//! ∂E/∂ψ = T = t × g + m t                                    the moment of the joint on the rod
//! ∂²E/∂ψ² = Aᵀ H A + sym(g⊗t) − (g·t) 1,    A ψ = (ψ × t, ψ·t)
//! ```
//!
//! with the Hessian H with respect to t and its spin; the second derivative is that along
//! exp(s[ψ]×). The first node of the ghost edge is the node of the joint, so that the forces on
//! both add up.

use super::vertex_lanes::{GradientLanes, HessianLanes, VERTEX_UNKNOWNS};
use crate::linalg::ElementMatrix;
use crate::mechanics::{Matrix3, Vector3};
use nalgebra::{SMatrix, SVector};

/// Unknowns of such a half vertex: start of the real edge, its angle, its end, and the rotation of the ghost.
pub(crate) const TURNING_UNKNOWNS: usize = 10;
/// Index of the rotation among them.
pub(crate) const TURNING_ROTATION: usize = 7;

/// The ghost edge of a half vertex.
pub(super) struct TurningGhost {
    /// Unit vector t of the ghost edge.
    pub tangent: Vector3,
    /// Whether it is the edge before.
    pub is_first: bool,
}

impl TurningGhost {
    /// Derivatives of the unknowns of the vertex over those of the half vertex.
    fn jacobian(&self) -> SMatrix<f64, VERTEX_UNKNOWNS, TURNING_UNKNOWNS> {
        let mut jacobian = SMatrix::zeros();
        let turn = -self.tangent.cross_matrix();
        // Start indices, among the unknowns of the vertex, of the real edge, of the far end of the
        // ghost, of its near end, and of its spin.
        let (real, far, near, spin) = if self.is_first {
            (4, 0, 0, 3)
        } else {
            (0, 8, 4, 7)
        };
        for k in 0..TURNING_ROTATION {
            jacobian[(real + k, k)] = 1.0;
        }
        let sign = if self.is_first { -1.0 } else { 1.0 };
        for i in 0..3 {
            jacobian[(far + i, near + i)] = 1.0;
            for j in 0..3 {
                jacobian[(far + i, TURNING_ROTATION + j)] = sign * turn[(i, j)];
            }
            jacobian[(spin, TURNING_ROTATION + i)] = self.tangent[i];
        }
        jacobian
    }

    /// Force with respect to the unit vector, g, N m.
    fn force(&self, local: &GradientLanes, lane: usize) -> Vector3 {
        let (far, sign) = if self.is_first { (0, -1.0) } else { (8, 1.0) };
        Vector3::from_fn(|axis, _| sign * local[far + axis][lane])
    }

    /// The gradient with respect to the unknowns of the half vertex.
    pub(crate) fn gradient(&self, local: &GradientLanes, lane: usize) -> [f64; TURNING_UNKNOWNS] {
        let local = SVector::<f64, VERTEX_UNKNOWNS>::from_fn(|k, _| local[k][lane]);
        (self.jacobian().transpose() * local).into()
    }

    /// Adds the Hessian with respect to the unknowns of the half vertex to an element.
    pub(crate) fn add_hessian(
        &self,
        local: &GradientLanes,
        hessians: &HessianLanes,
        lane: usize,
        element: &mut ElementMatrix,
    ) {
        let hessian = SMatrix::<f64, VERTEX_UNKNOWNS, VERTEX_UNKNOWNS>::from_fn(|i, j| {
            let (row, column) = (i.max(j), i.min(j));
            hessians[column][row - column][lane]
        });
        let jacobian = self.jacobian();
        let mut over = jacobian.transpose() * hessian * jacobian;
        let force = self.force(local, lane);
        let bent = force * self.tangent.transpose();
        let bent = (bent + bent.transpose()) * 0.5 - Matrix3::identity() * force.dot(&self.tangent);
        let mut rotation = over.fixed_view_mut::<3, 3>(TURNING_ROTATION, TURNING_ROTATION);
        rotation += bent;
        for i in 0..TURNING_UNKNOWNS {
            for j in 0..TURNING_UNKNOWNS {
                element[i][j] += over[(i, j)];
            }
        }
    }
}
