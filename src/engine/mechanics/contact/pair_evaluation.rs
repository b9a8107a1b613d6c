//! Forces and Jacobians of the contacts of rods with each other, with obstacles and bodies at one
//! configuration.

use super::body_faces::motion_jacobian;
use super::body_turns::force_on_nodes;
use super::candidates::approach;
use super::closest_points::edge_distance;
use super::contact_system::ContactSystem;
use super::contacts::{
    ActiveContact, CandidatePair, ContactPair, EDGE, EdgeJacobian, Gradients, Linearised,
    PlaneJacobian, Proximity,
};
use super::edge_contact::{Sliding, edge_jacobian};
use super::evaluated::{EvaluatedPair, Rotation};
use super::evaluation::{Motion, Request, Touch};
use super::friction::{FrictionLaw, slip};
use super::multipliers::LinearLaw;
use super::nearest_points::NearestPoints;
use super::normal_law::NormalLaw;
use super::patch::{PatchBend, patch_jacobian};
use super::plane_contact::{NodeSliding, plane_jacobian};
use super::rim::rim_jacobian;
use super::surface_turns::TurnedBodies;
use super::tractions::{LinearTraction, correction};
use super::turned_contacts::{Turned, with_turning};
use crate::mechanics::Vector3;

impl ContactSystem {
    /// Evaluates the contacts of candidate pairs.
    pub(super) fn evaluate_pairs(&mut self, motion: &Motion, request: Request) {
        let is_known = request == Request::Jacobians;
        let mut farthest = 0.0;
        if !is_known {
            self.evaluated.clear();
            self.candidates.motion(motion.positions, &mut self.motion);
            farthest = 2.0 * self.motion.iter().copied().fold(0.0, f64::max);
        }
        let mut known = std::mem::take(&mut self.evaluated);
        let (mut next, mut rotation) = (0, Rotation::default());
        for candidate in 0..self.candidates.pairs().len() {
            let own = known
                .get(next)
                .filter(|own| is_known && own.candidate == candidate);
            if let Some(own) = own {
                next += 1;
                self.turn_pair(
                    &mut rotation,
                    own.sliding.as_ref(),
                    &own.pair,
                    &own.nearest,
                    motion,
                );
                self.add_pair(own, &rotation, motion);
                self.linearize_pair(own, &rotation, motion.positions);
                continue;
            }
            let loaded = request.has_jacobians() && self.multipliers.is_loaded(candidate);
            if !loaded && (is_known || self.is_far(candidate, farthest)) {
                continue;
            }
            let Some(pair) = self.evaluated_pair(candidate, motion, loaded, &mut rotation) else {
                continue;
            };
            self.add_pair(&pair, &rotation, motion);
            if request.has_jacobians() {
                self.linearize_pair(&pair, &rotation, motion.positions);
            } else {
                known.push(pair);
            }
        }
        if is_known {
            known.clear();
        }
        self.evaluated = known;
    }

    /// Sets how the bodies of a settled pair turn in a step with friction.
    fn turn_pair(
        &self,
        rotation: &mut Rotation,
        sliding: Option<&Sliding>,
        pair: &CandidatePair,
        nearest: &NearestPoints,
        motion: &Motion,
    ) {
        if self.surface_turns.is_none() && !self.has_bodies() {
            return;
        }
        let positions = [motion.positions, motion.previous];
        rotation.turning =
            sliding.and_then(|_| self.turning_of_pair(pair, nearest, positions, motion.time_step));
        rotation.spin = sliding.and_then(|_| self.spin_of_pair(pair, motion));
    }

    /// Whether a candidate is out of reach whatever the direction in which its nodes have moved
    /// since the candidates were built; nodes approach by at most `farthest`, m.
    fn is_far(&self, candidate: usize, farthest: f64) -> bool {
        let reach = self.parameters.reach();
        let (earlier, pair) = (
            self.candidates.gaps()[candidate],
            &self.candidates.pairs()[candidate],
        );
        earlier - farthest >= reach || earlier - approach(pair, &self.motion) >= reach
    }

