//! Joints and bodies: nodes that coincide, and frames that turn freely with rods clamped to them.
//!
//! **Points.** The positions of joined nodes are one set of unknowns, that of one of the nodes,
//! the owner. Residuals, and rows and columns of the Jacobian, of the other nodes are added to
//! those of the owner: x = P r gives Pᵀ R and Pᵀ J P. The joint holds exactly, and its force needs
//! no unknown.
//!
//! **Frames.** Rods that meet rigidly, at a hinge or in a body are clamped to a frame
//! ([`frame::TurningFrame`]), with the half vertex of every clamp ([`crate::mechanics::rod`],
//! `turning_ghost`), so that the joint is at the node and its error is of second order in the edge
//! length. In the middle of a rod the two half vertices in series are as stiff as the original
//! vertex. Kernels compute moments on frames in the fixed frame; [`derivatives`] converts these
//! and their derivatives to those over the unknowns.
//!
//! **Slides.** A node that slides along a rod has the position of a point of the rod ([`slide`]),
//! which depends on the rod and on one unknown. Since the nodes that carry it change from edge to
//! edge, it is not eliminated within the matrix, but by a border of the matrix ([`border`]). So is
//! a node that is a point of a free body ([`pin`]).

pub(crate) mod border;
mod charts;
mod derivatives;
pub(crate) mod frame;
mod masses;
mod pin;
mod plan;
mod rubbing;
pub(crate) mod slide;
mod span;
mod spring_ends;
mod track;
mod turned;
mod virtual_motion;

use super::System;
use super::demand::Demand;
use crate::linalg::{Element, SharedUnknown, UNUSED};
use crate::mechanics::rod::topology::{add_to_node, position};
use crate::mechanics::rod::{GhostEdge, STRIDE, TURNING_ROTATION};
use crate::mechanics::{SceneError, UnitQuaternion, Vector3, rotation};
pub(crate) use border::Border;
use derivatives::{HINGE, OWN_HINGE, OWN_NODE};
pub(super) use frame::EccentricMass;
pub(crate) use frame::TurningFrame;
pub(super) use pin::Pin;
pub use plan::joint_unknowns;
pub(super) use plan::{JointPlan, PlannedFrame, PlannedSlide};
use rubbing::Rubbing;
pub(super) use slide::Slide;
pub use spring_ends::check_joints;
pub(super) use track::Track;
pub(super) use turned::TurnedEnd;

const NO_EQUILIBRIUM: SceneError = SceneError::Unsuitable(
    "an equilibrium does not determine the friction of sliding nodes: run dynamically",
);

const ONLY_IN_MOTION: SceneError = SceneError::Unsuitable(
    "free bodies have no equilibrium without contact: run dynamically, with time.scheme = \"implicit-euler\" or \"backward-differences\"",
);

/// Joints and bodies of a scene, with its unknowns numbered.
#[derive(Clone, Debug, Default)]
pub struct Joints {
    /// Nodes that have the position of another node: the index of the node and that of the owner.
    pub points: Vec<[usize; 2]>,
    /// Frames; those tied by hinges come after the frames to which they are tied.
    pub frames: Vec<TurningFrame>,
    /// Frames that turn together with another frame until a weld breaks: their places among the
    /// unknowns, own place and that of the owner.
    pub welds: Vec<[usize; 2]>,
    /// Nodes that slide along rods; each owns its position.
    pub slides: Vec<Slide>,
    /// Nodes that are points of free bodies; each owns its position.
    pub pins: Vec<Pin>,
    /// Frames of the free bodies.
    pub bodies: Vec<usize>,
    /// Unknowns at the start of the step if the scheme solves for the middle of the step; `None`
    /// if it solves for the end.
    start: Option<Vec<f64>>,
    /// Scratch: rotation of each frame at the last evaluation.
    rotations: Vec<UnitQuaternion>,
    /// Scratch: moment on each frame at the last evaluation, including those on frames tied to it
    /// by hinges, N m.
    moments: Vec<Vector3>,
    /// Scratch: forces on the tips of bodies at the last evaluation, N.
    tip_forces: Vec<[Vector3; 3]>,
    /// Scratch: forces on the vertices and pins of free bodies at the last evaluation, N, body
    /// after body.
    vertex_forces: Vec<Vector3>,
}

