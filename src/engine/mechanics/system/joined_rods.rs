//! Joints and bodies of a scene with numbered rods: the owners of positions, and the masses of
//! bodies.

use super::Assembly;
use super::joints::{EccentricMass, JointPlan, PlannedFrame, PlannedSlide, Slide, Track};
use crate::linalg::UNUSED;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::{Body, Clamp, RodNode, Scene};
use crate::mechanics::{JointError, SceneError, Vector3};

impl Assembly {
    /// Joins the rods, which already have their nodes, clamps and ghost edges, and adds the
    /// bodies.
    ///
    /// # Errors
    /// [`SceneError::Joint`] if clamps hold a motion that joints hold, or if a body is invalid.
    pub(super) fn join(&mut self, scene: &Scene, plan: &JointPlan) -> Result<(), SceneError> {
        self.share_points(scene, plan)?;
        for (number, planned) in plan.frames.iter().enumerate() {
            if let Some(base) = planned.weld {
                self.weld(number, base);
            }
        }
        for (number, planned) in plan.frames.iter().enumerate() {
            let clamp = self.clamp_of_frame(scene, plan, number)?;
            let is_held = planned.hinge.is_some() || clamp.is_some() || planned.is_ground;
            self.free_frame(number, &planned.nodes[0], is_held);
            self.joints.frames[number].clamp = clamp;
            let mut bodies = scene.bodies.iter();
            let here =
                bodies.find(|body| planned.nodes.contains(&body.at) && body.inertia.is_some());
            if let Some(body) = here {
                self.add_inertia(number, body);
                let own = scene.rods[body.at.rod].radius_at(body.at.node);
                let radius = (body.ball).filter(|ball| *ball > own);
                self.joints.frames[number].ball =
                    radius.map(|radius| (self.number(&body.at), radius));
            }
        }
        let first_place = self.rods.nodes + plan.places() - plan.slides.len();
        for (place, slide) in (first_place..).zip(&plan.slides) {
            self.free_slide(scene, slide, place);
        }
        self.turn_free_bodies(scene, plan);
        self.add_masses(scene)?;
        self.start_rotations(scene);
        let mut unknowns = std::mem::take(&mut self.unknowns);
        self.joints.complete(&mut unknowns);
        self.unknowns = unknowns;
        Ok(())
    }

    /// Mass that moves with a node, kg: with a joint, that of all nodes at its point.
    pub(super) fn mass_at(&self, node: usize) -> f64 {
        let own = self.masses[STRIDE * node];
        let others = self.joints.others_at(node);
        others.fold(own, |sum, other| sum + self.masses[STRIDE * other])
    }

    /// Index of a node among those of all rods.
    pub(super) fn number(&self, at: &RodNode) -> usize {
        self.rods.rods[at.rod].first_node + at.node
    }

    /// Makes one of several joined nodes the owner of their position: a clamped node if there is
    /// one.
    fn share_points(&mut self, scene: &Scene, plan: &JointPlan) -> Result<(), SceneError> {
        for group in &plan.points {
            let is_held = |at: &&RodNode| self.held[STRIDE * self.number(at)];
            let mut clamped = group.iter().filter(is_held);
            let owner = clamped.next().unwrap_or(&group[0]);
            if let Some(other) = clamped.next() {
                let [first, second] = [owner, other].map(|at| scene.rods[at.rod].name.clone());
                return Err(wrong(scene, other, JointError::TwoClamps { first, second }));
            }
            for at in group.iter().filter(|at| *at != owner) {
                let [node, owner] = [at, owner].map(|at| self.number(at));
                let [own, of_owner] = [node, owner].map(|node| STRIDE * node..STRIDE * node + 3);
                self.unknowns.copy_within(of_owner.clone(), own.start);
                self.velocity.copy_within(of_owner.clone(), own.start);
                self.held.copy_within(of_owner, own.start);
                self.joints.points.push([node, owner]);
            }
        }
        Ok(())
    }

