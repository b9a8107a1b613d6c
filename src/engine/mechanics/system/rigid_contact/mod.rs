//! Signorini's and Coulomb's laws of a single contact, as a linear law of the state that the
//! contact is assumed to have.
//!
//! With the inertia ρ of the contact points (N/m), the force λ of the last linear law and the
//! corresponding gap and slip w, the projections
//!
//! ```text
//! λ_n* = (λ_n − ρ w_n)₊,   λ_t* = P(λ_t − ρ w_t)
//! ```
//!
//! onto the half line and onto the disk of radius μ λ_n* determine the state (Alart and Curnier
//! 1991): open, sticking if the disk contains λ_t − ρ w_t, otherwise sliding. λ* = λ is the
//! solution. The resulting law is linear in the motion m of the contact points: λ = λ* − K w, with
//! a stiffness far above all others in the closed directions. Friction of a sliding contact turns
//! with the slip, and its magnitude follows the normal force.
//!
//! [`ForceSearch`] iterates these laws until all projections are solutions at once. This is
//! Newton's method for a function with kinks, and may cycle, for example if adjacent contacts on
//! nearly parallel edges carry nearly the same load; then it follows smoothed laws to the
//! solution.

use crate::linalg::ElementMatrix;
use crate::mechanics::contact::{ContactConstraint, cut};
use crate::mechanics::{Matrix3, Vector3};

mod search;
mod smoothed;

pub(crate) use search::ForceSearch;
pub(super) use search::Moves;

/// Stiffness of closed directions, in units of ρ. Redundant contacts, as at the joint of two
/// edges, share their force by this stiffness; rounding leaves ten digits of it.
const SHUT: f64 = 1e6;
/// Part of the force that a contact keeps in the iteration in which it opens, and its stiffness
/// then in units of ρ, so that iterations do not cycle.
const KEPT_PART: f64 = 0.02;
const KEPT_STIFFNESS: f64 = 20.0;
/// Resistance to slip in units of ρ, as for the smoothed law of friction, and the factor on it
/// after reversals of the slip.
const BEGINNING_PART: f64 = 4.0;
const FREE_REVERSALS: i32 = 3;
const PART_AFTER_REVERSAL: f64 = 0.25;
/// Number of changes between sticking and sliding after which the slip is damped by ρ times powers
/// of two, and the largest such power.
const FREE_CHANGES: i32 = 3;
const MOST_GOINGS: i32 = 6;

/// A contact between iterations.
pub(super) struct RigidContact {
    normal: Vector3,
    friction: f64,
    /// Gap and slip at zero motion, m.
    start: Vector3,
    inertia: f64,
    /// Force to begin with, N.
    begun: Vector3,
    /// Force of the last linear law, N.
    wanted: Vector3,
    /// Gap and slip w, m.
    apart: Vector3,
    /// Projection λ* of the force, N.
    projected: Vector3,
    /// Whether the contact kept a part of its force when it opened.
    kept: bool,
    slid: Vector3,
    reversals: i32,
    /// Whether the contact slid in the last iteration, and how often that has changed.
    slides: bool,
    changes: i32,
}

/// A linear law λ = `force` − `stiffness` m of the motion m of the contact points.
pub(super) struct State {
    pub force: Vector3,
    pub stiffness: Matrix3,
}

impl RigidContact {
    /// A contact with points that have moved by `slid` (m) since the step began, and with its
    /// initial force.
    pub(crate) fn new(constraint: &ContactConstraint, slid: Vector3, inertia: f64) -> Self {
        let normal = constraint.normal;
        let along = slid - normal * normal.dot(&slid);
        let start = normal * constraint.gap + along;
        Self::beginning_with(
            normal,
            constraint.friction,
            start,
            inertia,
            constraint.force,
        )
    }

    fn beginning_with(
        normal: Vector3,
        friction: f64,
        start: Vector3,
        inertia: f64,
        force: Vector3,
    ) -> Self {
        Self {
            normal,
            friction,
            start,
            inertia,
            begun: force,
            wanted: force,
            apart: start,
            projected: force,
            kept: false,
            slid: Vector3::zeros(),
            reversals: 0,
            slides: false,
            changes: 0,
        }
    }

    /// The force λ*, N.
    pub(crate) fn force(&self) -> Vector3 {
        self.projected
    }

    /// Violation of the laws by λ, w, N.
    fn violation(&mut self) -> f64 {
        let (pressure, traction, _) = self.project();
        self.projected = self.normal * pressure + traction;
        (self.projected - self.wanted).norm()
    }

