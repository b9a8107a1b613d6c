//! The elastic energy of all rods: E = E_s + E_b + E_t (thesis Eq. 1.6), its gradient and Hessian.

use super::ReferenceFrames;
use super::edge::{stretching_energy, stretching_gradient, stretching_hessian};
use super::geometry::RodGeometry;
use super::topology::{RodRange, STRIDE, add_to_node};
use super::vertex::{self, VertexStiffness, VertexStrains, curvature_binormal};
use super::vertex_lanes::{self, GradientLanes, HessianLanes, VERTEX_UNKNOWNS, VertexLanes};
use crate::linalg::instruction_set::LANES;
use crate::linalg::{BandedSymmetric, Element};
use crate::mechanics::{Matrix3, Vector3};

/// An edge of prescribed direction and frame at a clamped node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GhostEdge {
    /// Unit tangent.
    pub tangent: Vector3,
    /// First material director.
    pub director: Vector3,
}

/// A real edge.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Node at its start, also its own index.
    pub start: usize,
    /// Node at its end.
    pub end: usize,
    /// Natural length l̃, m.
    pub natural_length: f64,
    /// Stretching stiffness EA, N.
    pub stretching: f64,
}

/// A place where two edges, one of which may be a ghost, meet.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Edge before it.
    pub before: usize,
    /// Edge after it.
    pub after: usize,
    /// Natural strains.
    pub natural: VertexStrains,
    /// Stiffness over Voronoi length.
    pub stiffness: VertexStiffness,
    /// Twist at which the frames of a ring are glued at its joint, rad; zero elsewhere.
    pub joint_twist: f64,
    /// Where its derivatives go.
    pub unknowns: VertexUnknowns,
}

/// Numbering of the eleven unknowns (x₋, θ⁰, x, θ¹, x₊) of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexUnknowns {
    /// Local unknowns `from..to` are consecutive and start at `first`; the others belong to a ghost.
    Consecutive {
        /// Global number of local unknown `from`.
        first: usize,
        /// First local unknown that exists.
        from: usize,
        /// End of the local unknowns that exist.
        to: usize,
    },
    /// The vertex closes a ring: its unknowns are those of element number `element`.
    Closing {
        /// Index into [`ElasticRods::elements`].
        element: usize,
    },
}

/// All rods as elastic bodies.
#[derive(Clone, Debug, Default)]
pub struct ElasticRods {
    /// Numbering of each rod.
    pub rods: Vec<RodRange>,
    /// Real edges.
    pub edges: Vec<Edge>,
    /// Vertices, those of ghost edges among them.
    pub vertices: Vec<Vertex>,
    /// Unknowns of the vertices that close rings; they do not fit in the band.
    pub elements: Vec<Element>,
    /// Number of nodes of all rods.
    pub nodes: usize,
    /// Number of ghost edges; their indices follow those of the nodes.
    pub ghosts: usize,
}

/// Elastic energies, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElasticEnergy {
    /// E_s.
    pub stretching: f64,
    /// E_b.
    pub bending: f64,
    /// E_t.
    pub twisting: f64,
}

impl ElasticEnergy {
    /// E_s + E_b + E_t.
    pub fn total(&self) -> f64 {
        self.stretching + self.bending + self.twisting
    }
}

impl ElasticRods {
    /// Energy at `geometry`.
    pub fn energy(&self, geometry: &RodGeometry) -> ElasticEnergy {
        let mut energy = ElasticEnergy::default();
        for edge in &self.edges {
            energy.stretching += stretching_energy(
                edge.stretching,
                geometry.edges[edge.start].length,
                edge.natural_length,
            );
        }
        for (vertex, strains) in self.vertices.iter().zip(&geometry.strains) {
            let (bending, twisting) = vertex::energies(strains, &vertex.natural, &vertex.stiffness);
            energy.bending += bending;
            energy.twisting += twisting;
        }
        energy
    }

    /// Adds the gradient to `gradient` (4 entries per node).
    pub fn add_gradient(&self, geometry: &RodGeometry, gradient: &mut [f64]) {
        for edge in &self.edges {
            self.add_stretching_gradient(edge, geometry, gradient);
        }
        let mut lanes = VertexLanes::new();
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        for (vertices, strains) in self.batches(geometry) {
            lanes.fill(vertices, strains, &geometry.edges);
            vertex_lanes::gradients(geometry.set, &lanes, &mut local);
            for (lane, vertex) in vertices.iter().enumerate() {
                self.scatter_gradient(vertex, &local, lane, gradient);
            }
        }
    }

    /// Adds the gradient to `gradient` and the Hessian to `band` and `elements` (one 12×12 matrix for each
    /// of [`Self::elements`]). `spin_moment`, one entry per edge, ghosts included, is scratch.
    pub fn add_derivatives(
        &self,
        geometry: &RodGeometry,
        reference: &ReferenceFrames,
        gradient: &mut [f64],
        band: &mut BandedSymmetric,
        elements: &mut [[[f64; 12]; 12]],
        spin_moment: &mut [f64],
    ) {
        spin_moment.fill(0.0);
        let mut lanes = VertexLanes::new();
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        let mut hessians = [[[0.0; LANES]; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];
        for (vertices, strains) in self.batches(geometry) {
            lanes.fill(vertices, strains, &geometry.edges);
            vertex_lanes::derivatives(geometry.set, &lanes, &mut local, &mut hessians);
            for (lane, vertex) in vertices.iter().enumerate() {
                self.scatter_gradient(vertex, &local, lane, gradient);
                spin_moment[vertex.before] += local[3][lane];
                spin_moment[vertex.after] += local[7][lane];
                scatter_hessian(vertex, &hessians, lane, band, elements);
            }
        }
        for edge in &self.edges {
            self.add_stretching_gradient(edge, geometry, gradient);
            let frame = &geometry.edges[edge.start];
            let hessian = stretching_hessian(
                edge.stretching,
                &frame.tangent,
                frame.length,
                edge.natural_length,
            ) + holonomy_hessian(
                &reference.tangent[edge.start],
                frame,
                spin_moment[edge.start],
            );
            self.scatter_edge_hessian(edge, &hessian, band, elements);
        }
    }

    /// Vertices and their strains, as many at a time as there are lanes.
    fn batches<'a>(
        &'a self,
        geometry: &'a RodGeometry,
    ) -> impl Iterator<Item = (&'a [Vertex], &'a [VertexStrains])> {
        self.vertices
            .chunks(LANES)
            .zip(geometry.strains.chunks(LANES))
    }

