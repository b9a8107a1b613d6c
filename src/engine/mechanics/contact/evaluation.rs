//! Forces and Jacobians of all contacts at one configuration.

use super::body_faces::motion_jacobian;
use super::body_turns::{Spin, force_on_nodes};
use super::candidates::approach;
use super::closest_points::edge_distance;
use super::contact_system::ContactSystem;
use super::contacts::{
    ActiveContact, CandidatePair, ContactPair, EDGE, EdgeJacobian, Gradients, Linearised,
    PlaneJacobian, Proximity,
};
use super::edge_contact::{Sliding, edge_jacobian};
use super::friction::{FrictionLaw, slip};
use super::multipliers::{LinearLaw, Moved};
use super::nearest_points::NearestPoints;
use super::normal_law::NormalLaw;
use super::normal_response::NormalResponse;
use super::patch::{PatchBend, patch_jacobian};
use super::plane_contact::{NodeSliding, plane_jacobian};
use super::rim::rim_jacobian;
use super::surface_turns::TurnedBodies;
use super::tractions::{Displaced, LinearTraction, correction};
use super::turned_contacts::{Turned, with_turning};
use super::turning::Turning;
use crate::mechanics::Vector3;

/// Least gap at which a barrier is evaluated while multipliers are in use, in units of δ. The
/// force there is about 10⁴ times that of contacts at rest, so no balance is possible.
const COUNTED_PART: f64 = 1e-4;

/// The positions at which contact is evaluated.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub positions: &'a [Vector3],
    pub previous: &'a [Vector3],
    pub time_step: f64,
}

impl Motion<'_> {
    pub(crate) fn velocity(&self, node: usize) -> Vector3 {
        (self.positions[node] - self.previous[node]) / self.time_step
    }

    /// The friction law, if the coefficient is positive and the time step finite.
    pub(crate) fn friction(&self, coefficient: f64, slip_tolerance: f64) -> Option<FrictionLaw> {
        (coefficient > 0.0 && self.time_step.is_finite()).then_some(FrictionLaw {
            coefficient,
            slip_tolerance,
            grain: None,
        })
    }
}

/// A candidate pair whose bodies are within reach of each other.
struct TouchingPair {
    candidate: usize,
    nodes: [Vector3; 4],
    nearest: NearestPoints,
    gap: f64,
    law: NormalLaw,
    response: NormalResponse,
    sliding: Option<Sliding>,
    /// Rotation of the surfaces, if friction acts at them.
    turning: Option<Turning>,
    /// Rotation of its free bodies, if there is friction.
    spin: Option<Spin>,
    /// Relative velocity of the contact points along the surfaces, m/s; zero without friction.
    slip: Vector3,
    /// Friction per normal force.
    traction: Vector3,
    /// Force on the four nodes, N.
    force: [f64; 12],
    /// Sign: −1 for a counter-pair.
    sign: f64,
}

/// Initial values of the linearised laws of a contact.
pub(super) struct Touch<'a> {
    /// Rotation of the surfaces, if friction acts at them, and the positions of all nodes, m.
    pub turning: Option<(&'a Turning, &'a [Vector3])>,
    /// Rotation of free bodies, if there is friction.
    pub spin: Option<Spin>,
    pub gap: f64,
    pub law: NormalLaw,
    pub response: NormalResponse,
    /// Friction law, and the size of the step, s.
    pub friction: Option<(FrictionLaw, f64)>,
    pub normal: Vector3,
    pub slip: Vector3,
    pub traction: Vector3,
}

impl ContactSystem {
    /// Finds the active contacts at `positions` and evaluates energy, forces and Jacobians.
    ///
    /// Friction acts on the velocity (`positions` − `previous`)/`time_step`, and is omitted if
    /// `time_step` is infinite (statics).
    ///
    /// Centrelines that cross (Δ = 0) have no direction of separation. Their forces are NaN, and
    /// the line search rejects them.
    pub fn evaluate(&mut self, positions: &[Vector3], previous: &[Vector3], time_step: f64) {
        self.evaluate_contacts(positions, previous, time_step, true);
    }

    /// Like [`Self::evaluate`] but without Jacobians, for line searches; `Self::jacobians` and
    /// `Self::plane_jacobians` are empty afterwards.
    pub fn evaluate_forces(&mut self, positions: &[Vector3], previous: &[Vector3], time_step: f64) {
        self.evaluate_contacts(positions, previous, time_step, false);
    }

