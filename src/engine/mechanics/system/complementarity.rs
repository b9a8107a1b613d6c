//! Contact forces by complementarity: the linearised step with Signorini's and Coulomb's laws (thesis 3.3).
//!
//! Newton's system of a step without contact is A δq = −R. Forces λ at the contacts act on the
//! unknowns by the transpose of the rows H of their gaps and slips. With them the system is
//!
//! ```text
//! A δq = Hᵀλ − R,   w = g + H δq,
//! ```
//!
//! with 0 ≤ λ_n ⊥ w_n ≥ 0 (Eq. 3.1) and ‖λ_t‖ ≤ μ λ_n, λ_t = −μ λ_n w_t/‖w_t‖ where w_t ≠ 0 (Eq.
//! 3.2); `rigid_contact` has the laws of a single contact. All laws hold where Alart and Curnier's
//! function (Eq. 3.3) vanishes, and Newton's method finds its roots. With each contact in the
//! state that the last iteration suggests (open, sticking, sliding) the laws are linear, and one
//! factorisation of the sparse matrix A + Hᵀ K H solves them all. Here K is the stiffness of
//! contacts that hardly yield; their forces of the last iteration are included, so that the
//! displacement by which they yield vanishes (proximal point). Starting from the forces of the
//! previous step, this takes only the iterations needed to find the states; if the states cycle,
//! smoothed laws lead to the solution (`rigid_contact::search`).
//!
//! Possible contacts are predicted from the motion under the present forces, initially those of
//! the last step: rods that fall or carry a load together do not approach each other. A contact
//! missed by the prediction is found as an overlap in the next pass. From then on it belongs to
//! the step, with or without a force.
//!
//! Contacts turn with the rods. If edges are nearly parallel, the contact points run along them as
//! they turn, and alternating between rods and forces would not converge. From the second pass on,
//! A therefore includes the change of the last forces as their contacts turn.
//!
//! The two-step method of the thesis does this once per step: forces explicitly, then the rods.
//! Here it is repeated around Newton's method for the rods under these forces, until the new
//! forces would move no node farther than the displacement tolerance. Contact points and
//! directions are then those of the end of the step.
//!
//! **Guarantees.** No creep in sticking; sliding exactly at μ; contact forces in balance; no
//! restitution. Gaps are never below zero by more than the square of that tolerance over the edge
//! length.
//!
//! **Limits.** The method does not prevent edges from passing through each other between two
//! configurations without overlap: the certificate of the step detects this, and the step is
//! halved. With friction the laws may have several solutions, or none; a step with an unsolved
//! contact problem counts as failed and is halved, too. The distribution of the force over
//! redundant contacts depends on the start of the iteration.

use super::rigid_contact::{ForceSearch, Moves, RigidContact, State};
use super::{Stage, System, copy_positions};
use crate::linalg::{ElementMatrix, SingularMatrix};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactConstraint, ContactSystem};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{motion_of, position};

/// Allowed violation of the contact laws as a fraction of the residual that Newton's method
/// leaves: light contacts of rods with far larger forces need not be more accurate.
const NEGLIGIBLE_PART: f64 = 1e-2;

/// Reason why the contact forces could not be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoContactForces {
    /// Newton's matrix is singular.
    SingularMatrix,
    /// The contact problem has no solution, or none was found.
    Unsolved,
}

impl From<SingularMatrix> for NoContactForces {
    fn from(_: SingularMatrix) -> Self {
        Self::SingularMatrix
    }
}

impl System {
    /// Whether contact forces are computed by complementarity.
    pub(crate) fn has_constraints(&self) -> bool {
        self.terms.contact.is_rigid()
    }

    /// Whether nearby rods move by more than `far` (m) relative to each other in a step that ends
    /// at `unknowns`.
    pub(crate) fn meets_fast(&self, unknowns: &[f64], stage: &Stage, far: f64) -> bool {
        let starts = stage.positions.iter().enumerate();
        let motions: Vec<Vector3> = starts
            .map(|(node, start)| position(unknowns, node) - start)
            .collect();
        let contact = self.contact();
        contact.is_some_and(|contact| contact.largest_relative_motion(&motions) > far)
    }

