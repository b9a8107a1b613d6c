//! The joints and bodies of a scene whose rods are numbered: who owns which position, and what bodies weigh.

use super::Assembly;
use super::joints::JointPlan;
use crate::linalg::UNUSED;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{RodNode, Scene};
use crate::mechanics::{JointError, SceneError, Vector3};

impl Assembly {
    /// Joins the rods, which have their nodes, clamps and ghost edges, and lets them carry their bodies.
    ///
    /// # Errors
    /// [`SceneError::Joint`] where clamps hold what joints hold, or a body is none.
    pub(super) fn join(&mut self, scene: &Scene, plan: &JointPlan) -> Result<(), SceneError> {
        let number = |at: &RodNode| self.rods.rods[at.rod].first_node + at.node;
        let named = |at: &RodNode, reason: JointError| {
            let joint = scene.joints.iter().find(|joint| joint.nodes.contains(at));
            let body = scene.bodies.iter().find(|body| body.at == *at);
            let name = joint
                .map(|joint| &joint.name)
                .or(body.map(|body| &body.name));
            SceneError::Joint {
                name: name.cloned().unwrap_or_default(),
                reason,
            }
        };
        let mut points = Vec::new();
        for group in &plan.points {
            let is_held = |at: &&RodNode| self.held[STRIDE * number(at)];
            let mut clamped = group.iter().filter(is_held);
            let owner = clamped.next().unwrap_or(&group[0]);
            if let Some(other) = clamped.next() {
                let [first, second] = [owner, other].map(|at| scene.rods[at.rod].name.clone());
                return Err(named(other, JointError::TwoClamps { first, second }));
            }
            let others = group.iter().filter(|at| *at != owner);
            points.extend(others.map(|at| [number(at), number(owner)]));
        }
        for [node, owner] in &points {
            let [own, of_owner] = [node, owner].map(|node| STRIDE * node..STRIDE * node + 3);
            self.unknowns.copy_within(of_owner.clone(), own.start);
            self.velocity.copy_within(of_owner.clone(), own.start);
            self.held.copy_within(of_owner, own.start);
        }
        for (number, planned) in plan.frames.iter().enumerate() {
            let at = planned.nodes[0];
            for at in &planned.nodes {
                let clamps = scene.clamps.iter();
                if scene.rods[at.rod].held {
                    return Err(named(at, JointError::HeldRod));
                }
                if clamps
                    .into_iter()
                    .any(|clamp| (clamp.rod, clamp.node) == (at.rod, at.node) && clamp.holds_frame)
                {
                    let rod = scene.rods[at.rod].name.clone();
                    return Err(named(at, JointError::ClampedFrame { rod }));
                }
            }
            let frame = &mut self.joints.frames[number];
            frame.node = self.rods.rods[at.rod].first_node + at.node;
            frame.element = self.rods.elements.len();
            self.rods.elements.push([UNUSED; 12]);
            let slot = frame.first_unknown;
            self.held[slot..slot + 3].fill(planned.hinge.is_some());
            self.held[slot + 3] = planned.hinge.is_none();
            let Some(inertia) = planned.inertia else {
                continue;
            };
            let body = scene
                .bodies
                .iter()
                .find(|body| body.inertia.is_some() && planned.nodes.contains(&body.at));
            let body = body.expect("the plan took the inertia from it");
            let borne = |(ghost, _): &&(usize, _)| {
                let of_ghost = |edge: usize| edge == self.rods.nodes + ghost;
                let mut vertices = self.rods.vertices.iter();
                vertices.any(|vertex| {
                    let (here, real) = if of_ghost(vertex.before) {
                        (true, vertex.after)
                    } else {
                        (of_ghost(vertex.after), vertex.before)
                    };
                    here && self.locate(real).0 == body.at.rod
                })
            };
            let ghosts = self.joints.frames[number].ghosts.iter();
            let placed = { ghosts }.find(borne).expect("a rod bears the body").1;
            let axes = [
                placed.director,
                placed.tangent.cross(&placed.director),
                placed.tangent,
            ];
            let first = slot + STRIDE;
            let length = self.joints.frames[number].length;
            self.joints.frames[number].body = Some((first, axes));
            let sum: f64 = inertia.iter().sum();
            for (k, moment) in inertia.iter().enumerate() {
                let tip = first + STRIDE * k;
                let mass = (0.5 * sum - moment) / (length * length);
                self.masses[tip..tip + 3].fill(mass);
                self.held[tip..tip + STRIDE].fill(true);
            }
        }
        for body in &scene.bodies {
            let check = |at: &RodNode| {
                let nodes = scene.rods.get(at.rod).map_or(0, |rod| rod.centreline.len());
                (at.node < nodes)
                    .then_some(())
                    .ok_or(JointError::NoSuchNode {
                        node: at.node,
                        nodes,
                    })
            };
            check(&body.at).map_err(|reason| named(&body.at, reason))?;
            let unknown = STRIDE * (self.rods.rods[body.at.rod].first_node + body.at.node);
            for mass in &mut self.masses[unknown..unknown + 3] {
                *mass += body.mass;
            }
        }
        self.joints.points = points;
        self.start_rotations(scene);
        let mut unknowns = std::mem::take(&mut self.unknowns);
        self.joints.complete(&mut unknowns);
        self.unknowns = unknowns;
        Ok(())
    }

    /// Lets frames and bodies turn at first as the rods that bear them begin to move.
    fn start_rotations(&mut self, scene: &Scene) {
        for number in 0..self.joints.frames.len() {
            let frame = &self.joints.frames[number];
            let Some((first, axes)) = frame.body else {
                continue;
            };
            let (rod, _) = self.locate(frame.node);
            let spin = scene.rods[rod].angular_velocity;
            let slot = frame.first_unknown;
            for (k, axis) in axes.iter().enumerate() {
                let velocity: Vector3 = spin.cross(axis) * frame.length;
                let tip = first + STRIDE * k;
                self.velocity[tip..tip + 3].copy_from_slice(velocity.as_slice());
            }
            if frame.hinge.is_none() {
                let rate = spin * frame.length;
                self.velocity[slot..slot + 3].copy_from_slice(rate.as_slice());
            }
        }
    }
}
