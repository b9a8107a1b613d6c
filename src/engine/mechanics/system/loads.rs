//! External loads: dead forces, moments on edges, forces that turn with the rod.

use super::build::Assembly;
use super::events::Event;
use super::factor::Scale;
use super::follower::{FollowerForce, element_of_edge, subtract_on_edge};
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::linalg::Element;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::vertex::EdgeFrame;
use crate::mechanics::rod::{Edge, ElasticRods, RodGeometry, RodRange, STRIDE, holonomy_jacobian};
use crate::mechanics::scene::{Load, LoadKind, Scene};
use crate::mechanics::{LoadError, Matrix3, SceneError, Vector3};

/// All external loads of a scene, resolved to unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loads {
    dead: Vec<DeadLoad>,
    /// Moments on edges.
    pub moments: Vec<EdgeMoment>,
    /// Forces that turn with edges.
    pub followers: Vec<FollowerForce>,
    /// Dead forces (N) and moments (N m) on the unknowns at the present time.
    pub present: Vec<f64>,
    /// Factors of the dead loads in these sums, and whether other contributions have changed
    /// since.
    present_factors: Vec<f64>,
    has_other_external: bool,
    /// Forces (N) and moments (N m) of another solver on the unknowns; they are included from the
    /// next [`Term::drive`] on.
    external: Vec<f64>,
    /// Acceleration of gravity, with schedules, for the potential energy.
    gravity: Vec<(Vector3, Scale)>,
    /// Masses at the tips of bodies with a centre of mass away from their node: unknown along x
    /// and mass, kg.
    weights_of_tips: Vec<(usize, f64)>,
    /// Factor of each load of the scene in addition to its schedule.
    factors: Vec<f64>,
}

/// Forces that do not depend on the configuration.
#[derive(Clone, Debug)]
struct DeadLoad {
    /// Entries (unknown, force).
    entries: Vec<(usize, f64)>,
    scale: Scale,
}

/// A moment on an edge.
#[derive(Clone, Debug)]
pub(crate) struct EdgeMoment {
    /// Node at the start of the edge.
    pub start: usize,
    /// Node at its end.
    pub end: usize,
    /// Components in space, or along the two material directors and the tangent, N m.
    moment: Vector3,
    /// Whether the moment turns with the edge.
    turns: bool,
    scale: Scale,
}

impl Loads {
    /// Whether any load is a force or a moment.
    pub(crate) fn are_forces(&self) -> bool {
        !self.dead.is_empty() || !self.moments.is_empty()
    }

