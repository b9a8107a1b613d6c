//! Springs: between two nodes, and about hinges.
//!
//! A spring of the stiffness k and the length L without force between two nodes, the vector d from the one to the other and
//! r = ‖d‖ long, has
//!
//! ```text
//! E = ½ k (r − L)²,   ∂E/∂d = k (1 − L/r) d,   ∂²E/∂d² = k [ (1 − L/r) 1 + L/r d⊗d/r² ]
//! ```
//!
//! Without L that is k d and k 1, wherever the nodes are. Where the nodes of another one meet exactly its force has no
//! direction, and is taken to be none.
//!
//! A spring about a hinge has E = ½ c (α − α₀)² with the angle α, which is an unknown: ∂E/∂α = c (α − α₀), ∂²E/∂α² = c.

use super::System;
use super::build::Assembly;
use super::joints::JointPlan;
use crate::linalg::{Element, ElementMatrix, UNUSED};
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{ElasticEnergy, STRIDE};
use crate::mechanics::scene::{RodNode, Scene};
use crate::mechanics::{Matrix3, SceneError, Vector3};

/// The springs of a scene, at the configuration of the last [`Self::stretch`].
#[derive(Clone, Debug, Default)]
pub struct Springs {
    between_nodes: Vec<NodeSpring>,
    about_hinges: Vec<AngleSpring>,
}

#[derive(Clone, Debug)]
struct NodeSpring {
    /// Numbers of its nodes among those of all rods.
    nodes: [usize; 2],
    /// k, N/m.
    stiffness: f64,
    /// L, m.
    rest_length: f64,
    /// d, m.
    span: Vector3,
}

#[derive(Clone, Debug)]
struct AngleSpring {
    /// Unknown of the angle.
    unknown: usize,
    /// c, N m/rad.
    stiffness: f64,
    /// α₀, rad.
    rest_angle: f64,
    /// α, rad.
    angle: f64,
}

impl NodeSpring {
    /// L/r; 0 where the direction is lost.
    fn rest_part(&self) -> f64 {
        let length = self.span.norm();
        if length > 0.0 {
            self.rest_length / length
        } else {
            0.0
        }
    }

    fn energy(&self) -> f64 {
        let lengthening = self.span.norm() - self.rest_length;
        0.5 * self.stiffness * lengthening * lengthening
    }

    /// ∂E/∂d, N.
    fn gradient(&self) -> Vector3 {
        self.span * (self.stiffness * (1.0 - self.rest_part()))
    }

    /// ∂²E/∂d², N/m.
    fn hessian(&self) -> Matrix3 {
        let rest_part = self.rest_part();
        let across = Matrix3::from_diagonal_element(1.0 - rest_part);
        let square = self.span.norm_squared();
        if rest_part == 0.0 {
            return across * self.stiffness;
        }
        let along = self.span * self.span.transpose() * (rest_part / square);
        (across + along) * self.stiffness
    }
}

impl Springs {
    /// The springs of a scene with its unknowns numbered.
    ///
    /// # Errors
    /// [`SceneError::Joint`] where one cannot be.
    pub fn new(scene: &Scene, assembly: &Assembly) -> Result<Self, SceneError> {
        let plan = if scene.springs.is_empty() {
            JointPlan::default()
        } else {
            JointPlan::new(scene)?
        };
        let mut between_nodes = Vec::new();
        for spring in &scene.springs {
            let rest_length = plan.rest_length(scene, spring)?;
            let number = |at: RodNode| assembly.rods.rods[at.rod].first_node + at.node;
            between_nodes.push(NodeSpring {
                nodes: spring.nodes.map(number),
                stiffness: spring.stiffness,
                rest_length,
                span: Vector3::zeros(),
            });
        }
        let hinges = assembly.joints.frames.iter();
        let about_hinges = hinges.filter_map(|frame| {
            frame.spring.map(|spring| AngleSpring {
                unknown: frame.first_unknown + 3,
                stiffness: spring.stiffness,
                rest_angle: spring.rest_angle,
                angle: 0.0,
            })
        });
        Ok(Self {
            between_nodes,
            about_hinges: about_hinges.collect(),
        })
    }

    /// Whether there are none between nodes.
    pub fn couple_nothing(&self) -> bool {
        self.between_nodes.is_empty()
    }

    /// Tells `assembly` what the last digits of positions leave in the forces of springs.
    pub fn round(&self, assembly: &mut Assembly) {
        for spring in &self.between_nodes {
            let rounding = spring.stiffness * f64::EPSILON;
            for node in spring.nodes {
                let (rod, _) = assembly.locate(node);
                let scale = &mut assembly.scales[rod];
                scale.rounding_stiffness = scale.rounding_stiffness.max(rounding);
            }
            assembly.rounding_stiffness = assembly.rounding_stiffness.max(rounding);
        }
    }

    /// Force of one between nodes, k (r − L), N.
    pub fn force(&self, number: usize) -> f64 {
        let spring = &self.between_nodes[number];
        spring.stiffness * (spring.span.norm() - spring.rest_length)
    }

    /// Lets one between nodes exert no force any more.
    pub fn cut(&mut self, number: usize) {
        let spring = &mut self.between_nodes[number];
        (spring.stiffness, spring.rest_length) = (0.0, 0.0);
    }

