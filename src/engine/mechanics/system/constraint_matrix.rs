//! Matrices of contacts by complementarity over the unknowns, with free bodies.

use super::attached::AttachedNodes;
use crate::linalg::ElementMatrix;
use crate::mechanics::contact::{ConstraintPlace, ContactSystem, SpunJacobian};

/// Matrix of a constraint.
#[expect(
    clippy::large_enum_variant,
    reason = "one at a time, and used at once: contacts of rods allocate nothing"
)]
pub(crate) enum ConstraintMatrix {
    /// Over the coordinates of its nodes, N/m.
    OfNodes(ElementMatrix),
    /// Derivative of the forces on its nodes and of the moments on these bodies over their
    /// coordinates and rotations.
    OfBodies([Option<usize>; 2], Box<SpunJacobian>),
}

impl ConstraintMatrix {
    /// The matrix of the element of the constraint.
    pub(crate) fn over_unknowns(
        self,
        attached: &AttachedNodes,
        contact: &ContactSystem,
        place: ConstraintPlace,
    ) -> ElementMatrix {
        match self {
            Self::OfNodes(matrix) if attached.is_empty() => matrix,
            Self::OfNodes(matrix) => {
                let jacobian = matrix.map(|row| row.map(|entry| -entry));
                with_nodes(contact, place, |nodes| attached.matrix_of(nodes, &jacobian))
            }
            Self::OfBodies(bodies, jacobian) => with_nodes(contact, place, |nodes| {
                attached.matrix_of_spun(nodes, bodies, &jacobian)
            }),
        }
    }
}

/// Passes the nodes of a constraint that are not vertices of obstacles.
fn with_nodes<T>(
    contact: &ContactSystem,
    place: ConstraintPlace,
    pass: impl FnOnce(&[usize]) -> T,
) -> T {
    match place {
        ConstraintPlace::Candidate(candidate) => {
            let pair = &contact.candidates()[candidate];
            match contact.is_of_rod(pair.nodes[3]) {
                true => pass(&pair.nodes),
                false => pass(&pair.nodes[..pair.first_body()]),
            }
        }
        ConstraintPlace::Node(node) => pass(&[node]),
    }
}