    /// Couples the rotation of a frame to another frame, with a common length scale.
    fn weld(&mut self, number: usize, base: usize) {
        let frames = &mut self.joints.frames;
        let length = frames[number].length.min(frames[base].length);
        for frame in [number, base] {
            frames[frame].length = length;
        }
        let places = [number, base].map(|frame| frames[frame].first_unknown / STRIDE);
        self.joints.welds.push(places);
    }

    /// Makes the rotation of a frame an unknown, or its angle if it turns on a hinge, and adds its
    /// element.
    fn free_frame(&mut self, number: usize, at: &RodNode, is_held: bool) {
        let node = self.number(at);
        let frame = &mut self.joints.frames[number];
        frame.node = node;
        frame.element = self.rods.elements.len();
        self.rods.elements.push([UNUSED; 12]);
        let first = frame.first_unknown;
        let is_hinged = frame.hinge.is_some();
        self.held[first..first + 3].fill(is_held);
        self.held[first + 3] = !is_hinged;
    }

    /// The clamp that holds the frame of a rigid joint, if any.
    ///
    /// # Errors
    /// [`SceneError::Joint`] if clamps hold frames that hinges, bodies or breaking joints turn, or
    /// if several clamps hold one frame.
    fn clamp_of_frame(
        &self,
        scene: &Scene,
        plan: &JointPlan,
        number: usize,
    ) -> Result<Option<usize>, SceneError> {
        let planned = &plan.frames[number];
        let is_tied = |other: &PlannedFrame| {
            other.weld == Some(number) || other.hinge.is_some_and(|(base, _)| base == number)
        };
        let may_be_held = planned.hinge.is_none()
            && planned.weld.is_none()
            && !planned.bears_body
            && planned.body.is_none()
            && !plan.frames.iter().any(is_tied);
        let mut holding = None;
        for at in planned.nodes.iter().filter(|at| at.rod < scene.rods.len()) {
            if scene.rods[at.rod].held {
                return Err(wrong(scene, at, JointError::HeldRod));
            }
            let here = |clamp: &&Clamp| (clamp.rod, clamp.node) == (at.rod, at.node);
            let mut clamps = scene.clamps.iter().filter(here);
            if !clamps.any(|clamp| clamp.holds_frame) {
                continue;
            }
            if !may_be_held || holding.is_some() {
                let rod = scene.rods[at.rod].name.clone();
                return Err(wrong(scene, at, JointError::ClampedFrame { rod }));
            }
            let node = self.number(at);
            holding = self.drives.iter().position(|drive| drive.node == node);
        }
        Ok(holding)
    }

    /// Turns the frames held by clamps to the orientation of the clamps at a time, s.
    pub(super) fn turn_held_frames(&mut self, time: f64) {
        for frame in &mut self.joints.frames {
            if let Some(clamp) = frame.clamp {
                frame.base = self.drives[clamp].rotation(time);
            }
        }
    }

    /// Makes a node follow a point along a rod, whose parameter becomes an unknown.
    fn free_slide(&mut self, scene: &Scene, planned: &PlannedSlide, place: usize) {
        let [node, start] = planned.nodes.each_ref().map(|at| self.number(at));
        let mut points = self.joints.points.iter();
        let node = points
            .find_map(|&[own, owner]| (own == node).then_some(owner))
            .unwrap_or(node);
        let range = self.rods.rods[planned.nodes[1].rod];
        let lengths: Vec<f64> = (self.rods.edges.iter())
            .filter(|edge| range.edge_indices().contains(&edge.start))
            .map(|edge| edge.natural_length)
            .collect();
        let track = Track::new(&range, planned.rail, &lengths);
        let unknown = STRIDE * place + 3;
        self.unknowns[unknown] = track.parameter(start);
        // The other unknowns of this slot are unused, and are at the node.
        self.unknowns
            .copy_within(STRIDE * node..STRIDE * node + 3, STRIDE * place);
        self.held[STRIDE * place..unknown].fill(true);
        let friction = planned.friction.as_ref();
        let rail = &scene.rods[planned.nodes[1].rod];
        let stretching = rail.section(planned.rail[0]).stretching;
        let mut slide = Slide::new([node, unknown], track, friction, &self.unknowns);
        if planned.is_held {
            slide.yield_with(stretching / slide.edge());
        }
        self.joints.slides.push(slide);
    }

