//! The surfaces that may touch: capsules around the edges of rods, balls around nodes, rigid
//! planes, and rigid obstacles.

use super::contacts::CandidatePair;
use super::root::Roots;
use super::smooth_faces::SmoothFaces;
use crate::mechanics::Vector3;
use crate::mechanics::rigid_body::RigidBody;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::ops::Range;

/// Contact shape of an edge: a capsule around the segment between two nodes of a rod or two
/// vertices of an obstacle; or a ball around one node, which is listed twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEdge {
    /// The two nodes, indices into the positions of all rods; the vertices of obstacles are numbered after them.
    pub nodes: [usize; 2],
    /// Index of the rod; balls, free bodies and obstacles are numbered after the rods.
    pub rod: usize,
    /// Radius h of the surface, m.
    pub radius: f64,
    /// Arc length at the two nodes along the rod as placed, m.
    pub arc_length: [f64; 2],
    /// Whether the edge is part of a rigid obstacle; two held edges never touch.
    pub held: bool,
    /// Own friction coefficient of the part of a rod or of the free body, if it has one.
    pub friction: Option<f64>,
}

/// A node of a rod that is not held, in contact with planes and faces: a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactNode {
    /// Index into the positions of all rods.
    pub node: usize,
    /// The edge of the rod that starts at the node; at the end of an open rod, the edge that ends
    /// there.
    pub edge: usize,
    /// Radius h of the surface, m.
    pub radius: f64,
}

/// A triangle of an obstacle or of a free body; nodes of rods may touch its interior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactFace {
    /// The vertices, anticlockwise as seen from outside; those of obstacles are numbered after the
    /// nodes of the rods.
    pub vertices: [usize; 3],
    /// Index of the obstacle; `None` for a free body.
    pub obstacle: Option<usize>,
    /// Index of the body, counted like [`ContactEdge::rod`].
    pub rod: usize,
    /// Distance of the surface from the triangle, m.
    pub radius: f64,
    /// Own friction coefficient of a free body, if it has one.
    pub friction: Option<f64>,
}

impl ContactFace {
    /// The nodes of a pair of a node of a rod and this face.
    pub(crate) fn with(&self, node: usize) -> [usize; 4] {
        let [a, b, c] = self.vertices;
        [node, a, b, c]
    }
}

/// The contact surfaces of all rods and obstacles.
///
/// Bodies that may touch are numbered in this order: edges of rods, balls, edges of free bodies,
/// edges of obstacles, faces of free bodies, faces of obstacles.
#[derive(Clone, Debug, Default)]
pub struct ContactSurface {
    pub(super) edges: Vec<ContactEdge>,
    /// Vertices opposite to each edge of an obstacle in its two faces, numbered after the nodes of
    /// the rods; `None` if the edge does not have two faces.
    opposite: Vec<Option<[usize; 2]>>,
    faces: Vec<ContactFace>,
    pub(super) smooth_faces: SmoothFaces,
    /// Nodes of all rods.
    rod_nodes: usize,
    /// Number of edges of all rods, balls and free bodies, which come first.
    rod_edges: usize,
    /// Number of faces of free bodies, which come before those of obstacles.
    body_faces: usize,
    /// Nodes of free bodies, and the radii of their roundings, m.
    bodies: Vec<(Range<usize>, f64)>,
    obstacles: Vec<RigidBody>,
    /// Own friction coefficients of the obstacles.
    pub(super) frictions: Vec<Option<f64>>,
    /// Whether a part of a rod or a free body has a friction coefficient of its own.
    pub(super) has_own_frictions: bool,
    nodes: Vec<ContactNode>,
    /// Length of every closed rod, m; `None` for open rods.
    closed_lengths: Vec<Option<f64>>,
    /// Smallest radius of the rods that move, and of all rods, m; `None` if there are none.
    least_radii: [Option<f64>; 2],
    /// Joints of two rods, by their indices, the lower first.
    joints: HashMap<[usize; 2], Vec<ContactJoint>>,
    /// Pairs ignored where rods are rooted in bodies.
    pub(super) roots: Roots,
}