    /// Takes their configuration from `unknowns`.
    pub fn stretch(&mut self, unknowns: &[f64]) {
        for spring in &mut self.between_nodes {
            let [from, to] = spring.nodes.map(|node| position(unknowns, node));
            spring.span = to - from;
        }
        for spring in &mut self.about_hinges {
            spring.angle = unknowns[spring.unknown];
        }
    }

    /// Energy, J: that between nodes counts as of stretching, that about hinges as of bending.
    pub fn energy(&self) -> ElasticEnergy {
        let of_angle = |spring: &AngleSpring| {
            let turn = spring.angle - spring.rest_angle;
            0.5 * spring.stiffness * turn * turn
        };
        ElasticEnergy {
            stretching: self.between_nodes.iter().map(NodeSpring::energy).sum(),
            bending: self.about_hinges.iter().map(of_angle).sum(),
            twisting: 0.0,
        }
    }

    /// Adds the gradient of the energy to `gradient`, over all unknowns.
    pub fn add_gradient(&self, gradient: &mut [f64]) {
        for spring in &self.between_nodes {
            let force = spring.gradient();
            let [from, to] = spring.nodes.map(|node| STRIDE * node);
            for axis in 0..3 {
                gradient[from + axis] -= force[axis];
                gradient[to + axis] += force[axis];
            }
        }
        for spring in &self.about_hinges {
            gradient[spring.unknown] += spring.stiffness * (spring.angle - spring.rest_angle);
        }
    }

    /// Adds the sizes of the forces on nodes to `forces`, over all unknowns, N.
    pub fn add_sizes(&self, forces: &mut [f64]) {
        for spring in &self.between_nodes {
            let force = spring.gradient();
            for node in spring.nodes {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += force[axis].abs();
                }
            }
        }
    }

    /// The unknowns of the springs between nodes.
    pub fn elements(&self) -> impl Iterator<Item = Element> {
        self.between_nodes.iter().map(|spring| {
            let mut element = [UNUSED; 12];
            for (end, node) in spring.nodes.iter().enumerate() {
                for axis in 0..3 {
                    element[3 * end + axis] = STRIDE * node + axis;
                }
            }
            element
        })
    }

    /// Adds the second derivatives of the springs between nodes to the matrices of [`Self::elements`].
    pub fn add_hessians(&self, matrices: &mut [ElementMatrix]) {
        for (spring, matrix) in self.between_nodes.iter().zip(matrices) {
            let hessian = spring.hessian();
            for i in 0..3 {
                for j in 0..3 {
                    matrix[i][j] += hessian[(i, j)];
                    matrix[3 + i][3 + j] += hessian[(i, j)];
                    matrix[3 + i][j] -= hessian[(i, j)];
                    matrix[i][3 + j] -= hessian[(i, j)];
                }
            }
        }
    }

    /// Unknowns and second derivatives of the springs about hinges.
    pub fn diagonal(&self) -> impl Iterator<Item = (usize, f64)> {
        let hinges = self.about_hinges.iter();
        hinges.map(|spring| (spring.unknown, spring.stiffness))
    }

    /// Whether one between nodes turns, or is stretched, by more than `part` of its length without force where its ends move
    /// so. The force of one without such a length is linear however far it turns.
    pub fn turn_by(&self, part: f64, moved: impl Fn(usize) -> Vector3) -> bool {
        self.between_nodes.iter().any(|spring| {
            let [from, to] = spring.nodes.map(&moved);
            spring.rest_length > 0.0 && (to - from).norm() > part * spring.rest_length
        })
    }
}

impl System {
    /// Force of a spring between nodes at the last evaluation, N: positive where it pulls.
    pub fn spring_force(&self, spring: usize) -> f64 {
        self.springs.force(spring)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spring(rest_length: f64, span: Vector3) -> NodeSpring {
        NodeSpring {
            nodes: [0, 1],
            stiffness: 3.0,
            rest_length,
            span,
        }
    }

    #[test]
    fn gradient_and_hessian_are_derivatives_of_the_energy() {
        let direction = Vector3::new(0.48, -0.6, 0.64);
        for size in [1e-3, 1.0, 1e3] {
            for part in [0.0, 0.3, 1.0, 2.5] {
                let at = |span: Vector3| spring(part * size, span);
                let here = at(direction * size);
                let step = 1e-4 * size;
                for axis in 0..3 {
                    let moved = |by: f64| at(here.span + Vector3::ith(axis, by * step));
                    let slope = |value: &dyn Fn(NodeSpring) -> f64| {
                        let [near, far] = [1.0, 2.0].map(|by| value(moved(by)) - value(moved(-by)));
                        (8.0 * near - far) / (12.0 * step)
                    };
                    let error = slope(&|spring| spring.energy()) - here.gradient()[axis];
                    assert!(error.abs() < 1e-8 * 3.0 * size, "{size} {part}: {error:e}");
                    for row in 0..3 {
                        let slope = slope(&|spring| spring.gradient()[row]);
                        let error = slope - here.hessian()[(row, axis)];
                        assert!(error.abs() < 1e-8 * 3.0, "{size} {part}: {error:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn one_without_length_is_linear_where_its_nodes_meet() {
        let here = spring(0.0, Vector3::zeros());
        assert_eq!(here.energy(), 0.0);
        assert_eq!(here.gradient(), Vector3::zeros());
        assert_eq!(here.hessian(), Matrix3::identity() * 3.0);
    }
}
