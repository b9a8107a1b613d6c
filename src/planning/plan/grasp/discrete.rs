//! The optimal grasp of the discrete elastic rod, with the engine's energies; second-order
//! accurate in the edge length.
//!
//! Nodes are numbered 0 to N, starting at the contact node; edges are short there and become
//! longer towards the gripper. At the contact node the curvature of the pattern is the angle φ
//! between a ghost edge, which is φ/2 behind the tangent x̂, and the first edge, which is φ/2
//! ahead of it. The moment there, the derivative of the energy ½ (2 tan(φ/2))²/l̄ with respect to
//! φ, is κ̄ EI: with x = tan(φ/2), x + x³ = κ̄ l̄/2. The force of the gripper has no component
//! along x̂, and there is no moment at the gripper. The unknowns are the nodes, the angles of the
//! edges, and the components y and z of that force. Newton's method solves the band matrix of the
//! rod, bordered by the direction of the first edge.

use super::shape::Shape;
use super::{Grasp, GraspError, GraspProblem, TWIST_STIFFNESS, Vector3, WEIGHT};
use nalgebra::Rotation3;
use rodlab_engine::linalg::{BandedFactor, BandedSymmetric};
use rodlab_engine::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use rodlab_engine::mechanics::rod::{
    BendingStrain, Edge, ElasticRods, GhostEdge, ReferenceFrames, RodGeometry, STRIDE, Vertex,
    VertexUnknowns, VertexWeights, topology::position,
};
use rodlab_engine::mechanics::{Matrix3, UnitQuaternion};

/// Maximum number of Newton iterations.
const ITERATIONS: usize = 40;
/// Minimum number of edges: the stability analysis holds those next to the two ends.
pub const FEWEST_EDGES: usize = 8;
/// Largest displacement of a node in one iteration, relative to the length of the rod.
const LARGEST_MOVE: f64 = 0.05;
/// Displacement, relative to the length of the rod, at which the rounding errors of a stiff rod
/// are reached.
const CONVERGED: f64 = 1e-9;
/// Largest stiffness k̄_s of the discrete rod, also used for inextensible rods: it stretches by
/// some millionths.
const STIFFEST: f64 = 1e6;
/// Distance from the contact node, L_gb, over which the edges double in length. Half of all edges
/// are spread evenly, half by the logarithm of the distance, so that strongly bent edges are
/// short.
const GRADING: f64 = 0.5;

/// The grasp of a rod with a number of edges, near the shape of the continuous rod.
///
/// # Errors
/// Newton's method does not converge.
pub fn discrete_grasp(shape: &Shape, edges: usize) -> Result<Grasp, GraspError> {
    let problem = shape.problem;
    let stuck = GraspError::NoConvergence { problem };
    let mut rod = DiscreteRod::new(shape, edges);
    for _ in 0..ITERATIONS {
        if rod.iterate().ok_or(stuck)? < CONVERGED {
            return rod.grasp().ok_or(stuck);
        }
    }
    Err(stuck)
}

struct DiscreteRod {
    problem: GraspProblem,
    rods: ElasticRods,
    geometry: RodGeometry,
    reference: ReferenceFrames,
    ghost: GhostEdge,
    unknowns: Vec<f64>,
    /// The gripper's force, components y and z.
    force: [f64; 2],
    /// Two directions across the first edge.
    across: [Vector3; 2],
    matrix: BandedSymmetric,
    factor: BandedFactor,
}

