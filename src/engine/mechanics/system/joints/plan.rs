//! Nodes that coincide, and frames that turn together, from the description of a scene before its
//! rods are numbered.

use super::Joints;
use super::frame::{BODY_PLACES, TurningFrame};
use super::span::span;
use super::turned::turned_nodes;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{
    BodyJoint, CoulombFriction, HingeSpring, Joint, JointKind, RodNode, Scene,
};
use crate::mechanics::{JointError, SceneError, Vector3};
use std::collections::BTreeMap;

/// A frame that turns freely, with rods clamped to it.
#[derive(Clone, Debug, Default)]
pub(in crate::mechanics::system) struct PlannedFrame {
    /// Nodes at which rods are clamped to it.
    pub nodes: Vec<RodNode>,
    /// The frame to which a hinge ties this frame, and the axis of the hinge as placed.
    pub hinge: Option<(usize, Vector3)>,
    /// The spring about that axis.
    pub spring: Option<HingeSpring>,
    /// The frame with which this frame turns until the weld breaks.
    pub weld: Option<usize>,
    /// Whether a body with inertia that a rod carries turns with it.
    pub bears_body: bool,
    /// The free body that turns with it, with its index.
    pub body: Option<usize>,
    /// Whether it never turns, and carries axles.
    pub is_ground: bool,
}

/// A node that slides along a rod.
#[derive(Clone, Debug)]
pub(in crate::mechanics::system) struct PlannedSlide {
    /// The node, and the node of the rod at which its slide begins.
    pub nodes: [RodNode; 2],
    /// First and last node of that rod along which it may slide.
    pub rail: [usize; 2],
    /// Friction along it.
    pub friction: Option<CoulombFriction>,
    /// Whether the position of the node is given.
    pub is_held: bool,
}

/// A hinge whose frames are not determined yet.
struct PlannedHinge {
    name: String,
    nodes: [RodNode; 2],
    axis: Vector3,
    spring: Option<HingeSpring>,
}

/// Number of unknowns that the joints of a scene remove from those of its rods, and number that
/// their frames add; zero if the joints are invalid.
pub fn joint_unknowns(scene: &Scene) -> [usize; 2] {
    let Ok(plan) = JointPlan::new(scene) else {
        return [0; 2];
    };
    let taken = plan.points.iter().map(|point| 3 * (point.len() - 1));
    // A slide removes three unknowns of a position and adds one for the parameter along the rod.
    let slides = plan.slides.len();
    let frames = plan.frames.iter().filter(|frame| !frame.is_ground);
    let added = frames.map(|frame| match (frame.hinge, frame.weld) {
        (None, _) if frame.body.is_some() => 6,
        (Some(_), _) => 1,
        (_, Some(_)) => 0,
        _ => 3,
    });
    [
        taken.sum::<usize>() + 3 * (slides + plan.pins.len()),
        added.sum::<usize>() + slides,
    ]
}

impl PlannedFrame {
    fn places(&self) -> usize {
        // On an axle, the inertia of a body is that of its angle.
        let has_tips = self.bears_body || self.body.is_some() && !self.is_on_axle();
        if has_tips { BODY_PLACES } else { 1 }
    }

    /// Whether it is that of a free body that turns about an axle.
    fn is_on_axle(&self) -> bool {
        self.body.is_some() && self.hinge.is_some()
    }
}

/// Joints and bodies of a scene.
#[derive(Clone, Debug, Default)]
pub(in crate::mechanics::system) struct JointPlan {
    /// Nodes that are one point.
    pub points: Vec<Vec<RodNode>>,
    /// Frames; those tied by hinges come after the frames to which they are tied.
    pub frames: Vec<PlannedFrame>,
    /// Nodes that slide along rods.
    pub slides: Vec<PlannedSlide>,
    /// Nodes that are points of free bodies, with the indices of the bodies.
    pub pins: Vec<(RodNode, usize)>,
    /// Frames by the nodes that turn with them, and by free bodies ([`stand_in`]).
    frame_of: BTreeMap<RodNode, usize>,
}

