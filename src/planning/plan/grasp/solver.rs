//! Solver for sequences of grasps.

use super::branches;
use super::continuation::{gentle, walk};
use super::discrete::discrete_grasp;
use super::shape::{March, Shape};
use super::solution::centreline;
use super::{Grasp, GraspError, GraspProblem, Vector3};

/// Largest relative change of l̄_s, and largest change of κ̄, for which the last grasp is the
/// initial guess of the next one.
const NEAR: [f64; 2] = [0.3, 0.8];

/// Method of solution for a grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraspMethod {
    /// Collocation of the continuous rod.
    Theory,
    /// The discrete elastic rod.
    Discrete {
        /// Number of edges, at least [`Self::FEWEST_EDGES`].
        edges: usize,
    },
}

impl GraspMethod {
    /// Minimum number of edges of a discrete rod.
    pub const FEWEST_EDGES: usize = super::discrete::FEWEST_EDGES;

    fn grasp(self, shape: &Shape) -> Result<Grasp, GraspError> {
        match self {
            Self::Theory => Ok(Grasp::of(shape)),
            Self::Discrete { edges } => discrete_grasp(shape, edges.max(Self::FEWEST_EDGES)),
        }
    }
}

/// Computes grasps; each starts from the previous one if the two problems are close.
#[derive(Debug, Default)]
pub struct GraspSolver {
    march: March,
    last: Option<Shape>,
}

impl GraspSolver {
    /// A solver without an initial guess.
    pub fn new() -> Self {
        Self::default()
    }

    /// The grasp on the gentle branch: the local minimum 1 of thesis Fig. 5.4.
    ///
    /// # Errors
    /// Newton's method does not converge.
    pub fn solve(
        &mut self,
        problem: &GraspProblem,
        method: GraspMethod,
    ) -> Result<Grasp, GraspError> {
        method.grasp(self.shape(problem)?)
    }

    /// All grasps that are found. The gentle one is first; the others are sorted by the force at
    /// the contact node.
    ///
    /// At κ̄ = 0 and l̄_s ≤ 8 these are all planar grasps with n_z(0) between −12 and 4 EI/L_gb².
    /// For longer rods and other curvatures they are continued from those, so new branches are not
    /// found. For the discrete rod they are the grasps to which Newton's method converges from the
    /// continuous ones.
    ///
    /// # Errors
    /// Newton's method does not converge for the gentle one.
    pub fn solve_all(
        &mut self,
        problem: &GraspProblem,
        method: GraspMethod,
    ) -> Result<Vec<Grasp>, GraspError> {
        self.all(problem, |shape| method.grasp(shape), |grasp| grasp)
    }

    /// Nodes of the suspended part on the gentle branch at equal arc lengths, from the contact node to the gripper, L_gb.
    ///
    /// # Errors
    /// Newton's method does not converge.
    pub fn centreline(
        &mut self,
        problem: &GraspProblem,
        edges: usize,
    ) -> Result<Vec<Vector3>, GraspError> {
        Ok(centreline(self.shape(problem)?, edges))
    }

    /// The grasps of [`Self::solve_all`] by theory, each with its nodes at equal arc lengths,
    /// L_gb.
    ///
    /// # Errors
    /// Newton's method does not converge for the gentle one.
    pub fn all_centrelines(
        &mut self,
        problem: &GraspProblem,
        edges: usize,
    ) -> Result<Vec<(Grasp, Vec<Vector3>)>, GraspError> {
        let of = |shape: &Shape| Ok((Grasp::of(shape), centreline(shape, edges)));
        self.all(problem, of, |(grasp, _)| grasp)
    }

    /// A property of the gentle rod and of all other rods, sorted by the force at the contact
    /// node.
    fn all<Answer>(
        &mut self,
        problem: &GraspProblem,
        answer: impl Fn(&Shape) -> Result<Answer, GraspError>,
        grasp: impl Fn(&Answer) -> &Grasp,
    ) -> Result<Vec<Answer>, GraspError> {
        let gentle = self.shape(problem)?;
        let mut found = vec![answer(gentle)?];
        let force = gentle.force;
        // A discrete rod may not have all of these grasps.
        let others = branches::others(problem, force, &mut self.march);
        found.extend(others.iter().flat_map(answer));
        let size = |answer: &Answer| grasp(answer).contact_force.norm();
        found[1..].sort_by(|one, other| size(one).total_cmp(&size(other)));
        Ok(found)
    }

