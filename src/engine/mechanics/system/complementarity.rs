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
//! **Joints and bodies.** Forces on nodes with dependent positions act on the unknowns that
//! determine these (`linear`, `attached`). At free bodies, gaps and slips contain the
//! rotation of the bodies (`contact::constraint_turns`). The derivatives at sliding nodes and at
//! free bodies depend on the forces there: A contains those of the last pass.
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

use super::constraint_matrix::ConstraintMatrix;
use super::rigid_contact::{ForceSearch, Moves, RigidContact};
use super::{Stage, System, copy_positions};
use crate::linalg::{ElementMatrix, SingularMatrix};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ConstraintTurns, ContactConstraint, ContactSystem};
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
        // The derivatives at a sliding node contain the force on it, and so does the choice
        // whether a stop holds it; those at a free body contain the forces on its vertices. The
        // forces of the last pass act there.
        let joints = &self.assembly.joints;
        let carries = !joints.slides.is_empty() || !self.matrix.attached().is_empty();
        if carries {
            self.linearize(unknowns, Some(stage));
        }
        let Some(mut contact) = self.terms.contact.model.take() else {
            return Ok(0.0);
        };
        let earlier = contact.release_constraints();
        let found = if contact.candidates().is_empty() && !self.terms.contact.has_planes {
            Ok(0.0)
        } else {
            if carries {
                self.remove_from_residual(&contact, &earlier, stage);
            } else {
                self.linearize(unknowns, Some(stage));
            }
            self.load_constraints(&mut contact, &earlier, unknowns, stage, search, radius)
        };
        self.terms.contact.model = Some(contact);
        found
    }

    /// Adds the last correction of [`Self::find_contact_forces`] to the unknowns, scaled down so
    /// that no position moves farther than `farthest`, m.
    pub(crate) fn take_correction(&mut self, unknowns: &mut [f64], farthest: f64) {
        let part = (farthest / largest_move(&self.terms.contact.correction)).min(1.0);
        for (own, correction) in unknowns.iter_mut().zip(&self.terms.contact.correction) {
            *own += part * correction;
        }
        self.complete(unknowns);
    }

    /// Removes the forces of constraints of `contact` from the residual of the last evaluation, the
    /// positions of which contact has.
    fn remove_from_residual(
        &mut self,
        contact: &ContactSystem,
        constraints: &[ContactConstraint],
        stage: &Stage,
    ) {
        let mut forces = std::mem::take(&mut self.terms.contact.correction);
        forces.clear();
        forces.resize(self.residual.len(), 0.0);
        for constraint in constraints {
            let turns = self.turns_at(contact, constraint, stage);
            self.push(constraint, turns.as_ref(), &constraint.force, &mut forces);
        }
        self.matrix.attached().gather(&mut forces);
        self.assembly.joints.gather(&mut forces);
        for (residual, force) in self.residual.iter_mut().zip(&forces) {
            *residual += force;
        }
        self.terms.contact.correction = forces;
    }

    /// Lists the constraints of `contact`, which was taken out of the linearised system, and applies
    /// their forces; returns the largest move of a node by all forces, m.
    fn load_constraints(
        &mut self,
        contact: &mut ContactSystem,
        earlier: &[ContactConstraint],
        unknowns: &[f64],
        stage: &Stage,
        search: &mut ForceSearch,
        radius: f64,
    ) -> Result<f64, NoContactForces> {
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
            let turns = self.turns_at(contact, constraint, stage);
            let force = &constraint.force;
            self.push(constraint, turns.as_ref(), force, &mut correction);
        }
        self.solve_with_bodies(&mut correction)?;
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
        let constraints = contact.constraints();
        let turns_at = |constraint| self.turns_at(contact, constraint, stage);
        let turns_of: Vec<Option<ConstraintTurns>> = constraints.iter().map(turns_at).collect();
        let mut contacts: Vec<RigidContact> = (constraints.iter().zip(&turns_of))
            .map(|(constraint, turns)| {
                let mut slid = constraint.turned
                    + constraint.relative_motion(|node| self.slid(contact, node, stage));
                if let Some(turns) = turns {
                    slid += turns.slid();
                }
                RigidContact::new(constraint, slid, self.inertia_at(constraint, stage))
            })
            .collect();
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
                let turning = turning.get(index);
                if let Some(turns) = &turns_of[index] {
                    let jacobian = turns.jacobian(constraint, &state.stiffness, turning);
                    let matrix = ConstraintMatrix::OfBodies(turns.bodies(), jacobian);
                    return (constraint.place(), matrix);
                }
                let mut matrix = state.matrix(constraint);
                let turning = turning.map_or(&[][..], |one| one.as_flattened());
                for (entry, turn) in matrix.as_flattened_mut().iter_mut().zip(turning) {
                    *entry -= turn;
                }
                (constraint.place(), ConstraintMatrix::OfNodes(matrix))
            });
            self.matrix.set_constraints(contact, matrices);
            self.factor()?;
            self.free_forces(correction);
            for ((constraint, turns), state) in constraints.iter().zip(&turns_of).zip(states) {
                self.push(constraint, turns.as_ref(), &state.force, correction);
            }
            self.solve_with_bodies(correction)?;
            if correction.iter().any(|entry| !entry.is_finite()) {
                return Err(NoContactForces::Unsolved);
            }
            let of_nodes = &correction[..STRIDE * self.assembly.rods.nodes];
            let of_node = |node: usize| motion_of(of_nodes, node);
            let attached = self.matrix.attached();
            let of_body = |body: usize| attached.turn_of(body, correction);
            let moved = |(constraint, turns): (&ContactConstraint, &Option<ConstraintTurns>)| {
                let along = turns.as_ref().map(|turns| turns.moved(of_node, of_body));
                constraint.relative_motion(of_node) + along.unwrap_or_default()
            };
            Ok(Moves {
                contacts: constraints.iter().zip(&turns_of).map(moved).collect(),
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
        let of_node = |node: usize, weight: f64| {
            if self.matrix.attached().contains(node) {
                weight * weight * self.terms.contact.mobilities[node]
            } else {
                weight * weight * square / self.assembly.mass_at(node)
            }
        };
        let mobility: f64 = (constraint.nodes.iter().zip(constraint.weights))
            .filter(|(node, _)| self.moves(**node))
            .map(|(&node, weight)| of_node(node, weight))
            .sum();
        if mobility > 0.0 { 1.0 / mobility } else { 1.0 }
    }

    /// Rotations at a constraint, at the positions of contact.
    fn turns_at(
        &self,
        contact: &ContactSystem,
        constraint: &ContactConstraint,
        stage: &Stage,
    ) -> Option<ConstraintTurns> {
        contact.turns_at(constraint, &self.terms.contact.positions, &stage.positions)
    }

    /// Solves for the motion under forces on all nodes, with the vertices of free bodies.
    fn solve_with_bodies(&mut self, motion: &mut [f64]) -> Result<(), SingularMatrix> {
        self.matrix.attached().gather(motion);
        self.solve(motion)?;
        self.matrix.attached().spread(motion);
        Ok(())
    }

    /// Whether a node moves, freely or with a free body.
    fn moves(&self, node: usize) -> bool {
        self.assembly.is_free(node) || self.matrix.attached().contains(node)
    }

    /// Writes −R.
    fn free_forces(&self, forces: &mut [f64]) {
        let entries = self.residual.iter().zip(&self.assembly.held);
        for (force, (residual, held)) in forces.iter_mut().zip(entries) {
            *force = if *held { 0.0 } else { -residual };
        }
    }

    /// Adds a force (N) at a contact with rotations `turns` to the forces on nodes and bodies.
    fn push(
        &self,
        constraint: &ContactConstraint,
        turns: Option<&ConstraintTurns>,
        force: &Vector3,
        forces: &mut [f64],
    ) {
        for (&node, weight) in constraint.nodes.iter().zip(constraint.weights) {
            if self.moves(node) {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += weight * force[axis];
                }
            }
        }
        let Some(turns) = turns else {
            return;
        };
        for (&node, couple) in constraint
            .nodes
            .iter()
            .zip(turns.couples(force).as_chunks::<3>().0)
        {
            if self.moves(node) {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += couple[axis];
                }
            }
        }
        for (body, moment) in turns.moments(force) {
            if let Some(body) = body {
                self.matrix.attached().add_moment(body, &moment, forces);
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