impl JointPlan {
    /// # Errors
    /// [`SceneError::Joint`] if nodes are missing or apart, or if joints hold the same motion
    /// twice.
    pub(crate) fn new(scene: &Scene) -> Result<Self, SceneError> {
        let mut points = Groups::default();
        let mut rigid = Groups::default();
        let mut hinges: Vec<PlannedHinge> = Vec::new();
        let mut slides: Vec<(String, PlannedSlide)> = Vec::new();
        let mut welds: Vec<[RodNode; 2]> = Vec::new();
        for joint in &scene.joints {
            let wrong = |reason| SceneError::Joint {
                name: joint.name.clone(),
                reason,
            };
            check_places(scene, &joint.nodes).map_err(wrong)?;
            if let JointKind::Slide { friction } = joint.kind {
                let rail = rail_of(scene, joint.nodes).map_err(wrong)?;
                let nodes = joint.nodes;
                slides.push((
                    joint.name.clone(),
                    PlannedSlide {
                        nodes,
                        rail,
                        friction,
                        is_held: false,
                    },
                ));
                continue;
            }
            if joint.strength.may_break() && !is_alone(scene, joint) {
                return Err(wrong(JointError::Unbreakable));
            }
            points.join(joint.nodes);
            match joint.kind {
                JointKind::Ball | JointKind::Slide { .. } => {}
                JointKind::Rigid if joint.strength.may_break() => {
                    joint.nodes.into_iter().for_each(|node| rigid.add(node));
                    welds.push(joint.nodes);
                }
                JointKind::Rigid => {
                    if rigid.are_joined(joint.nodes) {
                        return Err(wrong(JointError::Twice));
                    }
                    rigid.join(joint.nodes);
                }
                JointKind::Hinge { axis, spring } => hinges.push(PlannedHinge {
                    name: joint.name.clone(),
                    nodes: joint.nodes,
                    axis,
                    spring,
                }),
            }
        }
        for node in hinges.iter().flat_map(|hinge| hinge.nodes) {
            rigid.add(node);
        }
        for node in turned_nodes(scene)? {
            rigid.add(node);
        }
        for body in scene.bodies.iter().filter(|body| body.inertia.is_some()) {
            rigid.add(body.at);
        }
        let pins = join_to_bodies(scene, &points, &mut rigid, &mut hinges)?;
        judge_slides(scene, &slides, &points)?;
        let slides = slides.into_iter().map(|(_, slide)| PlannedSlide {
            is_held: is_held(scene, &points, slide.nodes[0]),
            ..slide
        });
        let mut plan = Self {
            slides: slides.collect(),
            points: points.into_groups(),
            pins,
            ..Self::default()
        };
        plan.add_ground(scene);
        plan.add_frames(scene, rigid.into_groups(), hinges)?;
        plan.add_axles(scene)?;
        for weld in welds {
            let [base, tied] = weld.map(|node| plan.frame_of[&node]);
            plan.frames[tied].weld = Some(base);
        }
        for body in scene.bodies.iter().filter(|body| body.inertia.is_some()) {
            let frame = &mut plan.frames[plan.frame_of[&body.at]];
            if std::mem::replace(&mut frame.bears_body, true) {
                return Err(SceneError::Joint {
                    name: body.name.clone(),
                    reason: JointError::TwoBodies,
                });
            }
        }
        Ok(plan)
    }

    /// Adds the frame that carries all axles, if there are any.
    fn add_ground(&mut self, scene: &Scene) {
        let mut bodies = scene.free_bodies.iter();
        if let Some(body) = bodies.position(|body| body.axle.is_some()) {
            self.frames.push(PlannedFrame {
                nodes: vec![stand_in(scene, body)],
                is_ground: true,
                ..PlannedFrame::default()
            });
        }
    }

    /// Ties the frames of bodies on axles to the ground.
    fn add_axles(&mut self, scene: &Scene) -> Result<(), SceneError> {
        for (number, body) in scene.free_bodies.iter().enumerate() {
            let own = self.frame_of[&stand_in(scene, number)];
            self.frames[own].body = Some(number);
            let Some(axle) = &body.axle else { continue };
            let mut hinges = self.frames.iter().filter_map(|frame| frame.hinge);
            if hinges.any(|(base, _)| base == own) {
                return Err(SceneError::Joint {
                    name: body.name.clone(),
                    reason: JointError::HingeOnHinge,
                });
            }
            self.frames[own].hinge = Some((0, axle.direction));
        }
        Ok(())
    }

