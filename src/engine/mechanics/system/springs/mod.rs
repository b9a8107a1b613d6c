//! Springs: between two nodes ([`between_nodes`]), between the material frames of two rods ([`between_frames`]), and about
//! hinges. Springs between nodes may act in one direction only, as ties do.
//!
//! A spring about a hinge has E = ½ c (α − α₀)² with the angle α, which is an unknown: ∂E/∂α = c (α − α₀), ∂²E/∂α² = c.

mod between_frames;
mod between_nodes;

use super::System;
use super::build::Assembly;
use super::clamps::Drive;
use super::demand::Demand;
use super::joints::{JointPlan, Joints, TurnedEnd};
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::linalg::{Element, UNUSED};
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{ElasticEnergy, RodGeometry, STRIDE};
use crate::mechanics::scene::{RodNode, Scene};
use crate::mechanics::{SceneError, Vector3, rotation};
use between_frames::{FrameSpring, SpringEnd};
use between_nodes::NodeSpring;

const NO_PATH: SceneError = SceneError::Unsuitable(
    "a path of equilibria does not support springs that act only in tension or compression: their stiffness jumps where \
     they become slack",
);

/// The springs of a scene, at the configuration of the last [`Self::stretch`] and [`Self::turn`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Springs {
    between_nodes: Vec<NodeSpring>,
    between_frames: Vec<FrameSpring>,
    about_hinges: Vec<AngleSpring>,
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

impl Springs {
    /// Force of a spring between nodes, k (r − L), N.
    pub(crate) fn force(&self, number: usize) -> f64 {
        self.between_nodes[number].force()
    }

    /// Moment of a torsional spring, c ‖θ‖, N m; 0 for other springs.
    pub(crate) fn moment(&self, number: usize) -> f64 {
        let mut between_frames = self.between_frames.iter();
        let spring = between_frames.find(|spring| spring.number == number);
        spring.map_or(0.0, |spring| spring.moments()[1].norm())
    }

    /// Adds the rounding errors of the forces of springs, from positions and rotations, to those
    /// of `assembly`.
    fn round(&self, assembly: &mut Assembly) {
        let frames = assembly.joints.frames.iter();
        let frames: Vec<_> = frames.map(|frame| (frame.node, frame.length)).collect();
        for spring in &self.between_nodes {
            for node in spring.nodes {
                assembly.round(node, spring.stiffness);
            }
        }
        for spring in &self.between_frames {
            for end in spring.ends {
                if let SpringEnd::Frame(number) = end {
                    let (node, length) = frames[number];
                    assembly.round(node, spring.stiffness / (length * length));
                }
            }
        }
    }

    /// Removes the spring about the hinge whose angle is the unknown `angle`.
    pub(crate) fn leave_hinge(&mut self, angle: usize) {
        self.about_hinges.retain(|spring| spring.unknown != angle);
    }

    /// Disables the force and moment of a spring.
    pub(crate) fn cut(&mut self, number: usize) {
        let spring = &mut self.between_nodes[number];
        (spring.stiffness, spring.rest_length) = (0.0, 0.0);
        let between_frames = self.between_frames.iter_mut();
        for spring in between_frames.filter(|spring| spring.number == number) {
            spring.stiffness = 0.0;
        }
    }

    /// Moment on a clamp of the springs that turn against it, N m.
    pub(crate) fn moment_on_clamp(&self, clamp: usize) -> Vector3 {
        let mut moment = Vector3::zeros();
        for spring in &self.between_frames {
            for (end, gradient) in spring.ends.iter().zip(spring.moments()) {
                if matches!(end, SpringEnd::Clamp(number) if *number == clamp) {
                    moment -= gradient;
                }
            }
        }
        moment
    }

    /// Whether a spring turns against a clamp.
    pub(crate) fn turns_against(&self, clamp: usize) -> bool {
        let mut ends = self.between_frames.iter().flat_map(|spring| &spring.ends);
        ends.any(|end| matches!(end, SpringEnd::Clamp(number) if *number == clamp))
    }

    /// Updates rotations from the frames of the last evaluation, and from clamps at a time (s).
    pub(crate) fn turn(&mut self, joints: &Joints, drives: &[Drive], time: f64) {
        for spring in &mut self.between_frames {
            spring.turn(joints, drives, time);
        }
    }

    /// Updates lengths and angles of hinges from `unknowns`.
    pub(crate) fn stretch(&mut self, unknowns: &[f64]) {
        for spring in &mut self.between_nodes {
            let [from, to] = spring.nodes.map(|node| position(unknowns, node));
            spring.span = to - from;
        }
        for spring in &mut self.about_hinges {
            spring.angle = unknowns[spring.unknown];
        }
    }

    /// Whether a spring between nodes turns, or is stretched, by more than `part` of its length
    /// without force under a motion of its ends. A spring with zero such length is excluded, since
    /// its force is linear however far it turns.
    pub(crate) fn turn_by(&self, part: f64, moved: impl Fn(usize) -> Vector3) -> bool {
        self.between_nodes.iter().any(|spring| {
            let [from, to] = spring.nodes.map(&moved);
            spring.rest_length > 0.0 && (to - from).norm() > part * spring.rest_length
        })
    }
}

