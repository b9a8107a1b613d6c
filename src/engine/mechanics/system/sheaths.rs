//! Rods that are fed out of sheaths ([`crate::mechanics::scene::Sheath`]).
//!
//! Nodes are material points. The edges whose midpoints are in the sheath are held on its axis,
//! with their frames, and move along it; those outside are free. An edge that leaves is released,
//! and one that returns is held, from one step to the next, so that each length, mass and momentum
//! of the rod is conserved.
//!
//! **The mouth** is at an arc length m of the rod, between nodes. The vertex between the last edge
//! that is held and the first free one, at the node j, bends only over the part l = s_{j+½} − m of
//! its Voronoi length that is outside. The complementary energy ½ ∫ M²/EI ds over this part, with M²
//! linear between the nodes j and j+1 at the distance h, is that of the lengths
//!
//! ```text
//! wⱼ = l − l (h − l)/2h,     wⱼ₊₁ = l̄ⱼ₊₁ + l (h − l)/2h
//! ```
//!
//! of the two vertices, whose stiffnesses are therefore EI/w and GJ/w, with the natural bending κ̃ w.
//! (Inside, the rod has its natural twist, which stays that of the whole vertex.) The stiffness of
//! the free edge is EA l̄/l, since it would otherwise be released with a jump of its tension. So the
//! wall is at the mouth for every m, with an error of second order in the edge length, and the
//! vertex is rigid when its edge is released or held.
//!
//! **Force.** The energy depends on m by itself. The work of the sheath on the rod is F δ(fed), so
//! that
//!
//! ```text
//! F = Σ R·d + ∂E/∂l,     ∂E/∂l = −½ EI κ² − ½ GJ τ² − ½ EA ε²
//! ```
//!
//! with the reactions R of the held nodes and the direction d, and the curvature κ interpolated to
//! the mouth. The second part is the force by which a bent rod moves itself out of a sleeve: D. Bigoni, F. Dal Corso, F. Bosi and D. Misseroni
//! (2015), *Eshelby-like forces acting on elastic structures: theoretical and experimental proof*,
//! Mechanics of Materials 80, 368.

use super::System;
use super::build::Assembly;
use super::clamps::list_corners;
use super::demand::Demand;
use super::events::Event;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::transport::{parallel_transport, rotated, signed_angle, unwrapped};
use crate::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use crate::mechanics::rod::{ElasticEnergy, ElasticRods, ReferenceFrames, RodGeometry, STRIDE};
use crate::mechanics::scene::{Inertia, RodDescription, Scene, Sheath, piecewise_linear};
use crate::mechanics::{SceneError, Vector3};

/// Least part of a vertex that bends; with less, its edge is held.
const LEAST_PART: f64 = 1e-3;

/// Largest ratio of an edge to the next one for which the length at the mouth is shared with the
/// next vertex.
const LARGEST_RATIO: f64 = 2.0;

/// Largest distance of a node in a sheath from its place, relative to the length inside.
const STRAIGHT: f64 = 1e-6;

const NO_PATH: SceneError = SceneError::Unsuitable(
    "a path of equilibria does not support sheaths, whose rods change their free nodes",
);

const NO_START: SceneError =
    SceneError::Unsuitable("a scene with sheaths cannot start from the end of another run");

const NO_MIDPOINT: SceneError = SceneError::Unsuitable(
    "sheaths need time.scheme = \"implicit-euler\" or \"backward-differences\"",
);

