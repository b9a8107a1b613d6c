//! The flow operator as the solver sees it: exact for few nodes, by clusters for many.

use super::Filament;
use super::hierarchy::HierarchicalOperator;
use super::operator::FlowOperator;
use crate::mechanics::{Matrix3, Vector3};

/// Nodes from which clusters are cheaper than all pairs. A step of 15 helices (1,020 nodes, 3 cm apart) costs
/// the same either way; 10 helices cost 1.6 times as much by clusters, 30 cost half as much.
const CROSSOVER: usize = 1024;

/// A product with A, exact or not.
pub(super) enum Flow {
    Exact(FlowOperator),
    Hierarchical(HierarchicalOperator),
}

impl Flow {
    /// Exact below [`CROSSOVER`] nodes and for a `far_field_error` of zero; by clusters otherwise.
    pub fn new(filaments: &[Filament], regularization: f64, far_field_error: f64) -> Self {
        let nodes: usize = filaments.iter().map(|filament| filament.nodes).sum();
        if far_field_error == 0.0 || nodes < CROSSOVER {
            Self::Exact(FlowOperator::new(filaments, regularization))
        } else {
            Self::Hierarchical(HierarchicalOperator::new(
                filaments,
                regularization,
                order_for(far_field_error),
            ))
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        match self {
            Self::Exact(operator) => operator.nodes(),
            Self::Hierarchical(operator) => operator.nodes(),
        }
    }

    /// Evaluates the operator at new positions of the nodes, m.
    pub fn assemble(&mut self, positions: &[Vector3]) {
        match self {
            Self::Exact(operator) => operator.assemble(positions),
            Self::Hierarchical(operator) => operator.assemble(positions),
        }
    }

    /// Calls `each` with every node and its diagonal block A_ii.
    pub fn diagonal(&self, mut each: impl FnMut(usize, Matrix3)) {
        match self {
            Self::Exact(operator) => {
                (0..operator.nodes()).for_each(|node| each(node, operator.block(node, node)));
            }
            Self::Hierarchical(operator) => operator.diagonal(each),
        }
    }

    /// `velocities` = A `densities`.
    pub fn multiply(&mut self, densities: &[f64], velocities: &mut [f64]) {
        match self {
            Self::Exact(operator) => operator.multiply(densities, velocities),
            Self::Hierarchical(operator) => operator.multiply(densities, velocities),
        }
    }

    /// [`multiply`](Self::multiply) for three vectors.
    pub fn multiply_three(&mut self, densities: &[Vec<f64>; 3], velocities: &mut [Vec<f64>; 3]) {
        match self {
            Self::Exact(operator) => operator.multiply_three(densities, velocities),
            Self::Hierarchical(operator) => operator.multiply_three(densities, velocities),
        }
    }

    /// Floating-point operations of a product.
    pub fn operations(&self) -> f64 {
        match self {
            Self::Exact(operator) => 18.0 * (operator.nodes() * operator.nodes()) as f64,
            Self::Hierarchical(operator) => operator.operations(),
        }
    }
}

/// Degree of the expansions for a relative error of the drag. In helices 3 mm and 3 cm apart the velocities
/// err by about 0.015 · 0.37ᵖ at degree p, and the forces ten times as much: what expansions get wrong varies
/// from node to node, and such velocities take larger forces than even ones.
fn order_for(far_field_error: f64) -> usize {
    (libm::log(far_field_error / 0.2) / libm::log(0.38f64)).ceil() as usize
}
