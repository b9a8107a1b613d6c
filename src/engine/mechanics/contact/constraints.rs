//! Contacts as constraints on the motion: geometry for the complementarity model (thesis 3.3).
//!
//! Near a configuration q the gap and the slip of a contact are linear in the displacements of its nodes,
//!
//! w_n = g + n·Σ w_m δx_m,   w_t = t·Σ w_m (x_m − x_mⁿ + δx_m),
//!
//! with the weights w of the contact points, which also distribute a force at the contact points
//! to the nodes. The forces found by the model keep their direction and weights until the model
//! computes new ones.

use super::candidates::approach;
use super::contact_system::ContactSystem;
use super::contacts::{
    ActiveContact, Bodies, CandidatePair, ContactConstraint, EdgeJacobian, PlaneContact,
};
use super::distance::{DistanceDerivatives, WEIGHT_RATES};
use super::evaluation::Motion;
use super::levers::Levers;
use super::nearest_points::{NearestPoints, separation};
use super::normal_law::NormalLaw;
use crate::mechanics::Vector3;

/// Part of a relative tangential motion that may close a gap, because normals turn. Contacts
/// missed by this estimate are later found as overlaps.
const SIDEWAYS: f64 = 0.1;

impl ContactSystem {
    /// Lists the contacts that `motions` (m) of the nodes from `positions` may close, or bring to
    /// within `margin` (m) of closing. Contacts in `earlier` are listed at any distance. Each
    /// contact starts with its force in `earlier`, or else with that of the last step.
    pub(crate) fn list_constraints(
        &mut self,
        positions: &[Vector3],
        motions: &[Vector3],
        margin: f64,
        earlier: &[ContactConstraint],
    ) {
        let slack = self.parameters().reach() + margin;
        let is_known = |place: (bool, usize, usize)| {
            let found = earlier.binary_search_by_key(&place, ContactConstraint::order);
            found.is_ok()
        };
        self.constraints.clear();
        self.candidates.motion(positions, &mut self.motion);
        let points = self.obstacles.points(positions);
        let pairs = self.candidates.pairs().iter().zip(self.candidates.gaps());
        for (candidate, (pair, last_gap)) in pairs.enumerate() {
            if pair.sign() < 0.0 {
                continue; // rigid contacts share their force as they like
            }
            let is_known = is_known((false, candidate, 0));
            let farthest = largest_relative_motion(pair, motions);
            if !is_known && last_gap - approach(pair, &self.motion) >= farthest + slack {
                continue;
            }
            let Some(nearest) = self.nearest_in_step(pair, &points, 0.0) else {
                continue;
            };
            let threshold = self.surface.threshold(pair.edges);
            let gap = nearest.distance() - self.surface.core(pair) - threshold;
            let normal = nearest.unit_normal();
            let closing = largest_approach(pair, motions, &normal) + SIDEWAYS * farthest;
            let may_touch = is_known || gap < closing + slack;
            let is_prescribed = || self.are_prescribed(&pair.nodes, &nearest.weights());
            if may_touch
                && !is_prescribed()
                && !self.surface.is_at_reflex_edge(pair, &normal, &points)
            {
                let friction = self.friction_between(pair);
                let constraint = ContactConstraint::new(
                    Bodies::Edges(candidate),
                    nearest.settled(&self.surface, pair).nodes,
                    nearest.weights(),
                    normal,
                    [gap, threshold, friction],
                );
                self.constraints.push(ContactConstraint {
                    turned: normal.cross(&self.swing_of_obstacle(pair)),
                    ..constraint
                });
                if let Some(turns) = &self.surface_turns {
                    let levers = turns.edges.of_pair(&self.surface, pair);
                    turn(&mut self.constraints, &levers, positions);
                }
            }
        }
        for (index, plane) in self.planes.iter().enumerate() {
            for surface in self.surface.nodes() {
                let (node, radius) = (surface.node, surface.radius);
                if self.is_prescribed(node) || self.surface.roots.frees_from_plane(node, index) {
                    continue;
                }
                let gap = plane.distance(&positions[node]) - radius;
                let closing = slack - plane.normal.dot(&motions[node]);
                if gap < closing || is_known((true, index, node)) {
                    self.constraints.push(ContactConstraint::new(
                        Bodies::Plane(index),
                        [node; 4],
                        [1.0, 0.0, 0.0, 0.0],
                        plane.normal,
                        [gap, radius, self.friction_over(plane, surface)],
                    ));
                    if let Some(turns) = &self.surface_turns {
                        let levers = turns.edges.of_node(node, radius);
                        turn(&mut self.constraints, &levers, positions);
                    }
                }
            }
        }
        self.warm_start(earlier);
    }