/// Field of a sheath that is at fault, and why.
type Fault = (&'static str, String);

/// The sheaths of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sheaths(Vec<PlacedSheath>);

#[derive(Clone, Debug)]
struct PlacedSheath {
    /// Nodes of the rod, from the end inside on.
    nodes: Vec<usize>,
    /// Starts of the edges between them.
    edges: Vec<usize>,
    /// Natural arc length of each node from the end inside, m.
    along: Vec<f64>,
    /// Indices of the vertices at nodes with two edges among those of all rods, and their natural
    /// strains and stiffness outside; `None` at the ends.
    vertices: Vec<Option<(usize, VertexStrains, VertexStiffness)>>,
    /// Index of the first edge of the rod among those of all rods.
    first_edge: usize,
    /// EA of the edges, N.
    stretching: Vec<f64>,
    /// Place of the end inside at time zero, m.
    origin: Vector3,
    /// Direction in which the rod is fed.
    axis: Vector3,
    /// Tangent of the rod inside: the axis, or its opposite.
    tangent: Vector3,
    /// First material directors of the edges inside without turning.
    directors: Vec<Vector3>,
    inside: f64,
    fed: Vec<(f64, f64)>,
    turned: Vec<(f64, f64)>,
    /// Number of edges that are held.
    held: usize,
    /// Angles of the held edges, and those at the last commit; NaN for edges that were free.
    angles: Vec<f64>,
    committed: Vec<f64>,
    /// Node of the vertex at the mouth, counted as in `nodes`, and l, m.
    mouth: Option<(usize, f64)>,
}

impl PlacedSheath {
    fn new(sheath: &Sheath, rod: &RodDescription, assembly: &Assembly) -> Result<Self, Fault> {
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
        let mut edges: Vec<usize> = range.edge_indices().collect();
        if sheath.from_end {
            nodes.reverse();
            edges.reverse();
        }
        let found = (assembly.rods.edges).binary_search_by_key(&range.first_node, |e| e.start);
        let first_edge = found.expect("a rod has edges");
        let edge = |start: &usize| &assembly.rods.edges[first_edge + start - range.first_node];
        let lengths = edges.iter().map(|start| edge(start).natural_length);
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
            stretching: edges.iter().map(|start| edge(start).stretching).collect(),
            angles: vec![f64::NAN; edges.len()],
            committed: vec![f64::NAN; edges.len()],
            directors: Vec::new(),
            inside: sheath.inside,
            fed: sheath.fed.clone(),
            turned: sheath.turned.clone(),
            held: 0,
            mouth: None,
            nodes,
            edges,
            along,
            first_edge,
            origin,
            axis,
            tangent,
        };
        placed.check(assembly)?;
        placed.directors = placed.directors(assembly)?;
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
        let deepest = self.inside - least;
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
            let unknowns = STRIDE * node..STRIDE * node + 3;
            let inner = number > 0 && number < self.edges.len();
            let is_taken = assembly.held[unknowns].iter().any(|held| *held)
                || inner && self.vertices[number].is_none()
                || assembly.joints.slides_at(*node)
                || assembly.joints.joins(*node);
            if is_inside && is_taken {
                let message = format!(
                    "a clamp, joint or body is at node {} of its rod, which is inside at some time",
                    assembly.locate(*node).1
                );
                return Err(("rod", message));
            }
        }
        Ok(())
    }

    /// First material directors of all edges as they are inside without turning, with the natural
    /// twist.
    fn directors(&self, assembly: &Assembly) -> Result<Vec<Vector3>, Fault> {
        let mut directors: Vec<Vector3> = Vec::new();
        let forwards = self.tangent.dot(&self.axis);
        for (number, &edge) in self.edges.iter().enumerate() {
            let reference = &assembly.reference;
            let angle = assembly.unknowns[STRIDE * edge + 3];
            let placed = rotated(&reference.director[edge], &reference.tangent[edge], angle);
            let Some(last) = directors.last() else {
                directors.push(placed);
                continue;
            };
            let natural = self.vertices[number].map_or(0.0, |vertex| vertex.1.twist);
            let director = rotated(last, &self.tangent, forwards * natural);
            if self.middle(number) <= self.inside && (director - placed).norm() > STRAIGHT {
                let message = "its rod must be placed with its natural twist inside";
                return Err(("rod", message.to_owned()));
            }
            directors.push(director);
        }
        Ok(directors)
    }

    /// Arc length of the middle of an edge, m.
    fn middle(&self, edge: usize) -> f64 {
        0.5 * (self.along[edge] + self.along[edge + 1])
    }

    /// Place of a node inside, m.
    fn place(&self, number: usize, fed: f64) -> Vector3 {
        self.origin + self.axis * (self.along[number] + fed)
    }

    /// Length fed out at a time (s), m.
    fn fed(&self, time: f64) -> f64 {
        piecewise_linear(&self.fed, time).unwrap_or(0.0)
    }

    /// Angle at a time (s), rad.
    fn turned(&self, time: f64) -> f64 {
        piecewise_linear(&self.turned, time).unwrap_or(0.0)
    }

    /// Voronoi length of an inner node, m.
    fn voronoi(&self, number: usize) -> f64 {
        self.middle(number) - self.middle(number - 1)
    }

    /// Number of edges that are held if the mouth is at an arc length, m; the first always is.
    fn held_at(&self, mouth: f64) -> usize {
        let is_held = |&edge: &usize| {
            edge == 0 || self.middle(edge) - mouth <= LEAST_PART * self.voronoi(edge)
        };
        (0..self.edges.len()).take_while(is_held).count()
    }

    /// Marks the unknowns of the edges that are held at a time, s. Returns whether they changed.
    fn mark(&mut self, time: f64, held: &mut [bool]) -> bool {
        let before = self.held;
        self.held = self.held_at(self.inside - self.fed(time));
        let inside = self.held > before;
        for edge in self.held.min(before)..self.held.max(before) {
            held[STRIDE * self.edges[edge] + 3] = inside;
            held[STRIDE * self.nodes[edge + 1]..STRIDE * self.nodes[edge + 1] + 3].fill(inside);
        }
        if before == 0 {
            held[STRIDE * self.nodes[0]..STRIDE * self.nodes[0] + 3].fill(true);
        }
        before != self.held
    }

    /// Moves and turns a rod that nothing else holds as a whole to where it is at time zero.
    fn begin(&self, assembly: &mut Assembly) {
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
        for &edge in &self.edges {
            for vector in [&mut reference.tangent[edge], &mut reference.director[edge]] {
                *vector = rotated(vector, &self.axis, angle);
            }
        }
    }

    /// Sets the held unknowns at a time, s, for reference frames of the time `committed`.
    fn apply(
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
        for number in 0..self.edges.len() {
            if number >= self.held {
                self.angles[number] = f64::NAN;
                continue;
            }
            let edge = self.edges[number];
            let source = &reference.tangent[edge];
            let carried = parallel_transport(&reference.director[edge], source, &self.tangent);
            let director = rotated(&self.directors[number], &self.axis, angle);
            let present = signed_angle(&carried, &director, &self.tangent);
            let expected = match self.committed[number] {
                free if free.is_nan() => unknowns[STRIDE * edge + 3],
                committed => committed + spin,
            };
            self.angles[number] = unwrapped(present, expected);
            unknowns[STRIDE * edge + 3] = self.angles[number];
        }
    }

    /// Gives the vertices and the edge at the mouth their natural strains and stiffness at a time, s.
    fn stiffen(&mut self, time: f64, rods: &mut ElasticRods) {
        if let Some((number, _)) = self.mouth.take() {
            for number in [number, number + 1] {
                self.set_vertex(number, 1.0, rods);
            }
            self.set_edge(number, 1.0, rods);
        }
        let number = self.held;
        if number < self.edges.len() {
            let outside = self.middle(number) - (self.inside - self.fed(time));
            let outside = outside.min(self.voronoi(number));
            for (number, [length, _]) in self.lengths(number, outside) {
                self.set_vertex(number, length / self.voronoi(number), rods);
            }
            self.set_edge(number, outside / self.voronoi(number), rods);
            self.mouth = Some((number, outside));
        }
    }

    /// The vertices at the mouth, their lengths w (m), and dw/dl.
    fn lengths(&self, number: usize, outside: f64) -> Vec<(usize, [f64; 2])> {
        let next = number + 1;
        let edge = self.along[next] - self.along[number];
        let before = self.along[number] - self.along[number - 1];
        if next == self.edges.len()
            || self.vertices[next].is_none()
            || before > LARGEST_RATIO * edge
        {
            return vec![(number, [outside, 1.0])];
        }
        let shared = outside * (edge - outside) / (2.0 * edge);
        let rate = 0.5 - outside / edge;
        vec![
            (number, [outside - shared, 1.0 - rate]),
            (next, [self.voronoi(next) + shared, rate]),
        ]
    }

    /// Sets the length of a vertex, over its Voronoi length.
    fn set_vertex(&self, number: usize, part: f64, rods: &mut ElasticRods) {
        let Some(&Some((index, natural, stiffness))) = self.vertices.get(number) else {
            return;
        };
        let vertex = &mut rods.vertices[index];
        vertex.natural.curvature = natural.curvature.map(|strain| part * strain);
        vertex.stiffness = VertexStiffness {
            bending: stiffness.bending.map(|bending| bending / part),
            twisting: stiffness.twisting / part,
        };
    }

    /// Sets the part of an edge that stretches.
    fn set_edge(&self, number: usize, part: f64, rods: &mut ElasticRods) {
        rods.edges[self.edge(number)].stretching = self.stretching[number] / part;
    }

    /// Index of an edge among those of all rods.
    fn edge(&self, number: usize) -> usize {
        let first = self.edges[0].min(self.edges[self.edges.len() - 1]);
        self.first_edge + self.edges[number] - first
    }

    /// Bending energy of a vertex that is straight, J.
    fn straightened(&self, number: usize, assembly: &Assembly) -> f64 {
        let Some((index, natural, stiffness)) = self.vertices[number] else {
            return 0.0;
        };
        let mut vertex = assembly.rods.vertices[index];
        (vertex.natural, vertex.stiffness) = (natural, stiffness);
        vertex.energies(&VertexStrains::default()).0
    }

    /// Bending energy of the part of the vertex at the mouth that is inside, where the sheath
    /// straightens it, J.
    fn energy_inside(&self, assembly: &Assembly) -> f64 {
        self.mouth.map_or(0.0, |(number, outside)| {
            (1.0 - outside / self.voronoi(number)) * self.straightened(number, assembly)
        })
    }

    /// −∂E/∂l of the vertices and the edge at the mouth, N.
    fn push(&self, assembly: &Assembly, geometry: &RodGeometry) -> f64 {
        let Some((number, outside)) = self.mouth else {
            return 0.0;
        };
        let mut push = self.straightened(number, assembly) / self.voronoi(number);
        for (number, [length, rate]) in self.lengths(number, outside) {
            let Some((index, ..)) = self.vertices[number] else {
                continue;
            };
            let mut vertex = assembly.rods.vertices[index];
            vertex.natural.curvature = [0.0; 4];
            let (bending, twisting) = vertex.energies(&geometry.strains(index, &vertex));
            let straightened = self.straightened(number, assembly) / self.voronoi(number);
            push += rate * ((bending + twisting) / length - straightened);
        }
        let edge = &assembly.rods.edges[self.edge(number)];
        let stretch = geometry.edges[edge.start].length / edge.natural_length - 1.0;
        push + 0.5 * edge.stretching * stretch * stretch * edge.natural_length / outside
    }
}