impl Joints {
    /// Creates the joints with every frame as placed.
    pub(crate) fn new(points: Vec<[usize; 2]>, frames: Vec<TurningFrame>) -> Self {
        Self {
            rotations: vec![UnitQuaternion::identity(); frames.len()],
            moments: vec![Vector3::zeros(); frames.len()],
            tip_forces: vec![[Vector3::zeros(); 3]; frames.len()],
            vertex_forces: Vec::new(),
            points,
            frames,
            welds: Vec::new(),
            slides: Vec::new(),
            pins: Vec::new(),
            bodies: Vec::new(),
            start: None,
        }
    }

    /// Checks whether a scene with these joints meets a demand.
    ///
    /// # Errors
    /// The reason why it does not.
    pub(crate) fn admit(&self, demand: Demand) -> Result<(), SceneError> {
        match demand {
            Demand::Equilibrium | Demand::NearbyEquilibrium | Demand::Path if self.rub() => {
                Err(NO_EQUILIBRIUM)
            }
            Demand::Equilibrium
            | Demand::NearbyEquilibrium
            | Demand::Path
            | Demand::ImplicitMidpoint
                if self.frames.iter().any(|frame| frame.vertices.is_some()) =>
            {
                Err(ONLY_IN_MOTION)
            }
            _ => Ok(()),
        }
    }

    /// Whether a node slides with friction.
    pub(crate) fn rub(&self) -> bool {
        self.slides.iter().any(|slide| slide.rubbing.is_some())
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.points.is_empty() && self.frames.is_empty() && self.slides.is_empty()
    }

    /// The unknowns that are owned by others.
    pub(crate) fn shared(&self) -> Vec<SharedUnknown> {
        let of_point = |&[node, owner]: &[usize; 2]| {
            (0..3).map(move |axis| SharedUnknown {
                unknown: STRIDE * node + axis,
                owner: STRIDE * owner + axis,
            })
        };
        self.tied().flat_map(of_point).collect()
    }

    /// Places among the unknowns with three unknowns owned by another place: joined nodes and
    /// welded frames.
    fn tied(&self) -> impl Iterator<Item = &[usize; 2]> {
        self.points.iter().chain(&self.welds)
    }

    /// The unknowns of an element of the rods as numbered in the Jacobian: half vertices of hinges
    /// refer to the frame to which they are tied, and to the angle.
    pub(crate) fn elements(&self, of_rods: &[Element]) -> Vec<Element> {
        let mut elements = of_rods.to_vec();
        for frame in &self.frames {
            let rotation = self.free_rotation(frame);
            for &element in &frame.elements {
                for axis in 0..3 {
                    elements[element][TURNING_ROTATION + axis] = rotation + axis;
                }
                if frame.hinge.is_some() {
                    elements[element][HINGE] = frame.first_unknown + 3;
                }
            }
            let own = &mut elements[frame.element];
            *own = [UNUSED; 12];
            for axis in 0..3 {
                own[axis] = rotation + axis;
            }
            if frame.hinge.is_some() {
                own[OWN_HINGE] = frame.first_unknown + 3;
            }
            if let Some(eccentric) = &frame.eccentric {
                for axis in 0..3 {
                    own[OWN_NODE + axis] = STRIDE * eccentric.node + axis;
                }
            }
        }
        elements
    }

    /// Rotation of a frame since it was placed, at the last evaluation.
    pub(crate) fn rotation(&self, frame: usize) -> UnitQuaternion {
        self.rotations[frame]
    }

