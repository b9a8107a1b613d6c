//! The mass matrix of rods with consistent inertia, in which nodes share the mass of the edge
//! between them.
//!
//! Between two nodes that move with v₀ and v₁ an edge of mass m moves linearly, with the kinetic energy
//!
//! ```text
//! ½ m ∫₀¹ |(1−s) v₀ + s v₁|² ds = ½ [ m/2 |v₀|² + m/2 |v₁|² − m/6 |v₁ − v₀|² ]
//! ```
//!
//! the "consistent" mass of the finite element method: half of the edge is lumped at either node,
//! minus a sixth of it on the difference. In the middle of a uniform rod its stencil is ρA h [⅙,
//! ⅔, ⅙]. For waves e^{ikx} it is lighter than lumped masses by the factor 1 − (kh)²/6, and the
//! bending of the vertices is softer than that of the rod by (1 − (kh)²/12)². The errors cancel,
//! and bending waves have the right speed up to (kh)⁴. The same holds at free and hinged ends,
//! whose conditions the energy implies, and at clamps with the weights of
//! [`crate::mechanics::rod::VertexWeights`]. Held nodes act on their neighbours like other nodes;
//! where a clamp jerks, its neighbours react.
//!
//! **Twist.** Angles belong to edges, and twist to the vertices between them. The squared
//! frequency of twist waves is too low by the factor 1 − (kh)²/12, so the moments of inertia of
//! the two half edges at a vertex are shared with 1/12: ρJ h [1/12, 10/12, 1/12].
//!
//! **Stretching** keeps an error of second order. Fourth order would need the stencil of twist, but
//! bending needs that of linear interpolation, and a mass that differs between directions would not
//! conserve angular momentum. Axial waves are too fast by (kh)²/24, and the fastest by √3; with
//! lumped masses they are too slow by (kh)²/24.
//!
//! **Curved rods.** The nodes follow w − h²/12 w'', the least-squares projection of the centreline
//! onto polygons: where the centreline is bent, the nodes are h²κ/12 outside it. If an arc of the
//! length h turns by φ, the edges of a polygon around it have the length h (1 + φ²/24). Edges here
//! keep the length h, which leaves an error of second order. The error is small if loads bend a
//! straight rod that measures the angle by which it turns
//! ([`crate::mechanics::rod::BendingStrain`]), and large for rods with a strong natural curvature:
//! the lowest frequency of a ring of 25 edges is 1.5 % too high, with lumped masses 0.6 %.
//!
//! **Conservation.** The matrix is constant and the same for x, y and z. Σ Mᵢⱼ vⱼ and Σ Mᵢⱼ xᵢ ×
//! vⱼ are momentum and angular momentum, which balance the forces and their moments exactly in
//! space. The rows sum to the lumped masses, so weight and total momentum are those of lumped
//! masses.

use super::shared_mass::Shared;
use super::{Assembly, Stage};
use crate::linalg::{ElementMatrix, HALF_BANDWIDTH};
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use nalgebra::DMatrix;
use std::ops::Range;

impl Assembly {
    /// Inertia of each node (kg) in the motion for which it is least: against the motion of its
    /// neighbours, where they share masses.
    pub(crate) fn least_inertia(&self) -> Vec<f64> {
        let nodes = self.masses.len() / STRIDE;
        let mut least: Vec<f64> = (0..nodes).map(|node| self.masses[STRIDE * node]).collect();
        for (pair, shared) in self.consistent.pairs() {
            for node in pair {
                least[node] -= 2.0 * shared[0];
            }
        }
        least
    }

    /// Adds to the residual the inertia of the shared masses under the accelerations of a stage at
    /// `unknowns`: c (a₁ − a₀) at the first of two nodes, and the opposite at the second.
    pub(super) fn add_shared_inertia(&self, stage: &Stage, unknowns: &[f64], residual: &mut [f64]) {
        if self.consistent.chains.is_empty() {
            return;
        }
        let per_step = 1.0 / stage.step;
        let per_acceleration_step = 1.0 / stage.acceleration_step;
        let [unknowns, start, velocity] =
            [unknowns, &stage.start, &stage.velocity].map(|vector| vector.as_chunks::<STRIDE>().0);
        let acceleration = |node: usize| -> Shared {
            let (now, start, velocity) = (&unknowns[node], &start[node], &velocity[node]);
            std::array::from_fn(|k| {
                let change = (now[k] - start[k]) * per_step - velocity[k];
                per_acceleration_step * change
            })
        };
        let (residual, _) = residual.as_chunks_mut::<STRIDE>();
        self.consistent
            .for_each_chain(residual, &|chain, residual| {
                let mut own = acceleration(chain.first_node);
                for (k, shared) in chain.shared.iter().enumerate() {
                    let next = acceleration(chain.first_node + k + 1);
                    for axis in 0..STRIDE {
                        let force = shared[axis] * (next[axis] - own[axis]);
                        residual[k][axis] += force;
                        residual[k + 1][axis] -= force;
                    }
                    own = next;
                }
            });
        for joint in &self.consistent.joints {
            let [own, next] = joint.nodes.map(acceleration);
            for k in 0..STRIDE {
                let force = joint.shared[k] * (next[k] - own[k]);
                residual[joint.nodes[0]][k] += force;
                residual[joint.nodes[1]][k] -= force;
            }
        }
    }

