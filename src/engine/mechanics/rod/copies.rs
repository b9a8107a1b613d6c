//! [`LANES`] copies of the same rods, one in each lane: geometry, gradient and Hessian of all of them at once.
//!
//! The formulas, and the order of all sums, are those of one rod ([`super::geometry`], [`super::elastic`]), so that every copy gets the
//! bytes that it would get alone. The copies may differ in stiffness, natural strains, clamps and configuration.

use super::discretization::{ElasticRods, GhostEdge, VertexUnknowns};
use super::edge_lanes::{self, EdgeLanes, SymmetricLanes};
use super::frame_lanes::{FrameLanes, VectorLanes, every_lane, set_vector, transport};
use super::geometry::ReferenceFrames;
use super::topology::STRIDE;
use super::transport::unwrapped;
use super::vertex_lanes::{HessianLanes, SectionLanes, VERTEX_UNKNOWNS};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::linalg::{BandedLanes, HALF_BANDWIDTH};
use crate::mechanics::Vector3;
use std::f64::consts::PI;

/// Rods without rings and without clamps that turn with joints, in all lanes.
pub(crate) struct RodCopies {
    set: InstructionSet,
    framed: FramedEdges,
    vertices: Vec<VertexCopies>,
    /// Scratch: moments ∂E/∂φ on the spins of edges, ghosts included.
    spin_moments: Vec<Lanes>,
}

/// All edges.
struct FramedEdges {
    real: Vec<EdgeCopies>,
    ghosts: Vec<GhostCopies>,
    /// Place among the real ones of the edge that starts at each node; none at the last node of a rod.
    places: Vec<Option<usize>>,
}

impl FramedEdges {
    fn nodes(&self) -> usize {
        self.places.len()
    }

    /// Frames and reference directors of an edge by its number; those of ghosts follow those of the nodes.
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

struct EdgeCopies {
    /// Its nodes.
    nodes: [usize; 2],
    lanes: EdgeLanes,
    director: VectorLanes,
}

struct VertexCopies {
    /// Edges before and after, ghosts included.
    edges: [usize; 2],
    /// Number of the first unknown in the band, and which of the local ones are.
    unknowns: (usize, usize, usize),
    sections: SectionLanes,
    /// Reference twist at the start of the step, with what the ghosts have turned since, rad.
    expected: Lanes,
    joint_twist: Lanes,
}

/// A ghost edge in all lanes.
struct GhostCopies {
    frames: FrameLanes,
    director: VectorLanes,
    spin: Lanes,
}

impl RodCopies {
    /// Storage for copies of `rods`; `None` for rings and for clamps that turn with joints.
    pub(crate) fn new(rods: &ElasticRods) -> Option<Self> {
        let mut places = vec![None; rods.nodes];
        for (place, edge) in rods.edges.iter().enumerate() {
            places[edge.start] = Some(place);
        }
        let vertices = rods.vertices.iter().map(|vertex| {
            let VertexUnknowns::Consecutive { first, from, to } = vertex.unknowns else {
                return None;
            };
            Some(VertexCopies {
                edges: [vertex.before, vertex.after],
                unknowns: (first, from, to),
                sections: SectionLanes::new(),
                expected: [0.0; LANES],
                joint_twist: [0.0; LANES],
            })
        });
        let ghost = || GhostCopies {
            frames: FrameLanes::new(),
            director: every_lane(Vector3::y()),
            spin: [0.0; LANES],
        };
        Some(Self {
            set: InstructionSet::best(),
            vertices: vertices.collect::<Option<_>>()?,
            framed: FramedEdges {
                real: (rods.edges.iter())
                    .map(|edge| EdgeCopies {
                        nodes: [edge.start, edge.end],
                        lanes: EdgeLanes::new(&[]),
                        director: every_lane(Vector3::y()),
                    })
                    .collect(),
                ghosts: (0..rods.ghosts).map(|_| ghost()).collect(),
                places,
            },
            spin_moments: vec![[0.0; LANES]; rods.nodes + rods.ghosts],
        })
    }

