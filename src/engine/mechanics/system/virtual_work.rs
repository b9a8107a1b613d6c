//! Strains along a virtual motion, and the forces equivalent to given moments, for adjoints of
//! motions.
//!
//! Elastic forces R = Σ M ∂ε/∂q do the work λ·R = Σ M dε[λ] in a virtual motion λ, with the
//! derivatives dε[λ] of the strains along it. These derivatives therefore determine the full
//! effect on λ·R of a change of stiffness or of natural strains.
//!
//! Strains are in the order of the vertices, [`OF_VERTEX`] each (κ¹⁰, κ²⁰, κ¹¹, κ²¹, τ; see
//! [`crate::mechanics::rod::vertex`]), followed by the lengths of the edges in m.

use super::System;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{EdgeMotion, ElasticRods, STRIDE, Vertex};

/// Strains of a vertex.
pub(crate) const OF_VERTEX: usize = 5;

/// A number for each strain.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OfStrains {
    /// Of the vertices.
    pub vertices: Vec<[f64; OF_VERTEX]>,
    /// Of the edges.
    pub edges: Vec<f64>,
}

impl OfStrains {
    /// Creates a zero for each strain of `rods`.
    pub(crate) fn zero(rods: &ElasticRods) -> Self {
        Self {
            vertices: vec![[0.0; OF_VERTEX]; rods.vertices.len()],
            edges: vec![0.0; rods.edges.len()],
        }
    }

    /// Makes all of them zero.
    pub(crate) fn clear(&mut self) {
        self.all_mut().for_each(|number| *number = 0.0);
    }

    /// All numbers.
    fn all_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.vertices.iter_mut().flatten().chain(&mut self.edges)
    }

    /// All numbers.
    fn all(&self) -> impl Iterator<Item = &f64> {
        self.vertices.iter().flatten().chain(&self.edges)
    }

    /// Adds a factor times another list.
    pub(crate) fn add(&mut self, factor: f64, other: &Self) {
        let pairs = self.all_mut().zip(other.all());
        pairs.for_each(|(sum, other)| *sum += factor * other);
    }

    /// The products of two lists.
    pub(crate) fn product(one: &Self, other: &Self) -> Self {
        let mut product = one.clone();
        let pairs = product.all_mut().zip(other.all());
        pairs.for_each(|(own, other)| *own *= other);
        product
    }

    /// Adds a factor times the products of two other lists.
    pub(crate) fn add_products(&mut self, factor: f64, one: &Self, other: &Self) {
        let products = one.all().zip(other.all());
        for (sum, (one, other)) in self.all_mut().zip(products) {
            *sum += factor * one * other;
        }
    }

    fn of(strains: &[f64], rods: &ElasticRods) -> Self {
        let mut own = Self::zero(rods);
        let pairs = own.all_mut().zip(strains);
        pairs.for_each(|(own, strain)| *own = *strain);
        own
    }
}

/// Coefficients of a strain of the last evaluation, N m and N.
#[derive(Debug)]
pub(crate) struct StrainLaws {
    /// Stiffness K of the springs.
    pub stiffness: OfStrains,
    /// Derivative of the energy of the stage with respect to the strain: that of the springs and
    /// of the dashpots.
    pub moment: OfStrains,
    /// Stiffness K T/H of the dashpots; `None` if there are none.
    pub dashpot: Option<OfStrains>,
    /// The springs in series with dashpots; `None` if there are none.
    pub relaxation: Option<RelaxationLaws>,
    /// Weights of the strains at the start of the step and of the two before it in the reference
    /// strain of the dashpots.
    pub start_weights: [f64; 3],
}

/// Laws of the relaxing parts q of the strains in a step: q = e^(−x) qₙ + r γ (ε − εₙ), and the
/// force K q.
#[derive(Debug)]
pub(crate) struct RelaxationLaws {
    /// r γ.
    pub gained: OfStrains,
    /// e^(−x).
    pub kept: OfStrains,
    /// K r γ and K e^(−x).
    pub forces: [OfStrains; 2],
}

