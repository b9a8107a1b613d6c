//! Data of a single contact.

use crate::mechanics::Vector3;
use std::cmp::Ordering;

/// Derivative of the 12 force components of an edge–edge contact with respect to the 12 coordinates, N/m;
/// indices `[component of force][coordinate]`, both node after node.
pub type EdgeJacobian = [[f64; 12]; 12];
/// Derivative of the force of a plane on a node with respect to the node's position, N/m.
pub type PlaneJacobian = [[f64; 3]; 3];

/// A contact as a linear function of the coordinates of its four nodes; contact with a plane uses
/// only the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linearised<J> {
    /// Derivative of its force, N/m.
    pub jacobian: J,
    /// Derivative of its gap.
    pub gap_gradient: [f64; 12],
    /// Derivative of its friction per normal force, 1/m; zero without friction.
    pub traction_gradient: [[f64; 12]; 3],
}

/// Derivatives of the gap of a contact and of its friction per normal force, as in [`Linearised`].
pub(super) type Gradients = ([f64; 12], [[f64; 12]; 3]);

/// How a contact moves with the coordinates of its four nodes, to first order.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactMotion {
    /// Weights of the four nodes in the motion at the contact.
    pub weights: [f64; 4],
    /// Derivatives of the weights, 1/m.
    pub weight_rates: [[f64; 12]; 4],
    /// Normal, from the second body to the first.
    pub normal: Vector3,
    /// Derivative of the normal, 1/m.
    pub normal_jacobian: [[f64; 12]; 3],
    /// Derivative of the gap.
    pub gap_gradient: [f64; 12],
}

impl ContactMotion {
    /// The contact of a node with a plane at rest.
    pub(crate) fn over_plane(normal: &Vector3) -> Self {
        let mut gap_gradient = [0.0; 12];
        gap_gradient[..3].copy_from_slice(normal.as_slice());
        Self {
            weights: [1.0, 0.0, 0.0, 0.0],
            weight_rates: [[0.0; 12]; 4],
            normal: *normal,
            normal_jacobian: [[0.0; 12]; 3],
            gap_gradient,
        }
    }
}

/// Side of a pair of two edges.
pub(super) const EDGE: i8 = 0;
/// Side of a pair of a node and the axis of a tube around it; the pair lists the node twice.
pub(super) const TUBE: i8 = 2;
/// Sides of a pair of a piece of a rod and the rim of a tube: for a piece around a node, for the
/// piece before the middle of the first edge, and for the piece behind the middle of the last
/// edge. The pair lists three nodes, then the centre of the rim.
pub(super) const RIM: i8 = 3;
pub(super) const RIM_START: i8 = 4;
pub(super) const RIM_END: i8 = 5;
/// Sides of counter-pairs at the same rim: for the middle of an edge where two pieces meet, given
/// by the first two or by the last two of its nodes, and for a node in the tube, which is listed
/// three times.
pub(super) const RIM_JOINT: i8 = 6;
pub(super) const RIM_JOINT_END: i8 = 7;
pub(super) const RIM_NODE: i8 = 8;
/// Sides of a pair of a node and a smooth part of a mesh: on the side of its normals, and behind it.
pub(super) const ABOVE: i8 = 9;
pub(super) const BELOW: i8 = 10;

/// A pair of edges, or of an edge of a rod and a part of an obstacle, that may touch before the candidates are next updated.
#[derive(Clone, Copy, Debug)]
pub struct CandidatePair {
    /// The edges i < j, indices into [`ContactSurface::edges`](super::ContactSurface::edges);
    /// faces of obstacles are numbered after these. For a smooth part of a mesh: its first face.
    pub edges: [usize; 2],
    /// The nodes x_i, x_{i+1}, x_j, x_{j+1}. For a face: the node of the rod and the three
    /// vertices; for a tube: the node twice and the ends of the axis; for a rim: three nodes of
    /// the rod and the end of the axis. For a smooth part of a mesh: the node and the vertices of
    /// a face near it.
    pub nodes: [usize; 4],
    /// Kind of the second body: 0 for an edge, 2 for a tube around the first body, 3 to 8 for the
    /// rim of a tube; 1 or −1 for a face, by the side on which the node is, 9 or 10 for a smooth
    /// part of a mesh.
    pub side: i8,
    /// For a smooth part of a mesh: the face at which the search for the foot of the node starts.
    pub start: u32,
}