    /// Rotation of a frame since it was placed, at any unknowns.
    pub(crate) fn rotation_at(&self, frame: &TurningFrame, unknowns: &[f64]) -> UnitQuaternion {
        let of_vector = |frame: &TurningFrame| {
            rotation::from_vector(frame.rotation_vector(unknowns)) * frame.base
        };
        match frame.hinge {
            None => of_vector(frame),
            Some((base, axis)) => {
                let turn = rotation::from_vector(axis * frame.hinge_angle(unknowns));
                of_vector(&self.frames[base]) * turn
            }
        }
    }

    /// First unknown of the rotation that moves a frame, and the angle of its hinge.
    pub(crate) fn unknowns_of_frame(&self, number: usize) -> (usize, Option<usize>) {
        let frame = &self.frames[number];
        let hinge = frame.hinge.map(|_| frame.first_unknown + 3);
        (self.free_rotation(frame), hinge)
    }

    /// First unknown of the rotation that moves a frame.
    fn free_rotation(&self, frame: &TurningFrame) -> usize {
        let base = frame.hinge.map_or(frame, |(base, _)| &self.frames[base]);
        base.first_unknown
    }

    /// Computes the rotations of all frames.
    pub(crate) fn rotate(&mut self, unknowns: &[f64]) {
        for number in 0..self.frames.len() {
            self.rotations[number] = self.rotation_at(&self.frames[number], unknowns);
            let frame = &mut self.frames[number];
            frame.angles[0] = frame.hinge_angle(unknowns);
            frame.turned = frame.rotation_vector(unknowns).norm();
        }
    }

    /// Updates the ghost edges that turn with the frames at `unknowns`.
    pub(crate) fn turn_ghosts(&mut self, unknowns: &[f64], ghosts: &mut [GhostEdge]) {
        self.rotate(unknowns);
        self.turn_pins(unknowns);
        for (frame, rotation) in self.frames.iter().zip(&self.rotations) {
            let turn = rotation::to_vector(&(rotation * frame.committed.inverse()));
            for (ghost, placed) in &frame.ghosts {
                let tangent = rotation * placed.tangent;
                ghosts[*ghost] = GhostEdge {
                    tangent,
                    director: rotation * placed.director,
                    spin: turn.dot(&tangent),
                };
            }
        }
    }

    /// Moment on a frame at the last [`Self::gather_moments`], including those on frames tied to
    /// it by hinges, N m.
    pub(crate) fn moment_on(&self, frame: usize) -> Vector3 {
        self.moments[frame]
    }

    /// Gives a frame on a hinge its own rotation, before it is freed: that at `unknowns` with its
    /// rate at `velocity`.
    pub(crate) fn take_over_rotation(
        &mut self,
        number: usize,
        unknowns: &mut [f64],
        velocity: &mut [f64],
    ) {
        self.rotate(unknowns);
        let spin = self.turn_of_frame(number, unknowns, velocity);
        let frame = &mut self.frames[number];
        let own = frame.first_unknown;
        frame.base = self.rotations[number];
        unknowns[own..own + STRIDE].fill(0.0);
        velocity[own..own + STRIDE].fill(0.0);
        for axis in 0..3 {
            velocity[own + axis] = frame.length * spin[axis];
        }
    }

    /// Commits the frames of the last evaluation as the reference for rotations in the next step.
    pub(crate) fn commit(&mut self) {
        for (frame, rotation) in self.frames.iter_mut().zip(&self.rotations) {
            frame.committed = *rotation;
            frame.angles[1] = frame.angles[0];
        }
        self.rubbing_mut().for_each(Rubbing::commit);
    }

    /// Frictions of sliding nodes.
    fn rubbing_mut(&mut self) -> impl Iterator<Item = &mut Rubbing> {
        let slides = self.slides.iter_mut();
        slides.filter_map(|slide| slide.rubbing.as_mut())
    }