impl Term for Springs {
    /// # Errors
    /// [`SceneError::Joint`] if a spring is invalid.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let plan = if scene.springs.is_empty() {
            JointPlan::default()
        } else {
            JointPlan::new(scene)?
        };
        let (mut between_nodes, mut between_frames) = (Vec::new(), Vec::new());
        for (spring_number, spring) in scene.springs.iter().enumerate() {
            let rest_length = plan.rest_length(scene, spring)?;
            let number = |at: RodNode| assembly.rods.rods[at.rod].first_node + at.node;
            if let Some(turning) = &spring.turning {
                let end = |end: TurnedEnd| match end {
                    TurnedEnd::Frame(frame) => SpringEnd::Frame(frame),
                    TurnedEnd::Held => SpringEnd::Held,
                    TurnedEnd::Clamped(at) => {
                        let mut drives = assembly.drives.iter();
                        let drive = drives.position(|drive| drive.node == number(at));
                        SpringEnd::Clamp(drive.expect("the plan found the clamp"))
                    }
                };
                between_frames.push(FrameSpring {
                    number: spring_number,
                    ends: plan.turned_ends(scene, spring)?.map(end),
                    stiffness: turning.stiffness,
                    rest: rotation::from_vector(turning.rest_rotation),
                    vector: Vector3::zeros(),
                });
            }
            between_nodes.push(NodeSpring {
                nodes: spring.nodes.map(number),
                stiffness: spring.stiffness,
                rest_length,
                only: spring.only,
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
        let springs = Self {
            between_nodes,
            between_frames,
            about_hinges: about_hinges.collect(),
        };
        springs.round(assembly);
        Ok(springs)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        self.between_nodes.is_empty()
            && self.between_frames.is_empty()
            && self.about_hinges.is_empty()
    }

    /// The unknowns of the springs between nodes, then of those between frames.
    fn elements(&self, assembly: &Assembly) -> Vec<Element> {
        let between_nodes = self.between_nodes.iter().map(|spring| {
            let mut element = [UNUSED; 12];
            for (end, node) in spring.nodes.iter().enumerate() {
                for axis in 0..3 {
                    element[3 * end + axis] = STRIDE * node + axis;
                }
            }
            element
        });
        let joints = &assembly.joints;
        let between_frames = self.between_frames.iter();
        between_nodes
            .chain(between_frames.map(|spring| spring.element(joints)))
            .collect()
    }

    fn couples_nodes(&self) -> bool {
        !self.between_nodes.is_empty()
    }

    /// The stiffness of one-sided springs jumps where they become slack.
    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        let mut springs = self.between_nodes.iter();
        let jumps = demand == Demand::Path && springs.any(|spring| spring.only.is_some());
        jumps.then_some(NO_PATH)
    }

    fn update(&mut self, at: &Configuration) {
        self.stretch(at.unknowns);
        self.turn(&at.assembly.joints, &at.assembly.drives, at.time);
    }

    /// Springs between nodes count as stretching energy, springs between frames and about hinges
    /// as bending energy.
    fn energy(&self, _: &Assembly, _: &RodGeometry) -> ElasticEnergy {
        let of_angle = |spring: &AngleSpring| {
            let turn = spring.angle - spring.rest_angle;
            0.5 * spring.stiffness * turn * turn
        };
        ElasticEnergy {
            stretching: self.between_nodes.iter().map(NodeSpring::energy).sum(),
            bending: self.about_hinges.iter().map(of_angle).sum::<f64>()
                + (self.between_frames.iter())
                    .map(FrameSpring::energy)
                    .sum::<f64>(),
            twisting: 0.0,
        }
    }

    /// Moments on frames are in the fixed frame.
    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        for spring in &self.between_frames {
            spring.add_gradient(&at.assembly.joints, residual);
        }
        for spring in &self.between_nodes {
            let force = spring.gradient();
            let [from, to] = spring.nodes.map(|node| STRIDE * node);
            for axis in 0..3 {
                residual[from + axis] -= force[axis];
                residual[to + axis] += force[axis];
            }
        }
        for spring in &self.about_hinges {
            residual[spring.unknown] += spring.stiffness * (spring.angle - spring.rest_angle);
        }
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        let (matrices, of_frames) = entries.elements().split_at_mut(self.between_nodes.len());
        for (spring, matrix) in self.between_frames.iter().zip(of_frames) {
            spring.add_hessian(&at.assembly.joints, at.unknowns, matrix);
        }
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
        let columns = entries.columns();
        for spring in &self.about_hinges {
            columns[spring.unknown][0] += spring.stiffness;
        }
    }

    /// Adds the forces on nodes.
    fn add_sizes(&self, _: &Configuration, forces: &mut [f64]) {
        for spring in &self.between_nodes {
            let force = spring.gradient();
            for node in spring.nodes {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += force[axis].abs();
                }
            }
        }
    }
}

impl System {
    /// Force of a spring between nodes at the last evaluation, N: positive where it pulls.
    pub(crate) fn spring_force(&self, spring: usize) -> f64 {
        self.terms.springs.force(spring)
    }
}
