//! The frictional contact problem of one linearised step: Signorini's and Coulomb's laws for many contacts at
//! once (thesis 3.3, Eqs. 3.1–3.3; Alart and Curnier 1991).
//!
//! Contact c has the force λ = (λ_n, λ_t) in its local frame, and the surfaces move by the gap and slip
//! w = D λ + c, where D is the Delassus operator, symmetric and positive (semi)definite. Wanted is λ with
//!
//! - 0 ≤ λ_n ⊥ w_n ≥ 0 (Eq. 3.1),
//! - ‖λ_t‖ ≤ μ λ_n, and λ_t = −μ λ_n w_t/‖w_t‖ where w_t ≠ 0 (Eq. 3.2).
//!
//! With any ρ > 0 this is the root of Alart and Curnier's function (Eq. 3.3),
//!
//! ```text
//! Φ_n = λ_n − (λ_n − ρ_n w_n)₊,   Φ_t = λ_t − P(λ_t − ρ_t w_t),
//! ```
//!
//! P being the projection on the disk of radius μ (λ_n − ρ_n w_n)₊. Φ is piecewise smooth, so that Newton's
//! method with an element of its generalised Jacobian converges in a few steps near a solution. Farther
//! away it may cycle: a step that does not lower ‖Φ‖ is replaced by sweeps of a projected Gauss–Seidel
//! iteration, which is slow and hardly ever fails.

use nalgebra::{DMatrix, DVector};

/// Newton steps, with the sweeps between them, before the problem counts as unsolved.
const ITERATIONS: usize = 300;
/// Halvings of a Newton step that makes things worse, before sweeps take its place.
const HALVINGS: i32 = 4;
/// Sweeps in place of a Newton step.
const SWEEPS: usize = 30;
/// Largest ‖Φ‖∞ of a solution, relative to the largest force.
const TOLERANCE: f64 = 1e-9;
/// Compliance added to the diagonal, relative to the largest: contacts that do the same work, as at the joint
/// of two edges, share their force. It leaves a penetration of this fraction of the motion that contact
/// prevents.
const COMPLIANCE: f64 = 1e-6;

/// A frictional contact problem. With `directions` 3, contact c owns the rows 3c (normal), 3c + 1 and 3c + 2
/// (tangents); with 1 there is no friction and only the normal.
#[derive(Clone, Debug)]
pub(crate) struct CoulombProblem {
    delassus: DMatrix<f64>,
    /// Gap and slip without contact forces, m.
    free: DVector<f64>,
    friction: Vec<f64>,
    directions: usize,
    /// ρ of every row, N/m.
    weights: DVector<f64>,
}

/// Which branch of Φ a contact is on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Branch {
    /// No force.
    Open,
    /// Without gap and slip; without friction also where it slides.
    Sticking,
    /// Without gap, and λ_t the projection of `towards` = λ_t − ρ_t w_t, N, on the disk, by the factor `ratio`.
    Sliding { towards: [f64; 2], ratio: f64 },
}

/// Φ at some forces.
#[derive(Clone, Debug)]
struct Evaluation {
    /// Φ, N.
    function: DVector<f64>,
    /// One per contact.
    branches: Vec<Branch>,
}

/// A problem that has no solution, or none that was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unsolved;

impl CoulombProblem {
    /// The problem with the operator `delassus` (m/N), the free motion `free` (m) and a friction
    /// coefficient per contact.
    pub fn new(mut delassus: DMatrix<f64>, free: DVector<f64>, friction: Vec<f64>) -> Self {
        let directions = free.len() / friction.len().max(1);
        let compliance = COMPLIANCE * delassus.diagonal().amax();
        for row in 0..free.len() {
            delassus[(row, row)] += compliance;
        }
        let mut weights = delassus.diagonal().map(|entry| 1.0 / entry);
        if directions == 3 {
            // One weight for both tangents: the disk has no axes.
            for tangent in (0..friction.len()).map(|contact| 3 * contact + 1) {
                let weight = weights[tangent].min(weights[tangent + 1]);
                weights[tangent] = weight;
                weights[tangent + 1] = weight;
            }
        }
        Self {
            delassus,
            free,
            friction,
            directions,
            weights,
        }
    }

