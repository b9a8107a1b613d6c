//! The elastic energy of all rods: E = E_s + E_b + E_t (thesis Eq. 1.6), its gradient and Hessian.

use super::discretization::{Edge, ElasticRods, Vertex, VertexUnknowns};
use super::edge::stretching_energy;
use super::edge_lanes::{self, EdgeLanes, SymmetricLanes};
use super::frame_lanes::{VectorLanes, every_lane, vector};
use super::geometry::RodGeometry;
use super::topology::{STRIDE, add_to_node};
use super::turning_ghost::TurningGhost;
use super::vertex_lanes::{GradientLanes, HessianLanes, VERTEX_UNKNOWNS, VertexLanes};
use crate::linalg::BandedSymmetric;
use crate::linalg::instruction_set::LANES;
use crate::mechanics::Vector3;
use std::ops::Add;

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

impl Add for ElasticEnergy {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            stretching: self.stretching + other.stretching,
            bending: self.bending + other.bending,
            twisting: self.twisting + other.twisting,
        }
    }
}

impl ElasticEnergy {
    /// E_s + E_b + E_t.
    pub fn total(&self) -> f64 {
        self.stretching + self.bending + self.twisting
    }
}

impl ElasticRods {
    /// Twist per length at each node, τ/l̄ with the present Voronoi length l̄, rad/m; zero at free
    /// ends.
    pub(crate) fn twist_rates(&self, geometry: &RodGeometry) -> Vec<f64> {
        let mut rates = vec![0.0; self.nodes];
        let half_length = |edge: usize| {
            let is_ghost = edge >= self.nodes;
            if is_ghost {
                0.0
            } else {
                0.5 * geometry.edges[edge].length
            }
        };
        for (index, vertex) in self.vertices.iter().enumerate() {
            let node = if vertex.after < self.nodes {
                vertex.after
            } else {
                vertex.before + 1
            };
            let length = half_length(vertex.before) + half_length(vertex.after);
            rates[node] = geometry.twist(index) / length;
        }
        rates
    }

    /// Energy at `geometry`.
    pub(crate) fn energy(&self, geometry: &RodGeometry) -> ElasticEnergy {
        let mut energy = ElasticEnergy::default();
        for edge in &self.edges {
            energy.stretching += stretching_energy(
                edge.stretching,
                geometry.edges[edge.start].length,
                edge.natural_length,
            );
        }
        for (vertices, lanes) in self.vertex_batches(geometry) {
            for (lane, vertex) in vertices.iter().enumerate() {
                let (bending, twisting) = vertex.energies(&lanes.strains(lane));
                energy.bending += bending;
                energy.twisting += twisting;
            }
        }
        energy
    }

    /// Adds the gradient to `gradient` (4 entries per node).
    pub(crate) fn add_gradient(&self, geometry: &RodGeometry, gradient: &mut [f64]) {
        let geometry = &*geometry.with_batches(self);
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        for (vertices, lanes) in self.vertex_batches(geometry) {
            lanes.gradients(geometry.set, &mut local);
            for (lane, vertex) in vertices.iter().enumerate() {
                self.scatter_gradient(vertex, geometry, &local, lane, gradient);
            }
        }
        let mut force = every_lane(Vector3::zeros());
        for (edges, lanes) in self.edge_batches(geometry) {
            edge_lanes::forces(geometry.set, lanes, &mut force);
            scatter_forces(edges, &force, gradient);
        }
    }

    /// Adds the gradient to `gradient` and the Hessian to `band` and `elements` (one 12×12 matrix for each
    /// of [`Self::elements`]). `spin_moment`, one entry per edge, ghosts included, is scratch.
    pub fn add_derivatives(
        &self,
        geometry: &RodGeometry,
        gradient: &mut [f64],
        band: &mut BandedSymmetric,
        elements: &mut [[[f64; 12]; 12]],
        spin_moment: &mut [f64],
    ) {
        spin_moment.fill(0.0);
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        let mut hessians = [[[0.0; LANES]; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];
        for (vertices, lanes) in self.vertex_batches(geometry) {
            lanes.derivatives(geometry.set, &mut local, &mut hessians);
            for (lane, vertex) in vertices.iter().enumerate() {
                self.scatter_gradient(vertex, geometry, &local, lane, gradient);
                spin_moment[vertex.before] += local[3][lane];
                spin_moment[vertex.after] += local[7][lane];
                if let VertexUnknowns::Turning {
                    element,
                    ghost_first,
                } = vertex.unknowns
                {
                    let ghost = self.ghost_of(vertex, geometry, ghost_first);
                    ghost.add_hessian(&local, &hessians, lane, &mut elements[element]);
                } else {
                    scatter_hessian(vertex, &hessians, lane, band, elements);
                }
            }
        }
        let (mut force, mut hessian) = (every_lane(Vector3::zeros()), [[0.0; LANES]; 6]);
        for (edges, lanes) in self.edge_batches(geometry) {
            let mut moments = [0.0; LANES];
            for (moment, edge) in moments.iter_mut().zip(edges) {
                *moment = spin_moment[edge.start];
            }
            edge_lanes::derivatives(geometry.set, lanes, &moments, &mut force, &mut hessian);
            scatter_forces(edges, &force, gradient);
            for (lane, edge) in edges.iter().enumerate() {
                self.scatter_edge_hessian(edge, &hessian, lane, band, elements);
            }
        }
    }

    /// Edges in batches of as many as there are lanes, each with the lanes that hold them.
    fn edge_batches<'a>(
        &'a self,
        geometry: &'a RodGeometry,
    ) -> impl Iterator<Item = (&'a [Edge], &'a EdgeLanes)> {
        self.edges.chunks(LANES).zip(&geometry.edge_lanes)
    }

