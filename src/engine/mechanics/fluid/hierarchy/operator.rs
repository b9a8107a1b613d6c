//! The flow operator by clusters.

use super::super::Filament;
use super::super::chain::{Link, links};
use super::super::patch::Patch;
use super::evaluation::{TargetTables, Targets};
use super::harmonics::half_size;
use super::interactions::Interactions;
use super::sources::{SourceTables, Sources};
use super::translation::{
    ActionTables, Coefficient, ShiftTables, act, lower, operations_of_action, raise,
};
use super::tree::Tree;
use crate::linalg::instruction_set::{InstructionSet, LANES};
use crate::mechanics::{Matrix3, Vector3};
use rayon::prelude::*;

/// The operator A of [`FlowOperator`](super::super::FlowOperator): exact between nearby leaves,
/// otherwise by expansions up to degree `order`. Memory and cost grow like N, apart from the
/// sorting of nodes into the tree.
pub(in super::super) struct HierarchicalOperator {
    set: InstructionSet,
    order: usize,
    links: Vec<Link>,
    tree: Tree,
    interactions: Interactions,
    /// Clusters without children, in the order of their nodes.
    leaves: Vec<Leaf>,
    /// The leaf of each node.
    leaf_of: Vec<usize>,
    /// Expansions of all clusters, one after the other, as are `locals`.
    multipoles: Vec<Coefficient>,
    locals: Vec<Coefficient>,
    /// Scratch for shifting expansions between clusters.
    shifts: ShiftTables,
}

#[derive(Default)]
struct Leaf {
    cluster: usize,
    /// Blocks with all nearby nodes.
    patch: Patch,
    near: Vec<usize>,
    sources: Sources,
    targets: Targets,
    /// Velocities of its nodes, in the order of the tree.
    velocities: [Vec<[f64; 3]>; 3],
}

impl HierarchicalOperator {
    /// The operator of filaments whose nodes are numbered one filament after the other; ε is
    /// `regularization` times each filament's radius.
    pub(crate) fn new(filaments: &[Filament], regularization: f64, order: usize) -> Self {
        Self::with_instruction_set(filaments, regularization, order, InstructionSet::best())
    }

    pub(super) fn with_instruction_set(
        filaments: &[Filament],
        regularization: f64,
        order: usize,
        set: InstructionSet,
    ) -> Self {
        Self {
            set,
            order,
            links: links(filaments, regularization),
            tree: Tree::default(),
            interactions: Interactions::default(),
            leaves: Vec::new(),
            leaf_of: Vec::new(),
            multipoles: Vec::new(),
            locals: Vec::new(),
            shifts: ShiftTables::new(order),
        }
    }

    /// Builds the tree and evaluates the blocks between near leaves, at new positions of the nodes, m.
    pub(crate) fn assemble(&mut self, positions: &[Vector3]) {
        self.tree.build(&self.links, positions);
        self.interactions.find(&self.tree);
        let clusters = &self.tree.clusters;
        let is_leaf = |&cluster: &usize| clusters[cluster].children.is_none();
        let mut count = 0;
        self.leaf_of.resize(positions.len(), 0);
        for cluster in (0..clusters.len()).filter(is_leaf) {
            if self.leaves.len() == count {
                self.leaves.push(Leaf::default());
            }
            self.leaves[count].cluster = cluster;
            for &node in &self.tree.order[clusters[cluster].nodes.clone()] {
                self.leaf_of[node] = count;
            }
            count += 1;
        }
        self.leaves.truncate(count);
        let size = clusters.len() * half_size(self.order);
        self.multipoles.resize(size, Coefficient::default());
        self.locals.resize(size, Coefficient::default());
        let (set, links, tree) = (self.set, &self.links, &self.tree);
        let near = &self.interactions.near;
        self.leaves.par_iter_mut().for_each(|leaf| {
            let Leaf {
                cluster,
                patch,
                near: columns,
                ..
            } = leaf;
            let home = &tree.clusters[*cluster];
            let nodes = &tree.order[home.nodes.clone()];
            columns.clear();
            for &source in &near[*cluster] {
                columns.extend_from_slice(&tree.order[tree.clusters[source].nodes.clone()]);
            }
            columns.sort_unstable();
            patch.assemble(set, links, positions, nodes, columns);
            leaf.sources.place(links, positions, nodes, &home.centre);
            leaf.targets.place(positions, nodes, &home.centre);
            for velocities in &mut leaf.velocities {
                velocities.resize(nodes.len(), [0.0; 3]);
            }
        });
    }

    /// The block A_ij of nearby nodes; `None` for distant nodes.
    pub(crate) fn block(&self, row: usize, column: usize) -> Option<Matrix3> {
        self.leaves[self.leaf_of[row]].patch.between(row, column)
    }

    /// Floating-point operations of a product, near and far.
    pub(crate) fn operations(&self) -> f64 {
        let near: usize = (self.leaves.iter())
            .map(|leaf| leaf.near.len() * leaf.targets.count())
            .sum();
        let far: usize = self.interactions.far.iter().map(Vec::len).sum();
        18.0 * near as f64 + (far * operations_of_action(self.order)) as f64
    }

    /// Computes `velocities` = A `densities`.
    pub(crate) fn multiply(&mut self, densities: &[f64], velocities: &mut [f64]) {
        self.evaluate_far(densities, 0);
        let set = self.set;
        self.leaves.par_iter_mut().for_each(|leaf| {
            leaf.patch
                .add_product(set, densities, &mut leaf.velocities[0]);
        });
        self.collect(0, velocities);
    }

