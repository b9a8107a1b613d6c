//! Kinematic chains: the joints from an arm's base to its hand.

use super::pose::Pose;
use nalgebra::{UnitQuaternion, UnitVector3};

/// Maximum number of independent joints of a chain.
pub const MOST_JOINTS: usize = 12;

/// A chain of links from a base to a hand.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Independent joints, in the order from base to hand.
    pub joints: Vec<Joint>,
    /// The links beyond the base, each with the joint that carries it.
    pub segments: Vec<Segment>,
    /// Joints that mimic independent ones.
    pub followers: Vec<Follower>,
    /// Pose of the hand in the frame of the last link.
    pub tool: Pose,
}

/// An independent joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name of the joint, as its driver uses it.
    pub name: String,
    /// Whether the joint is revolute or prismatic.
    pub kind: JointKind,
    /// Limits of position, velocity, acceleration and jerk.
    pub limits: Limits,
}

/// Type of motion of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Revolute joint; positions are in rad.
    Revolute,
    /// Prismatic joint; positions are in m.
    Prismatic,
}

impl JointKind {
    /// The unit of the joint's positions.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }

    /// The unit of the joint's efforts.
    pub fn effort_unit(self) -> &'static str {
        match self {
            Self::Revolute => "N m",
            Self::Prismatic => "N",
        }
    }
}

/// Limits of a joint, in rad or m and seconds; infinite if there is no limit.
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
    /// Range in which postures are searched: one turn if the joint has no limits.
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

    /// Whether a position is allowed, up to round-off.
    pub fn allow(&self, position: f64) -> bool {
        (self.lower - 1e-9..=self.upper + 1e-9).contains(&position)
    }
}

/// A joint that mimics another, with its own limits.
#[derive(Clone, Debug)]
pub struct Follower {
    /// Name of the joint.
    pub name: String,
    /// Index of the joint that it follows.
    pub joint: usize,
    /// Motion per motion of the followed joint.
    pub ratio: f64,
    /// Position at zero of the followed joint.
    pub offset: f64,
    /// Limits of the joint.
    pub limits: Limits,
}

impl Follower {
    /// Narrows the limits of the followed joint so that the limits of the follower hold.
    ///
    /// # Errors
    /// A message if the followed joint has no such position.
    fn narrow(&self, leader: &mut Joint) -> Result<(), String> {
        let of_leader = |position: f64| (position - self.offset) / self.ratio;
        let limits = &mut leader.limits;
        let is_reachable = if self.ratio == 0.0 {
            self.limits.allow(self.offset)
        } else {
            let ends = [self.limits.lower, self.limits.upper].map(of_leader);
            limits.lower = limits.lower.max(ends[0].min(ends[1]));
            limits.upper = limits.upper.min(ends[0].max(ends[1]));
            limits.lower < limits.upper
        };
        if !is_reachable {
            return Err(format!(
                "joint `{}`: its limits, {} to {}, leave no range for joint `{}`, which it mimics",
                self.name, self.limits.lower, self.limits.upper, leader.name
            ));
        }
        let per_motion = self.ratio.abs();
        if per_motion > 0.0 {
            limits.velocity = limits.velocity.min(self.limits.velocity / per_motion);
            limits.acceleration = limits
                .acceleration
                .min(self.limits.acceleration / per_motion);
            limits.jerk = limits.jerk.min(self.limits.jerk / per_motion);
        }
        Ok(())
    }
}

/// A link, and its motion relative to the link before.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Name of the link.
    pub link: String,
    /// Pose of the joint in the frame of the link before.
    pub origin: Pose,
    /// Type of motion of the joint.
    pub motion: Motion,
}

/// The motion of a link about or along the axis of its joint.
#[derive(Clone, Copy, Debug)]
pub enum Motion {
    /// None.
    Fixed,
    /// The motion is `ratio · position + offset` of a joint; `ratio` is 1 and `offset` 0 except
    /// for a joint that mimics another.
    Driven {
        /// Whether the motion is a rotation or a translation.
        kind: JointKind,
        /// The axis, in the frame of the joint.
        axis: UnitVector3<f64>,
        /// Index of the joint that drives it.
        joint: usize,
        /// Motion per motion of that joint.
        ratio: f64,
        /// Motion at zero of that joint.
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

    /// Largest sliding distance of the link from the origin of its joint, m; 0 if it turns or is
    /// fixed.
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

    /// Whether the link can move relative to the link before.
    pub fn moves(&self) -> bool {
        matches!(self.motion, Motion::Driven { .. })
    }
}

impl Chain {
    /// Names of the joints, from base to hand.
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// Narrows the limits of joints so that the limits of the joints that mimic them hold, too.
    ///
    /// # Errors
    /// A message if no position of a joint is left.
    pub fn apply_followers(&mut self) -> Result<(), String> {
        let Self {
            joints, followers, ..
        } = self;
        followers
            .iter()
            .try_for_each(|follower| match joints.get_mut(follower.joint) {
                Some(leader) => follower.narrow(leader),
                None => Ok(()),
            })
    }

    /// The middle of the range of every joint; zero if the range is unlimited.
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

    /// Index of the link with a name among the segments.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.segments
            .iter()
            .position(|segment| segment.link == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{chain, revolute};

    #[test]
    fn a_slide_that_mimics_a_joint_reaches_as_far_as_its_ends() {
        let mut arm = chain(
            vec![revolute(Pose::identity(), (-0.2, 0.5))],
            Pose::identity(),
        );
        for (ratio, offset, farthest) in [(1.0, 0.3, 0.8), (-1.0, 0.3, 0.5), (2.0, -0.4, 0.8)] {
            let segment = &mut arm.segments[0];
            segment.motion = Motion::Driven {
                kind: JointKind::Prismatic,
                axis: nalgebra::Vector3::x_axis(),
                joint: 0,
                ratio,
                offset,
            };
            let found = segment.farthest_slide(&arm.joints);
            assert!((found - farthest).abs() < 1e-12, "{found}");
            let places = (0..=70).map(|k| segment.pose(&[-0.2 + 0.01 * f64::from(k)]));
            let reached = places.map(|pose| pose.translation.vector.norm());
            assert!((reached.fold(0.0, f64::max) - farthest).abs() < 1e-12);
        }
    }
}