    /// Finds the forces, N.
    ///
    /// # Errors
    /// [`Unsolved`] when the iterations run out, or where there are numbers that are not finite.
    pub fn solve(&self) -> Result<DVector<f64>, Unsolved> {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !finite(self.delassus.as_slice()) || !finite(self.free.as_slice()) {
            return Err(Unsolved);
        }
        let mut forces = DVector::zeros(self.free.len());
        self.sweep(&mut forces);
        let mut here = self.evaluate(&forces);
        for _ in 0..ITERATIONS {
            if here.function.amax() <= TOLERANCE * forces.amax() {
                return Ok(forces);
            }
            let norm = here.function.norm();
            let newton = self.newton_step(&here).and_then(|step| {
                (0..=HALVINGS).find_map(|halvings| {
                    let next = &forces - &step * 0.5_f64.powi(halvings);
                    let there = self.evaluate(&next);
                    (there.function.norm() < norm).then_some((next, there))
                })
            });
            (forces, here) = newton.unwrap_or_else(|| {
                let mut next = forces;
                for _ in 0..SWEEPS {
                    self.sweep(&mut next);
                }
                let there = self.evaluate(&next);
                (next, there)
            });
        }
        Err(Unsolved)
    }

    /// One sweep of projected Gauss–Seidel: every contact in turn follows the laws while the others rest.
    fn sweep(&self, forces: &mut DVector<f64>) {
        for (contact, friction) in self.friction.iter().enumerate() {
            let normal = self.directions * contact;
            let gap = self.motion(normal, forces);
            forces[normal] = (forces[normal] - self.weights[normal] * gap).max(0.0);
            if self.directions == 3 {
                let towards = [1, 2].map(|axis| {
                    let row = normal + axis;
                    forces[row] - self.weights[row] * self.motion(row, forces)
                });
                let size = libm::hypot(towards[0], towards[1]);
                let shrink = (friction * forces[normal] / size).min(1.0);
                for axis in [0, 1] {
                    forces[normal + 1 + axis] = if size > 0.0 {
                        shrink * towards[axis]
                    } else {
                        0.0
                    };
                }
            }
        }
    }

    /// Gap or slip of a row, m.
    fn motion(&self, row: usize, forces: &DVector<f64>) -> f64 {
        // The operator is symmetric, and columns lie together in memory.
        self.free[row] + self.delassus.column(row).dot(forces)
    }

    /// Φ, and the branch of it that each contact is on.
    fn evaluate(&self, forces: &DVector<f64>) -> Evaluation {
        let motion = &self.free + &self.delassus * forces;
        let mut function = forces.clone();
        let contacts = 0..self.friction.len();
        let branches = contacts.map(|contact| {
            let branch = self.branch(contact, forces, &motion);
            let normal = self.directions * contact;
            match branch {
                Branch::Open => {}
                Branch::Sticking => {
                    for row in normal..normal + self.directions {
                        function[row] = self.weights[row] * motion[row];
                    }
                }
                Branch::Sliding { towards, ratio } => {
                    function[normal] = self.weights[normal] * motion[normal];
                    for (axis, towards) in towards.iter().enumerate() {
                        function[normal + 1 + axis] -= ratio * towards;
                    }
                }
            }
            branch
        });
        let branches = branches.collect();
        Evaluation { function, branches }
    }

    fn branch(&self, contact: usize, forces: &DVector<f64>, motion: &DVector<f64>) -> Branch {
        let normal = self.directions * contact;
        let projected = |row: usize| forces[row] - self.weights[row] * motion[row];
        let pressure = projected(normal);
        // Not a number counts as open, for the search to refuse.
        if !(pressure > 0.0) {
            return Branch::Open;
        }
        if self.directions == 1 {
            return Branch::Sticking;
        }
        let towards = [projected(normal + 1), projected(normal + 2)];
        let (size, radius) = (
            libm::hypot(towards[0], towards[1]),
            self.friction[contact] * pressure,
        );
        if size <= radius {
            Branch::Sticking
        } else {
            let ratio = radius / size;
            Branch::Sliding { towards, ratio }
        }
    }

