//! Joints that break where the force on them is too large.
//!
//! That of a spring between nodes is k (r − L), pulled or pushed. That of a ball joint of two nodes is what holds the node
//! whose position is that of the other one: the residual M a + ∇E − F of its own rod there, before it is added to that of
//! the other; that of a slide is what holds the node that slides. Where a step ends with more than a joint bears, it breaks:
//! the spring is gone, the node has its own position and goes on with its velocity. Contact goes on to pass over what
//! overlapped at the joint.

use super::System;
use super::build::Assembly;
use crate::mechanics::rod::{STRIDE, topology::position};
use crate::mechanics::scene::{JointKind, RodNode, Scene};
use serde::{Deserialize, Serialize};
use tracing::info;

/// How a joint broke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Break {
    /// When, s: the end of a step.
    pub time: f64,
    /// Under which force, N.
    pub force: f64,
}

/// The joints and springs of a scene that break, in this order.
#[derive(Clone, Debug, Default)]
pub(super) struct Breaking {
    links: Vec<Link>,
}

#[derive(Clone, Debug)]
struct Link {
    name: String,
    /// Largest force that it bears, N.
    strength: f64,
    tie: Tie,
    broken: Option<Break>,
}

#[derive(Clone, Copy, Debug)]
enum Tie {
    /// A spring between nodes, by its number.
    Spring(usize),
    /// A node whose position is that of another one.
    Ball {
        node: usize,
        /// Force of the joint on it at the last evaluation, N.
        force: f64,
    },
    /// A node that slides along a rod.
    Slide(usize),
}

impl Breaking {
    /// Those of a scene whose rods are joined.
    pub fn new(scene: &Scene, assembly: &Assembly) -> Self {
        let number = |at: &RodNode| assembly.rods.rods[at.rod].first_node + at.node;
        let mut links = Vec::new();
        for joint in &scene.joints {
            let Some(strength) = joint.strength else {
                continue;
            };
            let nodes = joint.nodes.each_ref().map(number);
            if joint.kind == JointKind::Slide {
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
                tie: Tie::Ball { node, force: 0.0 },
                broken: None,
            });
        }
        for (number, spring) in scene.springs.iter().enumerate() {
            if let Some(strength) = spring.strength {
                links.push(Link {
                    name: spring.name.clone(),
                    strength,
                    tie: Tie::Spring(number),
                    broken: None,
                });
            }
        }
        Self { links }
    }

    /// Keeps the forces of joints from a residual over all nodes.
    pub fn note(&mut self, residual: &[f64]) {
        for link in &mut self.links {
            if let Tie::Ball { node, force } = &mut link.tie {
                *force = position(residual, *node).norm();
            }
        }
    }

    /// What broke, a sentence each.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        self.links.iter().filter_map(|link| {
            let Break { time, force } = link.broken?;
            let name = &link.name;
            Some(format!(
                "joint `{name}` broke at t = {time:.6e} s under {force:.6e} N"
            ))
        })
    }
}

impl System {
    /// Breaks the joints that bear less than the step put on them that ended at `time` (s) with `unknowns`; says whether
    /// there are any.
    pub fn break_joints(&mut self, time: f64, unknowns: &[f64]) -> bool {
        self.springs.stretch(unknowns);
        let mut breaking = std::mem::take(&mut self.breaking);
        let mut any = false;
        for link in breaking
            .links
            .iter_mut()
            .filter(|link| link.broken.is_none())
        {
            let force = match link.tie {
                Tie::Spring(number) => self.springs.force(number).abs(),
                Tie::Ball { force, .. } => force,
                Tie::Slide(node) => {
                    let mut slides = self.assembly.joints.slides.iter();
                    let slide = slides.find(|slide| slide.node == node);
                    slide.map_or(0.0, |slide| slide.force())
                }
            };
            if force > link.strength {
                info!(joint = link.name, time, force, "joint broke");
                link.broken = Some(Break { time, force });
                self.part(link.tie);
                any = true;
            }
        }
        self.breaking = breaking;
        if any {
            self.damping.rest();
            self.matrix.adapt(&self.assembly);
        }
        any
    }

    /// How each joint that may break did so, if it did: in the order of the joints of the scene, then of its springs.
    pub fn breaks(&self) -> Vec<Option<Break>> {
        let links = self.breaking.links.iter();
        links.map(|link| link.broken).collect()
    }

    /// What broke, a sentence each.
    pub fn remarks_on_breaks(&self) -> impl Iterator<Item = String> {
        self.breaking.remarks()
    }

    /// Breaks again what broke before a checkpoint of the same scene, of which nothing has broken yet.
    ///
    /// # Errors
    /// What of it does not fit.
    pub fn restore_breaks(&mut self, breaks: &[Option<Break>]) -> Result<(), &'static str> {
        if breaks.len() != self.breaking.links.len() {
            return Err("joints that break");
        }
        for (number, broken) in breaks.iter().enumerate() {
            if broken.is_some() {
                let link = &mut self.breaking.links[number];
                link.broken = *broken;
                let tie = link.tie;
                self.part(tie);
            }
        }
        self.matrix.adapt(&self.assembly);
        Ok(())
    }

    fn part(&mut self, tie: Tie) {
        match tie {
            Tie::Spring(number) => self.springs.cut(number),
            Tie::Ball { node, .. } => {
                let joints = &mut self.assembly.joints;
                joints.points.retain(|point| point[0] != node);
                self.assembly.held[STRIDE * node..STRIDE * node + 3].fill(false);
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
