//! The elastic energy of all rods: E = E_s + E_b + E_t (thesis Eq. 1.6), its gradient and Hessian.

use super::discretization::{Edge, ElasticRods, Vertex, VertexUnknowns};
use super::edge::stretching_energy;
use super::edge_lanes::{self, SymmetricLanes};
use super::frame_lanes::{VectorLanes, every_lane, vector};
use super::geometry::RodGeometry;
use super::parts::Part;
use super::topology::{STRIDE, add_to_node};
use super::turning_ghost::TurningGhost;
use super::vertex_lanes::{GradientLanes, HessianLanes, VERTEX_UNKNOWNS, VertexLanes};
use crate::linalg::instruction_set::LANES;
use crate::linalg::{BandedSymmetric, HALF_BANDWIDTH, Span, in_parts};
use crate::mechanics::Vector3;
use std::ops::{Add, Range};

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
        let of_vertices = |vertices: Range<usize>, gradient: &mut Span<f64>| {
            let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
            for batch in batches(&vertices) {
                let lanes = &geometry.vertex_lanes[batch];
                lanes.gradients(geometry.set, &mut local);
                for (lane, vertex) in lanes_of(&vertices, batch) {
                    self.scatter_gradient(&self.vertices[vertex], geometry, &local, lane, gradient);
                }
            }
        };
        let parts = &geometry.parts;
        in_parts(
            &parts.rods,
            Span::all(gradient),
            &|entries, part| entries.cut(STRIDE * part.nodes.start),
            &|part, mut own| of_vertices(part.vertices.clone(), &mut own),
            &|(), ()| (),
        );
        of_vertices(
            parts.later_vertices..self.vertices.len(),
            &mut Span::all(gradient),
        );
        in_parts(
            &parts.rods,
            Span::all(gradient),
            &|entries, part| entries.cut(STRIDE * part.nodes.start),
            &|part, mut own| {
                let mut force = every_lane(Vector3::zeros());
                for batch in batches(&part.edges) {
                    edge_lanes::forces(geometry.set, &geometry.edge_lanes[batch], &mut force);
                    self.scatter_forces(&part.edges, batch, &force, &mut own);
                }
            },
            &|(), ()| (),
        );
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
        let mut all = Derivatives {
            gradient: Span::all(gradient),
            columns: band.columns_mut(),
            elements,
            first_element: 0,
            spin_moment,
        };
        let parts = &geometry.parts;
        in_parts(
            &parts.rods,
            all.reborrow(),
            &Derivatives::cut,
            &|part, mut own| self.add_vertex_derivatives(geometry, &part.vertices, &mut own),
            &|(), ()| (),
        );
        let later = parts.later_vertices..self.vertices.len();
        self.add_vertex_derivatives(geometry, &later, &mut all);
        in_parts(
            &parts.rods,
            all,
            &Derivatives::cut,
            &|part, mut own| self.add_edge_derivatives(geometry, part, &mut own),
            &|(), ()| (),
        );
    }

    fn add_vertex_derivatives(
        &self,
        geometry: &RodGeometry,
        vertices: &Range<usize>,
        target: &mut Derivatives,
    ) {
        let mut local = [[0.0; LANES]; VERTEX_UNKNOWNS];
        let mut hessians = [[[0.0; LANES]; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];
        for batch in batches(vertices) {
            let lanes = &geometry.vertex_lanes[batch];
            lanes.derivatives(geometry.set, &mut local, &mut hessians);
            for (lane, vertex) in lanes_of(vertices, batch) {
                let vertex = &self.vertices[vertex];
                self.scatter_gradient(vertex, geometry, &local, lane, &mut target.gradient);
                target.add_spin_moment(vertex.before, local[3][lane]);
                target.add_spin_moment(vertex.after, local[7][lane]);
                if let VertexUnknowns::Turning {
                    element,
                    ghost_first,
                } = vertex.unknowns
                {
                    let ghost = self.ghost_of(vertex, geometry, ghost_first);
                    ghost.add_hessian(&local, &hessians, lane, target.element(element));
                } else {
                    scatter_hessian(vertex, &hessians, lane, target);
                }
            }
        }
    }

    fn add_edge_derivatives(&self, geometry: &RodGeometry, part: &Part, target: &mut Derivatives) {
        let (mut force, mut hessian) = (every_lane(Vector3::zeros()), [[0.0; LANES]; 6]);
        let first = target.first_node();
        for batch in batches(&part.edges) {
            let mut moments = [0.0; LANES];
            for (lane, edge) in lanes_of(&part.edges, batch) {
                moments[lane] = target.spin_moment[self.edges[edge].start - first];
            }
            let lanes = &geometry.edge_lanes[batch];
            edge_lanes::derivatives(geometry.set, lanes, &moments, &mut force, &mut hessian);
            self.scatter_forces(&part.edges, batch, &force, &mut target.gradient);
            for (lane, edge) in lanes_of(&part.edges, batch) {
                self.scatter_edge_hessian(&self.edges[edge], &hessian, lane, part, target);
            }
        }
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
        gradient: &mut Span<f64>,
    ) {
        match vertex.unknowns {
            VertexUnknowns::Consecutive { first, from, to } => {
                let first = first - gradient.first;
                let entries = &mut gradient.entries[first..first + to - from];
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
                        gradient.entries[unknown - gradient.first] += local[lane];
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
                    gradient.entries[unknown - gradient.first] += entry;
                }
            }
        }
    }

    /// Adds the gradients with respect to edge vectors to those of their nodes.
    fn scatter_forces(
        &self,
        edges: &Range<usize>,
        batch: usize,
        forces: &VectorLanes,
        gradient: &mut Span<f64>,
    ) {
        let first = gradient.first / STRIDE;
        for (lane, edge) in lanes_of(edges, batch) {
            let (force, edge) = (vector(forces, lane), &self.edges[edge]);
            add_to_node(gradient.entries, edge.end - first, &force);
            add_to_node(gradient.entries, edge.start - first, &-force);
        }
    }

    /// An edge that closes a ring is the edge before the first vertex of the ring, which has an
    /// element.
    fn scatter_edge_hessian(
        &self,
        edge: &Edge,
        hessian: &SymmetricLanes,
        lane: usize,
        part: &Part,
        target: &mut Derivatives,
    ) {
        let [xx, xy, xz, yy, yz, zz] = hessian.map(|component| component[lane]);
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        if edge.end == edge.start + 1 {
            let first = STRIDE * edge.start - target.gradient.first;
            let columns = &mut target.columns[first..first + STRIDE + 3];
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
            let closes = |element: &usize| {
                let unknowns = &self.elements[*element];
                unknowns[0] == STRIDE * edge.start && unknowns[4] == STRIDE * edge.end
            };
            let closing = part.elements.clone().find(closes);
            let matrix = target.element(closing.expect("every ring has a closing vertex"));
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

/// Batches that contain some of these edges or vertices.
fn batches(range: &Range<usize>) -> Range<usize> {
    range.start / LANES..range.end.div_ceil(LANES)
}

/// Those of the edges or vertices that are in a batch, each with its lane. A batch may also contain
/// some of the neighbouring parts.
fn lanes_of(range: &Range<usize>, batch: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
    let first = LANES * batch;
    let own = first.max(range.start)..range.end.min(first + LANES);
    own.map(move |index| (index - first, index))
}

/// Gradient and Hessian of consecutive rods.
struct Derivatives<'a> {
    gradient: Span<'a, f64>,
    /// The band, a column for each unknown.
    columns: &'a mut [[f64; HALF_BANDWIDTH + 1]],
    elements: &'a mut [[[f64; 12]; 12]],
    /// Number of their first element.
    first_element: usize,
    /// One per node; in the last part followed by those of the ghosts.
    spin_moment: &'a mut [f64],
}

impl Derivatives<'_> {
    fn reborrow(&mut self) -> Derivatives<'_> {
        Derivatives {
            gradient: self.gradient.reborrow(),
            columns: self.columns,
            elements: self.elements,
            first_element: self.first_element,
            spin_moment: self.spin_moment,
        }
    }

    fn first_node(&self) -> usize {
        self.gradient.first / STRIDE
    }

    /// Cuts before a part.
    fn cut(self, part: &Part) -> (Self, Self) {
        let node = part.nodes.start - self.first_node();
        let (gradient, gradient_after) = self.gradient.cut(STRIDE * part.nodes.start);
        let (columns, columns_after) = self.columns.split_at_mut(STRIDE * node);
        let element = part.elements.start - self.first_element;
        let (elements, elements_after) = self.elements.split_at_mut(element);
        let (spin_moment, spin_moment_after) = self.spin_moment.split_at_mut(node);
        let before = Self {
            gradient,
            columns,
            elements,
            spin_moment,
            ..self
        };
        let after = Self {
            gradient: gradient_after,
            columns: columns_after,
            elements: elements_after,
            first_element: part.elements.start,
            spin_moment: spin_moment_after,
        };
        (before, after)
    }

    fn element(&mut self, element: usize) -> &mut [[f64; 12]; 12] {
        &mut self.elements[element - self.first_element]
    }

    /// Adds to the moment about an edge. Those of ghosts, which are not used, may be outside.
    fn add_spin_moment(&mut self, edge: usize, moment: f64) {
        let first = self.first_node();
        if let Some(own) = self.spin_moment.get_mut(edge - first) {
            *own += moment;
        }
    }
}

/// Adds the Hessian of a vertex to the band, or to both triangles of its element.
fn scatter_hessian(
    vertex: &Vertex,
    hessians: &HessianLanes,
    lane: usize,
    target: &mut Derivatives,
) {
    match vertex.unknowns {
        VertexUnknowns::Consecutive { first, from, to } => {
            let first = first - target.gradient.first;
            let columns = &mut target.columns[first..first + to - from];
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
            let matrix = target.element(element);
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