    fn evaluate_contacts(
        &mut self,
        positions: &[Vector3],
        previous: &[Vector3],
        time_step: f64,
        with_jacobians: bool,
    ) {
        self.clear_results();
        let (positions, previous) = (self.placed(positions), self.placed(previous));
        let positions = positions.as_ref();
        let motion = Motion {
            positions,
            previous: &previous,
            time_step,
        };
        if !self.active_laws.is_empty() {
            return self.evaluate_active_laws(motion, with_jacobians);
        }
        if self.parameters.is_complementarity() {
            return self.evaluate_constraints(motion);
        }
        self.evaluate_pairs(motion, with_jacobians);
        self.evaluate_planes(motion, with_jacobians);
        if with_jacobians && self.multipliers.in_use() {
            self.iterate.linearised_at(positions);
            if let Some(turns) = &mut self.surface_turns {
                turns.linearised();
            }
            self.body_turns.mark();
        }
    }

    pub(super) fn clear_results(&mut self) {
        self.contacts.clear();
        self.tractions.clear();
        self.jacobians.clear();
        self.linear_corrections.clear();
        self.plane_contacts.clear();
        self.plane_tractions.clear();
        self.plane_jacobians.clear();
        self.plane_linear_corrections.clear();
        self.without_force.clear();
        self.turned.clear();
        self.spun.clear();
        self.plane_spun.clear();
        self.energy = 0.0;
        self.turning_work = 0.0;
        self.contact_count = 0;
    }

    fn evaluate_pairs(&mut self, motion: Motion, with_jacobians: bool) {
        let parameters = self.parameters;
        let (tolerance, reach) = (parameters.distance_tolerance, parameters.reach());
        self.candidates.motion(motion.positions, &mut self.motion);
        let farthest = 2.0 * self.motion.iter().copied().fold(0.0, f64::max);
        for candidate in 0..self.candidates.pairs().len() {
            let earlier = self.candidates.gaps()[candidate];
            let loaded = with_jacobians && self.multipliers.is_loaded(candidate);
            // Most candidates are out of reach whatever the direction in which their nodes have
            // moved so far.
            if !loaded && earlier - farthest >= reach {
                continue;
            }
            let pair = self.candidates.pairs()[candidate];
            if !loaded && earlier - approach(&pair, &self.motion) >= reach {
                continue;
            }
            let points = self.obstacles.points(motion.positions);
            let threshold = self.surface.threshold(pair.edges);
            let smoothing = parameters.smoothing(threshold);
            let Some(nearest) = self.nearest_in_step(&pair, &points, smoothing) else {
                continue;
            };
            let pair = nearest.settled(&self.surface, &pair);
            let nodes = points.of(pair.nodes);
            let core = self.surface.core(&pair);
            let gap = nearest.distance() - core - threshold - self.standoff(&pair);
            if !loaded && gap >= reach {
                continue;
            }
            let (weights, normal) = (nearest.weights(), nearest.normal());
            if self.surface.is_at_reflex_edge(&pair, &normal, &points) {
                continue;
            }
            if self.are_prescribed(&pair.nodes, &weights) {
                self.without_force.push(Proximity {
                    pair: ContactPair::Edges(pair.edges),
                    distance: true_distance(&pair, &nodes, &nearest) - core,
                    threshold,
                });
                continue;
            }
            let stiffness = self.stiffness_between(pair.nodes[0], pair.nodes[3]);
            let scale = self.surface.law_scale(pair.edges);
            let law = NormalLaw::new(&parameters, scale, stiffness);
            let response = law.response(self.counted_gap(gap));
            if pair.sign() < 0.0 && !response.energy.is_finite() {
                continue; // so is what it counts against, beyond a barrier
            }
            let coefficient = self.surface.friction_between(pair.edges);
            let friction = motion.friction(
                coefficient.unwrap_or(parameters.friction),
                parameters.slip_tolerance,
            );
            let sliding = friction.map(|law| self.sliding(law, &pair, &nodes, &nearest, &motion));
            let turning = sliding.and_then(|_| {
                let positions = [motion.positions, motion.previous];
                self.turning_of_pair(&pair, &nearest, positions, motion.time_step)
            });
            let spin = sliding.and_then(|_| self.spin_of_pair(&pair, &motion));
            let slip = sliding.map_or_else(Vector3::zeros, |sliding| {
                let of_centrelines = sliding.contact_velocity(&weights, &normal);
                let of_surfaces = with_turning(of_centrelines, turning.as_ref(), &normal);
                let spun = spin.map_or_else(Vector3::zeros, |spin| spin.velocity(&normal));
                slip(&normal, &(of_surfaces + spun))
            });
            let traction = friction.map_or_else(Vector3::zeros, |law| law.traction_of_slip(&slip));
            let sign = pair.sign();
            let pressed = sign * response.force;
            let rubbed = traction * (pressed * normal.norm());
            if let Some(sliding) = &sliding {
                let power = rubbed.dot(&sliding.velocity_of_swing(&normal));
                self.turning_work += power * motion.time_step / self.obstacle_pace;
            }
            let force = force_on_nodes(spin.as_ref(), &weights, &normal, pressed, &traction);
            self.contacts.push(ActiveContact {
                candidate,
                nodes: pair.nodes,
                // The reported distance is the true one, without smoothing.
                distance: true_distance(&pair, &nodes, &nearest) - core,
                threshold,
                normal,
                normal_force: pressed,
                force,
                first_body: pair.first_body(),
            });
            self.tractions.push(traction);
            if self.has_bodies() {
                (self.spun).push(spin.map(|spin| spin.contact(&normal, &rubbed)));
            }
            if let Some(turning) = &turning {
                let bodies = TurnedBodies::Pair(candidate);
                self.push_turned(bodies, turning, &normal, &rubbed);
            }
            if with_jacobians {
                let touching = TouchingPair {
                    candidate,
                    nodes,
                    nearest,
                    gap,
                    law,
                    response,
                    sliding,
                    turning,
                    spin,
                    slip,
                    traction,
                    force,
                    sign,
                };
                self.linearize_pair(&touching, motion.positions);
            }
            self.energy += sign * response.energy;
            self.contact_count += usize::from(gap < tolerance && sign > 0.0);
        }
    }

