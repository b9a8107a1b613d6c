//! The search for forces that obey the laws of many contacts at once.
//!
//! Going from the states of all contacts to the forces that they ask for, and from these to the next states, is Newton's method
//! for a function with corners. Where few states change it ends within a few iterations; where many do, it may cycle. Then the laws
//! are smoothed ([`super::smoothed`]), and the width of the smoothing falls as iterations follow it down to nothing. Every
//! iterate solves the equations of the rods, and so does what lies between two of them: a step that makes the smoothed laws worse
//! is shortened without another solution of a linear system.
//!
//! The rods are linearised again as they move, and forces are asked for no better than that: the width is carried from one
//! linearisation to the next.

use super::{RigidContact, State};
use crate::mechanics::Vector3;

/// Iterations from state to state before they count as cycling: where they do not, they take three or four.
const ITERATIONS: usize = 6;
/// The same where smoothed laws have led near the solution.
const LAST_ITERATIONS: usize = 12;
/// Iterations with smoothed laws before the contact problem counts as unsolved; they take about fifteen.
const SMOOTHED_ITERATIONS: usize = 60;

/// Width ν of smoothed laws at first, in units of the typical force, by what it falls, and where it ends.
const FIRST_WIDTH: f64 = 1.0;
const REDUCTION: f64 = 0.1;
const LAST_WIDTH: f64 = 1e-6;
/// Times that a step is halved that makes the smoothed laws worse.
const HALVINGS: usize = 6;

/// Largest violation of the laws of a solution, relative to the largest force.
const TOLERANCE: f64 = 1e-9;
/// Largest violation while rods still move, relative to the typical force, and the same per move in radii: normals turn as
/// much. From the second move on, in radii, forces are known as well as they can be.
const LOOSEST: f64 = 3e-2;
const LOOSENESS: f64 = 3e-2;
const SLIGHT_MOVE: f64 = 1e-3;

/// What the solution of all linear laws moves.
pub(in crate::mechanics::system) struct Moves {
    /// The contact points, m.
    pub contacts: Vec<Vector3>,
    /// The node that moves farthest, in radii.
    pub farthest: f64,
}

/// A search within a step; it remembers between linearisations of the rods how narrow smoothed laws have become.
#[derive(Clone, Debug, Default)]
pub struct ForceSearch {
    /// Width of smoothed laws, N, while they lead.
    width: Option<f64>,
}

/// What forces are measured by.
struct Sizes {
    /// That of a contact, N.
    typical: f64,
    /// What counts as obeyed in any case, N.
    negligible: f64,
}

impl ForceSearch {
    /// Finds forces that obey the laws of all contacts; says whether they do, or iterations ran out. `move_by` solves for the
    /// motion under the linear laws that it is given, one per contact. Laws count as obeyed where they are broken by no more
    /// than a part of the largest force, or by `negligible`, N; more is left while rods move far.
    pub(in crate::mechanics::system) fn find<E>(
        &mut self,
        contacts: &mut [RigidContact],
        negligible: f64,
        mut move_by: impl FnMut(&[State]) -> Result<Moves, E>,
    ) -> Result<bool, E> {
        let mut sizes = Sizes {
            typical: typical_force(contacts),
            negligible,
        };
        if self.width.is_none() {
            if from_state_to_state(contacts, &sizes, ITERATIONS, &mut move_by)? {
                return Ok(true);
            }
            sizes.typical = typical_force(contacts);
            contacts.iter_mut().for_each(RigidContact::begin_again);
        }
        let first = FIRST_WIDTH * sizes.typical;
        let mut width = self
            .width
            .map_or(first, |width| (width / REDUCTION).min(first));
        let least = LAST_WIDTH * sizes.typical;
        let mut before = f64::INFINITY;
        for _ in 0..SMOOTHED_ITERATIONS {
            let left: Vec<[Vector3; 2]> = contacts.iter().map(RigidContact::iterate).collect();
            let states: Vec<State> = contacts.iter_mut().map(|c| c.smooth(width)).collect();
            let moves = move_by(&states)?;
            let violation = follow(contacts, &states, &moves, &sizes);
            if violation == 0.0 {
                self.width = Some(width);
                return Ok(true);
            }
            if violation.is_infinite() {
                return Ok(false);
            }
            before = shorten(contacts, &left, width, before);
            let largest = contacts
                .iter()
                .map(|c| c.smoothed_violation(width))
                .fold(0.0, f64::max);
            if largest <= width {
                if width <= least {
                    break;
                }
                width *= REDUCTION;
                before = squared_violation(contacts, width);
            }
        }
        self.width = None;
        contacts.iter_mut().for_each(RigidContact::forget_changes);
        from_state_to_state(contacts, &sizes, LAST_ITERATIONS, &mut move_by)
    }
}

/// Shortens a step from `left` that has made the squared violation of smoothed laws larger than `before`, N²; returns what it is
/// then.
fn shorten(contacts: &mut [RigidContact], left: &[[Vector3; 2]], width: f64, before: f64) -> f64 {
    let mut now = squared_violation(contacts, width);
    let reached: Vec<[Vector3; 2]> = contacts.iter().map(RigidContact::iterate).collect();
    let mut part = 1.0;
    for _ in 0..HALVINGS {
        if now < before {
            break;
        }
        part *= 0.5;
        for (contact, (from, to)) in contacts.iter_mut().zip(left.iter().zip(&reached)) {
            contact.go_between(from, to, part);
        }
        now = squared_violation(contacts, width);
    }
    now
}

/// Iterations from the states of all contacts to the next ones; says whether they have led to the solution.
fn from_state_to_state<E>(
    contacts: &mut [RigidContact],
    sizes: &Sizes,
    iterations: usize,
    move_by: &mut impl FnMut(&[State]) -> Result<Moves, E>,
) -> Result<bool, E> {
    for _ in 0..iterations {
        let states: Vec<State> = contacts.iter_mut().map(RigidContact::advance).collect();
        let moves = move_by(&states)?;
        let violation = follow(contacts, &states, &moves, sizes);
        if violation == 0.0 || violation.is_infinite() {
            return Ok(violation == 0.0);
        }
    }
    Ok(false)
}

/// Median of the forces of contacts that bear any, N: where iterations cycle some are far too large. Where none does, the force of
/// the inertia that closes or opens the largest gap.
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

/// Takes over the motions under linear laws; returns by how much the contacts break their laws now, N: zero where that
/// counts as obeyed, infinite where a number is not finite.
fn follow(contacts: &mut [RigidContact], states: &[State], moves: &Moves, sizes: &Sizes) -> f64 {
    let (mut largest, mut violation) = (0.0_f64, 0.0_f64);
    for (contact, (state, moved)) in contacts.iter_mut().zip(states.iter().zip(&moves.contacts)) {
        largest = largest.max(contact.follow(state, moved).norm());
        let own = contact.violation();
        if !own.is_finite() {
            return f64::INFINITY;
        }
        violation = violation.max(own);
    }
    let loose = if moves.farthest > SLIGHT_MOVE {
        (LOOSENESS * moves.farthest).min(LOOSEST) * sizes.typical
    } else {
        0.0
    };
    if violation <= (TOLERANCE * largest).max(sizes.negligible).max(loose) {
        0.0
    } else {
        violation
    }
}

/// Sum of the squares by which smoothed laws of width `width` (N) are broken, N².
fn squared_violation(contacts: &[RigidContact], width: f64) -> f64 {
    let squares = contacts
        .iter()
        .map(|contact| contact.smoothed_violation(width).powi(2));
    squares.sum()
}
