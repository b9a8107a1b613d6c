//! Rotation at contacts of free bodies by complementarity ([`super::constraints`]).
//!
//! The slip of a step, and the motion of the contact points along the surfaces, contain the
//! rotations of the bodies and of the edges of rods at them ([`super::body_turns`]):
//!
//! ```text
//! u = Σ w_m (x_m − x_mⁿ) + n × Σ_b h_b θ_b,     δu = Σ w_m δx_m + n × Σ_b h_b δψ_b
//! ```
//!
//! A force f at the contact acts on nodes by their weights and on bodies and edges by the moments
//! h_b f × n.

use super::body_turns::{SPUN, Spin, SpunContact, SpunJacobian, TURNS};
use super::contact_system::ContactSystem;
use super::contacts::{Bodies, ContactConstraint, EdgeJacobian};
use super::evaluation::Motion;
use crate::mechanics::{Matrix3, Vector3};

/// The rotations at a contact.
pub(crate) struct ConstraintTurns {
    spin: Spin,
    normal: Vector3,
    nodes: [usize; 4],
}

impl ContactSystem {
    /// Rotations at a constraint in a step that began at the positions `previous`, m; `None`
    /// without free bodies.
    pub(crate) fn turns_at(
        &self,
        constraint: &ContactConstraint,
        positions: &[Vector3],
        previous: &[Vector3],
    ) -> Option<ConstraintTurns> {
        if !self.has_bodies() {
            return None;
        }
        // Motions instead of velocities.
        let motion = Motion {
            positions,
            previous,
            time_step: 1.0,
        };
        let spin = match constraint.bodies {
            Bodies::Edges(candidate) => {
                self.spin_of_pair(&self.candidates.pairs()[candidate], &motion)?
            }
            Bodies::Plane(_) => self.spin_over_plane(constraint.nodes[0], motion.time_step)?,
        };
        Some(ConstraintTurns {
            spin,
            normal: constraint.normal,
            nodes: constraint.nodes,
        })
    }
}

impl ConstraintTurns {
    /// Slip by rotation since the step began, m.
    pub(crate) fn slid(&self) -> Vector3 {
        self.spin.velocity(&self.normal)
    }

    /// Slip by small rotations of bodies in the fixed frame and small moves of nodes, m.
    pub(crate) fn moved(
        &self,
        of_node: impl Fn(usize) -> Vector3,
        of_body: impl Fn(usize) -> Vector3,
    ) -> Vector3 {
        let mut swing = Vector3::zeros();
        for (body, arm) in self.spin.bodies.iter().zip(self.spin.arms) {
            swing += body.map_or_else(Vector3::zeros, &of_body) * arm;
        }
        for (side, edge) in self.spin.edges.iter().enumerate() {
            if let Some(edge) = edge {
                let [from, to] = [0, 1].map(|end| of_node(self.nodes[2 * side + end]));
                swing += edge.by_span * (to - from) * edge.arm;
            }
        }
        self.normal.cross(&swing)
    }

    /// The bodies, and the moments of a force on them, N m.
    pub(crate) fn moments(&self, force: &Vector3) -> [(Option<usize>, Vector3); 2] {
        let moments = self.spin.moments(&self.normal, force);
        [0, 1].map(|side| (self.spin.bodies[side], moments[side]))
    }

    /// Forces on the four nodes by which a force turns the edges of rods, N.
    pub(crate) fn couples(&self, force: &Vector3) -> [f64; 12] {
        self.spin.couples(&self.normal, force)
    }

    /// The bodies on both sides, where they are free.
    pub(crate) fn bodies(&self) -> [Option<usize>; 2] {
        self.spin.bodies
    }

    /// The contact as it is evaluated, under a force, N.
    pub(super) fn contact(&self, force: &Vector3) -> SpunContact {
        self.spin.contact(&self.normal, force)
    }

    /// Derivative of forces and moments for a force that falls by `stiffness` (N/m) times the motion
    /// of the contact points, with that of the present forces on nodes if the contact is `turning`,
    /// N/m.
    pub(crate) fn jacobian(
        &self,
        constraint: &ContactConstraint,
        stiffness: &Matrix3,
        turning: Option<&EdgeJacobian>,
    ) -> Box<SpunJacobian> {
        let mut jacobian = Box::new([[0.0; SPUN]; SPUN]);
        let weights = &constraint.weights;
        for column in 0..SPUN {
            let moved = self.motion_of(weights, column);
            let force = -(stiffness * moved);
            let couples = self.couples(&force);
            for (row, couple) in couples.iter().enumerate() {
                jacobian[row][column] = weights[row / 3] * force[row % 3] + couple;
                if let Some(turning) = turning.filter(|_| column < TURNS) {
                    jacobian[row][column] += turning[row][column];
                }
            }
            for (side, (_, moment)) in self.moments(&force).iter().enumerate() {
                for axis in 0..3 {
                    jacobian[TURNS + 3 * side + axis][column] = moment[axis];
                }
            }
        }
        if turning.is_some() {
            // Derivatives with respect to rotations are S − ½ [M]ₓ with S as here.
            for (side, (_, moment)) in self.moments(&constraint.force).iter().enumerate() {
                let (first, half) = (TURNS + 3 * side, moment.cross_matrix() * 0.5);
                for row in 0..3 {
                    for column in 0..3 {
                        jacobian[first + row][first + column] += half[(row, column)];
                    }
                }
            }
        }
        jacobian
    }

    /// Motion of the contact points by one of the coordinates of a contact.
    fn motion_of(&self, weights: &[f64; 4], column: usize) -> Vector3 {
        let unit = Vector3::from_fn(|axis, _| if axis == column % 3 { 1.0 } else { 0.0 });
        if let Some(turn) = column.checked_sub(TURNS) {
            return self.normal.cross(&unit) * self.spin.arms[turn / 3];
        }
        let corner = column / 3;
        let mut moved = unit * weights[corner];
        if let Some(edge) = &self.spin.edges[corner / 2] {
            let end = if corner.is_multiple_of(2) {
                -edge.arm
            } else {
                edge.arm
            };
            moved += self.normal.cross(&(edge.by_span * unit)) * end;
        }
        moved
    }
}