/// A length with as many digits as messages show.
fn rounded(length: f64) -> f64 {
    format!("{length:.9e}").parse().unwrap_or(length)
}

/// Checks the sheaths of a scene.
///
/// # Errors
/// [`SceneError::Sheath`] for the first one that cannot hold its rod, or another fault of the scene.
pub fn check_sheaths(scene: &Scene) -> Result<(), SceneError> {
    let mut assembly = Assembly::new(scene)?;
    Sheaths::new(scene, &mut assembly).map(drop)
}

impl Sheaths {
    /// Marks the unknowns that are held at a time, s. Returns whether any changed.
    fn mark(&mut self, time: f64, held: &mut [bool]) -> bool {
        let changed = self.0.iter_mut().map(|sheath| sheath.mark(time, held));
        changed.fold(false, |any, changed| any | changed)
    }

    /// Whether the scene has none.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Term for Sheaths {
    /// # Errors
    /// [`SceneError::Sheath`] names a sheath that cannot hold its rod.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let by_stokeslets = matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. }));
        let mut rods: Vec<usize> = Vec::new();
        let place = |sheath: &Sheath| {
            let fault = |(field, reason): Fault| SceneError::Sheath {
                name: sheath.name.clone(),
                field,
                reason,
            };
            let of_rod = |reason: &str| Err(fault(("rod", reason.to_owned())));
            let Some(rod) = scene.rods.get(sheath.rod) else {
                return of_rod("its rod does not exist");
            };
            if rods.contains(&sheath.rod) {
                return of_rod("another sheath holds its rod");
            }
            if (scene.actuations.iter()).any(|actuation| actuation.rod == sheath.rod) {
                return of_rod("its rod is actuated");
            }
            if by_stokeslets {
                return of_rod(
                    "regularized Stokeslets do not support rods in sheaths; fluid.model = \"resistive\" does",
                );
            }
            rods.push(sheath.rod);
            PlacedSheath::new(sheath, rod, assembly).map_err(fault)
        };
        let placed: Result<Vec<_>, _> = scene.sheaths.iter().map(place).collect();
        let sheaths = Self(placed?);
        sheaths.0.iter().for_each(|sheath| sheath.begin(assembly));
        Ok(sheaths)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        self.is_empty()
    }

    /// Stiffens the vertices at the mouths.
    fn drive(&mut self, time: f64, rods: &mut ElasticRods, geometry: &mut RodGeometry) {
        if !self.is_empty() {
            (self.0.iter_mut()).for_each(|sheath| sheath.stiffen(time, rods));
            geometry.take_natural_strains(rods);
        }
    }

    fn energy(&self, assembly: &Assembly, _: &RodGeometry) -> ElasticEnergy {
        let inside = self.0.iter().map(|sheath| sheath.energy_inside(assembly));
        ElasticEnergy {
            bending: inside.sum(),
            ..ElasticEnergy::default()
        }
    }

    /// A sheath changes the stiffness of rods, and holds nodes; the term itself adds no forces.
    fn add_forces(&self, _: &Configuration, _: &mut [f64]) {}

    fn commit(&mut self) {
        for sheath in &mut self.0 {
            sheath.committed.clone_from(&sheath.angles);
        }
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        for sheath in &self.0 {
            let way = |from: &f64, to: &f64| (to - from).abs();
            list_corners(&sheath.fed, way, events);
            list_corners(&sheath.turned, way, events);
        }
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        if self.is_empty() {
            return None;
        }
        match demand {
            Demand::Path => Some(NO_PATH),
            Demand::Start => Some(NO_START),
            Demand::ImplicitMidpoint => Some(NO_MIDPOINT),
            _ => None,
        }
    }
}