    /// The sliding of a settled pair in the step.
    pub(super) fn sliding(
        &self,
        law: FrictionLaw,
        pair: &CandidatePair,
        nodes: &[Vector3; 4],
        nearest: &NearestPoints,
        motion: &Motion,
    ) -> Sliding {
        Sliding {
            law,
            velocities: self.velocities(pair, nodes, nearest, motion),
            swing: self.swing_of_obstacle(pair) * (self.obstacle_pace / motion.time_step),
            time_step: motion.time_step,
        }
    }

    /// Velocities of the nodes and vertices of a settled pair in the step, m/s; for a curved face,
    /// of points over its vertices at the height of the surface.
    pub(super) fn velocities(
        &self,
        pair: &CandidatePair,
        nodes: &[Vector3; 4],
        nearest: &NearestPoints,
        motion: &Motion,
    ) -> [Vector3; 4] {
        let obstacle = self.surface.obstacle_of(pair.edges[1]);
        if obstacle.is_some_and(|obstacle| !self.obstacles.moves(obstacle)) {
            return std::array::from_fn(|k| match motion.previous.get(pair.nodes[k]) {
                Some(before) => (nodes[k] - before) / motion.time_step,
                None => Vector3::zeros(),
            });
        }
        let at_start = self.obstacles.points_at_start(motion.previous);
        let (mut now, mut before) = (*nodes, at_start.of(pair.nodes));
        if let NearestPoints::Patch(foot) = nearest {
            let points = self.obstacles.points(motion.positions);
            self.surface.raise(&mut now, foot, &points);
            self.surface.raise(&mut before, foot, &at_start);
        }
        std::array::from_fn(|k| {
            let moved = now[k] - before[k];
            if self.is_of_rod(pair.nodes[k]) {
                moved / motion.time_step
            } else {
                moved * self.obstacle_pace / motion.time_step
            }
        })
    }