    fn shape(&mut self, problem: &GraspProblem) -> Result<&Shape, GraspError> {
        let last = self.last.take();
        let near = last.filter(|last| {
            let [length, curvature] = NEAR;
            let [from, to] = [last.problem.suspended_length, problem.suspended_length];
            (from - to).abs() < length * from.min(to)
                && (last.problem.curvature - problem.curvature).abs() < curvature
        });
        let march = &mut self.march;
        let warm = near.and_then(|last| walk(last, problem, march));
        let found = warm.or_else(|| gentle(problem, march));
        let found = found.ok_or(GraspError::NoConvergence { problem: *problem })?;
        Ok(self.last.insert(found))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;
    use GraspMethod::{Discrete, Theory};
    use rodlab_engine::mechanics::UnitQuaternion;

    fn grasp(length: f64, curvature: f64, stiffness: f64) -> Grasp {
        let problem = GraspProblem::new(length, curvature, stiffness).unwrap();
        GraspSolver::new().solve(&problem, Theory).unwrap()
    }

    /// Rows of the reference: problem, position and rotation vector of the gripper, n_y(0),
    /// n_z(0).
    fn reference() -> Vec<(GraspProblem, Vector3, Vector3, [f64; 2])> {
        let rows = reference::rows("grasp/optimal_grasp.csv");
        assert!(rows.is_empty() || rows.len() > 100);
        let solution = |row: &Vec<f64>| {
            let problem = GraspProblem::new(row[1], row[2], row[0]).unwrap();
            let vector = |first: usize| Vector3::new(row[first], row[first + 1], row[first + 2]);
            (problem, vector(3), vector(6), [row[12], row[13]])
        };
        rows.iter().map(solution).collect()
    }

    #[test]
    fn grasps_agree_with_the_reference() {
        for (problem, position, rotation, force) in reference() {
            let found = GraspSolver::new().solve(&problem, Theory).unwrap();
            assert!((found.position - position).amax() < 2e-9, "{problem}");
            assert!(
                (found.rotation.scaled_axis() - rotation).amax() < 2e-9,
                "{problem}"
            );
            let off = found.contact_force + Vector3::new(0.0, force[0], force[1]);
            assert!(off.amax() < 1e-9, "{problem}");
            assert!(found.is_stable() && found.is_feasible(), "{problem}");
        }
    }

    #[test]
    fn the_discrete_rod_of_100_edges_agrees_with_the_reference() {
        let mut solver = GraspSolver::new();
        for (problem, position, rotation, _) in reference() {
            let found = solver.solve(&problem, Discrete { edges: 100 }).unwrap();
            let off = (found.position - position).norm() / problem.suspended_length();
            assert!(off < 0.5e-4, "{problem}: {off}");
            let turned = UnitQuaternion::from_scaled_axis(rotation).angle_to(&found.rotation);
            assert!(turned.to_degrees() < 0.03, "{problem}: {turned}");
            assert!(found.is_stable(), "{problem}");
        }
    }

    #[test]
    fn the_discrete_rod_is_of_second_order() {
        for (length, curvature) in [(3.0, 1.5), (12.0, 0.7), (40.0, 1.0)] {
            let problem = GraspProblem::new(length, curvature, 3000.0).unwrap();
            let mut solver = GraspSolver::new();
            let exact = solver.solve(&problem, Theory).unwrap();
            let errors = [100, 200, 400].map(|edges| {
                let found = solver.solve(&problem, Discrete { edges }).unwrap();
                (found.position - exact.position).norm() + found.rotation.angle_to(&exact.rotation)
            });
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                assert!((order - 2.0).abs() < 0.1, "{problem}: {errors:?}");
            }
        }
    }

    #[test]
    fn moments_about_z_are_in_balance() {
        // This is also exact for the discrete rod: x_M n_y(0) = κ̄.
        let mut solver = GraspSolver::new();
        for (length, curvature, stiffness) in [
            (0.5, 0.3, f64::INFINITY),
            (9.0, 2.0, 500.0),
            (60.0, -1.2, 2087.0),
        ] {
            let problem = GraspProblem::new(length, curvature, stiffness).unwrap();
            for method in [Theory, Discrete { edges: 60 }] {
                let found = solver.solve(&problem, method).unwrap();
                let moment = -found.position.x * found.contact_force.y;
                assert!((moment - curvature).abs() < 1e-9, "{problem}: {moment}");
                assert_eq!(found.contact_force.x, 0.0);
            }
        }
    }

