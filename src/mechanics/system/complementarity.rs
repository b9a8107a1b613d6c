//! Contact forces by complementarity: the linearised step with Signorini's and Coulomb's laws (thesis 3.3).
//!
//! Newton's system of a step without contact, A δq = −R, and the forces λ at the contacts, which act on the
//! unknowns by the transpose of the rows H of their gaps and slips, give
//!
//! ```text
//! δq = A⁻¹ (Hᵀλ − R),   w = g + H δq = D λ + (g − H A⁻¹R),   D = H A⁻¹ Hᵀ,
//! ```
//!
//! with the Delassus operator D, by a solution with the factors of A for each row. The laws between λ and w
//! are those of [`CoulombProblem`].
//!
//! Solved once per step this is the two-step method of the thesis: forces explicit, then the rods. Here it is
//! repeated around Newton's method for the rods under these forces, until the forces found anew would move
//! no node farther than the displacement tolerance. Contact points and directions are then those of the end of
//! the step.
//!
//! **What holds.** No creep in sticking; sliding exactly at μ; contact forces in balance; no restitution. Gaps
//! are never less than zero by more than the square of that tolerance over the edge length, and the
//! millionth of the motion that contact prevents.
//!
//! **What does not.** Nothing keeps edges from passing through each other between two configurations without
//! overlap: that takes steps in which rods move by less than their radius. With friction the laws may have
//! several solutions, or none; a step whose contact problem is not solved counts as failed and is halved.
//! How contacts that do the same work share their force is up to a small compliance. The cost is a solution
//! per contact and direction that may close, and the cube of the number of those that press.

use super::{Stage, System, copy_positions};
use crate::linalg::SingularMatrix;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactConstraint, ContactSystem, CoulombProblem};
use crate::mechanics::rod::{STRIDE, topology::position};
use nalgebra::{DMatrix, DVector};

/// Why no contact forces were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoContactForces {
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
    /// Whether contact forces are found by complementarity.
    pub fn has_constraints(&self) -> bool {
        let contact = self.contact.as_ref();
        contact.is_some_and(|contact| contact.parameters().is_complementarity())
    }

    /// Finds the contact forces of the step `stage` linearised at `unknowns`; they act until the next call.
    /// Returns the largest move of a node that they and the other forces would cause, m: small where `unknowns`
    /// are the solution already.
    ///
    /// # Errors
    /// [`NoContactForces`].
    pub fn find_contact_forces(
        &mut self,
        unknowns: &[f64],
        stage: &Stage,
    ) -> Result<f64, NoContactForces> {
        let Some(mut contact) = self.contact.take() else {
            return Ok(0.0);
        };
        contact.release_constraints();
        let found = if contact.candidates().is_empty() && !self.has_planes {
            Ok(0.0)
        } else {
            self.load_constraints(&mut contact, unknowns, stage)
        };
        self.contact = Some(contact);
        found
    }

    /// Lists the constraints of `contact`, taken out of the system, and loads them with their forces; returns the
    /// largest move of a node by all forces, m.
    fn load_constraints(
        &mut self,
        contact: &mut ContactSystem,
        unknowns: &[f64],
        stage: &Stage,
    ) -> Result<f64, NoContactForces> {
        self.linearize(unknowns, Some(stage));
        self.factor()?;
        let mut correction = std::mem::take(&mut self.correction);
        correction.resize(unknowns.len(), 0.0);
        self.direction(&mut correction)?;
        let nodes = 0..self.positions.len();
        let reaches: Vec<f64> = nodes
            .map(|node| position(&correction, node).norm())
            .collect();
        copy_positions(unknowns, &mut self.positions);
        contact.list_constraints(&self.positions, &reaches);
        let forces = self.solve_constraints(contact.constraints(), stage, &mut correction)?;
        contact.load_constraints(forces.as_slice());
        let moved = largest_move(&correction);
        self.correction = correction;
        Ok(moved)
    }

    /// The forces of all constraints, and the correction of the unknowns with them in place of that without.
    fn solve_constraints(
        &mut self,
        constraints: &[ContactConstraint],
        stage: &Stage,
        correction: &mut [f64],
    ) -> Result<DVector<f64>, NoContactForces> {
        let has_friction = constraints
            .iter()
            .any(|constraint| constraint.friction > 0.0);
        let directions = if has_friction { 3 } else { 1 };
        let rows = directions * constraints.len();
        let row_of = |row: usize| (&constraints[row / directions], row % directions);
        let unknowns = correction.len();
        let mut responses = std::mem::take(&mut self.responses);
        responses.clear();
        responses.resize(rows * unknowns, 0.0);
        let mut free = DVector::zeros(rows);
        for (row, response) in responses.chunks_exact_mut(unknowns).enumerate() {
            let (constraint, axis) = row_of(row);
            let moved = constraint.relative_motion(|node| {
                let so_far = self.positions[node] - stage.positions[node];
                let slid = if axis > 0 { so_far } else { Vector3::zeros() };
                position(correction, node) + slid
            });
            free[row] = moved.dot(&constraint.frame[axis]);
            if axis == 0 {
                free[row] += constraint.gap;
            }
            for (&node, weight) in constraint.nodes.iter().zip(constraint.weights) {
                for component in 0..3 {
                    let unknown = STRIDE * node + component;
                    if !self.assembly.held[unknown] {
                        response[unknown] += weight * constraint.frame[axis][component];
                    }
                }
            }
            self.matrix.solve(response)?;
        }
        let response_to = |row: usize| &responses[row * unknowns..][..unknowns];
        let delassus = DMatrix::from_fn(rows, rows, |row, column| {
            let (constraint, axis) = row_of(row);
            let moved = constraint.relative_motion(|node| position(response_to(column), node));
            moved.dot(&constraint.frame[axis])
        });
        let friction = constraints.iter().map(|constraint| constraint.friction);
        let problem = CoulombProblem::new(delassus, free, friction.collect());
        let forces = problem.solve().map_err(|_| NoContactForces::Unsolved)?;
        for (row, force) in forces.iter().enumerate() {
            for (own, response) in correction.iter_mut().zip(response_to(row)) {
                *own += force * response;
            }
        }
        self.responses = responses;
        Ok(forces)
    }
}

/// Largest move of a position, m.
fn largest_move(correction: &[f64]) -> f64 {
    let nodes = 0..correction.len() / STRIDE;
    nodes.fold(0.0, |most, node| {
        f64::max(most, position(correction, node).norm())
    })
}