/// A point at which two rods are joined.
#[derive(Clone, Copy, Debug)]
struct ContactJoint {
    /// Arc length along each rod, m; `None` if the joint may be anywhere along it.
    arc_length: [Option<f64>; 2],
    /// Length of the path through the joint within which the rods are neighbours, m.
    reach: f64,
}

/// Largest reach of a joint in sums of the two radii. Rods joined at so small an angle that they
/// would need a longer reach count as overlapping.
const FARTHEST_REACH: f64 = 20.0;
/// Ratio of the reach of a joint to the length over which straight rods that meet at an angle
/// overlap.
const REACH: f64 = 1.5;

impl ContactSurface {
    /// A surface without rods.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the edges of a rod with the nodes `first_node`, `first_node + 1`, ..., placed at
    /// `centreline` (m); the last node is joined to the first if `closed`.
    pub fn add_rod(
        &mut self,
        first_node: usize,
        centreline: &[Vector3],
        closed: bool,
        radius: f64,
        held: bool,
    ) {
        debug_assert!(self.obstacles.is_empty(), "rods come first");
        let rod = self.closed_lengths.len();
        let nodes = centreline.len();
        self.rod_nodes = self.rod_nodes.max(first_node + nodes);
        let edges = if closed {
            nodes
        } else {
            nodes.saturating_sub(1)
        };
        self.note_least_radius(radius, held);
        if !held {
            let first_edge = self.edges.len();
            self.nodes.extend((0..nodes).map(|node| ContactNode {
                node: first_node + node,
                edge: first_edge + node.min(edges.saturating_sub(1)),
                radius,
            }));
        }
        let mut length = 0.0;
        for edge in 0..edges {
            let next = (edge + 1) % nodes;
            let start = length;
            length += (centreline[next] - centreline[edge]).norm();
            self.edges.push(ContactEdge {
                nodes: [first_node + edge, first_node + next],
                rod,
                radius,
                arc_length: [start, length],
                held,
                friction: None,
            });
        }
        self.closed_lengths.push(closed.then_some(length));
        self.rod_edges = self.edges.len();
    }

    /// Sets the radii of the edges of the rod that was added last, m, and the radii with which its
    /// nodes touch planes, faces and tubes. Parts of the rod that are nearer along it than π times
    /// the mean of their radii do not touch.
    pub fn set_radii(&mut self, edges: &[f64], nodes: &[f64]) {
        let rod = self.closed_lengths.len() - 1;
        let first = self.edges.len() - edges.len();
        let own = &mut self.edges[first..];
        debug_assert!(
            own.iter().all(|edge| edge.rod == rod),
            "one radius per edge"
        );
        let held = own.iter().all(|edge| edge.held);
        for (edge, radius) in own.iter_mut().zip(edges) {
            edge.radius = *radius;
        }
        if !held {
            let first = self.nodes.len() - nodes.len();
            for (node, radius) in self.nodes[first..].iter_mut().zip(nodes) {
                node.radius = *radius;
            }
        }
        let all = edges.iter().chain(nodes);
        let least = all.copied().fold(f64::INFINITY, f64::min);
        self.note_least_radius(least, held);
    }

    /// Takes a radius, m, into the smallest ones.
    fn note_least_radius(&mut self, radius: f64, held: bool) {
        let [moving, any] = &mut self.least_radii;
        for (least, counts) in [(moving, !held), (any, true)] {
            if counts {
                *least = Some(least.map_or(radius, |least| least.min(radius)));
            }
        }
    }