impl System {
    /// Holds the nodes that are in sheaths at a time, s, and sets their positions and frames.
    pub(super) fn hold_in_sheaths(&mut self, time: f64, unknowns: &mut [f64]) {
        if self.terms.sheaths.is_empty() {
            return;
        }
        if self.terms.sheaths.mark(time, &mut self.assembly.held) {
            self.note_prescribed_nodes();
            self.matrix.adapt(&self.assembly);
        }
        let committed = self.committed_time;
        for sheath in &mut self.terms.sheaths.0 {
            sheath.apply(time, committed, &self.reference, unknowns);
        }
    }

    /// The frames of held edges are those of a configuration that was committed at a time, s.
    pub(super) fn resume_sheaths(&mut self, time: f64, unknowns: &[f64]) {
        for sheath in &mut self.terms.sheaths.0 {
            let held = sheath.held_at(sheath.inside - sheath.fed(time));
            for (number, &edge) in sheath.edges.iter().enumerate() {
                let angle = unknowns[STRIDE * edge + 3];
                sheath.committed[number] = if number < held { angle } else { f64::NAN };
            }
        }
    }

    /// Whether the scene has sheaths.
    pub(crate) fn has_sheaths(&self) -> bool {
        !self.terms.sheaths.is_empty()
    }

    /// Natural length of the rod outside of a sheath at the last evaluation, m.
    pub(crate) fn length_outside(&self, sheath: usize) -> f64 {
        let sheath = &self.terms.sheaths.0[sheath];
        sheath.along[sheath.edges.len()] - sheath.inside + sheath.fed(self.time)
    }

    /// Force of a sheath on its rod in the direction in which it is fed, N, and moment about this
    /// direction, N m, at the last evaluation.
    pub(crate) fn sheath_force(&self, sheath: usize) -> [f64; 2] {
        let sheath = &self.terms.sheaths.0[sheath];
        let nodes = sheath.nodes[..=sheath.held].iter();
        let reactions = nodes.map(|&node| position(&self.residual, node).dot(&sheath.axis));
        let edges = sheath.edges[..sheath.held].iter();
        let moments = edges.map(|&edge| self.residual[STRIDE * edge + 3]);
        [
            reactions.sum::<f64>() - sheath.push(&self.assembly, &self.geometry),
            moments.sum::<f64>() * sheath.tangent.dot(&sheath.axis),
        ]
    }
}