    /// State of the friction of sliding nodes, for a checkpoint.
    pub(super) fn memory(&self) -> Vec<f64> {
        let rubbing = self
            .slides
            .iter()
            .filter_map(|slide| slide.rubbing.as_ref());
        rubbing.flat_map(Rubbing::memory).collect()
    }

    /// Restores what [`Self::memory`] returned.
    ///
    /// # Errors
    /// The difference if the checkpoint belongs to another scene.
    pub(super) fn restore(&mut self, memory: &[f64]) -> Result<(), &'static str> {
        let (pairs, rest) = memory.as_chunks::<2>();
        if pairs.len() != self.rubbing_mut().count() || !rest.is_empty() {
            return Err("friction of sliding nodes");
        }
        self.rubbing_mut()
            .zip(pairs)
            .for_each(|(one, pair)| one.restore(*pair));
        Ok(())
    }

    /// Sets the dependent values: positions of joined nodes, and tips of the principal axes of
    /// bodies.
    pub(crate) fn complete(&mut self, unknowns: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        self.spread_points(unknowns);
        if !self.slides.is_empty() {
            for slide in &self.slides {
                slide.complete(unknowns, self.start.as_deref());
            }
            self.spread_points(unknowns);
        }
        self.rotate(unknowns);
        for (frame, rotation) in self.frames.iter().zip(&self.rotations) {
            if let Some((first, tips)) = frame.tips(rotation) {
                for (k, tip) in tips.iter().enumerate() {
                    let unknown = first + STRIDE * k;
                    unknowns[unknown..unknown + 3].copy_from_slice(tip.as_slice());
                }
            }
            if let Some(vertices) = &frame.vertices {
                let centre = position(unknowns, vertices.centre);
                for (node, arm) in vertices.nodes().zip(&vertices.arms) {
                    let vertex = centre + rotation * arm;
                    unknowns[STRIDE * node..STRIDE * node + 3].copy_from_slice(vertex.as_slice());
                }
            }
        }
        for pin in &self.pins {
            if let Some(vertices) = &self.frames[pin.frame].vertices {
                let centre = position(unknowns, vertices.centre);
                let place = centre + self.rotations[pin.frame] * pin.arm;
                unknowns[STRIDE * pin.node..STRIDE * pin.node + 3]
                    .copy_from_slice(place.as_slice());
            }
        }
    }

    /// Sets whether unknowns are those in the middle of a step from `start`, or at its end if
    /// `start` is `None`.
    pub(crate) fn begin_step(&mut self, start: Option<&[f64]>) {
        if !self.slides.is_empty() {
            self.start = start.map(<[f64]>::to_vec);
        }
    }

    /// Sets the positions of sliding nodes from `unknowns`.
    pub(crate) fn place(&mut self, unknowns: &[f64]) {
        for slide in &mut self.slides {
            slide.place(unknowns, self.start.as_deref());
        }
    }

    /// Whether a node, or the owner of its position, slides along a rod.
    pub(crate) fn slides_at(&self, node: usize) -> bool {
        let mut points = self.points.iter();
        let owner = points.find_map(|&[own, owner]| (own == node).then_some(owner));
        let owner = owner.unwrap_or(node);
        self.slides.iter().any(|slide| slide.node == owner)
    }

    /// The other nodes at the point of a node.
    pub(crate) fn others_at(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let mut points = self.points.iter();
        let owner = points.find_map(|&[own, owner]| (own == node).then_some(owner));
        let owner = owner.unwrap_or(node);
        let tied = self.points.iter().filter(move |pair| pair[1] == owner);
        let all = tied.map(|pair| pair[0]).chain([owner]);
        all.filter(move |other| *other != node)
    }

    /// Whether a node coincides with another one.
    pub(crate) fn joins(&self, node: usize) -> bool {
        self.points.iter().any(|pair| pair.contains(&node))
    }

    /// Unknowns determined by others: those of joined nodes, of sliding nodes and of points of free
    /// bodies.
    pub(crate) fn dependent(&self) -> Vec<usize> {
        let mut dependent: Vec<usize> = self.shared().iter().map(|one| one.unknown).collect();
        let nodes = self.carried_nodes();
        dependent.extend(nodes.flat_map(|node| STRIDE * node..STRIDE * node + 3));
        dependent
    }

    /// Nodes whose positions are those of points of rods and free bodies.
    fn carried_nodes(&self) -> impl Iterator<Item = usize> + '_ {
        let slides = self.slides.iter().filter(|slide| slide.stiffness.is_none());
        let slides = slides.map(|slide| slide.node);
        slides.chain(self.pins.iter().map(|pin| pin.node))
    }

    /// Whether a node slides that a clamp holds.
    pub(crate) fn yields(&self) -> bool {
        self.slides.iter().any(|slide| slide.stiffness.is_some())
    }

    /// Adds the forces on nodes with dependent positions to the forces on the nodes that determine
    /// these.
    pub(crate) fn gather(&self, forces: &mut [f64]) {
        self.gather_points(forces);
        if !self.slides.is_empty() {
            self.slides.iter().for_each(|slide| slide.gather(forces));
            self.gather_points(forces);
        }
    }

    /// Adds the forces on joined nodes and welded frames to those on the owners of their positions
    /// and rotations.
    pub(crate) fn gather_points(&self, forces: &mut [f64]) {
        for &[node, owner] in self.tied() {
            for axis in 0..3 {
                forces[STRIDE * owner + axis] += std::mem::take(&mut forces[STRIDE * node + axis]);
            }
        }
    }

    /// Moves joined nodes and welded frames with the owners of their positions and rotations.
    pub(crate) fn spread_points(&self, moves: &mut [f64]) {
        for &[node, owner] in self.tied() {
            moves.copy_within(STRIDE * owner..STRIDE * owner + 3, STRIDE * node);
        }
    }

    /// Converts moments on frames, in the fixed frame, and forces on the tips of bodies to
    /// generalised forces over the unknowns; `unknowns` are those of the last
    /// [`Self::turn_ghosts`].
    pub(crate) fn gather_moments(&mut self, unknowns: &[f64], forces: &mut [f64]) {
        self.vertex_forces.clear();
        for (number, frame) in self.frames.iter().enumerate() {
            let slot = frame.first_unknown;
            let mut moment = take(forces, slot);
            if let Some((first, tips)) = frame.tips(&self.rotations[number]) {
                let on_tips = [0, 1, 2].map(|k| take(forces, first + STRIDE * k));
                for (tip, force) in tips.iter().zip(&on_tips) {
                    moment += tip.cross(force);
                }
                self.tip_forces[number] = on_tips;
            }
            if let Some(vertices) = &frame.vertices {
                for (node, arm) in vertices.nodes().zip(&vertices.arms) {
                    let force = take(forces, STRIDE * node);
                    moment += (self.rotations[number] * arm).cross(&force);
                    add_to_node(forces, vertices.centre, &force);
                    self.vertex_forces.push(force);
                }
                for pin in self.pins.iter().filter(|pin| pin.frame == number) {
                    let force = take(forces, STRIDE * pin.node);
                    moment += (self.rotations[number] * pin.arm).cross(&force);
                    add_to_node(forces, vertices.centre, &force);
                    self.vertex_forces.push(force);
                }
            }
            self.moments[number] = moment;
        }
        for (number, frame) in self.frames.iter().enumerate() {
            if let Some((base, axis)) = frame.hinge {
                let moment = self.moments[number];
                self.moments[base] += moment;
                forces[frame.first_unknown + 3] += moment.dot(&(self.rotations[base] * axis));
            }
        }
        for (frame, moment) in self.frames.iter().zip(&self.moments) {
            if frame.hinge.is_none() {
                let jacobian = rotation::left_jacobian(&frame.rotation_vector(unknowns));
                let over = jacobian.transpose() * moment / frame.length;
                add_to_node(forces, frame.first_unknown / STRIDE, &over);
            }
        }
    }
}

