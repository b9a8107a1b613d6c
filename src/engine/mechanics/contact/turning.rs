//! Friction at the surfaces, by which rods roll, drive each other, and walk.
//!
//! The surface of an edge e of a rod turns with the angular velocity
//!
//! Ω = t × ė/l + θ̇ t,
//!
//! with its tangent t, its length l and the rate θ̇ at which its material frame spins about it,
//! relative to the frame transported in time. In a stage of the size Δt these terms are t × (e −
//! eⁿ)/(l Δt) and (θ − θⁿ)/Δt. The contact point is at r = −h n̂ from the centreline of the first
//! body, and at h n̂ from that of the second, so that the surfaces slide on each other with
//!
//! u = v + n̂ × G,   G = Σ_b h_b Ω_b   (m rad/s),
//!
//! the sum over both bodies, where v is the relative velocity of the centrelines. A common rigid
//! motion of both causes no slip except for the gap. The friction f = N |n| t(u) on the first body
//! is that of [`FrictionLaw`](super::friction::FrictionLaw). From its power f·u follows, in
//! addition to the forces on the nodes by their weights, the moment
//!
//! M_b = h_b f × n̂   (N m)
//!
//! on each body: both turn in the same sense, as for wheels that roll on each other. The part M·t
//! along the tangent acts on the angle of the edge, the rest as a couple of forces ±M × t/l on its
//! two nodes. Forces balance on all bodies together, and so do moments, taken about the contact
//! point. The normal force has no moment about the centreline.
//!
//! # Derivatives
//!
//! With e₀ = eⁿ and ω = θ̇, Ω = e₀ × e/(l² Δt) + ω t and
//!
//! - ∂Ω = ([e₀]ₓ/(l² Δt) − 2 (e₀ × e) eᵀ/(l⁴ Δt) + ω (1 − t tᵀ)/l) ∂e + t ∂θ/Δt,
//! - ∂u = ∂v + [n̂]ₓ ∂G − [G]ₓ ∂n̂,
//! - ∂M = h ([f]ₓ ∂n̂ − [n̂]ₓ ∂f),   ∂(M·t) = tᵀ ∂M + Mᵀ (1 − t tᵀ)/l ∂e,
//! - ∂(M × t/l) = −[e/l²]ₓ ∂M + [M]ₓ (1 − 2 t tᵀ)/l² ∂e.

use super::contacts::ContactMotion;
use super::edge_contact::Sliding;
use super::levers::Levers;
use super::normal_response::NormalResponse;
use crate::mechanics::{Matrix3, Vector3};
use nalgebra::{SMatrix, SVector};

/// Unknowns of a contact: the positions of four nodes, and the angles of two edges.
pub(crate) const UNKNOWNS: usize = 14;
/// Where the angles begin.
pub(crate) const ANGLES: usize = 12;

/// A vector over the unknowns of a contact.
pub(crate) type Row = SVector<f64, UNKNOWNS>;
/// A matrix over them.
pub(crate) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
/// Derivative of a vector.
pub(crate) type Rates = SMatrix<f64, 3, UNKNOWNS>;

/// An edge that turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Turn {
    /// Vector from the first node of the edge to the second, now and at the start of the stage, m.
    pub span: [Vector3; 2],
    /// Change of the angle of the edge since then, rad.
    pub angle: f64,
}

/// Rotation of the surfaces at a contact in a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turning {
    pub levers: Levers,
    /// Turns of the edges of the levers.
    pub turns: [Turn; 2],
    /// Δt, s.
    pub time_step: f64,
}

/// A lever with quantities derived from its edge.
struct Swing {
    ends: [usize; 2],
    angle: usize,
    arm: f64,
    tangent: Vector3,
    /// 1/l, 1/m.
    per_length: f64,
    /// Ω, rad/s, and its derivative with respect to the span, rad/(s m).
    rate: Vector3,
    by_span: Matrix3,
}

