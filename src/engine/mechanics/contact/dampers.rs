//! Derivatives of contact forces with respect to the data at the start of a step: friction depends
//! on the positions of the nodes there, and all forces depend on the contact stiffness k.
//!
//! Friction N t(u) acts on the slip u of the velocity v = Σ w_m (x_m − x_mⁿ)/Δt, so it depends on
//! the positions x_mⁿ at the start of the step as a damper does:
//!
//! ∂F_k/∂x_mⁿ = −w_k w_m D,  D = N ∂t/∂v /Δt.
//!
//! The laws of an active set ([`super::active_set`]) are linear in the positions, with their own
//! derivatives with respect to those at the start.

use super::active_law::{ActiveLaw, START};
use super::contact_system::ContactSystem;
use super::contacts::EdgeJacobian;
use super::evaluation::Motion;
use super::friction::{FrictionLaw, slip};
use super::nearest_points::NearestPoints;
use crate::mechanics::{Matrix3, Vector3};

/// Contact forces as a function of the node positions at the start of the step.
#[derive(Clone, Debug)]
pub(crate) enum FromStart {
    /// Friction, as a damper between the nodes.
    Damper(Damper),
    /// A law of an active set.
    Active {
        /// `None` for vertices of obstacles.
        nodes: [Option<usize>; 4],
        /// Derivative of the forces, N/m.
        over: Box<EdgeJacobian>,
    },
}

impl FromStart {
    /// Adds the derivative of the work −Σ F·λ with respect to the node positions at the start of
    /// the step, for a virtual motion λ of the nodes at its end.
    pub(crate) fn add_to_start(
        &self,
        of_node: impl Fn(usize) -> Vector3,
        mut add: impl FnMut(usize, Vector3),
    ) {
        let (nodes, over) = match self {
            Self::Damper(damper) => return damper.add_to_start(of_node, add),
            Self::Active { nodes, over } => (nodes, over),
        };
        let moves = nodes.map(|node| node.map_or_else(Vector3::zeros, &of_node));
        for (corner, node) in nodes.iter().enumerate() {
            let work = |axis: usize| {
                let rates = over.iter().map(|row| row[3 * corner + axis]);
                let products = rates
                    .enumerate()
                    .map(|(k, rate)| rate * moves[k / 3][k % 3]);
                products.sum::<f64>()
            };
            if let Some(node) = node {
                add(*node, -Vector3::from_fn(|axis, _| work(axis)));
            }
        }
    }
}

/// A contact with friction, as a damper between its nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Damper {
    nodes: [usize; 4],
    /// Zero for vertices of obstacles, which are not unknowns at the start of a step.
    weights: [f64; 4],
    /// D, N/m.
    damping: Matrix3,
}

impl Damper {
    fn add_to_start(
        &self,
        of_node: impl Fn(usize) -> Vector3,
        mut add: impl FnMut(usize, Vector3),
    ) {
        let corners = self.nodes.into_iter().zip(self.weights);
        let corners = corners.filter(|(_, weight)| *weight != 0.0);
        let moves = (corners.clone()).map(|(node, weight)| of_node(node) * weight);
        let force = self.damping.tr_mul(&moves.sum::<Vector3>());
        for (node, weight) in corners {
            add(node, force * weight);
        }
    }
}

