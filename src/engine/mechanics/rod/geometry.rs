//! Edges, frames and strains of all rods at one set of unknowns.

use super::discretization::{Edge, ElasticRods, GhostEdge, Vertex};
use super::edge_lanes::EdgeLanes;
use super::frame_lanes::{self, every_lane, vector};
use super::parts::{BATCHES, Parts};
use super::topology::{STRIDE, position};
use super::transport::unwrapped;
use super::vertex::{EdgeFrame, VertexStrains, curvatures};
use super::vertex_lanes::VertexLanes;
use crate::linalg::in_parts;
use crate::linalg::instruction_set::{InstructionSet, LANES};
use crate::mechanics::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Frames at the start of a step, from which frames are transported during the step.
///
/// Arrays over edges have one entry per node (the edge that starts there; unused at the last node of an
/// open rod), `twist` one per vertex.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReferenceFrames {
    /// Unit tangents.
    pub tangent: Vec<Vector3>,
    /// First reference directors.
    pub director: Vec<Vector3>,
    /// Reference twists, rad; they count whole turns.
    pub twist: Vec<f64>,
}

/// Geometry of all rods at one set of unknowns; its storage is reused.
#[derive(Clone, Debug)]
pub struct RodGeometry {
    /// Instruction set for kernels.
    pub(super) set: InstructionSet,
    /// Division of the rods among threads.
    pub(super) parts: Parts,
    /// Framed edges, one per node, then the ghost edges.
    pub edges: Vec<EdgeFrame>,
    /// Vertices with their strains, in batches.
    pub(super) vertex_lanes: Vec<VertexLanes>,
    /// Real edges, in batches.
    pub(super) edge_lanes: Vec<EdgeLanes>,
    /// Reference directors, one per node, then those of the ghost edges.
    reference_director: Vec<Vector3>,
    reference_twist: Vec<f64>,
    /// Rotation of each ghost edge since the reference frames were committed, rad.
    ghost_spin: Vec<f64>,
    /// Whether the batches hold the frames. If not, the geometry was copied, and the batches hold
    /// only strains.
    has_batches: bool,
}

impl RodGeometry {
    /// Storage for `rods`.
    pub fn new(rods: &ElasticRods) -> Self {
        let unused = EdgeFrame {
            tangent: Vector3::zeros(),
            length: 1.0,
            inverse_length: 1.0,
            director_1: Vector3::zeros(),
            director_2: Vector3::zeros(),
            holonomy: Vector3::zeros(),
        };
        let edges = rods.nodes + rods.ghosts;
        Self {
            set: InstructionSet::best(),
            parts: Parts::of(rods),
            edges: vec![unused; edges],
            vertex_lanes: rods.vertices.chunks(LANES).map(VertexLanes::new).collect(),
            edge_lanes: rods.edges.chunks(LANES).map(EdgeLanes::new).collect(),
            reference_director: vec![Vector3::zeros(); edges],
            reference_twist: vec![0.0; rods.vertices.len()],
            ghost_spin: vec![0.0; rods.ghosts],
            has_batches: true,
        }
    }

    /// Copies natural strains, natural lengths and stiffnesses of `rods`, which must otherwise
    /// match this storage.
    pub(crate) fn take_natural_strains(&mut self, rods: &ElasticRods) {
        for (vertices, lanes) in rods.vertices.chunks(LANES).zip(&mut self.vertex_lanes) {
            lanes.take_natural_strains(vertices);
        }
        for (edges, lanes) in rods.edges.chunks(LANES).zip(&mut self.edge_lanes) {
            lanes.take_natural_strains(edges);
        }
    }

    /// Strains of a vertex, by its index.
    pub(crate) fn strains(&self, index: usize, vertex: &Vertex) -> VertexStrains {
        VertexStrains {
            curvature: curvatures(&self.edges[vertex.before], &self.edges[vertex.after]),
            twist: self.twist(index),
        }
    }