    #[test]
    fn left_and_right_mirror_each_other() {
        for (length, curvature) in [(0.7, 5.0), (4.0, 0.4), (50.0, 1.5)] {
            let [left, right] = [1.0, -1.0].map(|side| grasp(length, side * curvature, 2000.0));
            let mirror = |v: Vector3| Vector3::new(v.x, -v.y, v.z);
            assert!((left.position - mirror(right.position)).norm() < 1e-12 * length);
            // A rotation vector is an axial vector: its components in the mirror plane change
            // sign.
            let turned = right.rotation.scaled_axis();
            let turned = Vector3::new(-turned.x, turned.y, -turned.z);
            assert!((left.rotation.scaled_axis() - turned).norm() < 1e-12);
        }
    }

    #[test]
    fn the_centreline_ends_at_the_gripper_and_begins_along_the_pattern() {
        for (length, curvature) in [(2.0, 1.5), (27.0, -0.6), (60.0, 0.0)] {
            let problem = GraspProblem::new(length, curvature, 3000.0).unwrap();
            let mut solver = GraspSolver::new();
            let places = solver.centreline(&problem, 300).unwrap();
            let grasp = solver.solve(&problem, Theory).unwrap();
            assert!((places[300] - grasp.position).norm() < 1e-6, "{problem}");
            let first = (places[1] - places[0]).normalize();
            // The chord is ahead of the tangent by half the rotation of an edge, up to the change
            // of curvature.
            let edge = length / 300.0;
            let off = first.y - 0.5 * curvature * edge;
            assert!(off.abs() < 0.3 * edge * edge && first.z >= 0.0, "{first}");
        }
    }

    #[test]
    fn a_short_rod_is_a_heavy_beam() {
        // EI d⁴z/dx⁴ = −w, level and unbent at the contact node, without a moment at the gripper:
        // z = l x³/24 − x⁴/48.
        let length: f64 = 0.2;
        let found = grasp(length, 0.0, f64::INFINITY);
        assert!((found.contact_force.z / (length / 4.0) - 1.0).abs() < 1e-5);
        let rise = length.powi(4) / 48.0;
        assert!((found.position.z / rise - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_whole_range_is_found_and_stable() {
        for length in [0.1, 0.5, 2.0, 6.0, 20.0, 60.0, 100.0] {
            for curvature in [0.0, 0.4, 1.5, -4.0, 12.0] {
                for stiffness in [100.0, f64::INFINITY] {
                    let found = grasp(length, curvature, stiffness);
                    let problem = found.problem;
                    assert!(found.residual < 1e-9, "{problem}: {}", found.residual);
                    assert!(found.is_stable() && found.is_feasible(), "{problem}");
                }
            }
        }
    }

    #[test]
    fn a_warm_start_leads_to_the_same_grasp() {
        let mut solver = GraspSolver::new();
        for step in 0..60 {
            let step = f64::from(step);
            let (length, curvature) = (45.0 - 0.7 * step, 1.6 * (0.2 * step).sin());
            let problem = GraspProblem::new(length, curvature, 5000.0).unwrap();
            let warm = solver.solve(&problem, Theory).unwrap();
            let cold = grasp(length, curvature, 5000.0);
            assert!((warm.position - cold.position).norm() < 1e-8, "{problem}");
        }
    }

    #[test]
    fn the_other_planar_grasps_are_found_and_the_second_minimum_snaps() {
        // In local minimum 2 of thesis Fig. 5.4 the rod bends back over the contact node.
        let problem = GraspProblem::new(17.68, 0.0, f64::INFINITY).unwrap();
        let mut solver = GraspSolver::new();
        for method in [Theory, Discrete { edges: 400 }] {
            let found = solver.solve_all(&problem, method).unwrap();
            assert!(found[0].is_stable() && found[0].position.x > 2.5);
            let second = found[1..]
                .iter()
                .find(|grasp| grasp.is_feasible() && grasp.position.x < -3.0)
                .expect("the second minimum");
            assert_eq!(second.unstable_modes, 2);
            assert!((second.contact_force.z - 2.4567).abs() < 2e-3);
        }
    }

    #[test]
    fn values_out_of_range_are_rejected() {
        assert_eq!(
            GraspProblem::new(0.05, 0.0, 500.0),
            Err(GraspError::Length(0.05))
        );
        assert!(GraspProblem::new(f64::NAN, 0.0, 500.0).is_err());
        assert!(GraspProblem::new(5.0, f64::NAN, 500.0).is_err());
        assert!(GraspProblem::new(5.0, 12.1, 500.0).is_err());
        assert!(GraspProblem::new(5.0, 0.0, 99.0).is_err());
        assert!(GraspProblem::new(5.0, 0.0, -1.0).is_err());
    }
}