    /// λ_n*, λ_t*, and λ_t − ρ w_t.
    fn project(&self) -> (f64, Vector3, Vector3) {
        let split = |vector: &Vector3| {
            let along = self.normal.dot(vector);
            (along, vector - self.normal * along)
        };
        let ((wanted, drag), (gap, slip)) = (split(&self.wanted), split(&self.apart));
        let pressure = (wanted - self.inertia * gap).max(0.0);
        let disk = self.friction * pressure;
        let excess = (self.reversals - FREE_REVERSALS).max(0);
        let resistance = self.inertia * BEGINNING_PART * PART_AFTER_REVERSAL.powi(excess);
        let towards = cut(drag, disk) - slip * resistance;
        (pressure, cut(towards, disk), towards)
    }

    /// The linear law for the state that the last iteration suggests.
    fn advance(&mut self) -> State {
        let before = self.projected.dot(&self.normal);
        let (mut pressure, traction, towards) = self.project();
        let shut = SHUT * self.inertia;
        let mut stiffness = shut;
        let opens = pressure < KEPT_PART * before && !self.kept;
        if opens {
            pressure = KEPT_PART * before;
            stiffness = KEPT_STIFFNESS * self.inertia;
        }
        self.kept = opens;
        self.projected = self.normal * pressure + traction;
        if pressure <= 0.0 {
            return State {
                force: Vector3::zeros(),
                stiffness: Matrix3::zeros(),
            };
        }
        let pressing = self.normal * self.normal.transpose() * stiffness;
        let along = Matrix3::identity() - self.normal * self.normal.transpose();
        let disk = self.friction * pressure;
        let slides = towards.norm() > disk;
        self.changes += i32::from(slides != self.slides);
        self.slides = slides;
        let mut damped = Vector3::zeros();
        let rubbing = if self.friction == 0.0 {
            Matrix3::zeros()
        } else if opens {
            along * stiffness
        } else if !slides {
            along * shut
        } else {
            let size = towards.norm();
            let direction = towards / size;
            let reversed = self.slid.dot(&direction) < 0.0;
            self.slid = direction;
            self.reversals += i32::from(reversed);
            // Derivative across the slip, that of the projection onto the disk.
            let turn = (BEGINNING_PART * self.inertia * disk / (size - disk)).min(shut);
            // A slip that alternates between sticking and sliding approaches its solution
            // gradually.
            let goings = (self.changes - FREE_CHANGES).clamp(0, MOST_GOINGS);
            let damping = if goings > 0 {
                self.inertia * 2f64.powi(goings)
            } else {
                0.0
            };
            let slip = direction.dot(&self.apart);
            damped = direction * (damping * slip);
            (along - direction * direction.transpose()) * turn
                + direction * self.normal.transpose() * (self.friction * stiffness)
                + direction * direction.transpose() * damping
        };
        let stiffness = pressing + rubbing;
        State {
            force: self.projected + damped - stiffness * self.start,
            stiffness,
        }
    }

    /// The force that would move the contact points by gap and slip, N.
    fn size_of_gap(&self) -> f64 {
        self.inertia * self.apart.norm()
    }

    /// Restarts from the initial force.
    fn begin_again(&mut self) {
        (self.wanted, self.apart) = (self.begun, self.start);
        self.forget_changes();
    }

    /// Resets the number of state changes.
    fn forget_changes(&mut self) {
        (self.reversals, self.changes, self.kept) = (0, 0, false);
    }

    /// Force of the last linear law, N, and gap and slip, m.
    fn iterate(&self) -> [Vector3; 2] {
        [self.wanted, self.apart]
    }

    /// Interpolates between two iterates.
    fn go_between(&mut self, from: &[Vector3; 2], to: &[Vector3; 2], part: f64) {
        let between = |k: usize| from[k] + (to[k] - from[k]) * part;
        (self.wanted, self.apart) = (between(0), between(1));
    }

    /// Stores the motion of the contact points in the solution of all linear laws, m; returns the
    /// force of the linear law, N.
    fn follow(&mut self, state: &State, moved: &Vector3) -> Vector3 {
        self.apart = self.start + moved;
        self.wanted = state.force - state.stiffness * moved;
        self.wanted
    }
}

impl State {
    /// Contribution of the contact to Newton's matrix, N/m.
    pub(crate) fn matrix(&self, constraint: &ContactConstraint) -> ElementMatrix {
        let weights = &constraint.weights;
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                weights[row / 3] * weights[column / 3] * self.stiffness[(row % 3, column % 3)]
            })
        })
    }
}

#[cfg(test)]
mod tests;