    /// Resolves the loads of a scene to the unknowns of its rods.
    ///
    /// # Errors
    /// [`LoadError`] names a rod, node or edge that does not exist.
    fn of(descriptions: &[Load], assembly: &Assembly) -> Result<Self, LoadError> {
        let mut loads = Self {
            present: vec![0.0; assembly.unknowns.len()],
            external: vec![0.0; assembly.unknowns.len()],
            weights_of_tips: assembly.weights_of_tips(),
            ..Self::default()
        };
        loads.factors = vec![1.0; descriptions.len()];
        for (number, load) in descriptions.iter().enumerate() {
            let mut entries = Vec::new();
            let scale = Scale::of(number, load);
            match &load.kind {
                LoadKind::Gravity { acceleration } => {
                    loads.gravity.push((*acceleration, scale.clone()));
                    for node in (0..assembly.rods.nodes).filter(|&node| !assembly.obstacle[node]) {
                        for axis in 0..3 {
                            let unknown = STRIDE * node + axis;
                            entries.push((unknown, assembly.masses[unknown] * acceleration[axis]));
                        }
                    }
                    for &(unknown, mass) in &loads.weights_of_tips {
                        let weight = acceleration * mass;
                        entries.extend((0..3).map(|axis| (unknown + axis, weight[axis])));
                    }
                }
                LoadKind::Force { rod, node, force } => {
                    let range = assembly.range_of(*rod)?;
                    if *node >= range.nodes {
                        return Err(LoadError::NoSuchNode {
                            node: *node,
                            nodes: range.nodes,
                        });
                    }
                    for axis in 0..3 {
                        entries.push((STRIDE * (range.first_node + node) + axis, force[axis]));
                    }
                }
                LoadKind::Moment { rod, edge, moment }
                | LoadKind::FollowerMoment { rod, edge, moment } => {
                    let range = assembly.range_of(*rod)?;
                    if *edge >= range.edges() {
                        return Err(LoadError::NoSuchEdge {
                            edge: *edge,
                            edges: range.edges(),
                        });
                    }
                    let start = range.first_node + edge;
                    loads.moments.push(EdgeMoment {
                        start,
                        end: range.end_of(start),
                        moment: *moment,
                        turns: matches!(load.kind, LoadKind::FollowerMoment { .. }),
                        scale: scale.clone(),
                    });
                }
                LoadKind::FollowerForce { rod, node, force } => {
                    let range = assembly.range_of(*rod)?;
                    if *node >= range.nodes {
                        return Err(LoadError::NoSuchNode {
                            node: *node,
                            nodes: range.nodes,
                        });
                    }
                    let at = range.first_node + node;
                    let beside = range.edges_at(at);
                    // At an inner node the frames of the edges on both sides have equal weight.
                    let part = 1.0 / beside.len() as f64;
                    let shares =
                        |ends: &[usize; 2]| ends.map(|end| if end == at { part } else { 0.0 });
                    loads
                        .followers
                        .extend(beside.iter().map(|ends| FollowerForce {
                            start: ends[0],
                            end: ends[1],
                            shares: shares(ends),
                            components: *force,
                            scale: scale.clone(),
                        }));
                }
                LoadKind::FollowerDistributed {
                    rod,
                    force_per_length,
                } => {
                    for edge in assembly.edges_of(*rod)? {
                        loads.followers.push(FollowerForce {
                            start: edge.start,
                            end: edge.end,
                            shares: [0.5; 2],
                            components: force_per_length * edge.natural_length,
                            scale: scale.clone(),
                        });
                    }
                }
                LoadKind::Distributed {
                    rod,
                    force_per_length,
                } => {
                    for edge in assembly.edges_of(*rod)? {
                        for node in [edge.start, edge.end] {
                            for axis in 0..3 {
                                let share = 0.5 * edge.natural_length * force_per_length[axis];
                                entries.push((STRIDE * node + axis, share));
                            }
                        }
                    }
                }
                // It is a term of its own.
                LoadKind::Drag { rod, .. } => drop(assembly.edges_of(*rod)?),
            }
            if !entries.is_empty() {
                loads.dead.push(DeadLoad { entries, scale });
            }
        }
        Ok(loads)
    }

    /// Forces (N) and moments (N m) of another solver on the unknowns.
    pub(crate) fn external(&self) -> &[f64] {
        &self.external
    }

    /// The same, to be changed.
    pub(crate) fn external_mut(&mut self) -> &mut [f64] {
        self.has_other_external = true;
        &mut self.external
    }

    /// Factor of each load of the scene in addition to its schedule.
    pub(crate) fn factors(&self) -> &[f64] {
        &self.factors
    }

    /// Potential energy of gravity of bodies for their offsets from node to centre of mass, −Σ m
    /// g·r, J.
    pub(crate) fn gravitational_energy_of_arms(&self, time: f64, unknowns: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (acceleration, scale) in &self.gravity {
            let factor = scale.at(time);
            for &(unknown, mass) in &self.weights_of_tips {
                energy -= factor * mass * acceleration.dot(&position(unknowns, unknown / STRIDE));
            }
        }
        energy
    }

    /// Potential energy of gravity of nodes, −Σ m g·x, J.
    pub(crate) fn gravitational_energy(
        &self,
        time: f64,
        masses: &[f64],
        obstacle: &[bool],
        unknowns: &[f64],
    ) -> f64 {
        let mut energy = 0.0;
        for (acceleration, scale) in &self.gravity {
            let factor = scale.at(time);
            for node in (0..obstacle.len()).filter(|&node| !obstacle[node]) {
                for axis in 0..3 {
                    let unknown = STRIDE * node + axis;
                    energy -= factor * masses[unknown] * acceleration[axis] * unknowns[unknown];
                }
            }
        }
        energy
    }
}