    /// Vertices in batches of as many as there are lanes, each with the lanes that hold them.
    fn vertex_batches<'a>(
        &'a self,
        geometry: &'a RodGeometry,
    ) -> impl Iterator<Item = (&'a [Vertex], &'a VertexLanes)> {
        self.vertices.chunks(LANES).zip(&geometry.vertex_lanes)
    }

    /// The ghost edge of a vertex that rotates with a joint.
    fn ghost_of(&self, vertex: &Vertex, geometry: &RodGeometry, is_first: bool) -> TurningGhost {
        let edge = if is_first {
            vertex.before
        } else {
            vertex.after
        };
        TurningGhost {
            tangent: geometry.edges[edge].tangent,
            is_first,
        }
    }

    fn scatter_gradient(
        &self,
        vertex: &Vertex,
        geometry: &RodGeometry,
        local: &GradientLanes,
        lane: usize,
        gradient: &mut [f64],
    ) {
        match vertex.unknowns {
            VertexUnknowns::Consecutive { first, from, to } => {
                let entries = &mut gradient[first..first + to - from];
                if let Ok(entries) = <&mut [_; VERTEX_UNKNOWNS]>::try_from(&mut *entries) {
                    // The same loop as below, with a constant length.
                    for k in 0..VERTEX_UNKNOWNS {
                        entries[k] += local[k][lane];
                    }
                    return;
                }
                for (entry, local) in entries.iter_mut().zip(&local[from..to]) {
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
            VertexUnknowns::Turning {
                element,
                ghost_first,
            } => {
                let ghost = self.ghost_of(vertex, geometry, ghost_first);
                let entries = ghost.gradient(local, lane);
                for (&unknown, entry) in self.elements[element].iter().zip(entries) {
                    gradient[unknown] += entry;
                }
            }
        }
    }

    /// An edge that closes a ring is the edge before the first vertex of the ring, which has an
    /// element.
    fn scatter_edge_hessian(
        &self,
        edge: &Edge,
        hessian: &SymmetricLanes,
        lane: usize,
        band: &mut BandedSymmetric,
        elements: &mut [[[f64; 12]; 12]],
    ) {
        let [xx, xy, xz, yy, yz, zz] = hessian.map(|component| component[lane]);
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        if edge.end == edge.start + 1 {
            let first = STRIDE * edge.start;
            let columns = &mut band.columns_mut()[first..first + STRIDE + 3];
            for j in 0..3 {
                for i in j..3 {
                    columns[j][i - j] += rows[i][j];
                    columns[STRIDE + j][i - j] += rows[i][j];
                }
                for i in 0..3 {
                    columns[j][STRIDE + i - j] -= rows[i][j];
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
                    matrix[i][j] += rows[i][j];
                    matrix[4 + i][4 + j] += rows[i][j];
                    matrix[4 + i][j] -= rows[i][j];
                    matrix[i][4 + j] -= rows[i][j];
                }
            }
        }
    }
}

/// Adds the gradients with respect to edge vectors to those of their nodes.
fn scatter_forces(edges: &[Edge], forces: &VectorLanes, gradient: &mut [f64]) {
    for (lane, edge) in edges.iter().enumerate() {
        let force = vector(forces, lane);
        add_to_node(gradient, edge.end, &force);
        add_to_node(gradient, edge.start, &-force);
    }
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
            let columns = &mut band.columns_mut()[first..first + to - from];
            if let Ok(columns) = <&mut [_; VERTEX_UNKNOWNS]>::try_from(&mut *columns) {
                // The same loops as below, with constant lengths.
                for j in 0..VERTEX_UNKNOWNS {
                    for r in 0..VERTEX_UNKNOWNS - j {
                        columns[j][r] += hessians[j][r][lane];
                    }
                }
                return;
            }
            for (j, column) in (from..to).zip(columns) {
                for r in 0..to - j {
                    column[r] += hessians[j][r][lane];
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
        VertexUnknowns::Turning { .. } => unreachable!("goes to its element by way of the ghost"),
    }
}

#[cfg(test)]
#[path = "elastic_tests.rs"]
pub(super) mod tests;
