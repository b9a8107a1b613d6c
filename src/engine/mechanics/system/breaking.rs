//! Joints that break if the force or the moment on them is too large.
//!
//! The force and moment of a spring are k (r − L), pulled or pushed, and c θ. In a joint of two
//! nodes, one node has the position of the other. The force of the joint holds this node: it is the
//! residual M a + ∇E − F of the node's own rod there, before it is added to that of the other node.
//! The force of a slide is the one that holds the sliding node. The moment of a rigid joint or
//! hinge is the sum of all moments on the frame of one of its rods. A weld that may break has a
//! frame for either rod; one of these has the unknowns of the other ([`super::joints`]).
//!
//! A joint breaks at the end of a step with a load above its strength: the spring is removed, and
//! the node and the frame get their own unknowns and keep their velocities. Contact still ignores
//! the parts that overlapped at the joint.

use super::System;
use super::build::Assembly;
use super::joints::{Joints, TurningFrame};
use crate::mechanics::rod::{STRIDE, topology::position};
use crate::mechanics::scene::{JointKind, RodNode, Scene, Strength};
use serde::{Deserialize, Serialize};
use tracing::info;

/// Breaking of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Break {
    /// Time, s: the end of a step.
    pub time: f64,
    /// Force, N.
    pub force: f64,
    /// Moment, N m; 0 if the joint transmits none.
    pub moment: f64,
}

/// The joints, then the springs of a scene that may break.
#[derive(Clone, Debug, Default)]
pub(super) struct Breaking {
    links: Vec<Link>,
}

#[derive(Clone, Debug)]
struct Link {
    name: String,
    strength: Strength,
    tie: Tie,
    broken: Option<Break>,
}

#[derive(Clone, Copy, Debug)]
enum Tie {
    /// A spring between nodes, by its index.
    Spring(usize),
    /// A node that has the position of another node.
    Point {
        node: usize,
        /// The effect of the joint on the frame of the rod.
        turning: Turning,
        /// Force (N) and moment (N m) of the joint at the last evaluation.
        load: [f64; 2],
    },
    /// A node that slides along a rod.
    Slide(usize),
}

/// Effect of a joint on the frame of one of its rods, with the index of the frame.
#[derive(Clone, Copy, Debug)]
enum Turning {
    /// No effect: a ball joint.
    Free,
    /// The frame turns like that of the other rod.
    Weld(usize),
    /// The frame turns on a hinge.
    Hinge(usize),
}

impl Turning {
    fn frame(&self) -> Option<usize> {
        match *self {
            Self::Free => None,
            Self::Weld(frame) | Self::Hinge(frame) => Some(frame),
        }
    }
}

impl Breaking {
    /// Collects the breakable joints and springs of a scene whose rods are joined.
    pub(crate) fn new(scene: &Scene, assembly: &Assembly) -> Self {
        let number = |at: &RodNode| assembly.rods.rods[at.rod].first_node + at.node;
        let mut links = Vec::new();
        let joints = scene.joints.iter();
        for joint in joints.filter(|joint| joint.strength.may_break()) {
            let strength = joint.strength;
            let nodes = joint.nodes.each_ref().map(number);
            if joint.kind.slides() {
                let mut points = assembly.joints.points.iter();
                let owner = points.find(|point| point[0] == nodes[0]);
                links.push(Link {
                    name: joint.name.clone(),
                    strength,
                    tie: Tie::Slide(owner.map_or(nodes[0], |point| point[1])),
                    broken: None,
                });
                continue;
            }
            let mut points = assembly.joints.points.iter();
            let point = points.find(|point| point.iter().all(|node| nodes.contains(node)));
            let &[node, _] = point.expect("a joint that breaks has its point for itself");
            links.push(Link {
                name: joint.name.clone(),
                strength,
                tie: Tie::Point {
                    node,
                    turning: turning_of(joint.kind, nodes, &assembly.joints),
                    load: [0.0; 2],
                },
                broken: None,
            });
        }
        for (number, spring) in scene.springs.iter().enumerate() {
            if spring.strength.may_break() {
                links.push(Link {
                    name: spring.name.clone(),
                    strength: spring.strength,
                    tie: Tie::Spring(number),
                    broken: None,
                });
            }
        }
        Self { links }
    }