    /// Sets the initial forces of the constraints, N.
    fn warm_start(&mut self, earlier: &[ContactConstraint]) {
        let mut constraints = std::mem::take(&mut self.constraints);
        let mut known = earlier.iter().peekable();
        for constraint in &mut constraints {
            // Both lists are ordered by candidates, then by planes and their nodes.
            while known
                .next_if(|other| other.order() < constraint.order())
                .is_some()
            {}
            let same = known.next_if(|other| other.order() == constraint.order());
            constraint.force = match (same, earlier.is_empty()) {
                (Some(other), _) => {
                    constraint.touched = other.touched;
                    other.force
                }
                (None, true) => {
                    let slot = self.slot_of(constraint);
                    let force = self.multipliers.committed().get(slot);
                    let traction = self.carried_tractions.committed().get(slot);
                    let traction = traction.copied().flatten().unwrap_or_default();
                    let normal = constraint.normal;
                    let along = traction - normal * normal.dot(&traction);
                    (normal + along) * force.copied().unwrap_or(0.0)
                }
                (None, false) => Vector3::zeros(),
            };
        }
        self.constraints = constraints;
    }

    /// Largest relative motion of two rods that have candidates, for motions of all nodes, m.
    pub(crate) fn largest_relative_motion(&self, motions: &[Vector3]) -> f64 {
        let pairs = self.candidates.pairs().iter();
        pairs
            .map(|pair| largest_relative_motion(pair, motions))
            .fold(0.0, f64::max)
    }

    /// Slot for the data that a constraint keeps between steps.
    fn slot_of(&self, constraint: &ContactConstraint) -> usize {
        match constraint.bodies {
            Bodies::Edges(candidate) => candidate,
            Bodies::Plane(plane) => self.slots().over_plane(plane, constraint.nodes[0]),
        }
    }

    /// Applies the initial forces to the listed contacts.
    pub(crate) fn load_begun_forces(&mut self) {
        let mut constraints = std::mem::take(&mut self.constraints);
        for constraint in &mut constraints {
            let slot = self.slot_of(constraint);
            let (normal, traction) = (constraint.normal, self.carried_tractions.begun(slot));
            let along = traction - normal * normal.dot(&traction);
            constraint.force = (normal + along) * self.multipliers.begun(slot);
        }
        self.constraints = constraints;
    }

    /// Starts the iterations with the forces of the listed contacts, N, and with zero elsewhere.
    pub(crate) fn begin_with_forces(&mut self, forces: &[Vector3]) {
        self.multipliers.begin_without();
        for (index, force) in forces.iter().enumerate() {
            let constraint = &self.constraints[index];
            let (slot, normal) = (self.slot_of(constraint), constraint.normal);
            let pressure = force.dot(&normal);
            if pressure > 0.0 {
                self.multipliers.begin_with(slot, pressure);
                let traction = (force - normal * pressure) / pressure;
                self.carried_tractions.begin_with(slot, traction);
            }
        }
    }