    /// Computes edges, frames and strains. `unknowns`: 4 per node; `ghosts`: prescribed ghost edges.
    pub fn update(
        &mut self,
        rods: &ElasticRods,
        unknowns: &[f64],
        reference: &ReferenceFrames,
        ghosts: &[GhostEdge],
    ) {
        self.has_batches = true;
        self.update_edges(rods, unknowns, reference);
        self.place_ghosts(rods.nodes, ghosts);
        for ghost in &rods.turning_ghosts {
            // A unit vector, so that forces are derivatives of the energy with respect to it.
            let edge = &mut self.edges[rods.nodes + ghost];
            (edge.length, edge.inverse_length) = (1.0, 1.0);
        }
        self.update_vertices(rods, unknowns, reference);
    }

    fn place_ghosts(&mut self, nodes: usize, ghosts: &[GhostEdge]) {
        for (index, ghost) in ghosts.iter().enumerate() {
            let k = nodes + index;
            self.ghost_spin[index] = ghost.spin;
            self.reference_director[k] = ghost.director;
            self.edges[k] = ghost.frame();
        }
    }

    /// Prepares to receive the evaluation of rods with so many `nodes`, edge by edge and vertex by
    /// vertex.
    pub(super) fn begin_taking(&mut self, nodes: usize, ghosts: &[GhostEdge]) {
        self.has_batches = false;
        self.place_ghosts(nodes, ghosts);
    }

    /// Stores the edge that starts at a node, with its reference director.
    pub(super) fn take_edge(&mut self, start: usize, edge: &EdgeFrame, director: Vector3) {
        self.edges[start] = *edge;
        self.reference_director[start] = director;
    }

    /// Stores the strains and the reference twist (rad) of a vertex.
    pub(super) fn take_vertex(&mut self, vertex: usize, strains: &VertexStrains, twist: f64) {
        self.vertex_lanes[vertex / LANES].set_strains(vertex % LANES, strains);
        self.reference_twist[vertex] = twist;
    }

    /// This geometry with the frames filled into its batches, except the frames from which it was
    /// transported.
    pub(super) fn with_batches(&self, rods: &ElasticRods) -> Cow<'_, Self> {
        if self.has_batches {
            return Cow::Borrowed(self);
        }
        let mut filled = self.clone();
        let directors = &self.reference_director;
        for (vertices, lanes) in rods.vertices.chunks(LANES).zip(&mut filled.vertex_lanes) {
            for (lane, vertex) in vertices.iter().enumerate() {
                let (before, after) = (vertex.before, vertex.after);
                lanes.set_before(lane, &self.edges[before], &directors[before]);
                lanes.set_after(lane, &self.edges[after], &directors[after]);
            }
        }
        for (edges, lanes) in rods.edges.chunks(LANES).zip(&mut filled.edge_lanes) {
            for (lane, edge) in edges.iter().enumerate() {
                lanes.frames.set(lane, &self.edges[edge.start]);
            }
        }
        Cow::Owned(filled)
    }

    fn update_edges(&mut self, rods: &ElasticRods, unknowns: &[f64], reference: &ReferenceFrames) {
        if rods.edges.is_empty() {
            return;
        }
        let all = EdgeSpan {
            edges: &rods.edges,
            lanes: &mut self.edge_lanes,
            first_batch: 0,
            frames: &mut self.edges,
            directors: &mut self.reference_director,
            first_node: 0,
        };
        in_parts(
            &self.parts.edges,
            all,
            &|span, group| span.cut(group.first_batch, group.first_node),
            &|_, span| span.update(self.set, unknowns, reference),
            &|(), ()| (),
        );
    }

    fn update_vertices(
        &mut self,
        rods: &ElasticRods,
        unknowns: &[f64],
        reference: &ReferenceFrames,
    ) {
        let angle = |edge: usize| {
            if edge < rods.nodes {
                unknowns[STRIDE * edge + 3]
            } else {
                0.0
            }
        };
        let spin = |edge: usize| {
            let ghost = edge.checked_sub(rods.nodes);
            ghost.map_or(0.0, |ghost| self.ghost_spin[ghost])
        };
        let (frames, directors) = (&self.edges, &self.reference_director);
        let update = |vertices: &[Vertex],
                      lanes: &mut [VertexLanes],
                      twists: &mut [f64],
                      earlier: &[f64]| {
            let batches = vertices.chunks(LANES).zip(lanes);
            let twists = twists.chunks_mut(LANES).zip(earlier.chunks(LANES));
            for ((vertices, lanes), (twists, earlier)) in batches.zip(twists) {
                for (lane, vertex) in vertices.iter().enumerate() {
                    let after = vertex.after;
                    lanes.set_after(lane, &frames[after], &directors[after]);
                }
                let others = if lanes.is_chain() {
                    lanes.chain();
                    1
                } else {
                    vertices.len()
                };
                for (lane, vertex) in vertices[..others].iter().enumerate() {
                    let before = vertex.before;
                    lanes.set_before(lane, &frames[before], &directors[before]);
                }
                let angles = lanes.bend(self.set);
                for (lane, vertex) in vertices.iter().enumerate() {
                    let expected = earlier[lane] + spin(vertex.after) - spin(vertex.before);
                    let between = unwrapped(angles[lane], expected);
                    twists[lane] = between;
                    let turn = angle(vertex.after) - angle(vertex.before);
                    lanes.set_twist(lane, turn + between - vertex.joint_twist);
                }
            }
        };
        const GROUP: usize = LANES * BATCHES;
        let (lanes, twists) = (&mut self.vertex_lanes, &mut self.reference_twist);
        if lanes.len() <= BATCHES || rayon::current_num_threads() == 1 {
            return update(&rods.vertices, lanes, twists, &reference.twist);
        }
        (rods
            .vertices
            .par_chunks(GROUP)
            .zip(lanes.par_chunks_mut(BATCHES)))
        .zip(
            twists
                .par_chunks_mut(GROUP)
                .zip(reference.twist.par_chunks(GROUP)),
        )
        .for_each(|((vertices, lanes), (twists, earlier))| {
            update(vertices, lanes, twists, earlier);
        });
    }

    /// Twist τ of a vertex, rad.
    pub(crate) fn twist(&self, vertex: usize) -> f64 {
        self.vertex_lanes[vertex / LANES].twist(vertex % LANES)
    }

    /// Stores the present frames as the source of the next step.
    pub fn commit(&self, reference: &mut ReferenceFrames) {
        for k in 0..reference.tangent.len() {
            reference.tangent[k] = self.edges[k].tangent;
            reference.director[k] = self.reference_director[k];
        }
        reference.twist.copy_from_slice(&self.reference_twist);
    }
}

