//! [`LANES`] copies of the same rods, one in each lane: geometry, gradient and Hessian of all of them at once.
//!
//! The formulas, and the order of all sums, are those of a single rod ([`super::geometry`],
//! [`super::elastic`]), so that every copy gets the same bytes as alone. The copies may differ in
//! stiffness, natural strains, clamps and configuration.

mod exchange;
mod forces;
mod hessians;

use super::discretization::{ElasticRods, VertexUnknowns};
use super::edge_lanes::EdgeLanes;
use super::frame_lanes::{FrameLanes, VectorLanes, every_lane};
use super::vertex_lanes::{
    GradientLanes, HessianLanes, SectionLanes, VERTEX_UNKNOWNS, have_angles,
};
use crate::linalg::LaneVector;
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes};
use crate::mechanics::Vector3;
use std::ops::Range;

pub(crate) use exchange::Original;

/// Rods in all lanes, without rings and without clamps that rotate with joints.
pub(crate) struct RodCopies {
    set: InstructionSet,
    framed: FramedEdges,
    vertices: Vec<VertexCopies>,
    /// Moments ∂E/∂φ on the spins of edges, ghosts included, from the vertices whose Hessians have
    /// been added.
    spin_moments: LaneVector,
    scratch: Box<Scratch>,
}

/// Derivatives of one vertex.
#[repr(align(64))]
struct Scratch {
    gradient: GradientLanes,
    hessian: HessianLanes,
}

/// All edges.
struct FramedEdges {
    real: Vec<EdgeCopies>,
    ghosts: Vec<GhostCopies>,
    /// For each node, the index among real edges of the edge that starts there; none at the last
    /// node of a rod.
    places: Vec<Option<usize>>,
}

impl FramedEdges {
    fn nodes(&self) -> usize {
        self.places.len()
    }

    /// Frames and reference directors of an edge by its index; ghost edges follow those of the
    /// nodes.
    fn of(&self, edge: usize) -> (&FrameLanes, &VectorLanes) {
        match edge.checked_sub(self.nodes()) {
            Some(ghost) => (&self.ghosts[ghost].frames, &self.ghosts[ghost].director),
            None => {
                let edge = &self.real[self.places[edge].expect("a vertex is between edges")];
                (&edge.lanes.frames, &edge.director)
            }
        }
    }
}

#[repr(align(64))]
struct EdgeCopies {
    lanes: EdgeLanes,
    director: VectorLanes,
    /// Its nodes.
    nodes: [usize; 2],
}

#[repr(align(64))]
struct VertexCopies {
    sections: SectionLanes,
    /// Reference twist at the start of the step plus the rotation of the ghosts since then, rad.
    expected: Lanes,
    /// Reference twist of the last evaluation, rad.
    between: Lanes,
    /// Weight of the turning angle in the bending strain.
    share: f64,
    /// Edges before and after, ghosts included.
    edges: [usize; 2],
    /// Index of the first unknown in the band, and the range of its local unknowns.
    unknowns: (usize, usize, usize),
}

impl VertexCopies {
    fn unknowns(&self) -> Range<usize> {
        let (first, from, to) = self.unknowns;
        first..first + to - from
    }
}

/// A ghost edge in all lanes.
#[repr(align(64))]
struct GhostCopies {
    frames: FrameLanes,
    director: VectorLanes,
}

impl RodCopies {
    /// Storage for copies of `rods`; `None` for rings and for clamps that rotate with joints.
    pub(crate) fn new(rods: &ElasticRods) -> Option<Self> {
        if rods.edges.iter().any(|edge| edge.end != edge.start + 1) {
            return None;
        }
        let mut places = vec![None; rods.nodes];
        for (place, edge) in rods.edges.iter().enumerate() {
            places[edge.start] = Some(place);
        }
        let vertices = rods.vertices.iter().zip(batches_with_angles(rods));
        let vertices = vertices.map(|(vertex, has_angles)| {
            let VertexUnknowns::Consecutive { first, from, to } = vertex.unknowns else {
                return None;
            };
            Some(VertexCopies {
                sections: SectionLanes::new(has_angles),
                expected: [0.0; LANES],
                between: [0.0; LANES],
                share: vertex.strain.share(),
                edges: [vertex.before, vertex.after],
                unknowns: (first, from, to),
            })
        });
        let ghost = || GhostCopies {
            frames: FrameLanes::new(),
            director: every_lane(Vector3::y()),
        };
        Some(Self {
            set: InstructionSet::best(),
            vertices: vertices.collect::<Option<_>>()?,
            framed: FramedEdges {
                real: (rods.edges.iter())
                    .map(|edge| EdgeCopies {
                        lanes: EdgeLanes::new(&[]),
                        director: every_lane(Vector3::y()),
                        nodes: [edge.start, edge.end],
                    })
                    .collect(),
                ghosts: (0..rods.ghosts).map(|_| ghost()).collect(),
                places,
            },
            spin_moments: LaneVector::new(rods.nodes + rods.ghosts),
            scratch: Box::new(Scratch {
                gradient: [[0.0; LANES]; VERTEX_UNKNOWNS],
                hessian: [[[0.0; LANES]; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS],
            }),
        })
    }

    /// Whether `rods` have the same edges and vertices as these copies.
    pub(crate) fn are_of(&self, rods: &ElasticRods) -> bool {
        self.framed.nodes() == rods.nodes
            && self.framed.ghosts.len() == rods.ghosts
            && self.framed.real.len() == rods.edges.len()
            && self.vertices.len() == rods.vertices.len()
            && (self.framed.real.iter().zip(&rods.edges))
                .all(|(own, edge)| own.nodes == [edge.start, edge.end])
            && (self.vertices.iter().zip(&rods.vertices)).all(|(own, vertex)| {
                let (first, from, to) = own.unknowns;
                own.edges == [vertex.before, vertex.after]
                    && own.share == vertex.strain.share()
                    && vertex.unknowns == VertexUnknowns::Consecutive { first, from, to }
            })
    }

    /// Unknowns of the vertices, in the order in which the vertices are added to the band.
    pub(crate) fn unknowns_of_vertices(&self) -> impl Iterator<Item = Range<usize>> {
        self.vertices.iter().map(VertexCopies::unknowns)
    }

    /// Index of the edge that starts at a node.
    pub(crate) fn edge_from(&self, node: usize) -> Option<usize> {
        self.framed.places[node]
    }
}

/// For each vertex, whether any vertex of its batch bends by the turning angle.
fn batches_with_angles(rods: &ElasticRods) -> impl Iterator<Item = bool> {
    let batches = rods.vertices.chunks(LANES);
    batches.flat_map(|batch| std::iter::repeat_n(have_angles(batch), batch.len()))
}

#[cfg(test)]
mod tests;