impl ContactSystem {
    /// The contacts of the last evaluation, at `positions`, that depend on the start of the step:
    /// those with friction, or the laws of an active set.
    pub(crate) fn dependence_on_start(
        &self,
        positions: &[Vector3],
        previous: &[Vector3],
        time_step: f64,
    ) -> Vec<FromStart> {
        if !self.active_laws.is_empty() {
            return self.active_dependence();
        }
        let motion = Motion {
            positions,
            previous,
            time_step,
        };
        let tolerance = self.parameters.slip_tolerance;
        let damping = |law: FrictionLaw, normal: &Vector3, velocity: &Vector3, force: f64| {
            let at = slip(normal, velocity);
            let traction = law.traction_derivatives(normal, velocity, &at);
            traction.by_velocity * (force * normal.norm() / time_step)
        };
        let of_pairs = self.contacts.iter().filter_map(|contact| {
            let pair = self.candidates.pairs()[contact.candidate];
            let coefficient = self.friction_between(&pair);
            let law = motion.friction(coefficient, tolerance)?;
            let points = self.obstacles.points(positions);
            let smoothing = self.parameters.smoothing(contact.threshold);
            let nearest = NearestPoints::of(&self.surface, &pair, &points, smoothing)?;
            let pair = nearest.settled(&self.surface, &pair);
            let nodes = points.of(pair.nodes);
            let sliding = self.sliding(law, &pair, &nodes, &nearest, &motion);
            let (normal, mut weights) = (nearest.normal(), nearest.weights());
            let velocity = sliding.contact_velocity(&weights, &normal);
            let damping = damping(law, &normal, &velocity, contact.normal_force);
            for (weight, node) in weights.iter_mut().zip(pair.nodes) {
                if !self.is_of_rod(node) {
                    *weight = 0.0;
                }
            }
            Some(Damper {
                nodes: pair.nodes,
                weights,
                damping,
            })
        });
        let of_planes = self.plane_contacts.iter().filter_map(|touch| {
            let plane = &self.planes[touch.plane];
            let mut nodes = self.surface.nodes().iter();
            let node = nodes.find(|own| own.node == touch.node)?;
            let law = motion.friction(self.friction_over(plane, node), tolerance)?;
            let velocity = motion.velocity(touch.node);
            Some(Damper {
                nodes: [touch.node; 4],
                weights: [1.0, 0.0, 0.0, 0.0],
                damping: damping(law, &plane.normal, &velocity, touch.normal_force),
            })
        });
        of_pairs.chain(of_planes).map(FromStart::Damper).collect()
    }

    fn active_dependence(&self) -> Vec<FromStart> {
        let of_law = |law: &ActiveLaw| {
            let is_alone = law.nodes[0] == law.nodes[3];
            let corner = |corner: usize| {
                let node = law.nodes[corner];
                let counts = self.is_of_rod(node) && (corner == 0 || !is_alone);
                counts.then_some(node)
            };
            FromStart::Active {
                nodes: [0, 1, 2, 3].map(corner),
                over: Box::new(law.over[START]),
            }
        };
        self.active_laws.iter().map(of_law).collect()
    }

    /// Derivative of the work Σ F·λ of the contacts of the last evaluation with respect to k, in a
    /// virtual motion λ, m per unit of its motion.
    ///
    /// Forces are proportional to k where k is not below the least stiffness of the two bodies.
    /// Those of an active set do not depend on k.
    pub(crate) fn work_over_stiffness(&self, of_node: impl Fn(usize) -> Vector3) -> f64 {
        if !self.active_laws.is_empty() {
            return 0.0;
        }
        let follows =
            |first: usize, second: usize| self.stiffness_between(first, second) <= self.stiffness;
        let pairs = self
            .contacts
            .iter()
            .filter(|c| follows(c.nodes[0], c.nodes[3]));
        let of_pairs = pairs.map(|contact| {
            let (forces, _) = contact.force.as_chunks::<3>();
            let corners = contact.nodes.into_iter().zip(forces);
            let of_rods = corners.filter(|(node, _)| self.is_of_rod(*node));
            let work = of_rods.map(|(node, force)| Vector3::from(*force).dot(&of_node(node)));
            work.sum::<f64>()
        });
        let planes = self
            .plane_contacts
            .iter()
            .filter(|c| follows(c.node, c.node));
        let of_planes = planes.map(|c| Vector3::from(c.force).dot(&of_node(c.node)));
        of_pairs.chain(of_planes).sum::<f64>() / self.stiffness
    }
}
