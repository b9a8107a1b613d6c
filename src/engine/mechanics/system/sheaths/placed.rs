//! A rod in a sheath: which of its nodes are held, and where.

use crate::mechanics::Vector3;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::transport::rotated;
use crate::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use crate::mechanics::rod::{ReferenceFrames, STRIDE};
use crate::mechanics::scene::{Inertia, RodDescription, Sheath, piecewise_linear};
use crate::mechanics::system::build::Assembly;
use crate::mechanics::system::clamps::HeldEdge;

/// Least part of a vertex that bends; with less, its edge is held.
pub(super) const LEAST_PART: f64 = 1e-3;

/// Largest distance of a node in a sheath from its place, relative to the length inside.
const STRAIGHT: f64 = 1e-6;

/// Field of a sheath that is at fault, and why.
pub(super) type Fault = (&'static str, String);

/// A force that feeds a rod.
#[derive(Clone, Debug)]
pub(super) struct Push {
    /// At given times, [(s, N), ...].
    force: Vec<(f64, f64)>,
    /// Length fed out at the last evaluation, m.
    pub(super) fed: f64,
    /// Least and largest length that can be fed out, m.
    stops: [f64; 2],
    /// Number of edges that were held when the frames were committed; all if they were restored,
    /// since the angles of all edges were then restored, too.
    held_at_commit: usize,
}

impl Push {
    fn new(force: Vec<(f64, f64)>) -> Self {
        Self {
            force,
            fed: 0.0,
            stops: [0.0; 2],
            held_at_commit: 0,
        }
    }

    /// Sets the length fed out, m, or that at the nearest stop.
    pub(super) fn feed(&mut self, fed: f64) {
        let [least, most] = self.stops;
        self.fed = fed.clamp(least, most);
    }

    /// A change of the length fed out (m), with the sign that leads away from the stop in its way.
    pub(super) fn inwards(&self, change: f64) -> f64 {
        if self.fed + change > self.stops[1] {
            -change
        } else {
            change
        }
    }

    /// Whether a stop takes a part of the force (N) that is not balanced.
    pub(super) fn is_stopped(&self, unbalanced: f64) -> bool {
        let [least, most] = self.stops;
        self.fed >= most && unbalanced > 0.0 || self.fed <= least && unbalanced < 0.0
    }

    /// The force at a time (s), N.
    pub(super) fn force(&self, time: f64) -> f64 {
        piecewise_linear(&self.force, time).unwrap_or(0.0)
    }
}

#[derive(Clone, Debug)]
pub(super) struct PlacedSheath {
    /// Nodes of the rod, from the end inside on.
    pub(super) nodes: Vec<usize>,
    /// The edges between them, with their material directors inside without turning.
    pub(super) edges: Vec<HeldEdge>,
    /// Natural arc length of each node from the end inside, m.
    pub(super) along: Vec<f64>,
    /// Indices of the vertices at nodes with two edges among those of all rods, and their natural
    /// strains and stiffness outside; `None` at the ends.
    pub(super) vertices: Vec<Option<(usize, VertexStrains, VertexStiffness)>>,
    /// Index of the first edge of the rod among those of all rods.
    pub(super) first_edge: usize,
    /// EA of the edges, N.
    pub(super) stretching: Vec<f64>,
    /// Place of the end inside at time zero, m.
    pub(super) origin: Vector3,
    /// Direction in which the rod is fed.
    pub(super) axis: Vector3,
    /// Tangent of the rod inside: the axis, or its opposite.
    pub(super) tangent: Vector3,
    /// Radius of the rod, m.
    pub(super) radius: f64,
    pub(super) inside: f64,
    pub(super) fed: Vec<(f64, f64)>,
    /// The force that feeds the rod, if the length fed out is not given.
    pub(super) push: Option<Push>,
    pub(super) turned: Vec<(f64, f64)>,
    /// Number of edges that are held.
    pub(super) held: usize,
    /// Node of the vertex at the mouth, counted as in `nodes`, and l, m.
    pub(super) mouth: Option<(usize, f64)>,
}

impl PlacedSheath {
    pub(super) fn new(
        sheath: &Sheath,
        rod: &RodDescription,
        assembly: &Assembly,
    ) -> Result<Self, Fault> {
        let range = assembly.rods.rods[sheath.rod];
        let of_rod = |reason: &str| Err(("rod", reason.to_owned()));
        if rod.closed || rod.held {
            return of_rod("its rod must have two ends and must not be an obstacle");
        }
        if rod.inertia == Inertia::Consistent {
            return of_rod("its rod needs inertia = \"lumped\"");
        }
        if rod.retardation_time > 0.0 || rod.relaxation.is_some() || rod.yielding.is_some() {
            return of_rod("its rod must be elastic, without viscosity and plasticity");
        }
        let mut nodes: Vec<usize> = range.node_indices().collect();
        let mut starts: Vec<usize> = range.edge_indices().collect();
        if sheath.from_end {
            nodes.reverse();
            starts.reverse();
        }
        let found = (assembly.rods.edges).binary_search_by_key(&range.first_node, |e| e.start);
        let first_edge = found.expect("a rod has edges");
        let edge = |start: &usize| &assembly.rods.edges[first_edge + start - range.first_node];
        let lengths = starts.iter().map(|start| edge(start).natural_length);
        let ends = lengths.scan(0.0, |along, length| {
            *along += length;
            Some(*along)
        });
        let along: Vec<f64> = [0.0].into_iter().chain(ends).collect();
        let place = |node: usize| position(&assembly.unknowns, node);
        let origin = place(nodes[0]);
        let axis = (place(nodes[1]) - origin).normalize();
        let tangent = if sheath.from_end { -axis } else { axis };
        let vertex_at = |node: usize| {
            let mut vertices = assembly.rods.vertices.iter().enumerate();
            vertices.find(|(_, vertex)| {
                vertex.before.max(vertex.after) < assembly.rods.nodes && vertex.after == node
            })
        };
        let vertices = nodes.iter().map(|&node| {
            let (index, vertex) = vertex_at(node)?;
            Some((index, vertex.natural, vertex.stiffness))
        });
        let mut placed = Self {
            vertices: vertices.collect(),
            stretching: starts.iter().map(|start| edge(start).stretching).collect(),
            edges: (starts.iter())
                .map(|&start| {
                    let angle = assembly.unknowns[STRIDE * start + 3];
                    let ends = [start, range.end_of(start)];
                    HeldEdge::new(ends, placed_director(assembly, start), angle)
                })
                .collect(),
            radius: rod.radius,
            inside: sheath.inside,
            fed: sheath.fed.clone(),
            push: (!sheath.pushed.is_empty()).then(|| Push::new(sheath.pushed.clone())),
            turned: sheath.turned.clone(),
            held: 0,
            mouth: None,
            nodes,
            along,
            first_edge,
            origin,
            axis,
            tangent,
        };
        placed.check(assembly)?;
        placed.stop(assembly);
        placed.twist_naturally()?;
        Ok(placed)
    }

    /// Checks the lengths, and that nothing else holds the part of the rod that is ever inside.
    fn check(&self, assembly: &Assembly) -> Result<(), Fault> {
        let corners = self.fed.iter().map(|corner| corner.1).chain([0.0]);
        let most = corners.clone().fold(0.0, f64::max);
        let least = corners.fold(0.0, f64::min);
        let (first, whole) = (self.along[1], self.along[self.edges.len()]);
        let slack = STRAIGHT * first;
        let range = |field, value: f64, allowed: String| {
            let message = format!("{:?} m is out of range; allowed: {allowed}", rounded(value));
            Err((field, message))
        };
        if self.inside > whole + slack {
            let allowed = format!("at most {:?} m, the length of its rod", rounded(whole));
            return range("inside", self.inside, allowed);
        }
        if self.inside < first - slack {
            let allowed = format!("at least {:?} m, one edge of its rod", rounded(first));
            return range("inside", self.inside, allowed);
        }
        if self.inside - most < first - slack {
            let allowed = format!(
                "at most {:?} m, so that one edge of its rod stays inside",
                rounded(self.inside - first)
            );
            return range("fed", most, allowed);
        }
        if self.push.is_some() && !self.fed.is_empty() {
            let message = "either the length or the force is given, not both";
            return Err(("pushed", message.to_owned()));
        }
        let deepest = match &self.push {
            Some(_) => self.inside,
            None => self.inside - least,
        };
        for (number, node) in self.nodes.iter().enumerate() {
            // A node is inside as long as one of its edges is.
            let is_inside = self.along[number.saturating_sub(1)] < deepest;
            let is_first = self.along[number] <= self.inside;
            let off = position(&assembly.unknowns, *node) - self.place(number, 0.0);
            if is_first && off.norm() > STRAIGHT * self.inside {
                let message = format!(
                    "its rod must be placed straight and without tension along {:?} m from the end inside; node {} is {:?} m off",
                    rounded(self.inside),
                    assembly.locate(*node).1,
                    rounded(off.norm())
                );
                return Err(("inside", message));
            }
            if is_inside && self.is_taken(number, assembly) {
                let message = format!(
                    "a clamp, joint or body is at node {} of its rod, which is inside the sheath at some time",
                    assembly.locate(*node).1
                );
                return Err(("rod", message));
            }
        }
        Ok(())
    }

    /// Whether a clamp, joint or body is at a node.
    fn is_taken(&self, number: usize, assembly: &Assembly) -> bool {
        let node = self.nodes[number];
        let inner = number > 0 && number < self.edges.len();
        assembly.held[STRIDE * node..STRIDE * node + 3].contains(&true)
            || inner && self.vertices[number].is_none()
            || assembly.joints.slides_at(node)
            || assembly.joints.joins(node)
    }

    /// Sets the stops of a rod that a force feeds: at least its first edge stays inside, and nothing
    /// that holds a node comes in.
    fn stop(&mut self, assembly: &Assembly) {
        let mut numbers = 0..self.nodes.len();
        let taken = numbers.find(|number| self.is_taken(*number, assembly));
        let deepest = taken.map_or(self.along[self.edges.len()], |taken| self.along[taken - 1]);
        let stops = [self.inside - deepest, self.inside - self.along[1]];
        if let Some(push) = &mut self.push {
            push.stops = stops;
        }
    }

    /// Sets the directors of all edges as they are inside, with the natural twist from the first on.
    fn twist_naturally(&mut self) -> Result<(), Fault> {
        let forwards = self.tangent.dot(&self.axis);
        for number in 1..self.edges.len() {
            let natural = self.vertices[number].map_or(0.0, |vertex| vertex.1.twist);
            let last = &self.edges[number - 1].director;
            let director = rotated(last, &self.tangent, forwards * natural);
            let placed = std::mem::replace(&mut self.edges[number].director, director);
            if self.middle(number) <= self.inside && (director - placed).norm() > STRAIGHT {
                let message = "its rod must be placed with its natural twist inside";
                return Err(("rod", message.to_owned()));
            }
        }
        Ok(())
    }

    /// Arc length of the middle of an edge, m.
    pub(super) fn middle(&self, edge: usize) -> f64 {
        0.5 * (self.along[edge] + self.along[edge + 1])
    }

    /// Place of a node inside, m.
    pub(super) fn place(&self, number: usize, fed: f64) -> Vector3 {
        self.origin + self.axis * (self.along[number] + fed)
    }

    /// Length fed out at a time (s), m; that of the last evaluation where a force feeds the rod.
    pub(super) fn fed(&self, time: f64) -> f64 {
        match &self.push {
            Some(push) => push.fed,
            None => piecewise_linear(&self.fed, time).unwrap_or(0.0),
        }
    }

    /// Corners of the force that feeds it, [(s, N), ...].
    pub(super) fn pushes(&self) -> &[(f64, f64)] {
        self.push.as_ref().map_or(&[], |push| &push.force)
    }

    /// Arc length of the mouth at a time (s), m.
    pub(super) fn mouth_at(&self, time: f64) -> f64 {
        self.inside - self.fed(time)
    }

    /// The length fed out where a force feeds the rod becomes that of `unknowns`, the prediction of
    /// a step.
    pub(super) fn predict(&mut self, unknowns: &[f64]) {
        let end = position(unknowns, self.nodes[0]) - self.origin;
        let fed = end.dot(&self.axis);
        if let Some(push) = &mut self.push {
            push.feed(fed);
        }
    }

    /// Where the frames of the last evaluation are committed.
    pub(super) fn commit(&mut self) {
        let held = self.held;
        if let Some(push) = &mut self.push {
            push.held_at_commit = held;
        }
        self.edges.iter_mut().for_each(HeldEdge::commit);
    }

    /// The frames of held edges are those of a configuration that was committed before.
    pub(super) fn resume(&mut self, unknowns: &[f64]) {
        self.predict(unknowns);
        if let Some(push) = &mut self.push {
            push.held_at_commit = usize::MAX;
        }
        for edge in &mut self.edges {
            edge.resume(unknowns);
        }
    }

    /// Number of edges that were held when the frames were committed, at a time, s.
    fn held_before(&self, committed: f64) -> usize {
        match &self.push {
            Some(push) => push.held_at_commit,
            None => self.held_at(self.mouth_at(committed)),
        }
    }

    /// Angle at a time (s), rad.
    pub(super) fn turned(&self, time: f64) -> f64 {
        piecewise_linear(&self.turned, time).unwrap_or(0.0)
    }

    /// Voronoi length of an inner node, m.
    pub(super) fn voronoi(&self, number: usize) -> f64 {
        self.middle(number) - self.middle(number - 1)
    }

    /// Number of edges that are held if the mouth is at an arc length, m; the first always is.
    pub(super) fn held_at(&self, mouth: f64) -> usize {
        let is_held = |&edge: &usize| {
            edge == 0 || self.middle(edge) - mouth <= LEAST_PART * self.voronoi(edge)
        };
        (0..self.edges.len()).take_while(is_held).count()
    }

    /// Marks the unknowns of the edges that are held at a time, s. Returns whether they changed.
    pub(super) fn mark(&mut self, time: f64, held: &mut [bool]) -> bool {
        let before = self.held;
        self.held = self.held_at(self.mouth_at(time));
        let inside = self.held > before;
        for edge in self.held.min(before)..self.held.max(before) {
            held[STRIDE * self.edges[edge].start + 3] = inside;
            held[STRIDE * self.nodes[edge + 1]..STRIDE * self.nodes[edge + 1] + 3].fill(inside);
        }
        if before == 0 {
            held[STRIDE * self.nodes[0]..STRIDE * self.nodes[0] + 3].fill(true);
        }
        before != self.held
    }

    /// Moves and turns a rod that nothing else holds as a whole to where it is at time zero.
    pub(super) fn begin(&self, assembly: &mut Assembly) {
        let (fed, angle) = (self.fed(0.0), self.turned(0.0));
        let mut nodes = self.nodes.iter();
        let is_free = nodes.all(|&node| {
            let is_held = assembly.held[STRIDE * node..STRIDE * node + 3].contains(&true);
            !is_held && !assembly.joints.joins(node)
        });
        if !is_free || (fed == 0.0 && angle == 0.0) {
            return;
        }
        for &node in &self.nodes {
            let arm = position(&assembly.unknowns, node) - self.origin;
            let place = self.origin + self.axis * fed + rotated(&arm, &self.axis, angle);
            assembly.unknowns[STRIDE * node..STRIDE * node + 3].copy_from_slice(place.as_slice());
        }
        let reference = &mut assembly.reference;
        for edge in self.edges.iter().map(|edge| edge.start) {
            for vector in [&mut reference.tangent[edge], &mut reference.director[edge]] {
                *vector = rotated(vector, &self.axis, angle);
            }
        }
    }

    /// Sets the held unknowns at a time, s, for reference frames of the time `committed`.
    pub(super) fn apply(
        &mut self,
        time: f64,
        committed: f64,
        reference: &ReferenceFrames,
        unknowns: &mut [f64],
    ) {
        let fed = self.fed(time);
        for number in 0..=self.held {
            let (node, place) = (self.nodes[number], self.place(number, fed));
            unknowns[STRIDE * node..STRIDE * node + 3].copy_from_slice(place.as_slice());
        }
        let angle = self.turned(time);
        let spin = self.tangent.dot(&self.axis) * (angle - self.turned(committed));
        let were_held = self.held_before(committed);
        for (number, edge) in self.edges[..self.held].iter_mut().enumerate() {
            let director = rotated(&edge.director, &self.axis, angle);
            if number < were_held {
                edge.turn(&director, spin, reference, unknowns);
            } else {
                // It was free until now.
                edge.resume(unknowns);
                edge.turn(&director, 0.0, reference, unknowns);
            }
        }
    }
}

/// First material director of an edge as placed.
fn placed_director(assembly: &Assembly, edge: usize) -> Vector3 {
    let reference = &assembly.reference;
    let angle = assembly.unknowns[STRIDE * edge + 3];
    rotated(&reference.director[edge], &reference.tangent[edge], angle)
}

/// A length with as many digits as messages show.
fn rounded(length: f64) -> f64 {
    format!("{length:.9e}").parse().unwrap_or(length)
}
