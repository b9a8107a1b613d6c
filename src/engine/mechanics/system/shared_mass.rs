//! Neighbours that share masses in rods with consistent inertia: see [`super::mass`].

use crate::linalg::{Span, in_parts};
use crate::mechanics::rod::{ElasticRods, RodRange, STRIDE};
use crate::mechanics::scene::RodDescription;
use std::ops::Range;

/// Least number of nodes of chains that are processed together: waking a thread takes as long as
/// thousands of sums.
const LEAST_NODES: usize = 2000;
/// Fraction of the mass of an edge by which linear interpolation differs from masses lumped at its
/// nodes.
const OF_EDGE: f64 = 1.0 / 6.0;
/// Corresponding fraction of the moment of inertia of the two half edges at a vertex.
const OF_VERTEX: f64 = 1.0 / 12.0;

/// Masses that neighbours share in rods with consistent inertia.
#[derive(Clone, Debug, Default)]
pub struct ConsistentMasses {
    rods: Vec<Densities>,
    /// Neighbours with unknowns in the band: all of a rod except the pair that closes it.
    pub(super) chains: Vec<Chain>,
    /// Consecutive chains that are processed together.
    groups: Vec<Range<usize>>,
    /// Pairs that close rings: the last nodes and edges with the first.
    pub(super) joints: Vec<Joint>,
}

/// A rod and its masses.
#[derive(Clone, Copy, Debug)]
struct Densities {
    range: RodRange,
    /// kg/m.
    mass_per_length: f64,
    /// kg m.
    inertia_per_length: f64,
}

/// Masses (kg) and moments of inertia (kg m²) c shared by two nodes and by the edges that begin at
/// these: they subtract ½ c (v₁ − v₀)² from the kinetic energy of the lumped masses.
pub(super) type Shared = [f64; STRIDE];

#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub first_node: usize,
    /// Masses that each node shares with the next.
    pub shared: Vec<Shared>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub nodes: [usize; 2],
    pub shared: Shared,
    /// The element with the unknowns of both, and the index in it at which those of each begin.
    pub element: (usize, [usize; 2]),
}

impl ConsistentMasses {
    /// Takes up a rod.
    pub(super) fn add_rod(&mut self, range: RodRange, rod: &RodDescription) {
        self.rods.push(Densities {
            range,
            mass_per_length: rod.mass_per_length,
            inertia_per_length: rod.rotational_inertia_per_length,
        });
    }

    /// Recomputes the unknowns that share masses; call this after vertices are added or removed.
    pub(super) fn share(&mut self, rods: &ElasticRods) {
        let (mut chains, mut joints) = (Vec::new(), Vec::new());
        // Natural lengths of the edges by their first nodes, and between their middles, m.
        let mut lengths = vec![0.0; rods.nodes];
        for edge in &rods.edges {
            lengths[edge.start] = edge.natural_length;
        }
        let mut between = vec![0.0; rods.nodes];
        for vertex in &rods.vertices {
            let (before, after) = (vertex.before, vertex.after);
            if before < rods.nodes && after < rods.nodes {
                between[before] = 0.5 * (lengths[before] + lengths[after]);
            }
        }
        for rod in &self.rods {
            let (range, nodes) = (rod.range, rod.range.node_indices());
            let of_edge = OF_EDGE * rod.mass_per_length;
            let of_vertex = OF_VERTEX * rod.inertia_per_length;
            let own = lengths[nodes.clone()].iter().zip(&between[nodes.clone()]);
            let mut shared: Vec<Shared> = own
                .map(|(length, between)| {
                    let mass = of_edge * length;
                    [mass, mass, mass, of_vertex * between]
                })
                .collect();
            let closing = shared.pop().unwrap_or_default();
            let ends = [nodes.end - 1, nodes.start];
            let first_unknowns = ends.map(|node| STRIDE * node);
            let place = |element: &[usize; 12]| {
                let places = [[0, STRIDE], [STRIDE, 2 * STRIDE]];
                let fits = |places: &[usize; 2]| places.map(|k| element[k]) == first_unknowns;
                places.into_iter().find(fits)
            };
            let mut elements = rods.elements.iter().map(place).enumerate();
            // If there is no element, both ends of the edge that closes a ring are held.
            if range.closed
                && let Some((element, places)) = elements.find_map(|(k, at)| Some((k, at?)))
            {
                joints.push(Joint {
                    nodes: ends,
                    shared: closing,
                    element: (element, places),
                });
            }
            chains.push(Chain {
                first_node: nodes.start,
                shared,
            });
        }
        self.groups.clear();
        let (mut first, mut nodes) = (0, 0);
        for (number, chain) in chains.iter().enumerate() {
            nodes += chain.shared.len();
            if nodes >= LEAST_NODES || number + 1 == chains.len() {
                self.groups.push(first..number + 1);
                (first, nodes) = (number + 1, 0);
            }
        }
        self.chains = chains;
        self.joints = joints;
    }

    /// Calls `work` for each chain, in parallel with others, with the entries of its nodes in an
    /// array over all nodes.
    pub(super) fn for_each_chain<T: Send>(
        &self,
        entries: &mut [T],
        work: &(impl Fn(&Chain, &mut [T]) + Sync),
    ) {
        if self.groups.is_empty() {
            return;
        }
        in_parts(
            &self.groups,
            Span::all(entries),
            &|entries, group| entries.cut(self.chains[group.start].first_node),
            &|group, mut entries| {
                for chain in &self.chains[group.clone()] {
                    let first = chain.first_node;
                    work(chain, entries.of(&(first..first + chain.shared.len() + 1)));
                }
            },
            &|(), ()| (),
        );
    }

    /// Pairs of nodes that share masses, with the shares.
    pub(super) fn pairs(&self) -> impl Iterator<Item = ([usize; 2], &Shared)> {
        let chains = self.chains.iter().flat_map(|chain| {
            let nodes = (chain.first_node..).map(|node| [node, node + 1]);
            nodes.zip(&chain.shared)
        });
        let joints = self.joints.iter();
        chains.chain(joints.map(|joint| (joint.nodes, &joint.shared)))
    }
}