impl DiscreteRod {
    fn new(shape: &Shape, edges: usize) -> Self {
        let problem = shape.problem;
        let places = places(problem.suspended_length, edges);
        let nodes = edges + 1;
        let rods = elastic_rod(&problem, &places);
        let half_turn = half_turn(0.5 * problem.curvature * places[1]);
        let direction = |angle: f64| Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
        let normal = |angle: f64| Vector3::new(-libm::sin(angle), libm::cos(angle), 0.0);

        // Edges along the tangents at their middles, stretched by the force there.
        let mut unknowns = vec![0.0; STRIDE * nodes];
        let mut reference = ReferenceFrames {
            tangent: vec![Vector3::zeros(); nodes],
            director: vec![Vector3::zeros(); nodes],
            twist: vec![0.0; rods.vertices.len()],
        };
        let (mut place, mut director) = (Vector3::zeros(), normal(half_turn));
        let mut before = direction(half_turn);
        for edge in 0..edges {
            let middle = 0.5 * (places[edge] + places[edge + 1]);
            let length = places[edge + 1] - places[edge];
            let tangent = if edge == 0 {
                before
            } else {
                shape.at(middle).0.normalize()
            };
            let pull = shape.internal_force(middle).dot(&tangent);
            place += length * (1.0 + problem.stretch_compliance * pull) * tangent;
            director -=
                (before + tangent) * (director.dot(&tangent) / (1.0 + before.dot(&tangent)));
            before = tangent;
            reference.tangent[edge] = tangent;
            reference.director[edge] = director;
            unknowns[STRIDE * (edge + 1)..STRIDE * (edge + 1) + 3]
                .copy_from_slice(place.as_slice());
        }
        let end = shape.internal_force(problem.suspended_length);
        Self {
            problem,
            geometry: RodGeometry::new(&rods),
            reference,
            ghost: GhostEdge {
                tangent: direction(-half_turn),
                director: normal(-half_turn),
                spin: 0.0,
            },
            force: [end.y, end.z],
            across: [normal(half_turn), Vector3::z()],
            matrix: BandedSymmetric::new(unknowns.len()),
            factor: BandedFactor::new(unknowns.len()),
            rods,
            unknowns,
        }
    }

    /// Performs one Newton iteration; returns the largest displacement of a node over the length
    /// of the rod.
    fn iterate(&mut self) -> Option<f64> {
        let size = self.unknowns.len();
        let last = size - STRIDE;
        let mut right = self.linearise();
        for entry in &mut right {
            *entry = -*entry;
        }
        self.factor.factor(&self.matrix).ok()?;
        self.factor.solve(&mut right);
        // Displacement per unit force of the gripper.
        let mut lifts = [vec![0.0; size], vec![0.0; size]];
        for (axis, lift) in lifts.iter_mut().enumerate() {
            lift[last + 1 + axis] = 1.0;
            self.factor.solve(lift);
        }
        // The first edge keeps its direction, which gives two conditions for the two forces.
        let off = |moves: &[f64], direction: &Vector3| direction.dot(&position(moves, 1));
        let [one, other] = self.across;
        let now = position(&self.unknowns, 1);
        let (a, b) = (off(&lifts[0], &one), off(&lifts[1], &one));
        let (c, d) = (off(&lifts[0], &other), off(&lifts[1], &other));
        let e = -one.dot(&now) - off(&right, &one);
        let f = -other.dot(&now) - off(&right, &other);
        let determinant = a * d - b * c;
        let change = [(e * d - b * f) / determinant, (a * f - c * e) / determinant];
        for (moved, (y, z)) in right.iter_mut().zip(lifts[0].iter().zip(&lifts[1])) {
            *moved += change[0] * y + change[1] * z;
        }
        let nodes = right.chunks_exact(STRIDE);
        let largest = nodes
            .map(|node| libm::hypot(libm::hypot(node[0], node[1]), node[2]))
            .fold(0.0, f64::max)
            / self.problem.suspended_length;
        if !largest.is_finite() {
            return None;
        }
        let factor = (LARGEST_MOVE / largest.max(1e-300)).min(1.0);
        for (unknown, moved) in self.unknowns.iter_mut().zip(&right) {
            *unknown += factor * moved;
        }
        for axis in 0..2 {
            self.force[axis] += factor * change[axis];
        }
        self.geometry
            .update(&self.rods, &self.unknowns, &self.reference, &[self.ghost]);
        self.geometry.commit(&mut self.reference);
        Some(largest)
    }

    /// Gradient of the potential; the Hessian is written to the matrix. The contact node is held.
    fn linearise(&mut self) -> Vec<f64> {
        let size = self.unknowns.len();
        self.geometry
            .update(&self.rods, &self.unknowns, &self.reference, &[self.ghost]);
        let mut gradient = vec![0.0; size];
        let mut spin_moments = vec![0.0; self.rods.nodes + self.rods.ghosts];
        self.matrix.clear();
        self.rods.add_derivatives(
            &self.geometry,
            &mut gradient,
            &mut self.matrix,
            &mut [],
            &mut spin_moments,
        );
        let edges = self.rods.edges.len();
        for edge in &self.rods.edges {
            for node in [edge.start, edge.end] {
                gradient[STRIDE * node + 2] += 0.5 * WEIGHT * edge.natural_length;
            }
        }
        let last = STRIDE * edges;
        gradient[last + 1] -= self.force[0];
        gradient[last + 2] -= self.force[1];
        // Excludes the contact node, and the angle of the non-existent last edge.
        for held in [0, 1, 2, last + 3] {
            self.matrix.hold(held..held + 1);
            gradient[held] = 0.0;
        }
        gradient
    }

