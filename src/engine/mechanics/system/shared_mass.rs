//! Neighbours that share masses in rods with consistent inertia: see [`super::mass`].

use crate::mechanics::rod::{ElasticRods, RodRange, STRIDE};
use crate::mechanics::scene::RodDescription;

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
        for rod in &self.rods {
            let (range, nodes) = (rod.range, rod.range.node_indices());
            let mut shared = vec![[0.0; STRIDE]; range.nodes];
            let own = rods.edges.iter().filter(|edge| nodes.contains(&edge.start));
            let lengths: Vec<f64> = own.map(|edge| edge.natural_length).collect();
            for (shared, length) in shared.iter_mut().zip(&lengths) {
                shared[..3].fill(OF_EDGE * rod.mass_per_length * length);
            }
            for vertex in &rods.vertices {
                if nodes.contains(&vertex.before) && nodes.contains(&vertex.after) {
                    let [before, after] = [vertex.before, vertex.after].map(|e| e - nodes.start);
                    let length = 0.5 * (lengths[before] + lengths[after]);
                    shared[before][3] = OF_VERTEX * rod.inertia_per_length * length;
                }
            }
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
        self.chains = chains;
        self.joints = joints;
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