impl Term for Loads {
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        Ok(Self::of(&scene.loads, assembly)?)
    }

    fn kind(&self) -> Kind {
        Kind::Load
    }

    fn has_copies(&self) -> bool {
        self.moments.is_empty() && self.followers.is_empty()
    }

    fn elements(&self, _: &Assembly) -> Vec<Element> {
        let moments = self.moments.iter().map(EdgeMoment::unknowns);
        let followers = self.followers.iter().map(FollowerForce::unknowns);
        moments.chain(followers).collect()
    }

    fn drive(&mut self, time: f64, _: &mut ElasticRods, _: &mut RodGeometry) {
        let factors = self.dead.iter().map(|load| load.scale.at(time));
        let present = self.present_factors.iter().map(|factor| factor.to_bits());
        if !self.has_other_external && factors.clone().map(f64::to_bits).eq(present) {
            return;
        }
        self.has_other_external = false;
        self.present_factors.clear();
        self.present_factors.extend(factors);
        self.present.fill(0.0);
        for (load, factor) in self.dead.iter().zip(&self.present_factors) {
            for &(unknown, force) in &load.entries {
                self.present[unknown] += factor * force;
            }
        }
        for (present, external) in self.present.iter_mut().zip(&self.external) {
            *present += external;
        }
    }

    /// The potential of dead forces: their work.
    fn potential(&self, unknowns: &[f64]) -> [f64; 2] {
        let works = || (self.present.iter().zip(unknowns)).map(|(force, unknown)| force * unknown);
        [-works().sum::<f64>(), works().map(f64::abs).sum()]
    }

    /// Moments, and forces that turn with the rod, have no potential.
    fn has_potential(&self) -> bool {
        self.moments.is_empty() && self.followers.is_empty()
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        for (entry, force) in residual.iter_mut().zip(&self.present) {
            *entry -= force;
        }
        for moment in &self.moments {
            let (force, spin) = moment.force(at.time, &at.geometry.edges[moment.start]);
            for axis in 0..3 {
                residual[STRIDE * moment.end + axis] -= force[axis];
                residual[STRIDE * moment.start + axis] += force[axis];
            }
            residual[STRIDE * moment.start + 3] -= spin;
        }
        for follower in &self.followers {
            let force = follower.force(at.time, &at.geometry.edges[follower.start]);
            for (node, share) in follower.on_nodes() {
                for axis in 0..3 {
                    residual[STRIDE * node + axis] -= share * force[axis];
                }
            }
        }
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        let mut matrices = entries.elements().iter_mut();
        for (moment, matrix) in self.moments.iter().zip(&mut matrices) {
            let frame = &at.geometry.edges[moment.start];
            let source = &at.reference.tangent[moment.start];
            let (force, over_angle, spin) = moment.jacobian(at.time, source, frame);
            // Forces on the two ends are opposite.
            subtract_on_edge(matrix, [-1.0, 1.0], &force, &over_angle);
            for j in 0..3 {
                matrix[3][j] += spin[j];
                matrix[3][4 + j] -= spin[j];
            }
        }
        for (follower, matrix) in self.followers.iter().zip(&mut matrices) {
            let (force, over_angle) =
                follower.jacobian(at.time, &at.geometry.edges[follower.start]);
            subtract_on_edge(matrix, follower.shares, &force, &over_angle);
        }
    }

    /// The entries of forces that turn with edges; dead forces do not depend on the unknowns.
    fn add_sizes(&self, at: &Configuration, forces: &mut [f64]) {
        for follower in &self.followers {
            let force = follower.force(at.time, &at.geometry.edges[follower.start]);
            for (node, share) in follower.on_nodes() {
                for axis in 0..3 {
                    forces[STRIDE * node + axis] += share * force[axis].abs();
                }
            }
        }
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        let dead = self.dead.iter().map(|load| &load.scale);
        let moments = self.moments.iter().map(|moment| &moment.scale);
        let followers = self.followers.iter().map(|force| &force.scale);
        let scales = dead.chain(moments).chain(followers);
        events.extend(scales.flat_map(Scale::events));
    }

    fn scale_load(&mut self, load: usize, factor: f64) {
        self.factors[load] = factor;
        (self.dead.iter_mut().map(|load| &mut load.scale))
            .chain(self.moments.iter_mut().map(|moment| &mut moment.scale))
            .chain(self.followers.iter_mut().map(|force| &mut force.scale))
            .chain(self.gravity.iter_mut().map(|(_, scale)| scale))
            .for_each(|scale| scale.set_factor(load, factor));
    }
}

