//! Forces defined by code: each [`NodeForce`] is the gradient of a potential of up to four
//! positions.
//!
//! The force on one node is within the band of its rod; a force on several nodes couples them by
//! an element.

use super::System;
use super::build::Assembly;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::linalg::{Element, UNUSED};
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{ElasticEnergy, RodGeometry, STRIDE};
use crate::mechanics::scene::{NodeForce, NodeHessian, Scene};
use crate::mechanics::{Matrix3, SceneError, Vector3};
use std::sync::Arc;

/// Most nodes of a force.
const MOST_NODES: usize = 4;

/// All forces of code.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeForces(Vec<Placed>);

/// A force at the configuration of the last update.
#[derive(Clone, Debug)]
struct Placed {
    force: Arc<dyn NodeForce>,
    /// Indices of its nodes among those of all rods.
    nodes: Vec<usize>,
    /// Their positions, m.
    positions: Vec<Vector3>,
}

impl Placed {
    fn gradient(&self) -> [Vector3; MOST_NODES] {
        let mut gradient = [Vector3::zeros(); MOST_NODES];
        let own = &mut gradient[..self.nodes.len()];
        self.force.add_gradient(&self.positions, own);
        gradient
    }

    fn hessian(&self) -> NodeHessian {
        let mut hessian = [[Matrix3::zeros(); MOST_NODES]; MOST_NODES];
        self.force.add_hessian(&self.positions, &mut hessian);
        hessian
    }

    fn is_coupled(&self) -> bool {
        self.nodes.len() > 1
    }
}

impl Term for NodeForces {
    /// # Errors
    /// [`SceneError::Force`] if the nodes do not exist, or if there are none or too many.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let mut placed = Vec::new();
        for force in &scene.forces {
            let named = force.nodes();
            let numbers = named.iter().map(|at| {
                let rod = assembly.rods.rods.get(at.rod)?;
                (at.node < rod.nodes).then_some(rod.first_node + at.node)
            });
            let nodes: Option<Vec<usize>> = numbers.collect();
            let nodes = nodes.filter(|nodes| (1..=MOST_NODES).contains(&nodes.len()));
            let force = Placed {
                nodes: nodes.ok_or_else(|| SceneError::Force(force.name().to_owned()))?,
                positions: Vec::new(),
                force: Arc::clone(force),
            };
            placed.push(force);
        }
        let mut forces = Self(placed);
        forces.follow(&assembly.unknowns);
        forces.round(assembly);
        Ok(forces)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        self.0.is_empty()
    }

    /// The unknowns of each force on several nodes.
    fn elements(&self, _: &Assembly) -> Vec<Element> {
        let coupled = self.0.iter().filter(|force| force.is_coupled());
        let element = |force: &Placed| {
            let mut element = [UNUSED; 12];
            for (end, node) in force.nodes.iter().enumerate() {
                for axis in 0..3 {
                    element[3 * end + axis] = STRIDE * node + axis;
                }
            }
            element
        };
        coupled.map(element).collect()
    }

    fn couples_nodes(&self) -> bool {
        self.0.iter().any(Placed::is_coupled)
    }

    fn update(&mut self, at: &Configuration) {
        self.follow(at.unknowns);
    }

    /// Counts as stretching.
    fn energy(&self, _: &Assembly, _: &RodGeometry) -> ElasticEnergy {
        let energy = |force: &Placed| force.force.energy(&force.positions);
        ElasticEnergy {
            stretching: self.0.iter().map(energy).sum(),
            ..ElasticEnergy::default()
        }
    }

    fn add_forces(&self, _: &Configuration, residual: &mut [f64]) {
        for force in &self.0 {
            for (node, gradient) in force.nodes.iter().zip(force.gradient()) {
                for axis in 0..3 {
                    residual[STRIDE * node + axis] += gradient[axis];
                }
            }
        }
    }

    fn add_jacobian(&self, _: &Configuration, entries: &mut Entries) {
        let coupled = self.0.iter().filter(|force| force.is_coupled());
        for (force, matrix) in coupled.zip(entries.elements()) {
            let hessian = force.hessian();
            for i in 0..3 * force.nodes.len() {
                for j in 0..3 * force.nodes.len() {
                    matrix[i][j] += hessian[i / 3][j / 3][(i % 3, j % 3)];
                }
            }
        }
        let columns = entries.columns();
        for force in self.0.iter().filter(|force| !force.is_coupled()) {
            let (first, hessian) = (STRIDE * force.nodes[0], force.hessian()[0][0]);
            for column in 0..3 {
                for row in column..3 {
                    columns[first + column][row - column] += hessian[(row, column)];
                }
            }
        }
    }

    fn add_sizes(&self, _: &Configuration, forces: &mut [f64]) {
        for force in &self.0 {
            for (node, gradient) in force.nodes.iter().zip(force.gradient()) {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += gradient[axis].abs();
                }
            }
        }
    }
}

impl NodeForces {
    /// Reads the positions from `unknowns`.
    fn follow(&mut self, unknowns: &[f64]) {
        for force in &mut self.0 {
            let nodes = force.nodes.iter();
            force.positions.clear();
            (force.positions).extend(nodes.map(|node| position(unknowns, *node)));
        }
    }

    /// Adds the rounding errors of the forces as placed to those of `assembly`.
    fn round(&self, assembly: &mut Assembly) {
        for force in &self.0 {
            let hessian = force.hessian();
            for (end, node) in force.nodes.iter().enumerate() {
                assembly.round(*node, hessian[end][end].amax());
            }
        }
    }
}

impl System {
    /// Force on the first node of a force defined by code at the last evaluation, N.
    pub(crate) fn node_force(&self, number: usize) -> Vector3 {
        -self.terms.node_forces.0[number].gradient()[0]
    }
}