    /// Stores the forces of joints from a residual over all nodes.
    pub(crate) fn note(&mut self, residual: &[f64]) {
        for link in &mut self.links {
            if let Tie::Point { node, load, .. } = &mut link.tie {
                load[0] = position(residual, *node).norm();
            }
        }
    }

    /// Stores the moments of joints from those on frames.
    pub(crate) fn note_moments(&mut self, joints: &Joints) {
        for link in &mut self.links {
            if let Tie::Point { turning, load, .. } = &mut link.tie
                && let Some(frame) = turning.frame()
            {
                load[1] = joints.moment_on(frame).norm();
            }
        }
    }

    /// Remarks on broken joints, one sentence each.
    pub(crate) fn remarks(&self) -> impl Iterator<Item = String> {
        self.links.iter().filter_map(|link| {
            let Break {
                time,
                force,
                moment,
            } = link.broken?;
            let name = &link.name;
            let mut remark =
                format!("joint `{name}` broke at t = {time:.6e} s under {force:.6e} N");
            if moment > 0.0 {
                remark += &format!(" and {moment:.6e} N m");
            }
            Some(remark)
        })
    }
}

/// Effect of a joint of two nodes on the frame of one of their rods.
fn turning_of(kind: JointKind, nodes: [usize; 2], joints: &Joints) -> Turning {
    let mut frames = joints.frames.iter().enumerate();
    let mut of_frame = |is_tied: &dyn Fn(&TurningFrame) -> bool| {
        let tied = frames.find(|(_, frame)| nodes.contains(&frame.node) && is_tied(frame));
        tied.expect("a joint that breaks has its frames for itself")
            .0
    };
    match kind {
        JointKind::Ball | JointKind::Slide { .. } => Turning::Free,
        JointKind::Rigid => Turning::Weld(of_frame(&|frame| {
            let welds = &joints.welds;
            welds
                .iter()
                .any(|weld| STRIDE * weld[0] == frame.first_unknown)
        })),
        JointKind::Hinge { .. } => Turning::Hinge(of_frame(&|frame| frame.hinge.is_some())),
    }
}

impl System {
    /// Breaks the joints whose load exceeds their strength in the step that ended at `time` (s)
    /// with `unknowns` and `velocity`, which are then converted to those of free bodies; returns
    /// whether any broke.
    pub(crate) fn break_joints(
        &mut self,
        time: f64,
        unknowns: &mut [f64],
        velocity: &mut [f64],
    ) -> bool {
        if self.breaking.links.is_empty() {
            return false;
        }
        self.terms.springs.stretch(unknowns);
        self.assembly.joints.rotate(unknowns);
        (self.terms.springs).turn(&self.assembly.joints, &self.assembly.drives, time);
        let mut broken = Vec::new();
        let links = self.breaking.links.iter().enumerate();
        for (number, link) in links.filter(|(_, link)| link.broken.is_none()) {
            let [force, moment] = match link.tie {
                Tie::Spring(number) => [
                    self.terms.springs.force(number).abs(),
                    self.terms.springs.moment(number),
                ],
                Tie::Point { load, .. } => load,
                Tie::Slide(node) => {
                    let mut slides = self.assembly.joints.slides.iter();
                    let slide = slides.find(|slide| slide.node == node);
                    [slide.map_or(0.0, |slide| slide.force()), 0.0]
                }
            };
            if force > link.strength.force || moment > link.strength.moment {
                info!(joint = link.name, time, force, moment, "joint broke");
                broken.push((
                    number,
                    Break {
                        time,
                        force,
                        moment,
                    },
                ));
            }
        }
        self.break_links(&broken, unknowns, velocity);
        !broken.is_empty()
    }