    /// Gives a frame the inertia of a body that a rod carries: masses at the tips of its principal
    /// axes, and the mass of its centre if this is away from the node.
    fn add_inertia(&mut self, number: usize, body: &Body) {
        let (rod, inertia) = (body.at.rod, body.inertia.unwrap_or_default());
        let node = self.number(&body.at);
        let is_of_rod = |ghost: usize| {
            let edge = self.rods.nodes + ghost;
            self.rods.vertices.iter().any(|vertex| {
                let real = match [vertex.before, vertex.after] {
                    [before, after] if before == edge => after,
                    [before, after] if after == edge => before,
                    _ => return false,
                };
                self.locate(real).0 == rod
            })
        };
        let frame = &self.joints.frames[number];
        let mut ghosts = frame.ghosts.iter().filter(|(ghost, _)| is_of_rod(*ghost));
        let placed = ghosts.next().expect("the rod is clamped to the frame").1;
        let (first, length) = (frame.first_unknown + STRIDE, frame.length);
        let axes = [
            placed.director,
            placed.tangent.cross(&placed.director),
            placed.tangent,
        ];
        let frame = &mut self.joints.frames[number];
        frame.body = Some((first, axes));
        if body.offset != Vector3::zeros() {
            frame.eccentric = Some(EccentricMass {
                node,
                first_tip: first / STRIDE,
                mass: body.mass,
                parts: (body.offset / length).into(),
            });
        }
        let sum: f64 = inertia.iter().sum();
        for (k, moment) in inertia.iter().enumerate() {
            let tip = first + STRIDE * k;
            self.masses[tip..tip + 3].fill((0.5 * sum - moment) / (length * length));
            self.held[tip..tip + STRIDE].fill(true);
        }
    }

    /// Adds the masses of bodies to nodes.
    fn add_masses(&mut self, scene: &Scene) -> Result<(), SceneError> {
        for body in &scene.bodies {
            let node = body.at.node;
            let rod = scene.rods.get(body.at.rod);
            let nodes = rod.map_or(0, |rod| rod.centreline.len());
            if node >= nodes {
                let reason = JointError::NoSuchNode { node, nodes };
                return Err(wrong(scene, &body.at, reason));
            }
            let unknown = STRIDE * self.number(&body.at);
            for mass in &mut self.masses[unknown..unknown + 3] {
                *mass += body.mass;
            }
        }
        Ok(())
    }

    /// Sets the initial rotation rates of frames and bodies from the motion of the rods that carry
    /// them.
    fn start_rotations(&mut self, scene: &Scene) {
        for number in 0..self.joints.frames.len() {
            let frame = &self.joints.frames[number];
            let Some((first, axes)) = frame.body.filter(|_| frame.vertices.is_none()) else {
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
        for &[own, owner] in &self.joints.welds {
            let [own, owner] = [own, owner].map(|place| STRIDE * place);
            // The frame that carries a body already rotates.
            if position(&self.velocity, own / STRIDE) == Vector3::zeros() {
                self.velocity.copy_within(owner..owner + 3, own);
            } else {
                self.velocity.copy_within(own..own + 3, owner);
            }
        }
    }
}

/// Error of the joint or body at a node.
fn wrong(scene: &Scene, at: &RodNode, reason: JointError) -> SceneError {
    let joint = scene.joints.iter().find(|joint| joint.nodes.contains(at));
    let body = scene.bodies.iter().find(|body| body.at == *at);
    let name = joint
        .map(|joint| &joint.name)
        .or(body.map(|body| &body.name));
    SceneError::Joint {
        name: name.cloned().unwrap_or_default(),
        reason,
    }
}
