//! Joints, springs and bodies of rods.

use crate::mechanics::Vector3;

/// A node of a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RodNode {
    /// Index of the rod.
    pub rod: usize,
    /// Index of the node along the rod.
    pub node: usize,
}

/// Two nodes, of one rod or of two, that are the same point from time zero on. If the first slides
/// along the rod of the second, they are the same point only at time zero.
///
/// They share one position exactly, as one set of unknowns. Any number of joints may meet at a
/// point.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name in scenarios and messages.
    pub name: String,
    /// The nodes, which are placed at one point.
    pub nodes: [RodNode; 2],
    /// Relative motion that the joint leaves free.
    pub kind: JointKind,
    /// Strength; only for slides, and for joints that are alone at their point.
    pub strength: Strength,
}

/// Strength of a joint or spring, which breaks at the end of a step with a larger load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Largest force, N: for a spring the tension or compression, for a joint the force between
    /// the two rods.
    pub force: f64,
    /// Largest moment between the rods, N m.
    pub moment: f64,
}

impl Default for Strength {
    /// Strength of a joint that never breaks.
    fn default() -> Self {
        Self {
            force: f64::INFINITY,
            moment: f64::INFINITY,
        }
    }
}

impl Strength {
    /// Strength of a joint that breaks under a force (N) only.
    pub fn of_force(force: f64) -> Self {
        Self {
            force,
            ..Self::default()
        }
    }

    /// Strength of a joint that breaks under a moment (N m) only.
    pub fn of_moment(moment: f64) -> Self {
        Self {
            moment,
            ..Self::default()
        }
    }

    /// Whether any force or moment breaks it.
    pub(crate) fn may_break(&self) -> bool {
        self.force.min(self.moment) < f64::INFINITY
    }
}

/// Two nodes, of one rod or of two, between which a spring pulls or pushes, or whose material
/// frames it rotates relative to each other. They need not be at one point.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Name in scenarios and messages.
    pub name: String,
    /// The nodes.
    pub nodes: [RodNode; 2],
    /// Force per extension k, N/m; 0 if it neither pulls nor pushes.
    pub stiffness: f64,
    /// Torsional spring between the material frames of the rods at its nodes.
    pub turning: Option<TurningStiffness>,
    /// Rest length, m; `None` is the distance of the nodes as placed.
    pub rest_length: Option<f64>,
    /// The only sign of its force; `None` if it pulls and pushes.
    pub only: Option<SpringForce>,
    /// Strength.
    pub strength: Strength,
}

/// Sign of the force of a spring between nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringForce {
    /// The spring pulls where it is longer than its rest length: a tie, a bungee.
    Tension,
    /// The spring pushes where it is shorter than its rest length: a bumper.
    Compression,
}

/// Resistance of a spring to the relative rotation of the material frames of two rods, about any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningStiffness {
    /// Moment per angle c, N m/rad.
    pub stiffness: f64,
    /// Rotation vector of the second frame relative to the first at which there is no moment, rad.
    /// The rotation counts from the placed frames, in the axes of the scene.
    pub rest_rotation: Vector3,
}

/// Degrees of freedom of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Every rotation.
    Ball,
    /// No freedom: the angles between the rods, and between their cross-sections, stay as placed.
    Rigid,
    /// A rotation of the second rod relative to the first about an axis that rotates with the
    /// first; the axis is given as placed.
    Hinge {
        /// Unit vector.
        axis: Vector3,
        /// A spring that resists the rotation.
        spring: Option<HingeSpring>,
    },
    /// All rotations, and sliding along the rod of the second node, between stops at its ends. If
    /// both nodes are on the same rod, the first slides along the part of the rod on the side of
    /// the second.
    Slide {
        /// Friction along that rod; `None` if it slides freely.
        friction: Option<CoulombFriction>,
    },
}

impl JointKind {
    /// A slide without friction.
    pub const FREE_SLIDE: Self = Self::Slide { friction: None };

    /// Whether a node slides along a rod.
    pub fn slides(&self) -> bool {
        matches!(self, Self::Slide { .. })
    }
}

/// Friction of what slides: a node along a rod, or a tendon in its eyelets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombFriction {
    /// Coefficient μ.
    pub coefficient: f64,
    /// Distance of motion before it slides, m; `None` is 10⁻⁵ of the length of that rod, or of the
    /// tendon as placed.
    pub presliding: Option<f64>,
}

/// A spring about the axis of a hinge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HingeSpring {
    /// Moment per angle c, N m/rad.
    pub stiffness: f64,
    /// Angle, counted from the hinge as placed, at which there is no moment, rad.
    pub rest_angle: f64,
}

/// A mass at a node, or a rigid body that is welded to the rod there.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name in scenarios and messages.
    pub name: String,
    /// Node that carries the body.
    pub at: RodNode,
    /// Mass, kg.
    pub mass: f64,
    /// Vector from the node to its centre of mass, in components along the two material directors
    /// and the tangent of the rod there, m.
    pub offset: Vector3,
    /// Principal moments of inertia (kg m²) about axes through its centre of mass along the two
    /// material directors and the tangent; `None` for a point mass at the node, which does not
    /// stiffen the rod.
    pub inertia: Option<[f64; 3]>,
    /// Contact radius of the ball around the node, m; `None` without contact.
    pub ball: Option<f64>,
}

impl Body {
    /// A uniform ball of a mass (kg) and radius (m) with its centre at a node.
    pub fn uniform_ball(at: RodNode, mass: f64, radius: f64) -> Self {
        Self {
            name: "ball".into(),
            at,
            mass,
            offset: Vector3::zeros(),
            inertia: Some([0.4 * mass * radius * radius; 3]),
            ball: Some(radius),
        }
    }
}
