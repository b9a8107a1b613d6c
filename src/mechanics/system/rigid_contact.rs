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
//! [`find_forces`] goes from law to law until all projections are solutions at once.

use crate::linalg::ElementMatrix;
use crate::mechanics::contact::ContactConstraint;
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

/// Iterations before they count as cycling.
const ITERATIONS: usize = 12;
/// Times that sweeps with soft contacts follow then, before the contact problem counts as unsolved, and how many each.
const RELAXATIONS: usize = 6;
const SWEEPS: usize = 40;
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
    /// Force of sweeps, N.
    relaxed: Vector3,
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
            if obey(contacts, &states, &moves, negligible) {
                return Ok(true);
            }
        }
        if relaxation == RELAXATIONS {
            break;
        }
        contacts.iter_mut().for_each(RigidContact::forget);
        for sweep in 0..SWEEPS {
            let states: Vec<State> = contacts.iter_mut().map(RigidContact::relax).collect();
            let moves = move_by(&states, sweep == 0)?;
            if obey(contacts, &states, &moves, negligible) {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// Takes over the motions under linear laws, m; says whether all contacts obey their laws now.
fn obey(
    contacts: &mut [RigidContact],
    states: &[State],
    moves: &[Vector3],
    negligible: f64,
) -> bool {
    let (mut largest, mut violation) = (0.0_f64, 0.0_f64);
    for (contact, (state, moved)) in contacts.iter_mut().zip(states.iter().zip(moves)) {
        largest = largest.max(contact.follow(state, moved).norm());
        let own = contact.violation();
        if !own.is_finite() {
            return false;
        }
        violation = violation.max(own);
    }
    violation <= (TOLERANCE * largest).max(negligible)
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

    /// Forgets how often it has changed its mind, and goes on from its force.
    fn forget(&mut self) {
        (self.reversals, self.changes, self.kept) = (0, 0, false);
        self.relaxed = self.projected;
    }

    /// The law of an iteration of the alternating direction method of multipliers (Boyd et al. 2011, Eq. 3.5): the same
    /// stiffness for open and for closed contacts. It is slow, and does not cycle.
    fn relax(&mut self) -> State {
        let stiffness = SOFT * self.inertia;
        let before = self.relaxed;
        let towards = before - self.apart * stiffness;
        let pressure = self.normal.dot(&towards).max(0.0);
        let along = towards - self.normal * self.normal.dot(&towards);
        self.relaxed = self.normal * pressure + cut(along, self.friction * pressure);
        let kept = self.apart + (self.relaxed - before) / stiffness;
        State {
            force: self.relaxed + (kept - self.start) * stiffness,
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

/// The vector, shortened to `length` where it is longer.
fn cut(vector: Vector3, length: f64) -> Vector3 {
    let norm = vector.norm();
    if norm > length {
        vector * (length / norm)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::random::uniform_numbers;
    use nalgebra::{DMatrix, DVector};
    use std::convert::Infallible;

    /// Contacts of bodies of unit mass in unit steps: they move by w = H (v + Hᵀλ), v being the free motion.
    struct Problem {
        /// H, three rows per contact: along its normal z, then x and y.
        rows: DMatrix<f64>,
        free: DVector<f64>,
        friction: Vec<f64>,
    }

    /// Forces, N, and motions, m, of all contacts.
    struct Solution {
        forces: Vec<Vector3>,
        motions: Vec<Vector3>,
        /// Solutions of linear laws that it took.
        iterations: usize,
    }

    const AXES: [usize; 3] = [2, 0, 1];

    impl Problem {
        /// As hard as contact of tangled rods: every contact moves every other.
        fn random(seed: u64, contacts: usize, rank: usize) -> Self {
            let mut number = uniform_numbers(seed);
            let mut symmetric = || 2.0 * number() - 1.0;
            let rows = DMatrix::from_fn(3 * contacts, rank, |_, _| symmetric());
            // Free motions that forces can undo, which also an operator of deficient rank admits.
            let free = DVector::from_fn(rank, |_, _| symmetric());
            let friction = (0..contacts).map(|_| 0.5 + 0.5 * symmetric()).collect();
            Self {
                rows,
                free,
                friction,
            }
        }

        /// H of a contact with its rows along x, y, z.
        fn of_contact(&self, contact: usize) -> DMatrix<f64> {
            let mut rows = DMatrix::zeros(3, self.free.len());
            for (place, axis) in AXES.into_iter().enumerate() {
                rows.set_row(axis, &self.rows.row(3 * contact + place));
            }
            rows
        }

        fn contacts(&self, start: impl Fn(usize) -> Vector3) -> Vec<RigidContact> {
            let friction = self.friction.iter().enumerate();
            friction
                .map(|(contact, friction)| {
                    let yields = self.rows.rows(3 * contact, 3).norm_squared() / 3.0;
                    let force = start(contact);
                    let normal = Vector3::z();
                    RigidContact::beginning_with(
                        normal,
                        *friction,
                        Vector3::zeros(),
                        1.0 / yields,
                        force,
                    )
                })
                .collect()
        }

        fn motion(&self, states: &[State]) -> DVector<f64> {
            let mut matrix = DMatrix::identity(self.free.len(), self.free.len());
            let mut load = self.free.clone();
            for (contact, state) in states.iter().enumerate() {
                let rows = self.of_contact(contact);
                matrix += rows.transpose() * state.stiffness * &rows;
                load += rows.transpose() * state.force;
            }
            matrix.lu().solve(&load).unwrap()
        }

        /// The solution from the given forces; `None` where there is none, or none was found.
        fn solve_from(&self, start: impl Fn(usize) -> Vector3) -> Option<Solution> {
            let mut contacts = self.contacts(start);
            let mut iterations = 0;
            let all: Vec<DMatrix<f64>> = (0..contacts.len()).map(|k| self.of_contact(k)).collect();
            let mut motions = Vec::new();
            let found = find_forces(&mut contacts, 0.0, |states, _| {
                iterations += 1;
                let motion = self.motion(states);
                motions = all
                    .iter()
                    .map(|rows| {
                        let moved = rows * &motion;
                        Vector3::new(moved[0], moved[1], moved[2])
                    })
                    .collect();
                Ok::<_, Infallible>(motions.clone())
            });
            found.unwrap().then(|| Solution {
                forces: contacts.iter().map(RigidContact::force).collect(),
                motions,
                iterations,
            })
        }

        fn solve(&self) -> Option<Solution> {
            self.solve_from(|_| Vector3::zeros())
        }

        /// Largest violation of the two laws, in units of the largest force and free motion.
        fn violation(&self, solution: &Solution) -> f64 {
            let sizes = solution.forces.iter().map(Vector3::amax);
            let force_unit = sizes.fold(1e-3, f64::max);
            let motion_unit = (&self.rows * &self.free).amax();
            let contacts = solution.forces.iter().zip(&solution.motions);
            let mut worst = 0.0_f64;
            for ((force, motion), friction) in contacts.zip(&self.friction) {
                let (force, motion) = (force / force_unit, motion / motion_unit);
                worst = worst.max(-force.z).max(-motion.z);
                worst = worst.max((force.z * motion.z).abs());
                let (traction, slip) = (force.xy(), motion.xy());
                worst = worst.max(traction.norm() - friction * force.z);
                // Dissipation is the largest there is: −λ_t·w_t = μ λ_n ‖w_t‖.
                let dissipation = -traction.dot(&slip);
                worst = worst.max((dissipation - friction * force.z * slip.norm()).abs());
            }
            worst
        }
    }

    #[test]
    fn solutions_obey_both_laws() {
        for seed in 0..60 {
            for (contacts, has_friction) in [(1, true), (4, false), (5, true), (12, true)] {
                for rank in [3 * contacts, 6 * contacts] {
                    let mut problem = Problem::random(seed, contacts, rank);
                    if !has_friction {
                        problem.friction.fill(0.0);
                    }
                    let solution = problem.solve();
                    let solution = solution.unwrap_or_else(|| panic!("{seed} {contacts} {rank}"));
                    let violation = problem.violation(&solution);
                    assert!(violation < 1e-5, "{seed} {contacts} {rank}: {violation:e}");
                }
            }
        }
    }

    #[test]
    fn forces_that_no_contact_presses_for_vanish() {
        let problem = Problem {
            rows: DMatrix::identity(6, 6),
            free: DVector::from_element(6, 1.0),
            friction: vec![0.3; 2],
        };
        for start in [0.0, 0.1, 10.0] {
            let solution = problem.solve_from(|_| Vector3::repeat(start)).unwrap();
            assert_eq!(solution.forces, [Vector3::zeros(); 2]);
        }
    }

    #[test]
    fn motions_that_are_not_finite_are_no_solution() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut contacts = Problem::random(0, 2, 6).contacts(|_| Vector3::z());
            let moved = |_: &[State], _| Ok::<_, Infallible>(vec![Vector3::repeat(wrong); 2]);
            assert_eq!(find_forces(&mut contacts, 0.0, moved), Ok(false));
        }
    }

    #[test]
    fn known_forces_lead_to_the_solution_within_few_iterations() {
        let mut total = 0;
        for seed in 0..20 {
            let problem = Problem::random(seed, 6, 18);
            let known = problem.solve().unwrap();
            let again = problem.solve_from(|k| known.forces[k] * 1.3).unwrap();
            total += again.iterations;
            for (force, other) in known.forces.iter().zip(&again.forces) {
                assert!((force - other).norm() < 1e-6, "{seed}");
            }
        }
        // One of the twenty needs sweeps, all others at most 12.
        assert!(total <= 10 * 20, "{total}");
    }

    #[test]
    fn the_law_of_sliding_is_that_of_coulomb_to_second_order() {
        let (normal, friction, inertia) = (Vector3::z(), 0.4, 20.0);
        let coulomb = |pressure: f64, slip: &Vector3| slip * (-friction * pressure / slip.norm());
        let slip = Vector3::new(0.3, -0.4, 0.0);
        for decade in [1.0, 0.1] {
            let mut contact = RigidContact::beginning_with(
                normal,
                friction,
                Vector3::zeros(),
                inertia,
                normal * 2.0 + coulomb(2.0, &slip),
            );
            contact.apart = slip;
            contact.slides = true;
            let law = contact.advance();
            for turn in [Vector3::new(0.4, 0.3, 0.0), Vector3::new(0.3, -0.4, 0.0)] {
                let slid = slip + turn * (1e-3 * decade);
                let force = law.force - law.stiffness * slid;
                let expected = normal * 2.0 + coulomb(2.0, &slid);
                let allowed = (1e-3 * decade).powi(2);
                assert!(
                    (force - expected).norm() < allowed,
                    "{force:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn a_block_on_an_incline_sticks_up_to_the_angle_of_friction() {
        // Unit mass, unit step: the free motion is the pull of gravity along normal and tangent.
        for friction in [0.2, 0.5, 1.0_f64] {
            let limit = friction.atan();
            for (angle, sticks) in [(limit - 1e-4, true), (limit + 1e-4, false)] {
                let problem = Problem {
                    rows: DMatrix::identity(3, 3),
                    free: DVector::from_vec(vec![-angle.cos(), angle.sin(), 0.0]),
                    friction: vec![friction],
                };
                let solution = problem.solve().unwrap();
                let (force, slip) = (solution.forces[0], solution.motions[0].x);
                let traction = force.x / force.z;
                assert!((force.z - angle.cos()).abs() < 1e-5);
                if sticks {
                    assert!(slip.abs() < 1e-9 && traction > -friction);
                } else {
                    assert!(slip > 5e-5 && (traction + friction).abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn contacts_that_do_the_same_share_the_force() {
        let problem = Problem {
            rows: DMatrix::from_fn(6, 1, |row, _| if row % 3 == 0 { 1.0 } else { 0.0 }),
            free: DVector::from_element(1, -1.0),
            friction: vec![0.0; 2],
        };
        let forces = problem.solve().unwrap().forces;
        assert!((forces[0].z - 0.5).abs() < 1e-5 && (forces[0] - forces[1]).norm() < 1e-9);
    }
}