/// Derivatives of the force with respect to the unknowns of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurnedJacobian {
    /// Rows of nodes in N/m; rows of angles in N m per unit of the unknown.
    pub jacobian: Square,
    /// Derivative of the friction per normal force.
    pub traction: Rates,
}

impl Turning {
    fn swings(&self) -> impl Iterator<Item = Swing> {
        let levers = self.levers.edges.into_iter().zip(&self.turns);
        levers.enumerate().filter_map(|(k, (lever, turn))| {
            let lever = lever?;
            let [now, before] = turn.span;
            let per_length = 1.0 / now.norm();
            let tangent = now * per_length;
            let per_square = per_length * per_length / self.time_step;
            let across = before.cross(&now) * per_square;
            let spin = turn.angle / self.time_step;
            let by_span = before.cross_matrix() * per_square
                - across * tangent.transpose() * (2.0 * per_length)
                + across_of(&tangent) * (spin * per_length);
            Some(Swing {
                ends: lever.ends,
                angle: ANGLES + k,
                arm: lever.arm,
                tangent,
                per_length,
                rate: across + tangent * spin,
                by_span,
            })
        })
    }

    /// G, m rad/s.
    fn swing(&self) -> Vector3 {
        let swings = self.swings().map(|swing| swing.rate * swing.arm);
        swings.sum()
    }

    /// Velocity that rotation adds to the relative velocity of the centrelines, m/s.
    pub(crate) fn velocity(&self, normal: &Vector3) -> Vector3 {
        normal.normalize().cross(&self.swing())
    }

    /// Moments of a friction f (N) on the angles of the edges, and the equivalent couples on their
    /// nodes.
    pub(crate) fn moments(&self, normal: &Vector3, friction: &Vector3) -> Row {
        let mut row = Row::zeros();
        let lever = friction.cross(&normal.normalize());
        for swing in self.swings() {
            let moment = lever * swing.arm;
            row[swing.angle] += moment.dot(&swing.tangent);
            let couple = moment.cross(&swing.tangent) * swing.per_length;
            add(&mut row, swing.ends[1], couple);
            add(&mut row, swing.ends[0], -couple);
        }
        row
    }

    /// Generalised forces of a contact on all its unknowns: the forces on its four nodes, and its
    /// moments.
    pub(crate) fn force(
        &self,
        weights: &[f64; 4],
        normal: &Vector3,
        normal_force: f64,
        traction: &Vector3,
    ) -> Row {
        let friction = traction * (normal_force * normal.norm());
        let mut row = self.moments(normal, &friction);
        let force = normal * normal_force + friction;
        for (weight, place) in weights.iter().zip(self.levers.places) {
            if let Some(place) = place {
                add(&mut row, place, force * *weight);
            }
        }
        row
    }

