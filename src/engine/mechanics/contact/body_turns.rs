//! Friction at the surfaces of free bodies, which makes balls roll.
//!
//! The contact point is at −h n̂ from the segment or vertex of the first body that touches, and at
//! h n̂ from that of the second, with the radius h of their roundings. The surfaces slide on each
//! other with
//!
//! u = v + n̂ × G,   G = Σ_b h_b θ_b/Δt   (m rad/s),
//!
//! where v is the relative velocity of segments and vertices and θ_b the rotation vector of a free
//! body, or of an edge of a rod ([`super::edge_turn`]), since the stage began. The friction f on
//! the first body has the moment M_b = h_b f × n̂ on each body and edge, in addition to the forces
//! on their nodes. Where a node of a rod touches a face, its friction is on the centreline. With ∂θ = J⁻¹(θ) ∂ψ for a rotation ψ in the fixed frame,
//!
//! ∂u = ∂v + [n̂]ₓ ∂G − [G]ₓ ∂n̂,   ∂M = h ([f]ₓ ∂n̂ − [n̂]ₓ ∂f).

use super::contacts::ContactMotion;
use super::edge_contact::{Sliding, contact_force};
use super::edge_turn::EdgeTurn;
use super::normal_response::NormalResponse;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;
use crate::mechanics::rotation::inverse_left_jacobian;

/// Unknowns of a contact with free bodies: the positions of four nodes, and the rotations of both
/// bodies in the fixed frame.
pub(crate) const SPUN: usize = 18;
/// Where the rotations begin.
pub(super) const TURNS: usize = 12;

/// Derivative of forces and moments with respect to these unknowns.
pub(crate) type SpunJacobian = [[f64; SPUN]; SPUN];
/// Derivative of the friction per normal force with respect to the rotation vectors of both bodies.
pub(super) type TurnRates = [[f64; 6]; 3];

/// Rotations of the free bodies in the present stage.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyTurns {
    /// The body of each node; empty without free bodies.
    pub bodies_of: Vec<Option<usize>>,
    /// Radii of their roundings, m.
    pub radii: Vec<f64>,
    /// Rotation vectors since the stage began, rad.
    pub turns: Vec<Vector3>,
    /// Those at the last linearisation; empty before the first of a step.
    linearised: Vec<Vector3>,
}

impl BodyTurns {
    pub(crate) fn of(surface: &ContactSurface) -> Self {
        let mut all = Self::default();
        for (nodes, radius) in surface.bodies() {
            all.bodies_of.resize(surface.node_count(), None);
            all.bodies_of[nodes.clone()].fill(Some(all.radii.len()));
            all.radii.push(*radius);
        }
        all.turns = vec![Vector3::zeros(); all.radii.len()];
        all
    }

    /// Starts the iterations of a step.
    pub(crate) fn begin(&mut self) {
        self.linearised.clear();
    }

    /// The body of a node.
    pub(crate) fn body_of(&self, node: usize) -> Option<usize> {
        self.bodies_of.get(node).copied().flatten()
    }

    /// Rotation of the bodies of two nodes; `None` if neither belongs to one.
    pub(crate) fn spin(&self, nodes: [usize; 2], time_step: f64) -> Option<Spin> {
        let bodies = nodes.map(|node| self.body_of(node));
        if bodies == [None; 2] {
            return None;
        }
        let turn = |body: usize| self.turns[body];
        let moved = |body: usize| {
            let before = self.linearised.get(body);
            before.map_or_else(Vector3::zeros, |before| turn(body) - before)
        };
        Some(Spin {
            bodies,
            arms: bodies.map(|body| body.map_or(0.0, |body| self.radii[body])),
            turns: bodies.map(|body| body.map_or_else(Vector3::zeros, turn)),
            moved: bodies.map(|body| body.map_or_else(Vector3::zeros, moved)),
            edges: [None; 2],
            time_step,
        })
    }

    /// Marks the present rotations as those of a linearisation.
    pub(crate) fn mark(&mut self) {
        self.linearised.clone_from(&self.turns);
    }
}