impl Assembly {
    fn range_of(&self, rod: usize) -> Result<RodRange, LoadError> {
        let found = self.rods.rods.get(rod).copied();
        found.ok_or(LoadError::NoSuchRod(rod))
    }

    /// All edges, or only those of one rod.
    pub(super) fn edges_of(&self, rod: Option<usize>) -> Result<Vec<&Edge>, LoadError> {
        let own = rod.map(|rod| self.range_of(rod)).transpose()?;
        let edges = self.rods.edges.iter();
        let is_of_rod = |start: usize| own.is_none_or(|own| own.edge_indices().contains(&start));
        Ok(edges.filter(|edge| is_of_rod(edge.start)).collect())
    }
}

impl EdgeMoment {
    /// Generalised forces of the moment m on (x_start, θ, x_end). The edge turns with the angular
    /// velocity t×ṫ + (spin) t, so the forces on its ends are ∓(m×t)/l ∓ (m·t) c and the moment on
    /// its angle is m·t, with the holonomy c of the transported frame
    /// ([`crate::mechanics::rod::vertex`]).
    pub(crate) fn force(&self, time: f64, frame: &EdgeFrame) -> (Vector3, f64) {
        let moment = self.at(time, frame);
        let spin = moment.dot(&frame.tangent);
        (
            moment.cross(&frame.tangent) / frame.length + frame.holonomy * spin,
            spin,
        )
    }

    /// The moment in space.
    fn at(&self, time: f64, frame: &EdgeFrame) -> Vector3 {
        let moment = self.moment * self.scale.at(time);
        if self.turns {
            frame.director_1 * moment.x + frame.director_2 * moment.y + frame.tangent * moment.z
        } else {
            moment
        }
    }

    /// Derivatives of the force on the end node with respect to the edge vector and the angle of
    /// the edge, and of the spin moment with respect to the edge vector; `source` is the tangent
    /// from which the frame is transported.
    ///
    /// A moment that turns with the edge ([`super::follower`]) keeps its component along the
    /// tangent, and m×t turns with the edge.
    pub(crate) fn jacobian(
        &self,
        time: f64,
        source: &Vector3,
        frame: &EdgeFrame,
    ) -> (Matrix3, Vector3, Vector3) {
        let moment = self.at(time, frame);
        let tangent = &frame.tangent;
        let inverse_length = 1.0 / frame.length;
        let across = moment.cross(tangent);
        let transported = holonomy_jacobian(source, frame) * moment.dot(tangent);
        if self.turns {
            let swing = (tangent * across.transpose() + across * tangent.transpose())
                * (-inverse_length * inverse_length);
            let about_tangent = tangent.cross(&across) * inverse_length;
            let force = swing + about_tangent * frame.holonomy.transpose() + transported;
            return (force, about_tangent, Vector3::zeros());
        }
        let projector = Matrix3::identity() - tangent * tangent.transpose();
        let spin = projector * moment * inverse_length;
        let turning = moment.cross_matrix() * projector - across * tangent.transpose();
        let force = turning * (inverse_length * inverse_length)
            + frame.holonomy * spin.transpose()
            + transported;
        (force, Vector3::zeros(), spin)
    }

    /// The unknowns x_start, θ, x_end.
    pub(crate) fn unknowns(&self) -> [usize; 12] {
        element_of_edge(self.start, self.end)
    }
}
