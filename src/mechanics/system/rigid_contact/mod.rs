//! Signorini's and Coulomb's laws of a single contact, as a linear law of the state it is thought to be in.
//!
//! With the inertia ρ of the contact points (N/m), the wanted force λ of the last linear law and the gap and slip w that
//! came with it, the projections
//!
//! ```text
//! λ_n* = (λ_n − ρ w_n)₊,   λ_t* = P(λ_t − ρ w_t)
//! ```
//!
//! on the half line and on the disk of radius μ λ_n* tell the state (Alart and Curnier 1991): open, sticking where the disk
//! holds λ_t − ρ w_t, else sliding. λ* = λ is the solution. The law that follows is linear in the motion m of the contact
//! points: λ = λ* − K w with a stiffness far above all others in the directions that are shut, and friction that turns with
//! the slip while its size follows the normal force where they slide.
//!
//! [`find_forces`] goes from law to law until all projections are solutions at once. This is Newton's method for a function
//! with corners, and may cycle, as it does where contacts beside each other on nearly parallel edges bear nearly the same
//! load; then sweeps of the alternating direction method of multipliers take over, each time for longer. They go on from
//! where they ended and not from where Newton's method has led since. Where the matrix of the rods is indefinite, sweeps lead
//! away from any solution, and end.

use crate::linalg::ElementMatrix;
use crate::mechanics::contact::{ContactConstraint, cut};
use crate::mechanics::{Matrix3, Vector3};

/// Stiffness of directions that are shut, in units of ρ: contacts that do the same work, as at the joint of two edges,
/// share their force, and rounding leaves ten digits of it.
const SHUT: f64 = 1e6;
/// Part of its force that a contact keeps in the iteration in which it opens, and its stiffness then in units of ρ, lest
/// iterations cycle.
const KEPT_PART: f64 = 0.02;
const KEPT_STIFFNESS: f64 = 20.0;
/// Resistance to slip in units of ρ, as for the smoothed law of friction, and what of it remains after reversals of the
/// slip.
const BEGINNING_PART: f64 = 4.0;
const FREE_REVERSALS: i32 = 3;
const PART_AFTER_REVERSAL: f64 = 0.25;
/// Changes between sticking and sliding after which the slip is damped, by ρ times powers of two up to this one.
const FREE_CHANGES: i32 = 3;
const MOST_GOINGS: i32 = 6;

/// Stiffness of sweeps in units of ρ: contacts of a pile yield less than by their inertia alone.
const SOFT: f64 = 16.0;
/// Over-relaxation of sweeps (Boyd et al. 2011, section 3.4.3): half as many as without; from 2 on they lead nowhere.
const OVER_RELAXATION: f64 = 1.6;

/// Iterations before they count as cycling.
const ITERATIONS: usize = 12;
/// Times that sweeps with soft contacts follow then, before the contact problem counts as unsolved, and how many at first; each
/// time twice as many as before. In a pile of 50 rods the hardest of those that Newton's method leaves take 1,000 of them.
const RELAXATIONS: usize = 5;
const SWEEPS: usize = 40;
/// Growth of the violation over so many sweeps by which they are known to lead away from any solution.
const DIVERGENCE: f64 = 1e3;
/// Largest violation of the laws of a solution, relative to the largest force.
const TOLERANCE: f64 = 1e-9;

/// A contact between iterations.
pub(super) struct RigidContact {
    normal: Vector3,
    friction: f64,
    /// Gap and slip where the motion is zero, m.
    start: Vector3,
    inertia: f64,
    /// Force of the last linear law, N.
    wanted: Vector3,
    /// Gap and slip w, m.
    apart: Vector3,
    /// Its projection λ*, N.
    projected: Vector3,
    /// Force of sweeps, N, gap and slip that go with it, m, and those of the motion under it, m.
    relaxed: Vector3,
    admitted: Vector3,
    swept: Vector3,
    /// Whether it kept a part of its force when it opened.
    kept: bool,
    slid: Vector3,
    reversals: i32,
    /// Whether it slid in the last iteration, and how often that has changed.
    slides: bool,
    changes: i32,
}

/// A linear law λ = `force` − `stiffness` m of the motion m of the contact points.
pub(super) struct State {
    pub force: Vector3,
    stiffness: Matrix3,
}