/// Returns three entries of a vector and sets them to zero.
fn take(entries: &mut [f64], first: usize) -> Vector3 {
    let entries = &mut entries[first..first + 3];
    let taken = Vector3::from_column_slice(entries);
    entries.fill(0.0);
    taken
}

impl System {
    /// Sets the dependent unknowns: positions of joined nodes, and orientations of bodies.
    pub(crate) fn complete(&mut self, unknowns: &mut [f64]) {
        self.assembly.joints.complete(unknowns);
    }

    /// Converts changes of the forces on all nodes, frames and bodies, at the last evaluation,
    /// which was at `unknowns`, to changes over the free unknowns.
    pub(crate) fn gather_changes(&mut self, unknowns: &[f64], changes: &mut [f64]) {
        let joints = &mut self.assembly.joints;
        joints.gather_moments(unknowns, changes);
        joints.gather(changes);
    }

    /// Completes a derivative of all unknowns with respect to a parameter, at `unknowns` of the
    /// last evaluation. Tips of bodies turn with their frames; tips and sliding nodes also have
    /// the derivative at fixed unknowns in `explicit`.
    pub(crate) fn spread_change(&self, unknowns: &[f64], explicit: &[f64], change: &mut [f64]) {
        let joints = &self.assembly.joints;
        for (number, frame) in joints.frames.iter().enumerate() {
            let Some((first, tips)) = frame.tips(&joints.rotations[number]) else {
                continue;
            };
            let turn = joints.turn_of_frame(number, unknowns, change);
            for (k, tip) in tips.iter().enumerate() {
                let unknown = first + STRIDE * k;
                let moved = turn.cross(tip) + position(explicit, unknown / STRIDE);
                change[unknown..unknown + 3].copy_from_slice(moved.as_slice());
            }
        }
        for slide in &joints.slides {
            let explicit = position(explicit, slide.node);
            add_to_node(change, slide.node, &explicit);
        }
        joints.spread_points(change);
    }

