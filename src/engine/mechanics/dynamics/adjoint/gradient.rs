//! Derivatives of a result with respect to fields along the rods.

use super::covector::{Covector, VirtualMotion};
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{STRIDE, Vertex};
use crate::mechanics::system::{Assembly, OfStrains, StrainLaws};

/// Derivatives of a result I with respect to fields along all rods, an entry for each node, or for
/// the edge that starts there.
///
/// Derivatives with respect to natural strains are per node, not per length: if a field κ̄(s)
/// changes by δκ̄(s), the change of I is Σᵢ (dI/dκ̄ᵢ) δκ̄(sᵢ). Their sum over a rod is the
/// derivative with respect to a value that is constant along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// With respect to the natural curvatures about m₁ and m₂ at the node, per 1/m.
    pub natural_curvature: Vec<[f64; 2]>,
    /// With respect to the natural twist at the node, per rad/m.
    pub natural_twist: Vec<f64>,
    /// EI dI/dEI at the node, about m₁ and m₂.
    pub bending: Vec<[f64; 2]>,
    /// GJ dI/dGJ at the node.
    pub twisting: Vec<f64>,
    /// EA dI/dEA of the edge.
    pub stretching: Vec<f64>,
    /// With respect to a dead force on the node during the whole motion, per N.
    pub force: Vec<Vector3>,
    /// With respect to the initial velocity of the node, per m/s; zero after an equilibrium, which
    /// starts at rest.
    pub velocity: Vec<Vector3>,
}

/// Sums over the steps.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// Over natural strains.
    natural: OfStrains,
    /// With respect to relative changes of stiffness.
    stiffness: OfStrains,
    /// With respect to forces on the unknowns.
    force: Vec<f64>,
    /// With respect to initial velocities.
    velocity: Vec<f64>,
}

impl Sums {
    pub(super) fn zero(simulation: &Simulation) -> Self {
        let system = &simulation.system;
        let of_strains = OfStrains::zero(&system.assembly.rods);
        let of_unknowns = vec![0.0; system.residual.len()];
        Self {
            natural: of_strains.clone(),
            stiffness: of_strains,
            force: of_unknowns.clone(),
            velocity: of_unknowns,
        }
    }

    /// Adds the contribution of a step: −(∂R/∂p)ᵀ λ.
    pub(super) fn add(&mut self, along: &VirtualMotion, laws: &StrainLaws) {
        self.natural
            .add_products(1.0, &laws.stiffness, &along.strains);
        self.stiffness
            .add_products(-1.0, &laws.moment, &along.strains);
        let pairs = self.force.iter_mut().zip(&along.motion);
        pairs.for_each(|(sum, motion)| *sum += motion);
    }

    /// Adds the derivatives with respect to the velocities at the start of a motion and in the
    /// steps before it, which have the same velocities.
    pub(super) fn start(&mut self, covector: &Covector, assembly: &Assembly) {
        for velocities in &covector.velocities {
            let pairs = self.velocity.iter_mut().zip(velocities);
            pairs.for_each(|(sum, velocity)| *sum += velocity);
        }
        // Joined nodes start with the velocity of the owner of their position.
        assembly.joints.gather_points(&mut self.velocity);
    }

    /// The fields.
    pub(super) fn fields(&self, assembly: &Assembly) -> Gradient {
        let nodes = assembly.rods.nodes;
        let vectors = |of: &[f64]| (0..nodes).map(|node| position(of, node)).collect();
        let mut gradient = Gradient {
            natural_curvature: vec![[0.0; 2]; nodes],
            natural_twist: vec![0.0; nodes],
            bending: vec![[0.0; 2]; nodes],
            twisting: vec![0.0; nodes],
            stretching: vec![0.0; nodes],
            force: vectors(&self.force),
            velocity: vectors(&self.velocity),
        };
        for node in 0..nodes {
            for axis in (0..3).filter(|axis| assembly.held[STRIDE * node + axis]) {
                gradient.velocity[node][axis] = 0.0;
            }
        }
        // A ghost edge has none.
        let mut natural_lengths = vec![0.0; nodes + assembly.rods.ghosts];
        for edge in &assembly.rods.edges {
            natural_lengths[edge.start] = edge.natural_length;
        }
        let voronoi = |vertex: &Vertex| {
            0.5 * (natural_lengths[vertex.before] + natural_lengths[vertex.after])
        };
        let both = self.natural.vertices.iter().zip(&self.stiffness.vertices);
        for (vertex, (natural, stiffness)) in assembly.rods.vertices.iter().zip(both) {
            let (node, length) = (assembly.node_of(vertex), voronoi(vertex));
            let [k0, k1, k2, k3, twist] = *natural;
            // κ¹ is the curvature about m₂, κ² that about −m₁.
            gradient.natural_curvature[node][0] -= length * (k1 + k3);
            gradient.natural_curvature[node][1] += length * (k0 + k2);
            gradient.natural_twist[node] += length * twist;
            let [k0, k1, k2, k3, twist] = *stiffness;
            gradient.bending[node][0] += k1 + k3;
            gradient.bending[node][1] += k0 + k2;
            gradient.twisting[node] += twist;
        }
        for (edge, stiffness) in assembly.rods.edges.iter().zip(&self.stiffness.edges) {
            gradient.stretching[edge.start] = *stiffness;
        }
        gradient
    }
}