    /// Adds a ball around a node, after all rods and before obstacles, and returns its index among
    /// the rods. The ball may overlap the rods that meet at the node, given with the arc length
    /// (m) of the node along each, and balls added earlier, given with 0. These are its neighbours
    /// within 1.5 times the length over which a straight rod overlaps.
    ///
    /// Other bodies touch a ball like an edge of no length. Planes, faces and tubes touch it where
    /// they touch the node: the larger of the two radii counts.
    pub(crate) fn add_ball(
        &mut self,
        node: usize,
        radius: f64,
        held: bool,
        meeting: &[(usize, f64)],
    ) -> usize {
        debug_assert!(self.obstacles.is_empty(), "obstacles come last");
        let ball = self.closed_lengths.len();
        let edge = self.edges.len();
        for &(rod, arc_length) in meeting {
            let reach = REACH * (radius + self.largest_radius_of(rod));
            self.join([rod, ball], [Some(arc_length), Some(0.0)], reach);
        }
        self.note_least_radius(radius, held);
        self.edges.push(ContactEdge {
            nodes: [node; 2],
            rod: ball,
            radius,
            arc_length: [0.0; 2],
            held,
            friction: None,
        });
        let nodes = self.nodes.iter_mut();
        for own in nodes.filter(|own| own.node == node && own.radius < radius) {
            (own.edge, own.radius) = (edge, radius);
        }
        self.closed_lengths.push(None);
        self.rod_edges = self.edges.len();
        ball
    }

    /// Adds a free body with the nodes `first_node`, `first_node + 1`, ..., its vertices, after all
    /// rods and balls. Its segments touch like edges of rods, its vertices like nodes, and its faces
    /// like those of obstacles. Its own `friction` coefficient is as in `own_friction`.
    pub fn add_body(&mut self, first_node: usize, body: &RigidBody, friction: Option<f64>) {
        debug_assert!(self.obstacles.is_empty(), "obstacles come last");
        let rod = self.closed_lengths.len();
        let first_edge = self.edges.len();
        self.rod_nodes = self.rod_nodes.max(first_node + body.vertices.len());
        self.note_least_radius(body.radius, false);
        self.edges
            .extend(body.segments.iter().map(|segment| ContactEdge {
                nodes: segment.map(|vertex| first_node + vertex),
                rod,
                radius: body.radius,
                arc_length: [0.0; 2],
                held: false,
                friction,
            }));
        self.nodes.extend((0..body.vertices.len()).map(|vertex| {
            let mut segments = body.segments.iter();
            let own = segments.position(|segment| segment.contains(&vertex));
            ContactNode {
                node: first_node + vertex,
                edge: first_edge + own.unwrap_or(0),
                radius: body.radius,
            }
        }));
        self.faces.extend(body.faces.iter().map(|face| ContactFace {
            vertices: face.map(|vertex| first_node + vertex),
            obstacle: None,
            rod,
            radius: body.radius,
            friction,
        }));
        self.has_own_frictions |= friction.is_some();
        self.closed_lengths.push(None);
        self.rod_edges = self.edges.len();
        self.body_faces = self.faces.len();
        let nodes = first_node..first_node + body.vertices.len();
        self.bodies.push((nodes, body.radius));
    }

    /// Nodes of the free bodies, and the radii of their roundings, m.
    pub(super) fn bodies(&self) -> &[(Range<usize>, f64)] {
        &self.bodies
    }

    /// Whether a body is a ball around a node.
    pub(crate) fn is_ball(&self, body: usize) -> bool {
        body < self.rod_edges && self.edges[body].nodes[0] == self.edges[body].nodes[1]
    }