    /// Converts the product of the full Jacobian of the last evaluation with `moves` to that of
    /// the Jacobian over the free unknowns.
    pub(crate) fn gather_product(&self, moves: &[f64], product: &mut [f64]) {
        let joints = &self.assembly.joints;
        joints.gather(product);
        for slide in joints.slides.iter().filter(|slide| !slide.is_stopped) {
            let weights = &slide.grip.weights;
            for (node, slope) in weights.nodes.iter().zip(&weights.slopes) {
                let force = slide.residual * (slope * moves[slide.unknown]);
                add_to_node(product, *node, &force);
            }
        }
    }

    /// Converts a residual over all nodes, frames and bodies to one over the free unknowns.
    pub(super) fn gather_at_joints(&mut self, unknowns: &[f64]) {
        self.breaking.note(&self.residual);
        let joints = &mut self.assembly.joints;
        joints.gather_moments(unknowns, &mut self.residual);
        self.breaking.note_moments(joints);
        joints.gather_points(&mut self.residual);
        for slide in &mut joints.slides {
            slide.note(&self.residual, unknowns, joints.start.as_deref());
        }
        for slide in &joints.slides {
            slide.add_force(&mut self.residual);
        }
        joints.gather(&mut self.residual);
    }

    /// Sets whether unknowns are those in the middle of a step from `start`, or at its end if
    /// `start` is `None`.
    pub(crate) fn begin_step(&mut self, start: Option<&[f64]>) {
        self.assembly.joints.begin_step(start);
    }
}

#[cfg(test)]
mod free_body_tests;
#[cfg(test)]
mod slide_tests;
#[cfg(test)]
mod tests;