    /// The step s of Newton's method with J s = Φ, to be taken off the forces; `None` where J is singular.
    ///
    /// The rows of open contacts are those of the unit matrix: their forces go to zero at once, and only the pressed
    /// ones are left to be solved for together.
    fn newton_step(&self, here: &Evaluation) -> Option<DVector<f64>> {
        let contacts = 0..self.friction.len();
        let (open, pressed): (Vec<usize>, Vec<usize>) =
            contacts.partition(|&contact| matches!(here.branches[contact], Branch::Open));
        let rows_of = |contacts: &[usize]| -> Vec<usize> {
            let rows = |contact| self.directions * contact..self.directions * (contact + 1);
            contacts.iter().copied().flat_map(rows).collect()
        };
        let (released, rows) = (rows_of(&open), rows_of(&pressed));
        let mut step = here.function.clone();
        let mut matrix = DMatrix::zeros(rows.len(), rows.len());
        let mut right_side = DVector::from_fn(rows.len(), |row, _| step[rows[row]]);
        for (place, &contact) in pressed.iter().enumerate() {
            let first = self.directions * place;
            let branch = here.branches[contact];
            for (column, &row) in rows.iter().enumerate() {
                let derivative = self.derivative(contact, branch, row);
                for axis in 0..self.directions {
                    matrix[(first + axis, column)] = derivative[axis];
                }
            }
            for &row in released.iter().filter(|&&row| step[row] != 0.0) {
                let derivative = self.derivative(contact, branch, row);
                for axis in 0..self.directions {
                    right_side[first + axis] -= derivative[axis] * step[row];
                }
            }
        }
        if rows.is_empty() {
            return Some(step);
        }
        let solution = matrix.lu().solve(&right_side)?;
        for (row, value) in rows.iter().zip(&solution) {
            step[*row] = *value;
        }
        Some(step)
    }