    fn add_stretching_gradient(&self, edge: &Edge, geometry: &RodGeometry, gradient: &mut [f64]) {
        let frame = &geometry.edges[edge.start];
        let force = stretching_gradient(
            edge.stretching,
            &frame.tangent,
            frame.length,
            edge.natural_length,
        );
        add_to_node(gradient, edge.end, &force);
        add_to_node(gradient, edge.start, &-force);
    }

    fn scatter_gradient(
        &self,
        vertex: &Vertex,
        local: &GradientLanes,
        lane: usize,
        gradient: &mut [f64],
    ) {
        match vertex.unknowns {
            VertexUnknowns::Consecutive { first, from, to } => {
                for (entry, local) in gradient[first..].iter_mut().zip(&local[from..to]) {
                    *entry += local[lane];
                }
            }
            VertexUnknowns::Closing { element } => {
                for (&unknown, local) in self.elements[element].iter().zip(local) {
                    if unknown != usize::MAX {
                        gradient[unknown] += local[lane];
                    }
                }
            }
        }
    }

    /// An edge that closes a ring is the edge before the ring's first vertex, which has an element.
    fn scatter_edge_hessian(
        &self,
        edge: &Edge,
        hessian: &Matrix3,
        band: &mut BandedSymmetric,
        elements: &mut [[[f64; 12]; 12]],
    ) {
        if edge.end > edge.start {
            let (a, b) = (STRIDE * edge.start, STRIDE * edge.end);
            for i in 0..3 {
                for j in 0..=i {
                    band.add(a + i, a + j, hessian[(i, j)]);
                    band.add(b + i, b + j, hessian[(i, j)]);
                }
                for j in 0..3 {
                    band.add(b + i, a + j, -hessian[(i, j)]);
                }
            }
        } else {
            let closing = self
                .elements
                .iter()
                .position(|e| e[0] == STRIDE * edge.start && e[4] == STRIDE * edge.end);
            let matrix = &mut elements[closing.expect("every ring has a closing vertex")];
            for i in 0..3 {
                for j in 0..3 {
                    matrix[i][j] += hessian[(i, j)];
                    matrix[4 + i][4 + j] += hessian[(i, j)];
                    matrix[4 + i][j] -= hessian[(i, j)];
                    matrix[i][4 + j] -= hessian[(i, j)];
                }
            }
        }
    }
}

/// ∇c over the edge vector, 1/m²: [κb⊗(t̃ + t) − 2/χ s×]/2l², where κb, t̃ and χ are those of the source
/// tangent s and the present tangent t; see [`super::vertex`].
pub fn holonomy_jacobian(source: &Vector3, frame: &vertex::EdgeFrame) -> Matrix3 {
    let tangent = &frame.tangent;
    let inverse_chi = 1.0 / (1.0 + source.dot(tangent));
    let binormal = curvature_binormal(source, tangent);
    let sum = (source + tangent) * inverse_chi + tangent;
    (binormal * sum.transpose() - source.cross_matrix() * (2.0 * inverse_chi))
        * (0.5 / (frame.length * frame.length))
}

/// Symmetric part of (∂E/∂φ) ∇c of one edge; see [`super::vertex`].
pub(super) fn holonomy_hessian(
    source: &Vector3,
    frame: &vertex::EdgeFrame,
    moment: f64,
) -> Matrix3 {
    let jacobian = holonomy_jacobian(source, frame);
    (jacobian + jacobian.transpose()) * (0.5 * moment)
}

/// Adds the Hessian of a vertex to the band, or to both triangles of its element.
fn scatter_hessian(
    vertex: &Vertex,
    hessians: &HessianLanes,
    lane: usize,
    band: &mut BandedSymmetric,
    elements: &mut [[[f64; 12]; 12]],
) {
    match vertex.unknowns {
        VertexUnknowns::Consecutive { first, from, to } => {
            let columns = &mut band.columns_mut()[first..];
            for (j, (column, local)) in (from..to).zip(columns.iter_mut().zip(&hessians[from..])) {
                for (entry, local) in column.iter_mut().zip(&local[..to - j]) {
                    *entry += local[lane];
                }
            }
        }
        VertexUnknowns::Closing { element } => {
            let matrix = &mut elements[element];
            for j in 0..VERTEX_UNKNOWNS {
                matrix[j][j] += hessians[j][0][lane];
                for i in j + 1..VERTEX_UNKNOWNS {
                    matrix[i][j] += hessians[j][i - j][lane];
                    matrix[j][i] += hessians[j][i - j][lane];
                }
            }
        }
    }
}