    /// A candidate pair with its force, and its `rotation`; `None` if it has none, or if it is out of
    /// reach and not `loaded`.
    fn evaluated_pair(
        &mut self,
        candidate: usize,
        motion: &Motion,
        loaded: bool,
        rotation: &mut Rotation,
    ) -> Option<EvaluatedPair> {
        let parameters = self.parameters;
        let pair = self.candidates.pairs()[candidate];
        let points = self.obstacles.points(motion.positions);
        let threshold = self.surface.threshold(pair.edges);
        let smoothing = parameters.smoothing(threshold);
        let nearest = self.nearest_in_step(&pair, &points, smoothing)?;
        let pair = nearest.settled(&self.surface, &pair);
        let nodes = points.of(pair.nodes);
        let core = self.surface.core(&pair);
        let gap = nearest.distance() - core - threshold - self.standoff(&pair);
        if !loaded && gap >= parameters.reach() {
            return None;
        }
        let (weights, normal) = (nearest.weights(), nearest.normal());
        if self.surface.is_at_reflex_edge(&pair, &normal, &points) {
            return None;
        }
        let distance = true_distance(&pair, &nodes, &nearest) - core;
        if self.are_prescribed(&pair.nodes, &weights) {
            self.without_force.push(Proximity {
                pair: ContactPair::Edges(pair.edges),
                distance,
                threshold,
            });
            return None;
        }
        let stiffness = self.stiffness_between(pair.nodes[0], pair.nodes[3]);
        let scale = self.surface.law_scale(pair.edges);
        let law = NormalLaw::new(&parameters, scale, stiffness);
        let response = law.response(self.counted_gap(gap));
        let sign = pair.sign();
        if sign < 0.0 && !response.energy.is_finite() {
            return None; // so is what it counts against, beyond a barrier
        }
        let coefficient = self.friction_between(&pair);
        let friction = motion.friction(coefficient, parameters.slip_tolerance);
        let sliding = friction.map(|law| self.sliding(law, &pair, &nodes, &nearest, motion));
        self.turn_pair(rotation, sliding.as_ref(), &pair, &nearest, motion);
        let Rotation { turning, spin } = rotation;
        let slip = sliding.map_or_else(Vector3::zeros, |sliding| {
            let of_centrelines = sliding.contact_velocity(&weights, &normal);
            let of_surfaces = with_turning(of_centrelines, turning.as_ref(), &normal);
            let spun = (spin.as_ref()).map_or_else(Vector3::zeros, |spin| spin.velocity(&normal));
            slip(&normal, &(of_surfaces + spun))
        });
        let traction = friction.map_or_else(Vector3::zeros, |law| law.traction_of_slip(&slip));
        let pressed = sign * response.force;
        Some(EvaluatedPair {
            candidate,
            pair,
            nodes,
            nearest,
            distance,
            threshold,
            gap,
            law,
            response,
            sliding,
            slip,
            traction,
            force: force_on_nodes(spin.as_ref(), &weights, &normal, pressed, &traction),
            sign,
        })
    }

    /// Adds the force and the energy of a pair.
    fn add_pair(&mut self, evaluated: &EvaluatedPair, rotation: &Rotation, motion: &Motion) {
        let EvaluatedPair {
            candidate,
            pair,
            response,
            traction,
            sign,
            ..
        } = *evaluated;
        let normal = evaluated.nearest.normal();
        let pressed = sign * response.force;
        let rubbed = traction * (pressed * normal.norm());
        if let Some(sliding) = &evaluated.sliding {
            let power = rubbed.dot(&sliding.velocity_of_swing(&normal));
            self.turning_work += power * motion.time_step / self.obstacle_pace;
        }
        self.contacts.push(ActiveContact {
            candidate,
            nodes: pair.nodes,
            distance: evaluated.distance,
            threshold: evaluated.threshold,
            normal,
            normal_force: pressed,
            force: evaluated.force,
            first_body: pair.first_body(),
        });
        self.tractions.push(traction);
        if self.has_bodies() {
            let spun = rotation.spin.map(|spin| spin.contact(&normal, &rubbed));
            self.spun.push(spun);
        }
        if let Some(turning) = &rotation.turning {
            let bodies = TurnedBodies::Pair(candidate);
            self.push_turned(bodies, turning, &normal, &rubbed);
        }
        self.energy += sign * response.energy;
        let is_counted = evaluated.gap < self.parameters.distance_tolerance && sign > 0.0;
        self.contact_count += usize::from(is_counted);
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
    fn linearize_pair(&mut self, pair: &EvaluatedPair, rotation: &Rotation, positions: &[Vector3]) {
        let slot = pair.candidate;
        let sliding = pair.sliding.as_ref();
        let (weights, normal) = (pair.nearest.weights(), pair.nearest.normal());
        let touch = Touch {
            turning: (rotation.turning.as_ref()).map(|turning| (turning, positions)),
            spin: rotation.spin,
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
        if let (Some(turning), Some(sliding)) = (&rotation.turning, sliding) {
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
        if let (Some(spin), Some(sliding)) = (&rotation.spin, sliding) {
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
            self.push_correction(pair, rotation, (&pressure, &friction));
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
        self.push_correction(pair, rotation, (&pressure, &friction));
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
    fn bend_of(&self, pair: &EvaluatedPair, turns: bool, positions: &[Vector3]) -> PatchBend {
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
    fn push_correction(
        &mut self,
        pair: &EvaluatedPair,
        rotation: &Rotation,
        laws: (&LinearLaw, &LinearTraction),
    ) {
        let (weights, normal) = (pair.nearest.weights(), pair.nearest.normal());
        let with = |force: f64, traction: &Vector3| {
            let pressed = pair.sign * force;
            force_on_nodes(rotation.spin.as_ref(), &weights, &normal, pressed, traction)
        };
        let corrected = correction(laws.0, laws.1, pair.force, with);
        self.linear_corrections.push(corrected);
    }
}

/// Distance of a pair without smoothing, m.
fn true_distance(pair: &CandidatePair, nodes: &[Vector3; 4], nearest: &NearestPoints) -> f64 {
    match pair.side {
        EDGE => edge_distance(nodes),
        _ => nearest.distance(),
    }
}