    /// Derivative of [`Self::force`], for the friction law linearised at the slip `at` (m/s).
    /// `place` describes the motion of the contact; if it does not turn, the moments do not turn
    /// either.
    pub(crate) fn jacobian(
        &self,
        place: &ContactMotion,
        response: &NormalResponse,
        (sliding, at): (&Sliding, Vector3),
        turns: bool,
    ) -> TurnedJacobian {
        let swings: Vec<Swing> = self.swings().collect();
        let normal = place.normal;
        let length = normal.norm();
        let unit = normal / length;
        let by_normal = self.spread(&place.normal_jacobian);
        let unit_rates = across_of(&unit) * by_normal / length;
        let length_rates = unit.transpose() * by_normal;

        let mut swing_rates = Rates::zeros();
        for swing in &swings {
            add_by_span(&mut swing_rates, swing, &(swing.by_span * swing.arm));
            let by_angle = swing.tangent * (swing.arm / self.time_step);
            let mut column = swing_rates.column_mut(swing.angle);
            column += by_angle;
        }
        let swing = self.swing();
        let velocity = sliding.relative_velocity(&place.weights) + unit.cross(&swing);
        let mut velocity_rates =
            unit.cross_matrix() * swing_rates - swing.cross_matrix() * unit_rates;
        let mut weight_rates = [Row::zeros(); 4];
        for (corner, rates) in weight_rates.iter_mut().enumerate() {
            *rates = self.spread_row(&place.weight_rates[corner]);
            velocity_rates += sliding.velocities[corner] * rates.transpose();
            if let Some(own) = self.levers.places[corner] {
                for axis in 0..3 {
                    velocity_rates[(axis, 3 * own + axis)] +=
                        place.weights[corner] / self.time_step;
                }
            }
        }
        let traction = sliding.traction_derivatives(&normal, velocity, &at);
        let traction_rates = traction.by_velocity * velocity_rates + traction.by_normal * by_normal;

        let normal_force = response.force;
        let pressed = self.spread_row(&place.gap_gradient).transpose() * response.force_slope;
        let friction = traction.value * (normal_force * length);
        let friction_rates = traction.value * (pressed * length + length_rates * normal_force)
            + traction_rates * (normal_force * length);
        let force = normal * normal_force + friction;
        let force_rates = normal * pressed + by_normal * normal_force + friction_rates;

        let mut jacobian = Square::zeros();
        for (corner, own) in self.levers.places.iter().enumerate() {
            if let Some(own) = own {
                let rows =
                    force * weight_rates[corner].transpose() + force_rates * place.weights[corner];
                add_rows(&mut jacobian, *own, &rows);
            }
        }
        let lever = friction.cross(&unit);
        let lever_rates =
            friction.cross_matrix() * unit_rates - unit.cross_matrix() * friction_rates;
        for swing in &swings {
            let (moment, moment_rates) = (lever * swing.arm, lever_rates * swing.arm);
            let tangent = swing.tangent;
            let mut along = Rates::zeros();
            let mut couple = -(tangent * swing.per_length).cross_matrix() * moment_rates;
            if turns {
                let across = across_of(&tangent);
                add_by_span(&mut along, swing, &(across * swing.per_length));
                let reflected = across - tangent * tangent.transpose();
                let by_span = moment.cross_matrix() * reflected * swing.per_length.powi(2);
                add_by_span(&mut couple, swing, &by_span);
            }
            let about = tangent.transpose() * moment_rates + moment.transpose() * along;
            let mut row = jacobian.row_mut(swing.angle);
            row += about;
            add_rows(&mut jacobian, swing.ends[1], &couple);
            add_rows(&mut jacobian, swing.ends[0], &-couple);
        }
        TurnedJacobian {
            jacobian,
            traction: traction_rates,
        }
    }

    /// Converts a row over the four nodes of the contact to a row over its unknowns.
    fn spread_row(&self, over_nodes: &[f64; 12]) -> Row {
        let mut row = Row::zeros();
        for (corner, place) in self.levers.places.iter().enumerate() {
            if let Some(place) = place {
                for axis in 0..3 {
                    row[3 * place + axis] += over_nodes[3 * corner + axis];
                }
            }
        }
        row
    }

    fn spread(&self, over_nodes: &[[f64; 12]; 3]) -> Rates {
        let rows = over_nodes
            .each_ref()
            .map(|row| self.spread_row(row).transpose());
        Rates::from_rows(&rows)
    }
}

/// 1 − t tᵀ.
fn across_of(direction: &Vector3) -> Matrix3 {
    Matrix3::identity() - direction * direction.transpose()
}

fn add(row: &mut Row, node: usize, vector: Vector3) {
    let mut part = row.fixed_rows_mut::<3>(3 * node);
    part += vector;
}

fn add_rows(matrix: &mut Square, node: usize, rows: &Rates) {
    let mut part = matrix.fixed_rows_mut::<3>(3 * node);
    part += rows;
}

/// Adds the derivative with respect to the span of an edge.
fn add_by_span(rates: &mut Rates, swing: &Swing, by_span: &Matrix3) {
    for (end, sign) in swing.ends.iter().zip([-1.0, 1.0]) {
        let mut columns = rates.fixed_columns_mut::<3>(3 * end);
        columns += by_span * sign;
    }
}

#[cfg(test)]
#[path = "turning_tests.rs"]
mod tests;