    /// Adds the Jacobian of a pair, and the difference between its force and that of the
    /// linearised laws.
    fn linearize_pair(&mut self, pair: &TouchingPair, positions: &[Vector3]) {
        let slot = pair.candidate;
        let sliding = pair.sliding.as_ref();
        let (weights, normal) = (pair.nearest.weights(), pair.nearest.normal());
        let touch = Touch {
            turning: pair.turning.as_ref().map(|turning| (turning, positions)),
            spin: pair.spin,
            gap: pair.gap,
            law: pair.law,
            response: pair.response,
            friction: sliding.map(|sliding| (sliding.law, sliding.time_step)),
            normal,
            slip: pair.slip,
            traction: pair.traction,
        };
        let (pressure, friction) = self.linear_laws(slot, &touch, |system| {
            // Vertices of obstacles do not count, so the face on which a node is does not matter.
            let nodes = &system.candidates.pairs()[slot].nodes;
            system.iterate.moved(nodes, &weights, &pair.nodes)
        });
        let carries = self.multipliers.in_use();
        let is_known = self.multipliers.is_known(slot, pressure.tangent.force);
        let turns = !carries || self.iterate.moved_slightly || is_known;
        let bend = self.bend_of(pair, turns, positions);
        if let (Some(turning), Some(sliding)) = (&pair.turning, sliding) {
            let turned = Turned {
                turning,
                sliding,
                motion: &pair.nearest.motion(&pair.nodes, turns, &bend),
                turns,
                sign: pair.sign,
                force: (pair.response.force, pair.traction),
            };
            if carries {
                let second = self.candidates.pairs()[slot].edges[1];
                let rods = 2 - usize::from(self.surface.obstacle_of(second).is_some());
                self.compare_with_last(slot, rods, &pressure, &friction);
            }
            self.linearize_turned(slot, &turned, &pressure, &friction);
            self.jacobians.push([[0.0; 12]; 12]);
            self.linear_corrections.push([0.0; 12]);
            return;
        }
        let second = self.candidates.pairs()[slot].edges[1];
        let is_at_obstacle = self.surface.obstacle_of(second).is_some();
        if let (Some(spin), Some(sliding)) = (&pair.spin, sliding) {
            let place = match &pair.nearest {
                NearestPoints::Face(foot) if !is_at_obstacle => {
                    foot.motion_with(&pair.nodes, turns)
                }
                nearest => nearest.motion(&pair.nodes, turns, &bend),
            };
            if carries {
                let rods = if is_at_obstacle { 1 } else { 2 };
                self.compare_with_last(slot, rods, &pressure, &friction);
            }
            let laws = (&pressure, &friction);
            let force = (pair.response.force, pair.traction);
            let spun = self.linearize_spun((slot, spin), &place, force, laws, sliding);
            if let Some(last) = self.spun.last_mut() {
                *last = spun;
            }
            self.jacobians.push([[0.0; 12]; 12]);
            self.push_correction(pair, (&pressure, &friction));
            return;
        }
        let (gap_gradient, traction_gradient) = match &pair.nearest {
            NearestPoints::Edges(closest) => self.push_jacobian(edge_jacobian(
                &pair.nodes,
                closest,
                &pressure.tangent,
                sliding.map(|sliding| (sliding, friction.slip)),
                turns,
                is_at_obstacle,
            )),
            NearestPoints::Face(foot) if !is_at_obstacle => {
                let motion = foot.motion_with(&pair.nodes, turns);
                self.push_jacobian(motion_jacobian(&motion, &pressure.tangent))
            }
            NearestPoints::Face(_) => {
                let sliding = sliding.map(|sliding| NodeSliding {
                    law: sliding.law,
                    velocity: sliding.contact_velocity(&weights, &normal),
                    time_step: sliding.time_step,
                });
                let sliding = sliding.as_ref().map(|sliding| (sliding, friction.slip));
                self.push_of_first_node(plane_jacobian(&normal, &pressure.tangent, sliding))
            }
            NearestPoints::Patch(point) => {
                let sliding = sliding.map(|sliding| (sliding, friction.slip));
                self.push_of_first_node(patch_jacobian(point, &pressure.tangent, sliding, &bend))
            }
            NearestPoints::Rim(point) => {
                let sliding = sliding.map(|sliding| (sliding, friction.slip));
                self.push_jacobian(rim_jacobian(point, &pressure.tangent, sliding, turns))
            }
        };
        if pair.sign < 0.0 {
            let entries = self.jacobians.last_mut().into_iter().flatten().flatten();
            entries.for_each(|entry| *entry = -*entry);
        }
        if carries {
            let rods = if is_at_obstacle { 1 } else { 2 };
            self.compare_with_last(slot, rods, &pressure, &friction);
            self.multipliers.keep(slot, &pressure, &gap_gradient);
            self.carried_tractions
                .keep(slot, &friction, &traction_gradient);
        }
        self.push_correction(pair, (&pressure, &friction));
    }

    /// Stores the Jacobian of a pair, and returns the derivatives of its gap and of its friction
    /// per normal force.
    fn push_jacobian(&mut self, of_pair: Linearised<EdgeJacobian>) -> Gradients {
        self.jacobians.push(of_pair.jacobian);
        (of_pair.gap_gradient, of_pair.traction_gradient)
    }