    /// Gap (m) at which a listed contact rests under a normal force, N.
    pub(crate) fn rest_gap(&self, constraint: &ContactConstraint, force: f64) -> f64 {
        let [first, _, second, _] = constraint.nodes;
        let (scale, standoff) = match constraint.bodies {
            Bodies::Edges(candidate) => {
                let pair = self.candidates.pairs()[candidate];
                (self.surface.law_scale(pair.edges), self.standoff(&pair))
            }
            Bodies::Plane(_) => (constraint.threshold, 0.0),
        };
        let stiffness = self.stiffness_between(first, second);
        let law = NormalLaw::new(&self.parameters, scale, stiffness);
        if force <= law.least_force() {
            return 0.0;
        }
        law.gap_of_force(force) + standoff
    }

    /// Derivative of the forces of a listed contact with respect to the positions of its nodes,
    /// N/m, for a force of constant size that turns with the contact.
    ///
    /// Without friction, and for edges that touch between their ends, this is minus the stiffness
    /// N Δ Q⁻¹ of `distance`, which grows as edges turn through parallel.
    pub(crate) fn turning(
        &self,
        constraint: &ContactConstraint,
        positions: &[Vector3],
    ) -> EdgeJacobian {
        let mut jacobian = [[0.0; 12]; 12];
        let Bodies::Edges(candidate) = constraint.bodies else {
            return jacobian;
        };
        let pair = &self.candidates.pairs()[candidate];
        let points = self.obstacles.points(positions);
        // ∂n, and for each node w, a and ∂β.
        let (turns, weights, rates, moves) =
            match NearestPoints::of(&self.surface, pair, &points, 0.0) {
                Some(NearestPoints::Edges(closest)) => {
                    let distance = DistanceDerivatives::of(&points.of(constraint.nodes), &closest);
                    let [first, second] = distance.ratio_gradients;
                    let moves = [first, first, second, second];
                    let turns = distance.normal_jacobian;
                    (turns, distance.weights, WEIGHT_RATES, moves)
                }
                Some(NearestPoints::Rim(point)) => {
                    let derivatives = point.derivatives();
                    let (weights, rates) = (point.all_weights(), point.all_rates());
                    (derivatives.normal, weights, rates, [derivatives.ratio; 4])
                }
                Some(NearestPoints::Patch(point)) => {
                    let [over_node, ..] = point.all_weights();
                    let weights = [over_node, 0.0, 0.0, 0.0];
                    let bend = self.surface.bend_at(pair, &point, &points);
                    (
                        point.unit_normal_jacobian(&bend),
                        weights,
                        [0.0; 4],
                        [[0.0; 12]; 4],
                    )
                }
                _ => return jacobian,
            };
        let force = constraint.force;
        let pressure = force.dot(&constraint.normal);
        for (row, entries) in jacobian.iter_mut().enumerate() {
            let (node, axis) = (row / 3, row % 3);
            let (weight, rate) = (weights[node], rates[node]);
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry = pressure * weight * turns[axis][column]
                    + force[axis] * rate * moves[node][column];
            }
        }
        jacobian
    }

    /// The contacts that [`Self::list_constraints`] found.
    pub(crate) fn constraints(&self) -> &[ContactConstraint] {
        &self.constraints
    }

    /// Sets the forces of the listed contacts, N, and drops contacts that had no force in this
    /// step. A contact that had a force stays listed even if it has opened: without it the
    /// surfaces would overlap and it would be listed again, in a cycle.
    pub(crate) fn load_constraints(&mut self, forces: &[Vector3]) {
        for (constraint, force) in self.constraints.iter_mut().zip(forces) {
            constraint.force = *force;
            constraint.touched |= *force != Vector3::zeros();
        }
        self.constraints.retain(|constraint| constraint.touched);
    }

    /// Drops all constraints with their forces, and returns them.
    pub(crate) fn release_constraints(&mut self) -> Vec<ContactConstraint> {
        std::mem::take(&mut self.constraints)
    }

    /// Writes the forces of the loaded constraints as contacts, with the gaps at the present
    /// positions.
    pub(super) fn evaluate_constraints(&mut self, motion: Motion) {
        let positions = motion.positions;
        for index in 0..self.constraints.len() {
            let constraint = self.constraints[index];
            if constraint.force == Vector3::zeros() {
                continue;
            }
            let ContactConstraint {
                nodes,
                weights,
                force,
                threshold,
                ..
            } = constraint;
            let normal_force = force.dot(&constraint.normal);
            let traction = force / normal_force - constraint.normal;
            self.turning_work += force.dot(&constraint.turned);
            let turns = self.turns_at(&constraint, positions, motion.previous);
            if self.has_bodies() {
                let spun = match constraint.bodies {
                    Bodies::Edges(_) => &mut self.spun,
                    Bodies::Plane(_) => &mut self.plane_spun,
                };
                spun.push(turns.as_ref().map(|turns| turns.contact(&force)));
            }
            let tractions = match constraint.bodies {
                Bodies::Edges(_) => &mut self.tractions,
                Bodies::Plane(_) => &mut self.plane_tractions,
            };
            tractions.push(traction);
            match constraint.bodies {
                Bodies::Edges(candidate) => {
                    let mut force = std::array::from_fn(|row| weights[row / 3] * force[row % 3]);
                    if let Some(turns) = &turns {
                        let couples = turns.couples(&constraint.force);
                        let pairs = force.iter_mut().zip(couples);
                        pairs.for_each(|(own, couple)| *own += couple);
                    }
                    self.contacts.push(ActiveContact {
                        candidate,
                        nodes,
                        distance: separation(
                            &self.surface,
                            &self.candidates.pairs()[candidate],
                            &self.obstacles.points(positions),
                        )
                        .unwrap_or(f64::INFINITY),
                        threshold,
                        normal: constraint.normal,
                        normal_force,
                        force,
                        first_body: self.candidates.pairs()[candidate].first_body(),
                    });
                }
                Bodies::Plane(plane) => self.plane_contacts.push(PlaneContact {
                    node: nodes[0],
                    plane,
                    distance: self.planes[plane].distance(&positions[nodes[0]]),
                    threshold,
                    normal_force,
                    force: force.into(),
                }),
            }
        }
        self.contact_count = self.contacts.len() + self.plane_contacts.len();
    }
}