    /// Builds the frames of groups of nodes. Of frames tied together by hinges, that of a free
    /// body or else the one with the most hinges carries the others.
    fn add_frames(
        &mut self,
        scene: &Scene,
        mut groups: Vec<Vec<RodNode>>,
        mut hinges: Vec<PlannedHinge>,
    ) -> Result<(), SceneError> {
        let count = |group: &Vec<RodNode>| {
            let ends = hinges.iter().flat_map(|hinge| &hinge.nodes);
            ends.filter(|node| group.contains(node)).count()
        };
        let of_rods = |group: &Vec<RodNode>| group.iter().all(|at| at.rod < scene.rods.len());
        groups.sort_by_key(|group| (of_rods(group), std::cmp::Reverse(count(group))));
        while !groups.is_empty() {
            let base = self.frames.len();
            self.add_frame(groups.remove(0));
            while let Some(next) = (hinges.iter()).position(|hinge| {
                (hinge.nodes.iter()).any(|node| self.frame_of.get(node) == Some(&base))
            }) {
                let PlannedHinge {
                    name,
                    mut nodes,
                    mut axis,
                    spring,
                } = hinges.remove(next);
                if self.frame_of.get(&nodes[0]) != Some(&base) {
                    nodes.swap(0, 1);
                    axis = -axis;
                }
                let Some(tied) = groups.iter().position(|group| group.contains(&nodes[1])) else {
                    let reason = JointError::Twice;
                    return Err(SceneError::Joint { name, reason });
                };
                let frame = self.add_frame(groups.remove(tied));
                frame.hinge = Some((base, axis));
                frame.spring = spring;
            }
        }
        match hinges.into_iter().next() {
            None => Ok(()),
            Some(hinge) => Err(SceneError::Joint {
                name: hinge.name,
                reason: JointError::HingeOnHinge,
            }),
        }
    }

    fn add_frame(&mut self, nodes: Vec<RodNode>) -> &mut PlannedFrame {
        let number = self.frames.len();
        for node in &nodes {
            self.frame_of.insert(*node, number);
        }
        self.frames.push(PlannedFrame {
            nodes,
            ..PlannedFrame::default()
        });
        &mut self.frames[number]
    }

    /// Number of places of four unknowns that the frames and slides need: one for a rotation,
    /// three for the tips of a body, one for the parameter along a rod.
    pub(crate) fn places(&self) -> usize {
        let of_frames: usize = self.frames.iter().map(PlannedFrame::places).sum();
        of_frames + self.slides.len()
    }

    /// The frames with their unknowns after those of `nodes` nodes, before rods are clamped to
    /// them.
    pub(crate) fn with_unknowns(&self, nodes: usize) -> Joints {
        let mut place = nodes;
        let frames = self.frames.iter().map(|frame| {
            let first_unknown = STRIDE * place;
            place += frame.places();
            TurningFrame {
                spring: frame.spring,
                ..TurningFrame::new(first_unknown, frame.hinge)
            }
        });
        Joints::new(Vec::new(), frames.collect())
    }

    /// The frame of a free body.
    pub(crate) fn frame_of_body(&self, scene: &Scene, body: usize) -> usize {
        self.frame_of[&stand_in(scene, body)]
    }

    /// The frame to which a rod is clamped at a node.
    pub(crate) fn frame_at(&self, rod: usize, node: usize) -> Option<usize> {
        self.frame_of.get(&RodNode { rod, node }).copied()
    }
}

/// The node that stands for the frame of a free body among those of the rods.
fn stand_in(scene: &Scene, body: usize) -> RodNode {
    RodNode {
        rod: scene.rods.len() + body,
        node: 0,
    }
}

/// Joins rods to free bodies; returns the nodes that are points of the bodies.
fn join_to_bodies(
    scene: &Scene,
    points: &Groups,
    rigid: &mut Groups,
    hinges: &mut Vec<PlannedHinge>,
) -> Result<Vec<(RodNode, usize)>, SceneError> {
    let mut pins: Vec<(RodNode, usize)> = Vec::new();
    for (number, body) in scene.free_bodies.iter().enumerate() {
        let own = stand_in(scene, number);
        rigid.add(own);
        for BodyJoint { at, kind } in &body.joints {
            let wrong = |reason| SceneError::Joint {
                name: body.name.clone(),
                reason,
            };
            let nodes = scene.rods.get(at.rod).map_or(0, |rod| rod.centreline.len());
            if at.node >= nodes {
                let node = at.node;
                return Err(wrong(JointError::NoSuchNode { node, nodes }));
            }
            let slides = |joint: &Joint| joint.kind.slides() && joint.nodes[1].rod == at.rod;
            let is_taken = scene.rods[at.rod].held
                || points.parent.contains_key(at)
                || pins.iter().any(|(other, _)| other == at)
                || scene.bodies.iter().any(|other| other.at == *at)
                || (scene.clamps.iter()).any(|one| (one.rod, one.node) == (at.rod, at.node))
                || (scene.joints.iter()).any(|joint| joint.nodes.contains(at) || slides(joint));
            if is_taken {
                let rod = scene.rods[at.rod].name.clone();
                return Err(wrong(JointError::HeldAtBody { node: at.node, rod }));
            }
            match *kind {
                JointKind::Ball => {}
                JointKind::Rigid => rigid.join([*at, own]),
                JointKind::Hinge { axis, spring } => {
                    rigid.add(*at);
                    hinges.push(PlannedHinge {
                        name: body.name.clone(),
                        nodes: [own, *at],
                        axis,
                        spring,
                    });
                }
                JointKind::Slide { .. } => return Err(wrong(JointError::SlideOnBody)),
            }
            pins.push((*at, number));
        }
    }
    Ok(pins)
}