/// Pairs are sorted by their edges. A pair with a smooth part of a mesh is the same wherever the
/// search for the foot starts.
impl Ord for CandidatePair {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |pair: &Self| match pair.is_with_patch() {
            true => [pair.nodes[0], 0, 0, 0],
            false => pair.nodes,
        };
        let by_edges = self.edges.cmp(&other.edges);
        by_edges.then_with(|| (key(self), self.side).cmp(&(key(other), other.side)))
    }
}

impl PartialOrd for CandidatePair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for CandidatePair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for CandidatePair {}

impl CandidatePair {
    /// Number of nodes that belong to the first body.
    pub(crate) fn first_body(&self) -> usize {
        match self.side {
            EDGE | TUBE => 2,
            RIM_NODE => 1,
            _ if self.is_with_rim() => 3,
            _ => 1,
        }
    }

    /// Whether the first body is a single node, over a face or patch or in a tube.
    pub(crate) fn is_of_node(&self) -> bool {
        matches!(self.side, TUBE | RIM_NODE) || self.is_with_face() || self.is_with_patch()
    }

    /// Whether the first body has three nodes.
    pub(crate) fn is_of_piece(&self) -> bool {
        self.first_body() == 3
    }

    /// Whether the second body is a face.
    pub(super) fn is_with_face(&self) -> bool {
        matches!(self.side, -1 | 1)
    }

    /// Whether the second body is a smooth part of a mesh.
    pub(super) fn is_with_patch(&self) -> bool {
        matches!(self.side, ABOVE | BELOW)
    }

    /// The side of the normals of a smooth part of a mesh on which the node is: 1, or −1 behind it.
    pub(super) fn facing(&self) -> f64 {
        if self.side == ABOVE { 1.0 } else { -1.0 }
    }

    /// Largest approach of its two bodies if each of its nodes moves by this distance, m.
    pub(super) fn approach(&self, [a, b, c, d]: [f64; 4]) -> f64 {
        if self.is_with_face() || self.is_with_patch() {
            a + b.max(c).max(d)
        } else {
            a.max(b) + c.max(d)
        }
    }

    /// Whether the second body is the rim of a tube.
    pub(super) fn is_with_rim(&self) -> bool {
        (RIM..=RIM_NODE).contains(&self.side)
    }

    /// 1, or −1 for a counter-pair, which is subtracted so that no energy counts twice: see
    /// [`super::rim`].
    pub(super) fn sign(&self) -> f64 {
        if (RIM_JOINT..=RIM_NODE).contains(&self.side) {
            -1.0
        } else {
            1.0
        }
    }
}

/// A pair of edges within reach of the contact potential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveContact {
    /// Index into [`ContactSystem::candidates`](super::ContactSystem::candidates).
    pub candidate: usize,
    /// The nodes of the candidate.
    pub nodes: [usize; 4],
    /// Centreline distance Δ of two rods, or distance of the centreline from the surface of an
    /// obstacle, m.
    pub distance: f64,
    /// Distance at which the surfaces touch: h_i + h_j, or h at an obstacle, m.
    pub threshold: f64,
    /// Normal from the second edge to the first. Its length is 1, or shorter by about 1e-5 if
    /// closest points are smoothed.
    pub normal: Vector3,
    /// Normal force of one edge on the other, N, as the factor of the normal; negative for a
    /// counter-pair.
    pub normal_force: f64,
    /// Force on the four nodes, friction included, N.
    pub force: [f64; 12],
    /// Number of nodes of the first body: two for an edge, one over a face, three on a rim.
    pub first_body: usize,
}

impl ActiveContact {
    /// Force on the first body, N; the second has the opposite.
    pub fn force_on_first(&self) -> Vector3 {
        let corners = self.force.chunks_exact(3).take(self.first_body);
        corners.map(Vector3::from_column_slice).sum()
    }
}

/// A node within reach of the contact potential of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneContact {
    /// The node.
    pub node: usize,
    /// Index of the plane.
    pub plane: usize,
    /// Distance of the node from the plane, m; negative behind it.
    pub distance: f64,
    /// Distance at which the node's sphere touches the plane, h, m.
    pub threshold: f64,
    /// Magnitude of the normal force, N.
    pub normal_force: f64,
    /// Force on the node, friction included, N.
    pub force: [f64; 3],
}