    /// Whether `rods` have the edges and vertices of these.
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
                    && vertex.unknowns == VertexUnknowns::Consecutive { first, from, to }
            })
    }

    /// Puts rods into a lane, with the frames from which the present step transports and the ghost edges of the present time.
    pub(crate) fn set(
        &mut self,
        lane: usize,
        rods: &ElasticRods,
        reference: &ReferenceFrames,
        ghosts: &[GhostEdge],
    ) {
        for (own, edge) in self.framed.real.iter_mut().zip(&rods.edges) {
            own.lanes.take_natural_length(lane, edge);
            let (source, director) = (
                &reference.tangent[edge.start],
                &reference.director[edge.start],
            );
            own.lanes.from.set_source(lane, source, director);
        }
        for (own, ghost) in self.framed.ghosts.iter_mut().zip(ghosts) {
            own.frames.set(lane, &ghost.frame());
            set_vector(&mut own.director, lane, &ghost.director);
            own.spin[lane] = ghost.spin;
        }
        let nodes = self.framed.nodes();
        let spin = |edge: usize| {
            let ghost = edge.checked_sub(nodes);
            ghost.map_or(0.0, |ghost| ghosts[ghost].spin)
        };
        let chunks = rods.vertices.chunks(LANES);
        let has_angles = chunks.map(|chunk| chunk.iter().any(|one| one.strain.share() > 0.0));
        let has_angles = has_angles.flat_map(|has| [has; LANES]);
        let vertices = self.vertices.iter_mut().zip(&rods.vertices);
        for (((own, vertex), has_angles), twist) in vertices.zip(has_angles).zip(&reference.twist) {
            own.sections.set(lane, vertex, has_angles);
            own.expected[lane] = twist + spin(vertex.after) - spin(vertex.before);
            own.joint_twist[lane] = vertex.joint_twist;
        }
    }

    /// Computes edges, frames and strains at `unknowns`, 4 per node.
    pub(crate) fn update(&mut self, unknowns: &[Lanes]) {
        for edge in &mut self.framed.real {
            let [start, end] = edge.nodes.map(|node| STRIDE * node);
            let mut vectors = every_lane(Vector3::zeros());
            for axis in 0..3 {
                for lane in 0..LANES {
                    vectors[axis][lane] = unknowns[end + axis][lane] - unknowns[start + axis][lane];
                }
            }
            let EdgeLanes { from, frames, .. } = &mut edge.lanes;
            from.set_edges(&vectors, &unknowns[start + 3]);
            transport(self.set, from, frames, &mut edge.director);
        }
        let (framed, nodes) = (&self.framed, self.framed.nodes());
        for vertex in &mut self.vertices {
            let [before, after] = vertex.edges.map(|edge| framed.of(edge));
            let beside = [before.0, after.0];
            let angles = (vertex.sections).bend(self.set, beside, [before.1, after.1]);
            let angle = |edge: usize| match edge < nodes {
                true => &unknowns[STRIDE * edge + 3],
                false => &[0.0; LANES],
            };
            let turned = vertex.edges.map(angle);
            let mut twists = [0.0; LANES];
            for lane in 0..LANES {
                let expected = vertex.expected[lane];
                let between = if (expected - angles[lane]).abs() < PI {
                    angles[lane]
                } else {
                    unwrapped(angles[lane], expected)
                };
                let turn = turned[1][lane] - turned[0][lane];
                twists[lane] = turn + between - vertex.joint_twist[lane];
            }
            vertex.sections.set_twists(&twists);
        }
    }

    /// Adds the gradients to `gradient`, 4 entries per node.
    pub(crate) fn add_gradient(&self, gradient: &mut [Lanes]) {
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        for vertex in &self.vertices {
            let beside = vertex.edges.map(|edge| self.framed.of(edge).0);
            vertex.sections.gradients(self.set, beside, &mut local);
            let (first, from, to) = vertex.unknowns;
            let own = &mut gradient[first..first + to - from];
            add_all(self.set, &local[from..to], own);
        }
        let mut force = every_lane(Vector3::zeros());
        for edge in &self.framed.real {
            edge_lanes::forces(self.set, &edge.lanes, &mut force);
            edge.add_force(self.set, &force, gradient);
        }
    }

    /// Adds the gradients to `gradient` and the Hessians to `band`.
    pub(crate) fn add_derivatives(&mut self, gradient: &mut [Lanes], band: &mut BandedLanes) {
        let columns = band.columns_mut();
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        let mut hessians = [[[0.0; LANES]; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];
        self.spin_moments.fill([0.0; LANES]);
        for vertex in &self.vertices {
            let beside = vertex.edges.map(|edge| self.framed.of(edge).0);
            (vertex.sections).derivatives(self.set, beside, &mut local, &mut hessians);
            let (first, from, to) = vertex.unknowns;
            let unknowns = first..first + to - from;
            add_all(self.set, &local[from..to], &mut gradient[unknowns.clone()]);
            for (edge, own) in vertex.edges.into_iter().zip([3, 7]) {
                add_all(
                    self.set,
                    &local[own..=own],
                    &mut self.spin_moments[edge..=edge],
                );
            }
            add_hessian(self.set, &hessians, from, &mut columns[unknowns]);
        }
        let (mut force, mut hessian) = (every_lane(Vector3::zeros()), [[0.0; LANES]; 6]);
        for edge in &self.framed.real {
            let [start, _] = edge.nodes;
            let moments = &self.spin_moments[start];
            edge_lanes::derivatives(self.set, &edge.lanes, moments, &mut force, &mut hessian);
            edge.add_force(self.set, &force, gradient);
            let first = STRIDE * start;
            add_edge_hessian(self.set, &hessian, &mut columns[first..first + STRIDE + 3]);
        }
    }
}