    /// Adds `scale` (1/s²) times the shared masses to the elements that close rings and to a band,
    /// given by its columns, that already contains the lumped masses.
    pub(super) fn add_shared_masses(
        &self,
        scale: f64,
        columns: &mut [[f64; HALF_BANDWIDTH + 1]],
        elements: &mut [ElementMatrix],
    ) {
        let (nodes, _) = columns.as_chunks_mut::<STRIDE>();
        self.consistent.for_each_chain(nodes, &|chain, nodes| {
            let mut before = [0.0; STRIDE];
            for (columns, shared) in nodes.iter_mut().zip(&chain.shared) {
                for (k, column) in columns.iter_mut().enumerate() {
                    let mass = scale * shared[k];
                    // The diagonals lose exactly the part of the mass that survives rounding
                    // beside a stiffness 10¹⁵ times as large. So rows still sum to the masses: a
                    // short steel rod falls as a rigid body.
                    let sum = column[STRIDE] + mass;
                    let kept = sum - column[STRIDE];
                    column[STRIDE] = sum;
                    column[0] -= before[k] + kept;
                    before[k] = kept;
                }
            }
            for (column, before) in nodes[chain.shared.len()].iter_mut().zip(before) {
                column[0] -= before;
            }
        });
        for joint in &self.consistent.joints {
            let (element, [row, place]) = joint.element;
            let matrix = &mut elements[element];
            for k in (0..STRIDE).filter(|&k| joint.shared[k] != 0.0) {
                let mass = scale * joint.shared[k];
                matrix[row + k][place + k] += mass;
                matrix[place + k][row + k] += mass;
                matrix[row + k][row + k] -= mass;
                matrix[place + k][place + k] -= mass;
            }
        }
    }

    /// The mass matrix of all unknowns, with frames and bodies as placed; unknowns owned by others
    /// have no mass.
    pub(crate) fn mass_matrix(&self) -> DMatrix<f64> {
        self.mass_matrix_at(&self.unknowns)
    }

    /// The mass matrix with frames and bodies rotated as at `unknowns`, which were evaluated last.
    pub(crate) fn mass_matrix_at(&self, unknowns: &[f64]) -> DMatrix<f64> {
        let mut matrix = DMatrix::from_diagonal(&self.masses.clone().into());
        for (nodes, shared) in self.consistent.pairs() {
            for k in 0..STRIDE {
                let [first, second] = nodes.map(|node| STRIDE * node + k);
                matrix[(first, first)] -= shared[k];
                matrix[(second, second)] -= shared[k];
                matrix[(first, second)] += shared[k];
                matrix[(second, first)] += shared[k];
            }
        }
        self.joints.gather_masses(unknowns, &mut matrix);
        matrix
    }

    /// All nodes, followed by the places of frames and of the tips of bodies.
    pub(crate) fn all_places(&self) -> Range<usize> {
        0..self.unknowns.len() / STRIDE
    }

    /// Kinetic energy of some of the nodes, which must be those of complete rods, J.
    pub(crate) fn kinetic_energy(&self, nodes: &Range<usize>, velocity: &[f64]) -> f64 {
        let unknowns = STRIDE * nodes.start..STRIDE * nodes.end;
        let velocities = velocity[unknowns.clone()].iter();
        let lumped: f64 = velocities
            .zip(&self.masses[unknowns])
            .map(|(v, m)| 0.5 * m * v * v)
            .sum();
        let pairs = self.consistent.pairs();
        let own = pairs.filter(|(pair, _)| nodes.contains(&pair[0]));
        let shared = own.map(|(pair, shared)| -> f64 {
            let between =
                |k: usize| velocity[STRIDE * pair[1] + k] - velocity[STRIDE * pair[0] + k];
            (0..STRIDE)
                .map(|k| 0.5 * shared[k] * between(k).powi(2))
                .sum()
        });
        lumped - shared.sum::<f64>() + self.eccentric_energy(nodes, velocity)
    }

    /// Momentum, kg m/s, and angular momentum about the origin, kg m²/s, of the motion of all nodes.
    pub(crate) fn momenta(&self, unknowns: &[f64], velocity: &[f64]) -> [Vector3; 2] {
        let [mut momentum, mut angular] = [Vector3::zeros(); 2];
        for node in self.all_places() {
            let own = position(velocity, node) * self.masses[STRIDE * node];
            // The tips of bodies move about their centres.
            if node < self.rods.nodes {
                momentum += own;
            }
            angular += position(unknowns, node).cross(&own);
        }
        for (pair, shared) in self.consistent.pairs() {
            let between = |vector: &[f64]| position(vector, pair[1]) - position(vector, pair[0]);
            angular -= between(unknowns).cross(&between(velocity)) * shared[0];
        }
        let [of_arms, about_origin] = self.eccentric_momenta(unknowns, velocity);
        [momentum + of_arms, angular + about_origin]
    }
}

#[cfg(test)]
#[path = "mass_tests.rs"]
mod tests;