    /// Joins two rods at arc lengths along them (m) at which they meet at `angle` (rad).
    ///
    /// Near the joint they overlap: at the distance s on either side their axes are 2s sin(φ/2)
    /// apart. Two edges count as neighbours, like those along one rod, if the path between them
    /// through the joint is short: shorter than 1.5 times the length of the overlap, or than π
    /// times the mean of the radii along either rod. Returns that length of the path, m.
    pub(crate) fn add_joint(&mut self, rods: [usize; 2], arc_length: [f64; 2], angle: f64) -> f64 {
        let sum: f64 = rods
            .into_iter()
            .map(|rod| self.largest_radius_of(rod))
            .sum();
        let overlapping = REACH / libm::sin(0.5 * angle);
        let reach = sum * overlapping.clamp(PI, FARTHEST_REACH);
        self.join(rods, arc_length.map(Some), reach);
        reach
    }

    /// The nodes before and after each node along its rod; the node itself beyond an end.
    pub(super) fn chords(&self) -> Vec<[usize; 2]> {
        let mut chords: Vec<[usize; 2]> = (0..self.rod_nodes).map(|node| [node; 2]).collect();
        let edges = self.edges[..self.rod_edges].iter();
        for [from, to] in edges.map(|edge| edge.nodes).filter(|[from, to]| from != to) {
            chords[from][1] = to;
            chords[to][0] = from;
        }
        chords
    }

    /// Allows the point of the first rod at an arc length (m) to slide along the second rod. Edges
    /// of the first rod that are nearer to the point along the rod than π times the mean of the
    /// radii are neighbours of the whole second rod.
    pub(crate) fn add_slide(&mut self, rods: [usize; 2], arc_length: f64) {
        let sum: f64 = rods
            .into_iter()
            .map(|rod| self.largest_radius_of(rod))
            .sum();
        self.join(rods, [Some(arc_length), None], PI * sum);
    }

    /// Largest radius of a rod, m.
    fn largest_radius_of(&self, rod: usize) -> f64 {
        let first = self.edges.partition_point(|edge| edge.rod < rod);
        let own = self.edges[first..]
            .iter()
            .take_while(|edge| edge.rod == rod);
        own.map(|edge| edge.radius).fold(0.0, f64::max)
    }

    pub(super) fn join(&mut self, rods: [usize; 2], arc_length: [Option<f64>; 2], reach: f64) {
        let (rods, arc_length) = if rods[0] <= rods[1] {
            (rods, arc_length)
        } else {
            ([rods[1], rods[0]], [arc_length[1], arc_length[0]])
        };
        let joint = ContactJoint { arc_length, reach };
        self.joints.entry(rods).or_default().push(joint);
    }

    /// Whether two edges are neighbours through a joint.
    pub(super) fn are_joined(&self, a: &ContactEdge, b: &ContactEdge) -> bool {
        if self.joints.is_empty() {
            return false;
        }
        let (a, b) = if a.rod <= b.rod { (a, b) } else { (b, a) };
        let Some(joints) = self.joints.get(&[a.rod, b.rod]) else {
            return false;
        };
        joints.iter().any(|joint| {
            let [first, second] = joint.arc_length;
            let to = |edge, place: Option<f64>| place.map_or(0.0, |at| self.way_to(edge, at));
            let way = |one, other| to(a, one) + to(b, other);
            way(first, second) < joint.reach || a.rod == b.rod && way(second, first) < joint.reach
        })
    }

    /// Arc length between the nearest end of an edge and a point of its rod, m; 0 within the edge.
    pub(super) fn way_to(&self, edge: &ContactEdge, place: f64) -> f64 {
        let [start, end] = edge.arc_length;
        let direct = (start - place).max(place - end).max(0.0);
        match self.closed_lengths[edge.rod] {
            Some(length) if direct > 0.0 => {
                let around = if place > end {
                    length - place + start
                } else {
                    length - end + place
                };
                direct.min(around)
            }
            _ => direct,
        }
    }