    /// Like [`Self::push_jacobian`] for a contact of one node, padded to four nodes; the other three
    /// are prescribed.
    fn push_of_first_node(&mut self, of_node: Linearised<PlaneJacobian>) -> Gradients {
        let index = self.jacobians.len();
        self.jacobians.resize(index + 1, [[0.0; 12]; 12]);
        for (row, entries) in self.jacobians[index].iter_mut().zip(&of_node.jacobian) {
            row[..3].copy_from_slice(entries);
        }
        (of_node.gap_gradient, of_node.traction_gradient)
    }

    /// How the foot of a node on a curved face moves, if the contact `turns`.
    fn bend_of(&self, pair: &TouchingPair, turns: bool, positions: &[Vector3]) -> PatchBend {
        match &pair.nearest {
            NearestPoints::Patch(foot) if turns => {
                let points = self.obstacles.points(positions);
                let candidate = &self.candidates.pairs()[pair.candidate];
                self.surface.bend_at(candidate, foot, &points)
            }
            _ => PatchBend::none(),
        }
    }

    /// Adds the difference between the forces of a pair on its nodes and those of its linear laws.
    fn push_correction(&mut self, pair: &TouchingPair, laws: (&LinearLaw, &LinearTraction)) {
        let (weights, normal) = (pair.nearest.weights(), pair.nearest.normal());
        let with = |force: f64, traction: &Vector3| {
            let pressed = pair.sign * force;
            force_on_nodes(pair.spin.as_ref(), &weights, &normal, pressed, traction)
        };
        let corrected = correction(laws.0, laws.1, pair.force, with);
        self.linear_corrections.push(corrected);
    }

    /// Linearises the laws of a slot at its multipliers; `moved` are the displacements of its
    /// nodes.
    pub(super) fn linear_laws(
        &self,
        slot: usize,
        touch: &Touch,
        moved: impl Fn(&Self) -> Moved,
    ) -> (LinearLaw, LinearTraction) {
        let at_present = LinearTraction::at_present(touch.slip, touch.traction);
        if !self.multipliers.in_use() {
            let pressure = LinearLaw {
                tangent: touch.response,
                force: touch.response.force,
            };
            return (pressure, at_present);
        }
        let moved = moved(self);
        let pressure = self
            .multipliers
            .linear_law(slot, touch.gap, &touch.law, &moved);
        let force = pressure.tangent.force;
        let friction = match touch.friction {
            Some((law, time_step)) if force > 0.0 => {
                let (normal, slip) = (&touch.normal, &touch.slip);
                let turned = touch
                    .turning
                    .map(|(turning, now)| self.turned_since(turning, now));
                let (inertia, displaced) = match &turned {
                    Some((mobility, row)) => {
                        let both = 1.0 / moved.inertia + mobility;
                        (1.0 / both, Displaced::All(row))
                    }
                    None => match touch.spin {
                        Some(spin) => (moved.inertia, Displaced::Spun(&moved, spin.moved)),
                        None => (moved.inertia, Displaced::Nodes(&moved)),
                    },
                };
                let resistance = inertia * time_step / force;
                self.carried_tractions
                    .linear_law(slot, &law, normal, slip, displaced, resistance)
            }
            _ => at_present,
        };
        (pressure, friction)
    }

    /// Records the change of the force of a slot since the last step, with the number of its rods.
    pub(super) fn compare_with_last(
        &mut self,
        slot: usize,
        rods: usize,
        pressure: &LinearLaw,
        friction: &LinearTraction,
    ) {
        let traction = self.carried_tractions.committed()[slot];
        let before = (
            self.multipliers.committed()[slot],
            traction.unwrap_or_else(Vector3::zeros),
        );
        self.iterate
            .compare(rods, before, (pressure.tangent.force, friction.value));
    }

    /// The gap at which forces are evaluated, m. Iterations with multipliers may pass through a
    /// barrier before they reach the solution in front of it, and the force there would not be
    /// finite.
    pub(super) fn counted_gap(&self, gap: f64) -> f64 {
        if self.parameters.is_barrier() && self.multipliers.in_use() {
            gap.max(COUNTED_PART * self.parameters.distance_tolerance)
        } else {
            gap
        }
    }
}

/// Distance of a pair without smoothing, m.
fn true_distance(pair: &CandidatePair, nodes: &[Vector3; 4], nearest: &NearestPoints) -> f64 {
    match pair.side {
        EDGE => edge_distance(nodes),
        _ => nearest.distance(),
    }
}