impl System {
    /// Laws of the strains of the last evaluation.
    pub(crate) fn strain_laws(&self) -> StrainLaws {
        let acting = self.acting_rods();
        let mut stiffness = OfStrains::zero(acting);
        let mut moment = OfStrains::zero(acting);
        for (index, (vertex, own)) in acting
            .vertices
            .iter()
            .zip(&self.assembly.rods.vertices)
            .enumerate()
        {
            let strains = vertex.elastic_strains(&self.geometry.strains(index, vertex));
            let of = |vertex: &Vertex| {
                let [first, second] = vertex.stiffness.bending;
                [first, second, first, second, vertex.stiffness.twisting]
            };
            stiffness.vertices[index] = of(own);
            let [k0, k1, k2, k3] = strains.curvature;
            let strains = [k0, k1, k2, k3, strains.twist];
            let acting = of(vertex);
            moment.vertices[index] = std::array::from_fn(|k| acting[k] * strains[k]);
        }
        for (index, (edge, own)) in acting
            .edges
            .iter()
            .zip(&self.assembly.rods.edges)
            .enumerate()
        {
            let length = self.geometry.edges[edge.start].length;
            stiffness.edges[index] = own.stretching / own.natural_length;
            moment.edges[index] = edge.stretching * (length / edge.natural_length - 1.0);
        }
        let damping = &self.terms.damping;
        let dashpots = damping.dashpots(&self.assembly);
        StrainLaws {
            stiffness,
            moment,
            dashpot: dashpots.map(|all| OfStrains::of(&all, acting)),
            relaxation: (damping.relaxation(&self.assembly)).map(|all| {
                let [gained, kept, of_change, of_start] =
                    all.map(|all| OfStrains::of(&all, acting));
                RelaxationLaws {
                    gained,
                    kept,
                    forces: [of_change, of_start],
                }
            }),
            start_weights: damping.start_weights(),
        }
    }

    /// Derivatives of the strains along a virtual motion λ of the unknowns, at the last evaluation,
    /// which was at `unknowns`.
    pub(crate) fn strains_along(&self, unknowns: &[f64], motion: &[f64]) -> OfStrains {
        let rods = &self.assembly.rods;
        let frames = &self.geometry.edges;
        let mut along = OfStrains::zero(rods);
        let mut motions = vec![EdgeMotion::NONE; frames.len()];
        for (own, edge) in along.edges.iter_mut().zip(&rods.edges) {
            let change = position(motion, edge.end) - position(motion, edge.start);
            let frame = &frames[edge.start];
            motions[edge.start] = EdgeMotion::new(frame, &change, motion[STRIDE * edge.start + 3]);
            *own = frame.tangent.dot(&change);
        }
        for (ghost, turn) in self.assembly.joints.turns_of_ghosts(unknowns, motion) {
            let edge = rods.nodes + ghost;
            motions[edge] = EdgeMotion::turned(&frames[edge], &turn);
        }
        for (index, (own, vertex)) in along.vertices.iter_mut().zip(&rods.vertices).enumerate() {
            let strains = self.geometry.strains(index, vertex);
            let [before, after] = [vertex.before, vertex.after];
            *own = vertex.strains_along(
                [&frames[before], &frames[after]],
                &strains,
                [&motions[before], &motions[after]],
            );
        }
        along
    }

    /// Σ cₖ ∂εₖ/∂q at the last evaluation: the forces equivalent to given moments c. The entry of
    /// the angle of an edge is the derivative with respect to the spin of its frame; entries of
    /// frames are moments in the fixed frame.
    pub(crate) fn forces_of_moments(&self, moments: &OfStrains) -> Vec<f64> {
        let mut forces = vec![0.0; self.residual.len()];
        let largest =
            |of: &mut dyn Iterator<Item = &f64>| of.fold(0.0_f64, |sum, one| sum.max(one.abs()));
        let bending = largest(&mut moments.vertices.iter().flatten());
        // Prevents an infinite natural length of an edge.
        let stretching = 2.0 * largest(&mut moments.edges.iter());
        if bending == 0.0 && stretching == 0.0 {
            return forces;
        }
        // The rods that have these moments.
        let mut rods = self.assembly.rods.clone();
        let share = |moment: f64, scale: f64| if scale > 0.0 { moment / scale } else { 0.0 };
        for (index, (vertex, moments)) in
            rods.vertices.iter_mut().zip(&moments.vertices).enumerate()
        {
            let strains = vertex.strain.of(&self.geometry.strains(index, vertex));
            let natural = &mut vertex.natural;
            for k in 0..4 {
                natural.curvature[k] = strains.curvature[k] - share(moments[k], bending);
            }
            natural.twist = strains.twist - share(moments[4], bending);
            vertex.stiffness.bending = [bending; 2];
            vertex.stiffness.twisting = bending;
        }
        for (edge, moment) in rods.edges.iter_mut().zip(&moments.edges) {
            let length = self.geometry.edges[edge.start].length;
            edge.natural_length = length / (1.0 + share(*moment, stretching));
            edge.stretching = stretching;
        }
        let mut geometry = self.geometry.clone();
        geometry.take_natural_strains(&rods);
        rods.add_gradient(&geometry, &mut forces);
        forces
    }
}
