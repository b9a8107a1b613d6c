//! Search for forces that satisfy the laws of many contacts at once.
//!
//! Newton's method for a function with kinks computes forces from the states of all contacts, and
//! the next states from these forces. The method converges in a few iterations if few states
//! change, and may cycle if many do. Then the laws are smoothed ([`super::smoothed`]), and the
//! width of the smoothing is reduced step by step to zero. Every iterate solves the equations of
//! the rods, and so does every point between two iterates. A step that increases the violation of
//! the smoothed laws is therefore shortened without another solution of a linear system.
//!
//! The rods are linearised again as they move, and forces are solved only to the corresponding
//! accuracy: the width of the smoothed laws is reduced to a value proportional to the motion, and
//! further after the next linearisation. If they cannot be followed further, the laws are solved at
//! a larger width, and the rods are linearised at that solution. Near the end, the states of narrow
//! laws are those of the exact laws with few exceptions.

use super::{RigidContact, State};
use crate::mechanics::Vector3;

/// Maximum number of iterations from state to state; without cycles they take three or four.
const ITERATIONS: usize = 12;
/// Growth of the violation at which the iterations count as cycling; below, the part of the first
/// violation that may remain after a number of iterations.
const CYCLING_GROWTH: f64 = 10.0;
const PATIENCE: usize = 6;
const LEFT_OVER: f64 = 1e-2;
/// Maximum number of iterations with smoothed laws before the contact problem counts as unsolved;
/// they take about fifteen.
const SMOOTHED_ITERATIONS: usize = 60;

/// Initial width ν of smoothed laws, in units of the typical force, and the factor by which it
/// falls.
const FIRST_WIDTH: f64 = 1.0;
const REDUCTION: f64 = 0.1;
/// Width at and below which the exact laws are tried, mostly with success, and the smallest width.
const NARROW_WIDTH: f64 = 1e-4;
const LEAST_WIDTH: f64 = 1e-6;
/// Maximum number of iterations at a width, which mostly takes two to five. After these, the laws
/// are solved at a larger width, and the rods linearised again if they still move.
const STUCK_ITERATIONS: usize = 10;
/// Largest violation of smoothed laws, in units of their width, at which they count as satisfied.
const FOLLOWED: f64 = 2.0;
/// Maximum number of times that a step is halved if it increases the violation of the smoothed
/// laws.
const HALVINGS: usize = 6;

/// Largest violation of the laws of a solution, relative to the largest force.
const TOLERANCE: f64 = 1e-9;
/// Largest violation, or width of solved smoothed laws, while rods still move, relative to the
/// typical force; and the same per move in radii, since normals turn as much. At motions below the
/// third value, in radii, forces are solved completely.
const LOOSEST: f64 = 0.1;
const LOOSENESS: f64 = 0.1;
const SLIGHT_MOVE: f64 = 1e-3;

/// Displacements in the solution of all linear laws.
pub(in crate::mechanics::system) struct Moves {
    /// The contact points, m.
    pub contacts: Vec<Vector3>,
    /// Largest displacement of a node, in radii.
    pub farthest: f64,
}

/// A search within a step; it keeps the width of the smoothed laws between linearisations of the rods.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForceSearch {
    /// Width of smoothed laws, N, while they are used.
    width: Option<f64>,
}

/// Scales of forces.
struct Sizes {
    /// That of a contact, N.
    typical: f64,
    /// Violation that is always accepted, N.
    negligible: f64,
    /// Smallest value, over all iterations, of the largest displacement of a node, in radii: wide
    /// laws move even rods at rest.
    farthest: f64,
}

impl ForceSearch {
    /// Finds forces that satisfy the laws of all contacts; returns whether it succeeded before
    /// iterations ran out. `move_by` solves for the motion under the given linear laws, one per
    /// contact. Laws count as satisfied if their violation is at most a fraction of the largest
    /// force, or `negligible`, N; the limit is larger while rods move far.
    pub(in crate::mechanics::system) fn find<E>(
        &mut self,
        contacts: &mut [RigidContact],
        negligible: f64,
        mut move_by: impl FnMut(&[State]) -> Result<Moves, E>,
    ) -> Result<bool, E> {
        let mut sizes = Sizes {
            typical: typical_force(contacts),
            negligible,
            farthest: f64::INFINITY,
        };
        if self.width.is_none() {
            if from_state_to_state(contacts, &mut sizes, &mut move_by)? {
                return Ok(true);
            }
            sizes.typical = typical_force(contacts);
            contacts.iter_mut().for_each(RigidContact::begin_again);
        }
        self.follow_smoothed_laws(contacts, &mut sizes, &mut move_by)
    }

    /// Follows smoothed laws to smaller widths: as far as the motion of the rods requires, or to
    /// the exact laws.
    fn follow_smoothed_laws<E>(
        &mut self,
        contacts: &mut [RigidContact],
        sizes: &mut Sizes,
        move_by: &mut impl FnMut(&[State]) -> Result<Moves, E>,
    ) -> Result<bool, E> {
        let first = FIRST_WIDTH * sizes.typical;
        let mut width = self.width.take().map_or(first, |width| width.min(first));
        let (mut at_width, mut is_widened, mut before) = (0, false, f64::INFINITY);
        for _ in 0..SMOOTHED_ITERATIONS {
            let left = iterates(contacts);
            let states: Vec<State> = contacts.iter_mut().map(|c| c.smooth(width)).collect();
            let moves = move_by(&states)?;
            let violation = follow(contacts, &states, &moves, sizes);
            if violation.is_infinite() {
                return Ok(false);
            }
            let part = shorten(contacts, &left, width, &mut before);
            let violations = contacts.iter().map(|one| one.smoothed_violation(width));
            let is_obeyed = violations.fold(0.0, f64::max) <= FOLLOWED * width;
            let allowed = sizes.allowed();
            let is_narrow = width <= allowed || is_widened && allowed > 0.0;
            if violation == 0.0 || is_obeyed && is_narrow && part == 1.0 {
                self.width = Some(width);
                return Ok(true);
            }
            at_width += 1;
            if is_obeyed && !is_narrow {
                if width <= NARROW_WIDTH * sizes.typical
                    && is_solved_near(contacts, sizes, move_by)?
                {
                    return Ok(true);
                }
                if width <= LEAST_WIDTH * sizes.typical {
                    return Ok(false);
                }
                width = (REDUCTION * width).max(allowed);
                (at_width, before) = (0, squared_violation(contacts, width));
            } else if at_width >= STUCK_ITERATIONS && width < first {
                width = (width / REDUCTION).min(first);
                (at_width, is_widened, before) = (0, true, f64::INFINITY);
            }
        }
        Ok(false)
    }
}