/// First and last node along which the first node of a slide may slide: the ends of the other rod,
/// or of the part of its own rod that is on the same side as the second node.
fn rail_of(scene: &Scene, [node, start]: [RodNode; 2]) -> Result<[usize; 2], JointError> {
    let rod = &scene.rods[start.rod];
    let last = rod.centreline.len() - 1;
    if node.rod != start.rod {
        return Ok([0, last]);
    }
    if rod.closed {
        return Err(JointError::OwnRing);
    }
    Ok(if start.node > node.node {
        [node.node + 1, last]
    } else {
        [0, node.node - 1]
    })
}

/// Whether slides give each sliding node a single position, and no position depends on itself.
fn judge_slides(
    scene: &Scene,
    slides: &[(String, PlannedSlide)],
    points: &Groups,
) -> Result<(), SceneError> {
    for (index, (name, slide)) in slides.iter().enumerate() {
        let node = points.root(slide.nodes[0]);
        let wrong = |reason| SceneError::Joint {
            name: name.clone(),
            reason,
        };
        let is_on = |rail: &PlannedSlide| {
            let [first, last] = rail.rail;
            let rod = rail.nodes[1].rod;
            (first..=last).any(|along| points.root(RodNode { rod, node: along }) == node)
        };
        if is_on(slide) {
            return Err(wrong(JointError::JoinedToRail));
        }
        let mut earlier = slides[..index].iter();
        if earlier.any(|(_, other)| points.root(other.nodes[0]) == node) {
            return Err(wrong(JointError::SlidesTwice));
        }
        if let Some((_, other)) = slides.iter().find(|(_, other)| is_on(other)) {
            let rod = scene.rods[other.nodes[1].rod].name.clone();
            return Err(wrong(JointError::SlidingRail { rod }));
        }
    }
    Ok(())
}

/// Whether the position of a node, or of a node joined to it, is given.
fn is_held(scene: &Scene, points: &Groups, node: RodNode) -> bool {
    let root = points.root(node);
    let clamped = (scene.clamps.iter()).filter(|clamp| clamp.holds_position);
    let clamped = clamped.map(|clamp| RodNode {
        rod: clamp.rod,
        node: clamp.node,
    });
    let joined = points.parent.keys().copied().chain([node]);
    let of_held_rods = joined.filter(|at| scene.rods[at.rod].held);
    (clamped.chain(of_held_rods)).any(|at| points.root(at) == root)
}

/// Whether the nodes of a joint have no other joint.
fn is_alone(scene: &Scene, joint: &Joint) -> bool {
    let touches = |other: &&Joint| other.nodes.iter().any(|node| joint.nodes.contains(node));
    scene.joints.iter().filter(touches).count() == 1
}

/// Whether a joint has two existing nodes at one point.
fn check_places(scene: &Scene, nodes: &[RodNode; 2]) -> Result<(), JointError> {
    let span = span(scene, nodes)?;
    if span.is_a_point() {
        return Ok(());
    }
    Err(JointError::Apart {
        distance: span.distance,
    })
}

/// Sets of nodes, which can be merged.
#[derive(Default)]
struct Groups {
    parent: BTreeMap<RodNode, RodNode>,
}

impl Groups {
    fn add(&mut self, node: RodNode) {
        self.parent.entry(node).or_insert(node);
    }

    fn root(&self, node: RodNode) -> RodNode {
        let mut node = node;
        while let Some(parent) = self.parent.get(&node).filter(|parent| **parent != node) {
            node = *parent;
        }
        node
    }

    fn are_joined(&self, [a, b]: [RodNode; 2]) -> bool {
        self.root(a) == self.root(b)
    }

    fn join(&mut self, [a, b]: [RodNode; 2]) {
        self.add(a);
        self.add(b);
        let (a, b) = (self.root(a), self.root(b));
        self.parent.insert(a.max(b), a.min(b));
    }

    /// The sets, each in the order of its nodes, ordered by their first nodes.
    fn into_groups(self) -> Vec<Vec<RodNode>> {
        let mut groups: BTreeMap<RodNode, Vec<RodNode>> = BTreeMap::new();
        for node in self.parent.keys() {
            groups.entry(self.root(*node)).or_default().push(*node);
        }
        groups.into_values().collect()
    }
}
