//! The grasp of a shape.

use super::gauss::{RULE, STAGES};
use super::interval::eliminate;
use super::shape::Shape;
use super::stability::unstable_modes;
use super::{GraspProblem, Vector3, WEIGHT};
use nalgebra::Rotation3;
use rodlab_engine::mechanics::{Matrix3, UnitQuaternion};

/// Tolerance of the height above the table for rounding errors, in L_gb.
const TOUCH: f64 = 1e-9;

/// Pose of the gripper that holds the rod; lengths in L_gb, forces in EI/L_gb².
///
/// The contact node is the origin; its tangent is x̂, and ẑ points up from the table. Positive
/// curvature turns towards +ŷ.
#[derive(Clone, Debug)]
pub struct Grasp {
    /// Problem that the grasp solves.
    pub problem: GraspProblem,
    /// q_M.
    pub position: Vector3,
    /// Rotation of the frame of the rod at the gripper relative to that at the contact node; the
    /// rod is not twisted.
    pub rotation: UnitQuaternion,
    /// Force of the lying part of the rod on the suspended part, −n(0).
    pub contact_force: Vector3,
    /// Residual at convergence. For the continuous rod: the moment at the gripper and x_M n_y(0) −
    /// κ̄; for the discrete one: the force at a node.
    pub residual: f64,
    /// Lowest height of the suspended part.
    pub lowest: f64,
    /// Number of unstable modes of the rod with both ends held.
    pub unstable_modes: usize,
}

impl Grasp {
    /// The grasp of a rod in equilibrium.
    pub fn of(shape: &Shape) -> Self {
        let Ends {
            position,
            rotation,
            lowest,
        } = ends(shape);
        let force = shape.internal_force(0.0);
        let left = shape.moments.last().map_or(0.0, |moment| moment.norm());
        let identity = position.x * force.y - shape.problem.curvature;
        Self {
            problem: shape.problem,
            position,
            rotation,
            contact_force: -force,
            residual: left.max(identity.abs()),
            lowest,
            unstable_modes: unstable_modes(shape),
        }
    }

    /// Whether the shape is stable with both ends held.
    pub fn is_stable(&self) -> bool {
        self.unstable_modes == 0
    }

    /// The constraints of thesis Eq. 5.6: the rod stays above the table and presses on it at the contact node.
    pub fn is_feasible(&self) -> bool {
        self.lowest >= -TOUCH && self.contact_force.z >= 0.0
    }
}

/// n_y(0) and n_z(0) of a rod that is held at a position with a rotation, without a moment at the
/// gripper and without a force along the lying part; `None` if there is no such force.
///
/// The moment balance about the vertical through the contact node gives x_M n_y(0) = κ̄, and of
/// the suspended rod
///
/// > ½|M|² + n·t + (n·t)²/2k̄_s − z/2
///
/// is constant from the contact node, where it is ½κ̄², to the gripper.
pub fn force_of_pose(
    problem: &GraspProblem,
    position: Vector3,
    rotation: &UnitQuaternion,
) -> Option<[f64; 2]> {
    let tangent = rotation * Vector3::x();
    let compliance = problem.stretch_compliance;
    let integral = 0.5 * problem.curvature * problem.curvature + WEIGHT * position.z;
    // Solves q + q²/2k̄_s = integral, without a difference of nearly equal numbers.
    let pull = 2.0 * integral / (1.0 + (1.0 + 2.0 * compliance * integral).sqrt());
    let across = if problem.curvature == 0.0 {
        0.0
    } else {
        problem.curvature / position.x
    };
    let up = (pull - across * tangent.y) / tangent.z - WEIGHT * problem.suspended_length;
    (across.is_finite() && up.is_finite()).then_some([across, up])
}

/// The coefficient of friction that holds a lying rod at its contact node. There the suspended
/// part exerts n(0) on the rod, and the shear force of the lying part is −κ̄'; the table supports
/// the difference,
///
/// > |n_y(0) + κ̄'|/|n_z(0)|,
///
/// infinite if the suspended part does not press on the table. `curvature_slope` is κ̄' = κ'
/// L_gb².
pub fn contact_demand([across, up]: [f64; 2], curvature_slope: f64) -> f64 {
    if up < 0.0 {
        (across + curvature_slope).abs() / -up
    } else {
        f64::INFINITY
    }
}