    /// Computes the contact forces of the step `stage`, linearised at `unknowns`; they act until
    /// the next call. All calls of one attempt at a step share one `search`; `radius` is that of
    /// the thinnest rod, m. Returns the largest move of a node that these and the other forces
    /// would cause, m: small if `unknowns` are already the solution, infinite while the forces
    /// violate the laws.
    ///
    /// # Errors
    /// [`NoContactForces`].
    pub(crate) fn find_contact_forces(
        &mut self,
        unknowns: &[f64],
        stage: &Stage,
        search: &mut ForceSearch,
        radius: f64,
    ) -> Result<f64, NoContactForces> {
        let Some(mut contact) = self.terms.contact.model.take() else {
            return Ok(0.0);
        };
        let earlier = contact.release_constraints();
        let found = if contact.candidates().is_empty() && !self.terms.contact.has_planes {
            Ok(0.0)
        } else {
            self.load_constraints(&mut contact, &earlier, unknowns, stage, search, radius)
        };
        self.terms.contact.model = Some(contact);
        found
    }

    /// Adds the last correction of [`Self::find_contact_forces`] to the unknowns, scaled down so
    /// that no position moves farther than `farthest`, m.
    pub(crate) fn take_correction(&self, unknowns: &mut [f64], farthest: f64) {
        let part = (farthest / largest_move(&self.terms.contact.correction)).min(1.0);
        for (own, correction) in unknowns.iter_mut().zip(&self.terms.contact.correction) {
            *own += part * correction;
        }
    }

    /// Lists the constraints of `contact`, which was taken out of the system, and applies their
    /// forces; returns the largest move of a node by all forces, m.
    fn load_constraints(
        &mut self,
        contact: &mut ContactSystem,
        earlier: &[ContactConstraint],
        unknowns: &[f64],
        stage: &Stage,
        search: &mut ForceSearch,
        radius: f64,
    ) -> Result<f64, NoContactForces> {
        self.linearize(unknowns, Some(stage));
        self.matrix.expect_contacts(contact);
        self.factor()?;
        let mut correction = std::mem::take(&mut self.terms.contact.correction);
        correction.resize(unknowns.len(), 0.0);
        copy_positions(unknowns, &mut self.terms.contact.positions);
        // Bodies that approach each other under the present forces may touch; the next pass may
        // find other contacts.
        let mut motions = vec![Vector3::zeros(); self.terms.contact.positions.len()];
        contact.list_constraints(&self.terms.contact.positions, &motions, 0.0, earlier);
        self.free_forces(&mut correction);
        for constraint in contact.constraints() {
            self.push(constraint, &constraint.force, &mut correction);
        }
        self.matrix.solve(&mut correction)?;
        copy_positions(&correction, &mut motions);
        contact.list_constraints(&self.terms.contact.positions, &motions, 0.0, earlier);
        if contact.couple_constraints() {
            self.matrix.expect_other_candidates();
        }
        let mut moved = 0.0;
        if !contact.constraints().is_empty() {
            // Forces of the last step refer to other contact points and directions.
            let turns = !earlier.is_empty();
            let (forces, solved) =
                self.solve_constraints(contact, stage, &mut correction, turns, search, radius)?;
            contact.load_constraints(&forces);
            if !solved {
                moved = f64::INFINITY;
            }
        }
        let moved = largest_move(&correction).max(moved);
        self.terms.contact.correction = correction;
        Ok(moved)
    }