    /// As [`multiply`](Self::multiply), for three vectors; the near blocks are read only once.
    pub(crate) fn multiply_three(
        &mut self,
        densities: &[Vec<f64>; 3],
        velocities: &mut [Vec<f64>; 3],
    ) {
        for (vector, densities) in densities.iter().enumerate() {
            self.evaluate_far(densities, vector);
        }
        let set = self.set;
        self.leaves.par_iter_mut().for_each(|leaf| {
            leaf.patch
                .add_three_products(set, densities, &mut leaf.velocities);
        });
        for (vector, velocities) in velocities.iter_mut().enumerate() {
            self.collect(vector, velocities);
        }
    }

    /// Sets the velocities of the leaves for the given vector to the flow of all distant clusters.
    fn evaluate_far(&mut self, densities: &[f64], vector: usize) {
        self.expand(densities);
        self.raise();
        self.act();
        self.lower();
        let (set, order, size) = (self.set, self.order, half_size(self.order));
        let locals = &self.locals;
        self.leaves.par_iter_mut().for_each_init(
            || TargetTables::new(order),
            |tables, leaf| {
                let local = &locals[leaf.cluster * size..][..size];
                leaf.targets
                    .evaluate(set, order, local, tables, &mut leaf.velocities[vector]);
            },
        );
    }

    /// Computes the multipole expansions of the leaves; those of all other clusters become zero.
    fn expand(&mut self, densities: &[f64]) {
        let (set, order, size) = (self.set, self.order, half_size(self.order));
        self.multipoles.fill(Coefficient::default());
        let mut rest = self.multipoles.as_mut_slice();
        let mut first = 0;
        let mut places = Vec::with_capacity(self.leaves.len());
        for leaf in &self.leaves {
            let (place, behind) = rest[(leaf.cluster - first) * size..].split_at_mut(size);
            places.push(place);
            (rest, first) = (behind, leaf.cluster + 1);
        }
        (self.leaves.par_iter_mut().zip(places)).for_each_init(
            || SourceTables::new(order),
            |tables, (leaf, place)| leaf.sources.expand(set, order, densities, tables, place),
        );
    }

    /// Computes the multipole expansions of the parents from those of their children.
    fn raise(&mut self) {
        let size = half_size(self.order);
        let tables = &mut self.shifts;
        for (index, cluster) in self.tree.clusters.iter().enumerate().rev() {
            // Children come after their parent.
            let (before, after) = self.multipoles.split_at_mut((index + 1) * size);
            let parent = &mut before[index * size..];
            for child in cluster.children.into_iter().flatten() {
                let shift = self.tree.clusters[child].centre - cluster.centre;
                let from = &after[(child - index - 1) * size..][..size];
                raise(self.set, self.order, &shift.into(), from, parent, tables);
            }
        }
    }

    /// Computes local expansions from the multipole expansions of distant clusters.
    fn act(&mut self) {
        let (set, order, size) = (self.set, self.order, half_size(self.order));
        let (clusters, multipoles) = (&self.tree.clusters, &self.multipoles);
        (self.locals.par_chunks_exact_mut(size))
            .zip(&self.interactions.far)
            .enumerate()
            .for_each_init(
                || ActionTables::new(order),
                |tables, (target, (local, sources))| {
                    for local in &mut tables.local {
                        local.fill(Default::default());
                    }
                    for sources in sources.chunks(LANES) {
                        for lane in 0..LANES {
                            let source = sources.get(lane).copied();
                            // An empty lane holds a source of no strength at unit distance.
                            let displacement = source.map_or(Vector3::x(), |source| {
                                clusters[target].centre - clusters[source].centre
                            });
                            for k in 0..3 {
                                tables.displacement[k][lane] = displacement[k];
                            }
                            let from = source.map(|source| &multipoles[source * size..][..size]);
                            for (k, lanes) in tables.multipoles.iter_mut().enumerate() {
                                for (index, lanes) in lanes.iter_mut().enumerate() {
                                    for part in 0..2 {
                                        lanes[part][lane] = from.map_or(0.0, |f| f[index][part][k]);
                                    }
                                }
                            }
                        }
                        act(set, order, tables);
                    }
                    for (k, lanes) in tables.local.iter().enumerate() {
                        for (sum, lanes) in local.iter_mut().zip(lanes) {
                            for part in 0..2 {
                                sum[part][k] = lanes[part].iter().sum();
                            }
                        }
                    }
                },
            );
    }

    /// Adds the local expansions of the parents to those of the children.
    fn lower(&mut self) {
        let size = half_size(self.order);
        let tables = &mut self.shifts;
        for (index, cluster) in self.tree.clusters.iter().enumerate() {
            let (before, after) = self.locals.split_at_mut((index + 1) * size);
            let parent = &before[index * size..];
            for child in cluster.children.into_iter().flatten() {
                let shift = self.tree.clusters[child].centre - cluster.centre;
                let to = &mut after[(child - index - 1) * size..][..size];
                lower(self.set, self.order, &shift.into(), parent, to, tables);
            }
        }
    }

    fn collect(&self, vector: usize, velocities: &mut [f64]) {
        for leaf in &self.leaves {
            let nodes = &self.tree.order[self.tree.clusters[leaf.cluster].nodes.clone()];
            for (&node, velocity) in nodes.iter().zip(&leaf.velocities[vector]) {
                velocities[3 * node..3 * node + 3].copy_from_slice(velocity);
            }
        }
    }
}