/// The two bodies of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bodies {
    /// Index of the candidate pair of edges.
    Edges(usize),
    /// Index of the plane that the first node touches.
    Plane(usize),
}

/// Location of the matrix of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintPlace {
    /// A candidate pair of edges.
    Candidate(usize),
    /// A node over a plane.
    Node(usize),
}

/// A contact as a constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactConstraint {
    pub(super) bodies: Bodies,
    /// The four nodes; contact with a plane lists its node four times.
    pub nodes: [usize; 4],
    /// Weights of the nodes in the motion at the contact.
    pub weights: [f64; 4],
    /// Normal, from the second body to the first.
    pub normal: Vector3,
    /// Gap between the surfaces, m.
    pub gap: f64,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Distance at which the surfaces touch, m.
    pub(super) threshold: f64,
    /// Force on the first body, N.
    pub force: Vector3,
    /// Edges that the contact turns if friction acts at the surfaces, with the slip of the
    /// surfaces per turn, m/rad.
    pub turns: [Option<(usize, Vector3)>; 2],
    /// Slip in the step because a round obstacle turns about its centreline, m.
    pub turned: Vector3,
    /// Whether the contact has carried a force since the step began.
    pub(super) touched: bool,
}

impl ContactConstraint {
    /// Position in the order of all constraints.
    pub(super) fn order(&self) -> (bool, usize, usize) {
        match self.bodies {
            Bodies::Edges(candidate) => (false, candidate, 0),
            Bodies::Plane(plane) => (true, plane, self.nodes[0]),
        }
    }

    /// Location of its matrix.
    pub(crate) fn place(&self) -> ConstraintPlace {
        match self.bodies {
            Bodies::Edges(candidate) => ConstraintPlace::Candidate(candidate),
            Bodies::Plane(_) => ConstraintPlace::Node(self.nodes[0]),
        }
    }

    /// Creates a constraint without a force.
    pub(super) fn new(
        bodies: Bodies,
        nodes: [usize; 4],
        weights: [f64; 4],
        normal: Vector3,
        [gap, threshold, friction]: [f64; 3],
    ) -> Self {
        Self {
            bodies,
            nodes,
            weights,
            normal,
            gap,
            friction,
            threshold,
            force: Vector3::zeros(),
            turns: [None; 2],
            turned: Vector3::zeros(),
            touched: false,
        }
    }

    /// Relative motion at the contact for a motion of all nodes.
    pub(crate) fn relative_motion(&self, of_node: impl Fn(usize) -> Vector3) -> Vector3 {
        (0..4)
            .map(|m| of_node(self.nodes[m]) * self.weights[m])
            .sum()
    }

    /// Slip at the surfaces due to the turns of edges, m.
    pub(crate) fn turned_motion(&self, of_edge: impl Fn(usize) -> f64) -> Vector3 {
        let turns = self.turns.iter().flatten();
        turns.map(|(edge, slide)| slide * of_edge(*edge)).sum()
    }
}

/// Corrections to the forces of all contacts of an evaluation, N.
#[derive(Clone, Copy, Debug)]
pub struct ForceCorrections<'a> {
    /// Corrections of the contacts of two edges, node after node.
    pub edges: &'a [[f64; 12]],
    /// One per plane contact.
    pub planes: &'a [[f64; 3]],
}

/// Two bodies that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPair {
    /// Two edges, or an edge of a rod and an edge or a face of an obstacle. Indices into
    /// [`ContactSurface::edges`](super::ContactSurface::edges); faces are numbered after the
    /// edges.
    Edges([usize; 2]),
    /// A node and a plane.
    NodeAndPlane {
        /// The node.
        node: usize,
        /// Index of the plane.
        plane: usize,
    },
}

/// Distance of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proximity {
    /// The bodies.
    pub pair: ContactPair,
    /// Distance of two centrelines, or of a centreline from the surface of a plane or obstacle, m.
    pub distance: f64,
    /// The distance at which the surfaces touch: h_i + h_j, or h at a plane or an obstacle, m.
    pub threshold: f64,
}

impl Proximity {
    /// Ratio of distance to threshold: 1 where the surfaces touch.
    pub fn ratio(&self) -> f64 {
        self.distance / self.threshold
    }

    /// Depth of penetration as a fraction of the threshold; negative where the surfaces are apart.
    pub(crate) fn penetration(&self) -> f64 {
        1.0 - self.ratio()
    }
}