    /// Adds an obstacle with its friction coefficient, after all rods.
    ///
    /// A rod touches the obstacle where one of its edges is near a segment, or one of its nodes is
    /// near the interior of a face, above or below it; a foot on the border of a face belongs to
    /// the segments there. So the distances are those of two edges (thesis Eqs. 2.3–2.6), and of a
    /// point from a plane. Smooth parts of meshes touch nodes only, see `smooth_faces`. Its own
    /// `friction` coefficient is as in `own_friction`.
    pub fn add_obstacle(&mut self, obstacle: RigidBody, friction: Option<f64>) {
        let first = self.rod_nodes + self.vertex_count();
        // The rim of a tube is sharp.
        let own = if obstacle.hollow {
            0.0
        } else {
            obstacle.radius
        };
        let any = &mut self.least_radii[1];
        *any = Some(any.map_or(own, |least| least.min(own)));
        for (index, segment) in obstacle.segments.iter().enumerate() {
            let opposite = obstacle.opposite.get(index).copied().flatten();
            self.opposite
                .push(opposite.map(|corners| corners.map(|vertex| first + vertex)));
            self.edges.push(ContactEdge {
                nodes: segment.map(|vertex| first + vertex),
                rod: self.closed_lengths.len(),
                radius: obstacle.radius,
                arc_length: [0.0; 2],
                held: true,
                friction: None,
            });
        }
        self.smooth_faces.add(&obstacle, self.faces.len());
        for face in &obstacle.faces {
            self.faces.push(ContactFace {
                vertices: face.map(|vertex| first + vertex),
                obstacle: Some(self.obstacles.len()),
                rod: self.closed_lengths.len(),
                radius: obstacle.radius,
                friction: None,
            });
        }
        self.closed_lengths.push(None);
        self.obstacles.push(obstacle);
        self.frictions.push(friction);
    }

    /// All edges, rod after rod, then those of obstacles.
    pub fn edges(&self) -> &[ContactEdge] {
        &self.edges
    }

    /// Edges of the rods, and balls, which precede those of obstacles.
    pub(crate) fn rod_edges(&self) -> &[ContactEdge] {
        &self.edges[..self.rod_edges]
    }

    /// Whether a node belongs to a rod or a ball, not to a free body.
    pub(super) fn is_rod_node(&self, node: usize) -> bool {
        let first = self.bodies.first();
        first.is_none_or(|(nodes, _)| node < nodes.start)
    }

    /// The vertices opposite to an edge of an obstacle in its two faces.
    pub(super) fn opposite(&self, edge: usize) -> Option<[usize; 2]> {
        let segment = edge.checked_sub(self.rod_edges)?;
        self.opposite.get(segment).copied().flatten()
    }

    /// The faces of free bodies.
    pub(super) fn body_faces(&self) -> &[ContactFace] {
        &self.faces[..self.body_faces]
    }

    /// A node of a body, which for a rod is the first of an edge.
    pub(crate) fn first_node_of(&self, body: usize) -> usize {
        match self.edges.get(body) {
            Some(edge) => edge.nodes[0],
            None => self.faces[body - self.edges.len()].vertices[0],
        }
    }

    /// The faces of free bodies and of obstacles.
    pub(super) fn faces(&self) -> &[ContactFace] {
        &self.faces
    }

    /// The obstacles at time zero.
    pub(crate) fn obstacles(&self) -> &[RigidBody] {
        &self.obstacles
    }

    /// Vertices of all obstacles.
    fn vertex_count(&self) -> usize {
        let vertices = self
            .obstacles
            .iter()
            .map(|obstacle| obstacle.vertices.len());
        vertices.sum()
    }

    /// Nodes of all rods.
    pub(crate) fn node_count(&self) -> usize {
        self.rod_nodes
    }

    /// The obstacle to which a body belongs.
    pub(crate) fn obstacle_of(&self, body: usize) -> Option<usize> {
        if body >= self.edges.len() {
            return self.faces[body - self.edges.len()].obstacle;
        }
        let rods = self.closed_lengths.len() - self.obstacles.len();
        self.edges[body].rod.checked_sub(rods)
    }

    /// The nodes that planes may push.
    pub(super) fn nodes(&self) -> &[ContactNode] {
        &self.nodes
    }