/// Consecutive edges, and the arrays over the nodes at which they start.
struct EdgeSpan<'a> {
    edges: &'a [Edge],
    lanes: &'a mut [EdgeLanes],
    /// Number of their first batch.
    first_batch: usize,
    frames: &'a mut [EdgeFrame],
    directors: &'a mut [Vector3],
    /// Node to which the first frame and director belong.
    first_node: usize,
}

impl EdgeSpan<'_> {
    /// Cuts before a batch, whose first edge starts at `node`.
    fn cut(self, batch: usize, node: usize) -> (Self, Self) {
        let (batches, nodes) = (batch - self.first_batch, node - self.first_node);
        let (edges, edges_after) = self.edges.split_at(LANES * batches);
        let (lanes, lanes_after) = self.lanes.split_at_mut(batches);
        let (frames, frames_after) = self.frames.split_at_mut(nodes);
        let (directors, directors_after) = self.directors.split_at_mut(nodes);
        let before = Self {
            edges,
            lanes,
            frames,
            directors,
            ..self
        };
        let after = Self {
            edges: edges_after,
            lanes: lanes_after,
            first_batch: batch,
            frames: frames_after,
            directors: directors_after,
            first_node: node,
        };
        (before, after)
    }

    /// Computes frames and directors.
    fn update(self, set: InstructionSet, unknowns: &[f64], reference: &ReferenceFrames) {
        let mut directors = every_lane(Vector3::zeros());
        for (edges, lanes) in self.edges.chunks(LANES).zip(self.lanes) {
            let EdgeLanes { from, frames, .. } = lanes;
            for (lane, edge) in edges.iter().enumerate() {
                let k = edge.start;
                let vector = position(unknowns, edge.end) - position(unknowns, k);
                let (source, director) = (&reference.tangent[k], &reference.director[k]);
                from.set(lane, &vector, source, director, unknowns[STRIDE * k + 3]);
            }
            frame_lanes::transport(set, from, frames, &mut directors);
            for (lane, edge) in edges.iter().enumerate() {
                self.frames[edge.start - self.first_node] = frames.get(lane);
                self.directors[edge.start - self.first_node] = vector(&directors, lane);
            }
        }
    }
}