impl Sizes {
    /// Allowed error of forces while the rods still move, N.
    fn allowed(&self) -> f64 {
        if self.farthest > SLIGHT_MOVE {
            (LOOSENESS * self.farthest).min(LOOSEST) * self.typical
        } else {
            0.0
        }
    }
}

/// Shortens a step from `left` that has increased the squared violation of smoothed laws above
/// `before`, N², and updates `before`; returns the remaining part of the step.
fn shorten(
    contacts: &mut [RigidContact],
    left: &[[Vector3; 2]],
    width: f64,
    before: &mut f64,
) -> f64 {
    let mut now = squared_violation(contacts, width);
    let reached = iterates(contacts);
    let mut part = 1.0;
    for _ in 0..HALVINGS {
        if now < *before {
            break;
        }
        part *= 0.5;
        go_between(contacts, left, &reached, part);
        now = squared_violation(contacts, width);
    }
    *before = now;
    part
}

/// Forces and motions of the contacts so far.
fn iterates(contacts: &[RigidContact]) -> Vec<[Vector3; 2]> {
    contacts.iter().map(RigidContact::iterate).collect()
}

/// Interpolates all contacts between two iterates.
fn go_between(
    contacts: &mut [RigidContact],
    from: &[[Vector3; 2]],
    to: &[[Vector3; 2]],
    part: f64,
) {
    for (contact, (from, to)) in contacts.iter_mut().zip(from.iter().zip(to)) {
        contact.go_between(from, to, part);
    }
}

/// Whether iterations from the states of all contacts lead from a solution of narrow laws to a
/// solution of the exact laws; if not, they are undone.
fn is_solved_near<E>(
    contacts: &mut [RigidContact],
    sizes: &mut Sizes,
    move_by: &mut impl FnMut(&[State]) -> Result<Moves, E>,
) -> Result<bool, E> {
    let narrow = iterates(contacts);
    contacts.iter_mut().for_each(RigidContact::forget_changes);
    let solved = from_state_to_state(contacts, sizes, move_by)?;
    if !solved {
        go_between(contacts, &narrow, &narrow, 1.0);
    }
    Ok(solved)
}

/// Iterates from the states of all contacts to the next ones; returns whether this converged or
/// cycles.
fn from_state_to_state<E>(
    contacts: &mut [RigidContact],
    sizes: &mut Sizes,
    move_by: &mut impl FnMut(&[State]) -> Result<Moves, E>,
) -> Result<bool, E> {
    let mut first = None;
    for iteration in 1..=ITERATIONS {
        let states: Vec<State> = contacts.iter_mut().map(RigidContact::advance).collect();
        let moves = move_by(&states)?;
        let violation = follow(contacts, &states, &moves, sizes);
        if violation == 0.0 || violation.is_infinite() {
            return Ok(violation == 0.0);
        }
        let first = *first.get_or_insert(violation);
        let is_slow = iteration >= PATIENCE && violation > LEFT_OVER * first;
        if is_slow || violation > CYCLING_GROWTH * first {
            break;
        }
    }
    Ok(false)
}

/// Median of the nonzero contact forces, N: when iterations cycle, some forces are far too large.
/// If all are zero, the inertial force that closes or opens the largest gap.
fn typical_force(contacts: &[RigidContact]) -> f64 {
    let sizes = contacts.iter().map(|contact| contact.force().norm());
    let mut sizes: Vec<f64> = sizes.filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let found = sizes.get(sizes.len() / 2).copied();
    found.unwrap_or_else(|| {
        let sizes = contacts.iter().map(RigidContact::size_of_gap);
        sizes.fold(0.0, f64::max)
    })
}

/// Stores the motions under linear laws; returns the present violation of the laws, N: zero if it
/// counts as satisfied, infinite if a value is not finite.
fn follow(
    contacts: &mut [RigidContact],
    states: &[State],
    moves: &Moves,
    sizes: &mut Sizes,
) -> f64 {
    let (mut largest, mut violation) = (0.0_f64, 0.0_f64);
    for (contact, (state, moved)) in contacts.iter_mut().zip(states.iter().zip(&moves.contacts)) {
        largest = largest.max(contact.follow(state, moved).norm());
        let own = contact.violation();
        if !own.is_finite() {
            return f64::INFINITY;
        }
        violation = violation.max(own);
    }
    sizes.farthest = sizes.farthest.min(moves.farthest);
    let loose = sizes.allowed();
    if violation <= (TOLERANCE * largest).max(sizes.negligible).max(loose) {
        0.0
    } else {
        violation
    }
}

/// Sum of the squared violations of smoothed laws of width `width` (N), N².
fn squared_violation(contacts: &[RigidContact], width: f64) -> f64 {
    let squares = contacts
        .iter()
        .map(|contact| contact.smoothed_violation(width).powi(2));
    squares.sum()
}