/// Rotation of the free bodies at a contact in a stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spin {
    /// The bodies on both sides, where they are free.
    pub bodies: [Option<usize>; 2],
    /// h, m; 0 for others.
    pub arms: [f64; 2],
    /// θ, rad.
    turns: [Vector3; 2],
    /// Changes of θ since the last linearisation, rad.
    pub moved: [Vector3; 2],
    /// The edges of rods on both sides.
    pub edges: [Option<EdgeTurn>; 2],
    /// Δt, s.
    time_step: f64,
}

/// A contact of free bodies with friction.
#[derive(Clone, Debug)]
pub(crate) struct SpunContact {
    /// The bodies on both sides, where they are free.
    pub bodies: [Option<usize>; 2],
    /// Moments on them, in addition to the forces on their vertices, N m.
    pub moments: [Vector3; 2],
    /// Differences between the moments of the linearised laws and these, N m.
    pub corrections: [Vector3; 2],
    /// Rotations since the stage began, rad.
    pub turns: [Vector3; 2],
    /// Derivative of forces and moments; `None` if it was not requested.
    pub jacobian: Option<Box<SpunJacobian>>,
}

impl SpunContact {
    /// Work of the moments in the stage, J.
    pub(crate) fn work(&self) -> f64 {
        let works = self.moments.iter().zip(&self.turns);
        works.map(|(moment, turn)| moment.dot(turn)).sum()
    }
}

/// The derivatives of a contact.
pub(super) struct SpinRates {
    pub jacobian: Box<SpunJacobian>,
    pub by_nodes: [[f64; 12]; 3],
    pub by_turns: TurnRates,
}

impl Spin {
    /// G, m rad/s.
    fn swing(&self) -> Vector3 {
        let of_bodies = self.turns[0] * self.arms[0] + self.turns[1] * self.arms[1];
        let of_edges = self.edges.iter().flatten().map(|edge| edge.turn * edge.arm);
        (of_bodies + of_edges.sum::<Vector3>()) / self.time_step
    }

    /// Forces of the couples on the edges of rods on four nodes, N, under a friction, N.
    pub(crate) fn couples(&self, normal: &Vector3, friction: &Vector3) -> [f64; 12] {
        let lever = friction.cross(&normal.normalize());
        let mut forces = [0.0; 12];
        for (side, edge) in self.edges.iter().enumerate() {
            let Some(edge) = edge else { continue };
            let force = edge.couple(&(lever * edge.arm));
            for axis in 0..3 {
                forces[6 * side + axis] = -force[axis];
                forces[6 * side + 3 + axis] = force[axis];
            }
        }
        forces
    }

    /// Velocity that rotation adds to the relative velocity, m/s.
    pub(crate) fn velocity(&self, normal: &Vector3) -> Vector3 {
        normal.normalize().cross(&self.swing())
    }

    /// Moments of a friction f (N) on both bodies, N m.
    pub(crate) fn moments(&self, normal: &Vector3, friction: &Vector3) -> [Vector3; 2] {
        let lever = friction.cross(&normal.normalize());
        self.arms.map(|arm| lever * arm)
    }

    /// The contact without its derivatives; `friction` in N.
    pub(crate) fn contact(&self, normal: &Vector3, friction: &Vector3) -> SpunContact {
        SpunContact {
            bodies: self.bodies,
            moments: self.moments(normal, friction),
            corrections: [Vector3::zeros(); 2],
            turns: self.turns,
            jacobian: None,
        }
    }