impl EdgeCopies {
    /// Adds the gradient over the edge vector to those over its nodes.
    fn add_force(&self, set: InstructionSet, force: &VectorLanes, gradient: &mut [Lanes]) {
        let [start, end] = self.nodes.map(|node| STRIDE * node);
        add_all(set, force, &mut gradient[end..end + 3]);
        subtract_all(set, force, &mut gradient[start..start + 3]);
    }
}

kernel! {
    fn add_all(from: &[Lanes], to: &mut [Lanes]) {
        for (to, from) in to.iter_mut().zip(from) {
            for lane in 0..LANES {
                to[lane] += from[lane];
            }
        }
    }
}

kernel! {
    fn subtract_all(from: &[Lanes], to: &mut [Lanes]) {
        for (to, from) in to.iter_mut().zip(from) {
            for lane in 0..LANES {
                to[lane] -= from[lane];
            }
        }
    }
}

kernel! {
    /// Adds the Hessians of a vertex, from its local unknown `from` on, to their columns.
    fn add_hessian(hessians: &HessianLanes, from: usize, columns: &mut [[Lanes; HALF_BANDWIDTH + 1]]) {
        let size = columns.len();
        for (j, column) in columns.iter_mut().enumerate() {
            let entries = column.iter_mut().zip(&hessians[from + j]);
            for (entry, own) in entries.take(size - j) {
                for lane in 0..LANES {
                    entry[lane] += own[lane];
                }
            }
        }
    }
}

kernel! {
    /// Adds the Hessians of an edge over its vector to the columns of its two nodes.
    fn add_edge_hessian(hessian: &SymmetricLanes, columns: &mut [[Lanes; HALF_BANDWIDTH + 1]]) {
        let rows = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
        for j in 0..3 {
            for i in 0..3 {
                let own = &hessian[rows[i][j]];
                for lane in 0..LANES {
                    if i >= j {
                        columns[j][i - j][lane] += own[lane];
                        columns[STRIDE + j][i - j][lane] += own[lane];
                    }
                    columns[j][STRIDE + i - j][lane] -= own[lane];
                }
            }
        }
    }
}
