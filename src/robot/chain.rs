//! Kinematic chains: the joints from an arm's base to its hand.

use super::pose::Pose;
use nalgebra::{UnitQuaternion, UnitVector3};

/// Most joints of a chain that move on their own.
pub const MOST_JOINTS: usize = 12;

/// A chain of links from a base to a hand.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The joints that move on their own, in the order from base to hand.
    pub joints: Vec<Joint>,
    /// The links beyond the base, each with the joint that carries it.
    pub segments: Vec<Segment>,
    /// Pose of the hand in the frame of the last link.
    pub tool: Pose,
}

/// A joint that moves on its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name, as its driver knows it.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// How far and how fast it may.
    pub limits: Limits,
}

/// What a joint does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// It turns; positions are in rad.
    Revolute,
    /// It slides; positions are in m.
    Prismatic,
}

impl JointKind {
    /// The unit of its positions.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }
}

/// Limits of a joint, in rad or m and seconds; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Least position.
    pub lower: f64,
    /// Greatest position.
    pub upper: f64,
    /// Greatest speed.
    pub velocity: f64,
    /// Greatest acceleration.
    pub acceleration: f64,
    /// Greatest jerk.
    pub jerk: f64,
}

impl Limits {
    /// The range in which postures are sought: one turn where the joint has no end.
    pub fn search_range(&self) -> (f64, f64) {
        use std::f64::consts::PI;
        (
            if self.lower.is_finite() {
                self.lower
            } else {
                -PI
            },
            if self.upper.is_finite() {
                self.upper
            } else {
                PI
            },
        )
    }

    /// Whether a position is allowed, but for round-off.
    pub fn allow(&self, position: f64) -> bool {
        (self.lower - 1e-9..=self.upper + 1e-9).contains(&position)
    }
}

/// A link and how the joint before it moves it.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Name of the link.
    pub link: String,
    /// Pose of the joint in the frame of the link before.
    pub origin: Pose,
    /// What the joint does.
    pub motion: Motion,
}

/// The motion of a link about or along the axis of its joint.
#[derive(Clone, Copy, Debug)]
pub enum Motion {
    /// None.
    Fixed,
    /// `ratio · position + offset` of a joint: 1 and 0 but for a joint that mimics another.
    Driven {
        /// Whether it turns or slides.
        kind: JointKind,
        /// The axis, in the frame of the joint.
        axis: UnitVector3<f64>,
        /// Index of the joint that drives it.
        joint: usize,
        /// Motion per motion of that joint.
        ratio: f64,
        /// Motion where that joint is at zero.
        offset: f64,
    },
}

impl Segment {
    /// Pose of the link in the frame of the link before, at the given joint positions.
    pub fn pose(&self, positions: &[f64]) -> Pose {
        match self.motion {
            Motion::Fixed => self.origin,
            Motion::Driven {
                kind,
                axis,
                joint,
                ratio,
                offset,
            } => {
                let amount = ratio * positions[joint] + offset;
                match kind {
                    JointKind::Revolute => {
                        self.origin * UnitQuaternion::from_axis_angle(&axis, amount)
                    }
                    JointKind::Prismatic => {
                        self.origin * nalgebra::Translation3::from(axis.scale(amount))
                    }
                }
            }
        }
    }

    /// How far the link slides from the origin of its joint at most, m; 0 where it turns or is fixed.
    pub(super) fn farthest_slide(&self, joints: &[Joint]) -> f64 {
        match self.motion {
            Motion::Driven {
                kind: JointKind::Prismatic,
                joint,
                ratio,
                offset,
                ..
            } => {
                let (lower, upper) = joints[joint].limits.search_range();
                (ratio * lower + offset)
                    .abs()
                    .max((ratio * upper + offset).abs())
            }
            _ => 0.0,
        }
    }

    /// Whether the link can move against the one before.
    pub fn moves(&self) -> bool {
        matches!(self.motion, Motion::Driven { .. })
    }
}

impl Chain {
    /// The middle of every joint's range; zero where that is without end.
    pub fn middle(&self) -> Vec<f64> {
        self.joints
            .iter()
            .map(|joint| {
                let (lower, upper) = joint.limits.search_range();
                0.5 * (lower + upper)
            })
            .collect()
    }

    /// The joint that is farthest outside its range, if any is.
    pub fn outside_limits(&self, positions: &[f64]) -> Option<&Joint> {
        self.joints
            .iter()
            .zip(positions)
            .find(|(joint, position)| !joint.limits.allow(**position))
            .map(|(joint, _)| joint)
    }

    /// Index of the link of that name among the segments.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.segments
            .iter()
            .position(|segment| segment.link == name)
    }
}