    /// Derivatives for the friction law linearised at the slip `at`, m/s; `place` describes the
    /// motion of the contact.
    pub(crate) fn rates(
        &self,
        place: &ContactMotion,
        response: &NormalResponse,
        (sliding, at): (&Sliding, Vector3),
    ) -> SpinRates {
        let normal = place.normal;
        let length = normal.norm();
        let unit = normal / length;
        let swing = self.swing();
        let velocity = sliding.relative_velocity(&place.weights) + unit.cross(&swing);
        let law = sliding.traction_derivatives(&normal, velocity, &at);
        let (pressure, per_step) = (response.force, 1.0 / sliding.time_step);
        let friction = law.value * (pressure * length);
        let force = normal * pressure + friction;
        let [first, second] = self.moments(&normal, &friction);
        let spun = [0, 1].map(|b| {
            let rates = inverse_left_jacobian(&self.turns[b]) * (self.arms[b] * per_step);
            (unit.cross_matrix() * rates, self.arms[b])
        });
        let mut found = SpinRates {
            jacobian: Box::new([[0.0; SPUN]; SPUN]),
            by_nodes: [[0.0; 12]; 3],
            by_turns: [[0.0; 6]; 3],
        };
        for column in 0..SPUN {
            let mut turned = Vector3::zeros();
            let mut slid = Vector3::zeros();
            let (mut pressed, mut weight_rates) = (0.0, [0.0; 4]);
            if column < TURNS {
                turned = Vector3::from_fn(|row, _| place.normal_jacobian[row][column]);
                weight_rates = place.weight_rates.map(|rates| rates[column]);
                let moved = sliding.velocities.iter().zip(weight_rates);
                slid = moved.map(|(v, rate)| v * rate).sum();
                slid[column % 3] += place.weights[column / 3] * per_step;
                pressed = place.gap_gradient[column];
            }
            // Change of the vector between the ends of an edge.
            let mut spans = [Vector3::zeros(); 2];
            if column < TURNS {
                let end = if column / 3 % 2 == 0 { -1.0 } else { 1.0 };
                spans[column / 6][column % 3] = end;
            }
            for (edge, span) in self.edges.iter().zip(&spans) {
                if let Some(edge) = edge {
                    slid += unit.cross(&(edge.by_span * span)) * (edge.arm * per_step);
                }
            }
            let unit_rate = (turned - unit * unit.dot(&turned)) / length;
            slid -= swing.cross(&unit_rate);
            if let Some(turn) = column.checked_sub(TURNS) {
                slid += spun[turn / 3].0.column(turn % 3);
            }
            let traction = law.by_velocity * slid + law.by_normal * turned;
            let pressed = response.force_slope * pressed;
            let friction_rate = law.value * (pressed * length + pressure * unit.dot(&turned))
                + traction * (pressure * length);
            let force_rate = normal * pressed + turned * pressure + friction_rate;
            for row in 0..TURNS {
                let (node, axis) = (row / 3, row % 3);
                found.jacobian[row][column] =
                    force[axis] * weight_rates[node] + force_rate[axis] * place.weights[node];
            }
            let lever = friction_rate.cross(&unit) + friction.cross(&unit_rate);
            for (side, (edge, span)) in self.edges.iter().zip(&spans).enumerate() {
                let Some(edge) = edge else { continue };
                let moment = friction.cross(&unit) * edge.arm;
                let rate = edge.couple_rate(&moment, &(lever * edge.arm), span);
                for axis in 0..3 {
                    found.jacobian[6 * side + axis][column] -= rate[axis];
                    found.jacobian[6 * side + 3 + axis][column] += rate[axis];
                }
            }
            for (b, (_, arm)) in spun.iter().enumerate() {
                for axis in 0..3 {
                    found.jacobian[TURNS + 3 * b + axis][column] = lever[axis] * arm;
                }
            }
            for axis in 0..3 {
                if column < TURNS {
                    found.by_nodes[axis][column] = traction[axis];
                }
            }
        }
        for b in 0..2 {
            let by_turn = law.by_velocity * unit.cross_matrix() * (self.arms[b] * per_step);
            // Derivatives with respect to rotations are S − ½ [M]ₓ with S as here.
            let half = [first, second][b].cross_matrix() * 0.5;
            for row in 0..3 {
                for column in 0..3 {
                    found.by_turns[row][3 * b + column] = by_turn[(row, column)];
                    found.jacobian[TURNS + 3 * b + row][TURNS + 3 * b + column] +=
                        half[(row, column)];
                }
            }
        }
        found
    }
}

/// Force on the four nodes of a contact, N, with the couples on the edges of rods at free bodies.
pub(super) fn force_on_nodes(
    spin: Option<&Spin>,
    weights: &[f64; 4],
    normal: &Vector3,
    normal_force: f64,
    traction: &Vector3,
) -> [f64; 12] {
    let mut force = contact_force(weights, normal, normal_force, traction);
    if let Some(spin) = spin {
        let friction = traction * (normal_force * normal.norm());
        let couples = spin.couples(normal, &friction);
        force
            .iter_mut()
            .zip(couples)
            .for_each(|(own, couple)| *own += couple);
    }
    force
}