    /// Derivative of the components of Φ of one pressed contact with respect to the force of the row `by`.
    fn derivative(&self, contact: usize, branch: Branch, by: usize) -> [f64; 3] {
        let normal = self.directions * contact;
        // Of ρ w; the operator is symmetric, and columns lie together in memory.
        let moved = |row: usize| self.weights[row] * self.delassus[(by, row)];
        let (pressed, friction) = (moved(normal), self.friction[contact]);
        if self.directions == 1 {
            return [pressed, 0.0, 0.0];
        }
        let slid = [moved(normal + 1), moved(normal + 2)];
        let Branch::Sliding { towards, ratio } = branch else {
            return [pressed, slid[0], slid[1]];
        };
        let size = libm::hypot(towards[0], towards[1]);
        let unit = towards.map(|component| component / size);
        let own = |row: usize| f64::from(u8::from(row == by));
        // Derivatives of the pressure and of what is projected on the disk.
        let pressing = own(normal) - pressed;
        let along = [own(normal + 1) - slid[0], own(normal + 2) - slid[1]];
        let radial = along[0] * unit[0] + along[1] * unit[1];
        let [first, second] = [0, 1].map(|axis| {
            let turn = (along[axis] - radial * unit[axis]) * ratio;
            own(normal + 1 + axis) - pressing * friction * unit[axis] - turn
        });
        [pressed, first, second]
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::Random;
    use super::*;

    /// A random problem with an operator of rank `rank`.
    fn random(seed: u64, contacts: usize, directions: usize, rank: usize) -> CoulombProblem {
        let mut random = Random::new(seed);
        let rows = directions * contacts;
        let factor = DMatrix::from_fn(rows, rank, |_, _| random.symmetric());
        // Free motions that forces can undo, which also a deficient operator admits.
        let load = DVector::from_fn(rank, |_, _| random.symmetric());
        let friction = (0..contacts).map(|_| 0.5 + 0.5 * random.symmetric());
        let friction = friction.collect();
        CoulombProblem::new(&factor * factor.transpose(), factor * load, friction)
    }

    /// Largest violation of the two laws, in units of the largest force and motion.
    fn violation(problem: &CoulombProblem, forces: &DVector<f64>) -> f64 {
        let motion = &problem.free + &problem.delassus * forces;
        let (force_unit, motion_unit) = (forces.amax().max(1e-3), problem.free.amax());
        let mut worst = 0.0_f64;
        for (contact, friction) in problem.friction.iter().enumerate() {
            let normal = problem.directions * contact;
            let (force, gap) = (forces[normal] / force_unit, motion[normal] / motion_unit);
            worst = worst.max(-force).max(-gap).max((force * gap).abs());
            if problem.directions == 3 {
                let force_t =
                    nalgebra::Vector2::new(forces[normal + 1], forces[normal + 2]) / force_unit;
                let slip =
                    nalgebra::Vector2::new(motion[normal + 1], motion[normal + 2]) / motion_unit;
                worst = worst.max(force_t.norm() - friction * force);
                // Dissipation is the largest there is: −λ_t·w_t = μ λ_n ‖w_t‖.
                worst = worst.max((force_t.dot(&slip) + friction * force * slip.norm()).abs());
            }
        }
        worst
    }

    #[test]
    fn solutions_obey_both_laws() {
        for seed in 0..60 {
            for (contacts, directions) in [(1, 3), (4, 1), (5, 3), (12, 3)] {
                let rows = contacts * directions;
                for rank in [rows, 2 * rows] {
                    let problem = random(seed, contacts, directions, rank);
                    let forces = problem.solve().unwrap();
                    let violation = violation(&problem, &forces);
                    assert!(violation < 1e-5, "{seed} {contacts} {rank}: {violation:e}");
                }
            }
        }
    }

    #[test]
    fn forces_that_no_contact_presses_for_vanish() {
        // Newton's method used to panic where all contacts were open and forces left over.
        let apart = DVector::from_element(6, 1.0);
        let problem = CoulombProblem::new(DMatrix::identity(6, 6), apart, vec![0.3; 2]);
        let here = problem.evaluate(&DVector::from_element(6, 0.1));
        assert!(here.branches.iter().all(|branch| *branch == Branch::Open));
        assert_eq!(problem.newton_step(&here), Some(here.function));
        assert_eq!(problem.solve(), Ok(DVector::zeros(6)));
    }

    #[test]
    fn problems_with_numbers_that_are_not_finite_are_refused() {
        let mut delassus = DMatrix::identity(3, 3);
        delassus[(1, 2)] = f64::NAN;
        let problem = CoulombProblem::new(delassus, DVector::zeros(3), vec![0.3]);
        assert_eq!(problem.solve(), Err(Unsolved));
    }

    #[test]
    fn newtons_step_is_that_of_differences() {
        for seed in 0..20 {
            for directions in [1, 3] {
                let problem = random(seed, 6, directions, 18);
                let mut forces = problem.solve().unwrap();
                forces.apply(|force| *force *= 1.3);
                let here = problem.evaluate(&forces);
                let rows = forces.len();
                let mut jacobian = DMatrix::zeros(rows, rows);
                for column in 0..rows {
                    let moved = |sign: f64| {
                        let mut moved = forces.clone();
                        moved[column] += sign * 1e-6;
                        problem.evaluate(&moved).function
                    };
                    jacobian.set_column(column, &((moved(1.0) - moved(-1.0)) / 2e-6));
                }
                let step = problem.newton_step(&here).unwrap();
                let error = (jacobian * &step - &here.function).amax();
                assert!(error < 1e-5 * here.function.amax(), "{seed}: {error:e}");
            }
        }
    }

    #[test]
    fn a_block_on_an_incline_sticks_up_to_the_angle_of_friction() {
        // Unit mass, unit step: the free motion is the pull of gravity along normal and tangent.
        for friction in [0.2, 0.5, 1.0_f64] {
            let limit = friction.atan();
            for (angle, sticks) in [(limit - 1e-4, true), (limit + 1e-4, false)] {
                let free = DVector::from_vec(vec![-angle.cos(), angle.sin(), 0.0]);
                let problem = CoulombProblem::new(DMatrix::identity(3, 3), free, vec![friction]);
                let forces = problem.solve().unwrap();
                let (slip, traction) = (angle.sin() + forces[1], forces[1] / forces[0]);
                assert!((forces[0] - angle.cos()).abs() < 1e-5);
                if sticks {
                    assert!(slip.abs() < 1e-5 && traction > -friction);
                } else {
                    assert!(slip > 5e-5 && (traction + friction).abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn contacts_that_do_the_same_share_the_force() {
        let problem = CoulombProblem::new(
            DMatrix::from_element(2, 2, 1.0),
            DVector::from_element(2, -1.0),
            vec![0.0; 2],
        );
        let forces = problem.solve().unwrap();
        assert!((forces[0] - 0.5).abs() < 1e-5 && (forces[0] - forces[1]).abs() < 1e-9);
    }
}