/// Lists the edges that the last constraint turns.
fn turn(constraints: &mut [ContactConstraint], levers: &Levers, positions: &[Vector3]) {
    if let Some(last) = constraints.last_mut() {
        last.turns = levers.edges.map(|lever| {
            let lever = lever?;
            let [from, to] = lever.ends.map(|end| positions[levers.nodes[end]]);
            let tangent = (to - from).normalize();
            Some((lever.edge, last.normal.cross(&tangent) * lever.arm))
        });
    }
}

/// Largest motion of a point of one edge relative to a point of the other, m.
fn largest_relative_motion(pair: &CandidatePair, motions: &[Vector3]) -> f64 {
    let corners = relative_motions(pair, motions).map(|motion| motion.norm_squared());
    corners.into_iter().fold(0.0, f64::max).sqrt()
}

/// Largest relative motion against the normal, m: an upper bound on how far the gap closes.
fn largest_approach(pair: &CandidatePair, motions: &[Vector3], normal: &Vector3) -> f64 {
    let corners = relative_motions(pair, motions).map(|motion| -motion.dot(normal));
    corners.into_iter().fold(0.0, f64::max)
}

/// Motions of the ends of one edge relative to the ends of the other, m; the relative motion of
/// any two points of the edges is between these. Vertices of obstacles do not move.
fn relative_motions(pair: &CandidatePair, motions: &[Vector3]) -> [Vector3; 4] {
    let [a, b, c, d] = pair
        .nodes
        .map(|node| motions.get(node).copied().unwrap_or_default());
    [a - c, a - d, b - c, b - d]
}