    /// Largest radius of the rods that move, m; zero if none do. Obstacles do not use up any
    /// margin.
    pub(crate) fn largest_moving_radius(&self) -> f64 {
        self.rod_edges()
            .iter()
            .filter(|edge| !edge.held)
            .fold(0.0, |largest, edge| edge.radius.max(largest))
    }

    /// Distance at which the surfaces of two bodies touch, m: h_i + h_j for two rods. For
    /// obstacles the distance is that of their surface, see [`Self::core`], and the threshold is
    /// the radius h of the rod.
    pub(super) fn threshold(&self, [i, j]: [usize; 2]) -> f64 {
        self.edges[i].radius + self.moving_radius(j).unwrap_or(0.0)
    }

    /// Radius of a body that is not part of an obstacle, m.
    fn moving_radius(&self, body: usize) -> Option<f64> {
        if body < self.rod_edges {
            return Some(self.edges[body].radius);
        }
        let face = self.faces.get(body.checked_sub(self.edges.len())?)?;
        face.obstacle.is_none().then_some(face.radius)
    }

    /// Offset of the surface of an obstacle, m: subtract it from the distance of the edges or
    /// faces of a pair.
    pub(super) fn core(&self, pair: &CandidatePair) -> f64 {
        match self.obstacle_of(pair.edges[1]) {
            None => 0.0,
            Some(_) if pair.is_with_rim() => 0.0,
            // The distance from the axis of a tube counts as negative.
            Some(obstacle) if self.obstacles[obstacle].hollow => -self.obstacles[obstacle].radius,
            Some(obstacle) => self.obstacles[obstacle].radius,
        }
    }

    /// Length scale of the contact law of a pair, m: the mean radius of two rods, or the radius of
    /// a rod at an obstacle.
    pub(super) fn law_scale(&self, pair: [usize; 2]) -> f64 {
        let threshold = self.threshold(pair);
        match self.moving_radius(pair[1]) {
            Some(_) => 0.5 * threshold,
            None => threshold,
        }
    }

    /// Least distance of the centrelines of two edges at which their surfaces may touch, m;
    /// infinite if neither can move.
    pub(super) fn least_threshold(&self) -> f64 {
        match self.least_radii {
            [Some(moving), Some(any)] => moving + any,
            _ => f64::INFINITY,
        }
    }

    /// Whether two edges can touch at all.
    ///
    /// Two edges cannot touch if both are held, if they share a node, or if they are neighbours
    /// through a joint or along one rod, with nearest ends closer than πh along the rod, where h is
    /// the mean of their radii. A rod bent as sharply as its own radius allows (curvature 1/h)
    /// turns back on itself within πh. The bending stiffness keeps nearer pairs apart; without this
    /// rule, short edges would push each other all the time.
    pub fn may_touch(&self, first: usize, second: usize) -> bool {
        let (a, b) = (&self.edges[first], &self.edges[second]);
        if a.held && b.held {
            return false;
        }
        if a.nodes.iter().any(|node| b.nodes.contains(node)) {
            return false;
        }
        let mean = 0.5 * (a.radius + b.radius);
        (a.rod != b.rod || self.gap_along_rod(a, b) >= PI * mean) && !self.are_joined(a, b)
    }

    /// Arc length between the nearest ends of two edges of one rod, m.
    fn gap_along_rod(&self, a: &ContactEdge, b: &ContactEdge) -> f64 {
        let (before, after) = if a.arc_length[0] <= b.arc_length[0] {
            (a, b)
        } else {
            (b, a)
        };
        let gap = after.arc_length[0] - before.arc_length[1];
        match self.closed_lengths[a.rod] {
            Some(length) => gap.min(length - after.arc_length[1] + before.arc_length[0]),
            None => gap,
        }
    }
}

#[cfg(test)]
#[path = "surface_tests.rs"]
mod tests;