    fn grasp(mut self) -> Option<Grasp> {
        let gradient = self.linearise();
        let edges = self.rods.edges.len();
        let nodes = gradient.chunks_exact(STRIDE);
        let residual = nodes
            .map(|node| libm::hypot(libm::hypot(node[0], node[1]), node[2]))
            .fold(0.0, f64::max);
        // The gripper also holds the last edge and its angle.
        self.matrix.hold(STRIDE * (edges - 1)..STRIDE * edges + 3);
        let inertia = self.factor.factor(&self.matrix).ok()?;
        let frame = &self.geometry.edges[edges - 1];
        let frame = Matrix3::from_columns(&[frame.tangent, frame.director_1, frame.director_2]);
        let weight = WEIGHT * self.problem.suspended_length;
        let heights = (0..=edges).map(|node| position(&self.unknowns, node).z);
        Some(Grasp {
            problem: self.problem,
            position: position(&self.unknowns, edges),
            rotation: UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(
                frame,
            )),
            contact_force: -Vector3::new(0.0, self.force[0], self.force[1] - weight),
            residual,
            lowest: heights.fold(0.0, f64::min),
            unstable_modes: inertia.negative,
        })
    }
}

/// Arc lengths of the nodes.
fn places(length: f64, edges: usize) -> Vec<f64> {
    let whole = libm::log(1.0 + length / GRADING);
    let share = |s: f64| 0.5 * (s / length + libm::log(1.0 + s / GRADING) / whole);
    let slope = |s: f64| 0.5 * (1.0 / length + 1.0 / ((GRADING + s) * whole));
    let mut places = vec![0.0];
    for node in 1..edges {
        // Starting at the left of the root of a concave function, Newton's method stays there.
        let mut s = places[node - 1];
        for _ in 0..8 {
            s += (node as f64 / edges as f64 - share(s)) / slope(s);
        }
        places.push(s);
    }
    places.push(length);
    places
}

/// φ/2 for x + x³ = `moment`, x = tan(φ/2).
fn half_turn(moment: f64) -> f64 {
    let mut x = moment / (1.0 + moment * moment);
    for _ in 0..60 {
        x -= (x + x * x * x - moment) / (1.0 + 3.0 * x * x);
    }
    libm::atan(x)
}

/// A straight rod with EI = 1 and a ghost edge at its start, as long as the first edge.
fn elastic_rod(problem: &GraspProblem, places: &[f64]) -> ElasticRods {
    let edges = places.len() - 1;
    let length = |edge: usize| places[edge + 1] - places[edge];
    let stretching = 1.0 / problem.stretch_compliance.max(1.0 / STIFFEST);
    let vertex = |before, after, first, from, voronoi| Vertex {
        before,
        after,
        natural: VertexStrains::default(),
        stiffness: VertexStiffness::about_directors([1.0, 1.0], TWIST_STIFFNESS, voronoi),
        strain: BendingStrain::default(),
        weights: VertexWeights::default(),
        joint_twist: 0.0,
        unknowns: VertexUnknowns::Consecutive {
            first,
            from,
            to: 11,
        },
    };
    let mut vertices = vec![vertex(edges + 1, 0, 0, STRIDE, length(0))];
    vertices.extend((1..edges).map(|node| {
        let voronoi = 0.5 * (length(node - 1) + length(node));
        vertex(node - 1, node, STRIDE * (node - 1), 0, voronoi)
    }));
    ElasticRods {
        edges: (0..edges)
            .map(|edge| Edge {
                start: edge,
                end: edge + 1,
                natural_length: length(edge),
                stretching,
            })
            .collect(),
        vertices,
        nodes: edges + 1,
        ghosts: 1,
        ..ElasticRods::default()
    }
}