/// Finds forces that obey the laws of all contacts; says whether they do, or iterations ran out. `move_by` solves for the
/// motion under the linear laws that it is given, one per contact, and returns what moves the points of each, m; it is told
/// whether their stiffness may have changed since it was last asked. Laws count as obeyed where they are broken by no more
/// than a part of the largest force, or by `negligible`, N.
pub(super) fn find_forces<E>(
    contacts: &mut [RigidContact],
    negligible: f64,
    mut move_by: impl FnMut(&[State], bool) -> Result<Vec<Vector3>, E>,
) -> Result<bool, E> {
    for relaxation in 0..=RELAXATIONS {
        for _ in 0..ITERATIONS {
            let states: Vec<State> = contacts.iter_mut().map(RigidContact::advance).collect();
            let moves = move_by(&states, true)?;
            if largest_violation(contacts, &states, &moves, negligible) == 0.0 {
                return Ok(true);
            }
        }
        if relaxation == RELAXATIONS {
            break;
        }
        let goes_on = relaxation > 0;
        for contact in contacts.iter_mut() {
            contact.begin_sweeps(goes_on);
        }
        let mut first = None;
        for sweep in 0..SWEEPS << relaxation {
            let states: Vec<State> = contacts.iter_mut().map(RigidContact::relax).collect();
            let moves = move_by(&states, sweep == 0)?;
            let violation = largest_violation(contacts, &states, &moves, negligible);
            if violation == 0.0 {
                return Ok(true);
            }
            if violation > DIVERGENCE * *first.get_or_insert(violation) {
                return Ok(false);
            }
        }
        contacts.iter_mut().for_each(RigidContact::end_sweeps);
    }
    Ok(false)
}

/// Takes over the motions under linear laws, m; returns by how much the contacts break their laws now, N: zero where that
/// counts as obeyed, infinite where a number is not finite.
fn largest_violation(
    contacts: &mut [RigidContact],
    states: &[State],
    moves: &[Vector3],
    negligible: f64,
) -> f64 {
    let (mut largest, mut violation) = (0.0_f64, 0.0_f64);
    for (contact, (state, moved)) in contacts.iter_mut().zip(states.iter().zip(moves)) {
        largest = largest.max(contact.follow(state, moved).norm());
        let own = contact.violation();
        if !own.is_finite() {
            return f64::INFINITY;
        }
        violation = violation.max(own);
    }
    if violation <= (TOLERANCE * largest).max(negligible) {
        0.0
    } else {
        violation
    }
}

impl RigidContact {
    /// A contact whose points have moved by `slid` (m) since the step began, with the force that it has to begin with.
    pub fn new(constraint: &ContactConstraint, slid: Vector3, inertia: f64) -> Self {
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
            wanted: force,
            apart: start,
            projected: force,
            relaxed: force,
            admitted: start,
            swept: start,
            kept: false,
            slid: Vector3::zeros(),
            reversals: 0,
            slides: false,
            changes: 0,
        }
    }

    /// The force λ*, N.
    pub fn force(&self) -> Vector3 {
        self.projected
    }

    /// By how much λ, w break the laws, N.
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

    /// The law of the state that the last iteration suggests.
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
            // Perpendicular to the slip, that of the disk's projection.
            let turn = (BEGINNING_PART * self.inertia * disk / (size - disk)).min(shut);
            // A slip that comes and goes approaches its end by degrees.
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

    /// Forgets how often it has changed its mind, and begins sweeps with its force, or goes on with those before.
    fn begin_sweeps(&mut self, goes_on: bool) {
        (self.reversals, self.changes, self.kept) = (0, 0, false);
        if goes_on {
            self.apart = self.swept;
        } else {
            (self.relaxed, self.admitted) = (self.projected, self.apart);
        }
    }

    /// Remembers where sweeps have led.
    fn end_sweeps(&mut self) {
        self.swept = self.apart;
    }

    /// The law of an iteration of the alternating direction method of multipliers (Boyd et al. 2011, Eq. 3.5): the same
    /// stiffness for open and for closed contacts. It is slow, and does not cycle.
    fn relax(&mut self) -> State {
        let stiffness = SOFT * self.inertia;
        let before = self.relaxed;
        let apart = self.apart * OVER_RELAXATION + self.admitted * (1.0 - OVER_RELAXATION);
        let towards = before - apart * stiffness;
        let pressure = self.normal.dot(&towards).max(0.0);
        let along = towards - self.normal * self.normal.dot(&towards);
        self.relaxed = self.normal * pressure + cut(along, self.friction * pressure);
        self.admitted = apart + (self.relaxed - before) / stiffness;
        State {
            force: self.relaxed + (self.admitted - self.start) * stiffness,
            stiffness: Matrix3::identity() * stiffness,
        }
    }

    /// Takes over what the solution of all linear laws moves the contact points by, m; returns the force of its law, N.
    fn follow(&mut self, state: &State, moved: &Vector3) -> Vector3 {
        self.apart = self.start + moved;
        self.wanted = state.force - state.stiffness * moved;
        self.wanted
    }
}

impl State {
    /// What it adds to Newton's matrix, N/m.
    pub fn matrix(&self, constraint: &ContactConstraint) -> ElementMatrix {
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