    /// Returns the forces of all constraints, N, whether they satisfy the laws, and the correction
    /// of the unknowns with them. The forces may belong to other configurations unless the contact
    /// `turns` under the present ones.
    fn solve_constraints(
        &mut self,
        contact: &ContactSystem,
        stage: &Stage,
        correction: &mut [f64],
        turns: bool,
        search: &mut ForceSearch,
        radius: f64,
    ) -> Result<(Vec<Vector3>, bool), NoContactForces> {
        let mut contacts: Vec<RigidContact> = contact
            .constraints()
            .iter()
            .map(|constraint| {
                let slid = constraint.relative_motion(|node| self.slid(contact, node, stage));
                RigidContact::new(constraint, slid, self.inertia_at(constraint, stage))
            })
            .collect();
        let constraints = contact.constraints();
        let turning_of = |constraint| contact.turning(constraint, &self.terms.contact.positions);
        let turning: Vec<ElementMatrix> = if turns {
            constraints.iter().map(turning_of).collect()
        } else {
            Vec::new()
        };
        let negligible = NEGLIGIBLE_PART * self.least_tolerance();
        let solved = search.find(&mut contacts, negligible, |states| {
            let laws = constraints.iter().zip(states).enumerate();
            let matrices = laws.map(|(index, (constraint, state))| {
                let mut matrix = state.matrix(constraint);
                let turning = turning.get(index).map_or(&[][..], |one| one.as_flattened());
                for (entry, turn) in matrix.as_flattened_mut().iter_mut().zip(turning) {
                    *entry -= turn;
                }
                (constraint.place(), matrix)
            });
            self.matrix.set_constraints(contact, matrices);
            self.factor()?;
            self.correct_by(constraints, states, correction);
            self.matrix.solve(correction)?;
            if correction.iter().any(|entry| !entry.is_finite()) {
                return Err(NoContactForces::Unsolved);
            }
            let moved = |constraint: &ContactConstraint| {
                constraint.relative_motion(|node| motion_of(correction, node))
            };
            Ok(Moves {
                contacts: constraints.iter().map(moved).collect(),
                farthest: largest_move(correction) / radius,
            })
        })?;
        let forces = contacts.iter().map(RigidContact::force).collect();
        Ok((forces, solved))
    }

    /// Displacement of a node, or of a vertex of an obstacle, since the start of the step, m.
    pub(super) fn slid(&self, contact: &ContactSystem, node: usize, stage: &Stage) -> Vector3 {
        match self.terms.contact.positions.get(node) {
            Some(position) => position - stage.positions[node],
            None => contact.vertex_motion(node),
        }
    }

    /// Inertia ρ of the contact points of a constraint within the step, N/m.
    fn inertia_at(&self, constraint: &ContactConstraint, stage: &Stage) -> f64 {
        let square = stage.step * stage.acceleration_step;
        let mobility: f64 = (constraint.nodes.iter().zip(constraint.weights))
            .filter(|(node, _)| self.assembly.is_free(**node))
            .map(|(&node, weight)| weight * weight * square / self.assembly.masses[STRIDE * node])
            .sum();
        if mobility > 0.0 { 1.0 / mobility } else { 1.0 }
    }

    /// Writes −R with the constant part of the contact forces into `correction`.
    fn correct_by(
        &self,
        constraints: &[ContactConstraint],
        states: &[State],
        correction: &mut [f64],
    ) {
        self.free_forces(correction);
        for (constraint, state) in constraints.iter().zip(states) {
            self.push(constraint, &state.force, correction);
        }
    }

    /// Writes −R.
    fn free_forces(&self, forces: &mut [f64]) {
        let entries = self.residual.iter().zip(&self.assembly.held);
        for (force, (residual, held)) in forces.iter_mut().zip(entries) {
            *force = if *held { 0.0 } else { -residual };
        }
    }

    /// Adds a force (N) at a contact to the forces on the unknowns.
    fn push(&self, constraint: &ContactConstraint, force: &Vector3, forces: &mut [f64]) {
        for (&node, weight) in constraint.nodes.iter().zip(constraint.weights) {
            if self.assembly.is_free(node) {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += weight * force[axis];
                }
            }
        }
    }
}

/// Largest move of a position, m.
fn largest_move(correction: &[f64]) -> f64 {
    let nodes = 0..correction.len() / STRIDE;
    nodes.fold(0.0, |most, node| {
        f64::max(most, position(correction, node).norm())
    })
}