    /// Breaks the joints that a list from [`Self::breaks`] marks as broken and that are still
    /// intact; returns whether there are any.
    pub(crate) fn break_like(
        &mut self,
        breaks: &[Option<Break>],
        unknowns: &mut [f64],
        velocity: &mut [f64],
    ) -> bool {
        let links = self.breaking.links.iter().zip(breaks).enumerate();
        let here = links.filter_map(|(number, (link, there))| match link.broken {
            None => there.map(|there| (number, there)),
            Some(_) => None,
        });
        let broken: Vec<_> = here.collect();
        self.break_links(&broken, unknowns, velocity);
        !broken.is_empty()
    }

    /// Breaks joints, given by their indices, at `unknowns` and `velocity`, which are then
    /// converted to those of free bodies.
    fn break_links(
        &mut self,
        broken: &[(usize, Break)],
        unknowns: &mut [f64],
        velocity: &mut [f64],
    ) {
        if broken.is_empty() {
            return;
        }
        for &(number, own) in broken {
            let link = &mut self.breaking.links[number];
            link.broken = Some(own);
            let tie = link.tie;
            if let Tie::Point {
                turning: Turning::Hinge(frame),
                ..
            } = tie
            {
                let joints = &mut self.assembly.joints;
                joints.take_over_rotation(frame, unknowns, velocity);
            }
            self.part(tie);
        }
        self.terms.damping.rest();
        self.recouple();
    }

    /// The break of each breakable joint, if it broke: first the joints of the scene, then its
    /// springs.
    pub(crate) fn breaks(&self) -> Vec<Option<Break>> {
        let links = self.breaking.links.iter();
        links.map(|link| link.broken).collect()
    }

    /// Remarks on broken joints, one sentence each.
    pub(crate) fn remarks_on_breaks(&self) -> impl Iterator<Item = String> {
        self.breaking.remarks()
    }

    /// Breaks the joints that were broken at a checkpoint of the same scene. No joint may be
    /// broken before the call.
    ///
    /// # Errors
    /// The difference if the checkpoint belongs to another scene.
    pub(crate) fn restore_breaks(&mut self, breaks: &[Option<Break>]) -> Result<(), &'static str> {
        if breaks.len() != self.breaking.links.len() {
            return Err("the number of joints that break differs");
        }
        for (number, broken) in breaks.iter().enumerate() {
            if broken.is_some() {
                let link = &mut self.breaking.links[number];
                link.broken = *broken;
                let tie = link.tie;
                self.part(tie);
            }
        }
        self.recouple();
        Ok(())
    }

    fn recouple(&mut self) {
        let elements = self.terms.elements(&self.assembly);
        self.matrix.recouple(&self.assembly, &elements);
    }

    fn part(&mut self, tie: Tie) {
        match tie {
            Tie::Spring(number) => self.terms.springs.cut(number),
            Tie::Point { node, turning, .. } => {
                let joints = &mut self.assembly.joints;
                joints.points.retain(|point| point[0] != node);
                self.assembly.held[STRIDE * node..STRIDE * node + 3].fill(false);
                let own = turning
                    .frame()
                    .map_or(0, |frame| joints.frames[frame].first_unknown);
                match turning {
                    Turning::Free => {}
                    Turning::Weld(_) => joints.welds.retain(|weld| STRIDE * weld[0] != own),
                    Turning::Hinge(frame) => {
                        let frame = &mut joints.frames[frame];
                        (frame.hinge, frame.spring) = (None, None);
                        self.terms.springs.leave_hinge(own + 3);
                        self.assembly.held[own..own + 3].fill(false);
                        self.assembly.held[own + 3] = true;
                    }
                }
            }
            Tie::Slide(node) => {
                let slides = &mut self.assembly.joints.slides;
                if let Some(number) = slides.iter().position(|slide| slide.node == node) {
                    let slide = slides.remove(number);
                    self.assembly.held[slide.unknown] = true;
                }
            }
        }
    }
}