/// Nodes of the suspended part at equal arc lengths, from the contact node to the gripper, L_gb.
pub fn centreline(shape: &Shape, edges: usize) -> Vec<Vector3> {
    let length = shape.problem.suspended_length / edges as f64;
    let compliance = shape.problem.stretch_compliance;
    let mut place = Vector3::zeros();
    let mut places = vec![place];
    for edge in 0..edges {
        for (node, weight) in RULE.nodes.iter().zip(RULE.weights) {
            let s = (edge as f64 + node) * length;
            let tangent = shape.at(s).0;
            let stretch = 1.0 + compliance * shape.internal_force(s).dot(&tangent);
            place += length * weight * stretch * tangent;
        }
        places.push(place);
    }
    places
}

struct Ends {
    position: Vector3,
    rotation: UnitQuaternion,
    lowest: f64,
}

/// Integrates r' = λ t and the twist-free frame d' = M × d, with the same collocation as the
/// shape.
fn ends(shape: &Shape) -> Ends {
    let compliance = shape.problem.stretch_compliance;
    let mut position = Vector3::zeros();
    let mut director = Vector3::y();
    let mut lowest: f64 = 0.0;
    for interval in &shape.intervals {
        let h = interval.length;
        let slopes: [Vector3; STAGES] = std::array::from_fn(|k| {
            let force = shape.internal_force(interval.place(k));
            let tangent = interval.tangents[k];
            (1.0 + compliance * force.dot(&tangent)) * tangent
        });
        let mut end = position;
        for j in 0..STAGES {
            let rise: f64 = (0..STAGES).map(|k| RULE.matrix[j][k] * slopes[k].z).sum();
            lowest = lowest.min(position.z + h * rise);
            end += h * RULE.weights[j] * slopes[j];
        }
        position = end;
        lowest = lowest.min(position.z);
        director = carried(director, &interval.moments, h);
    }
    let tangent = shape.tangents.last().copied().unwrap_or(Vector3::x());
    // The vectors are orthonormal up to round-off, which is removed for the quaternion.
    let tangent = tangent.normalize();
    let director = (director - director.dot(&tangent) * tangent).normalize();
    let frame = Matrix3::from_columns(&[tangent, director, tangent.cross(&director)]);
    Ends {
        position,
        rotation: UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(frame)),
        lowest,
    }
}

/// d' = M × d over one interval.
fn carried(director: Vector3, moments: &[Vector3; STAGES], h: f64) -> Vector3 {
    let mut system = [[0.0; 3 * STAGES + 1]; 3 * STAGES];
    for j in 0..STAGES {
        for k in 0..STAGES {
            let block = -(h * RULE.matrix[j][k]) * moments[k].cross_matrix();
            for row in 0..3 {
                for column in 0..3 {
                    system[3 * j + row][3 * k + column] = block[(row, column)];
                }
            }
        }
        for row in 0..3 {
            system[3 * j + row][3 * j + row] += 1.0;
            system[3 * j + row][3 * STAGES] = director[row];
        }
    }
    eliminate(&mut system);
    let mut end = director;
    for k in 0..STAGES {
        let stage = Vector3::from_fn(|row, _| system[3 * k + row][3 * STAGES]);
        end += h * RULE.weights[k] * moments[k].cross(&stage);
    }
    end
}

#[cfg(test)]
mod tests {
    use super::super::{GraspMethod, GraspSolver};
    use super::*;

    #[test]
    fn the_force_at_the_contact_node_follows_from_the_pose_of_the_gripper() {
        let mut solver = GraspSolver::new();
        for length in [0.6, 3.0, 12.0, 60.0] {
            for curvature in [0.0, 0.4, -1.7] {
                for stiffness in [300.0, f64::INFINITY] {
                    let problem = GraspProblem::new(length, curvature, stiffness).unwrap();
                    let grasp = solver.solve(&problem, GraspMethod::Theory).unwrap();
                    let [across, up] =
                        force_of_pose(&problem, grasp.position, &grasp.rotation).unwrap();
                    let off = grasp.contact_force + Vector3::new(0.0, across, up);
                    assert!(off.norm() < 1e-6, "{problem}: {off}");
                }
            }
        }
    }

    #[test]
    fn a_node_that_is_not_pressed_down_cannot_be_held() {
        assert!((contact_demand([0.3, -0.6], -0.1) - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(contact_demand([0.3, 0.1], 0.0), f64::INFINITY);
    }
}
