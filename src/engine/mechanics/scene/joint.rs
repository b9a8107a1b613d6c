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

/// Two nodes, of one rod or of two, that are the same point from time zero on, or start as one where the first slides along
/// the rod of the second.
///
/// They keep one position, exactly: it is one set of unknowns. Any number of joints may meet at a point.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name in scenarios and messages.
    pub name: String,
    /// The nodes, which are placed at one point.
    pub nodes: [RodNode; 2],
    /// Relative rotation that the joint leaves free.
    pub kind: JointKind,
    /// Strength; only for slides, and for joints that share their point with no other one.
    pub strength: Strength,
}

/// Strength of a joint or spring: it breaks at the end of a step with a larger load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Largest force, N: of a spring its tension or compression, of a joint the force between the two rods.
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
    /// Strength of a joint that breaks under a force (N) alone.
    pub fn of_force(force: f64) -> Self {
        Self {
            force,
            ..Self::default()
        }
    }

    /// Strength of a joint that breaks under a moment (N m) alone.
    pub fn of_moment(moment: f64) -> Self {
        Self {
            moment,
            ..Self::default()
        }
    }

    /// Whether there is a force or moment under which it breaks.
    pub(crate) fn may_break(&self) -> bool {
        self.force.min(self.moment) < f64::INFINITY
    }
}

/// Two nodes, of one rod or of two, that a spring pulls together and pushes apart, or whose material frames it turns towards
/// each other; they need not be at one point.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Name in scenarios and messages.
    pub name: String,
    /// The nodes.
    pub nodes: [RodNode; 2],
    /// Force per lengthening k, N/m; 0 where it neither pulls nor pushes.
    pub stiffness: f64,
    /// Torsional spring between the material frames of the rods at its nodes.
    pub turning: Option<TurningStiffness>,
    /// Length without force, m; `None` is the distance of the nodes as placed.
    pub rest_length: Option<f64>,
    /// Strength.
    pub strength: Strength,
}

/// Resistance of a spring to the relative rotation of the material frames of two rods, about any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningStiffness {
    /// Moment per angle c, N m/rad.
    pub stiffness: f64,
    /// Rotation vector of the second frame against the first, from where they are placed and in the axes of the scene there,
    /// at which it exerts no moment, rad.
    pub rest_rotation: Vector3,
}

/// Degrees of freedom of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Every rotation.
    Ball,
    /// None: the angles between the rods, and between their cross-sections, stay as placed.
    Rigid,
    /// A rotation of the second rod against the first about an axis that turns with the first, here as placed.
    Hinge {
        /// Unit vector.
        axis: Vector3,
        /// A spring that resists the rotation.
        spring: Option<HingeSpring>,
    },
    /// Every rotation, and moves along the rod of the second node, between stops at its ends. Along its own rod a node slides
    /// on the side of it where the second one is.
    Slide,
}

/// A spring about the axis of a hinge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HingeSpring {
    /// Moment per angle c, N m/rad.
    pub stiffness: f64,
    /// Angle from the hinge as placed at which it exerts no moment, rad.
    pub rest_angle: f64,
}

/// A mass at a node, or a rigid body that is welded to the rod there.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name in scenarios and messages.
    pub name: String,
    /// Its node.
    pub at: RodNode,
    /// Mass, kg.
    pub mass: f64,
    /// From the node to its centre of mass along the two material directors and the tangent of the rod there, m.
    pub offset: Vector3,
    /// Principal moments of inertia (kg m²) about its centre of mass and axes along the two material directors and the tangent;
    /// `None` for a point mass at the node, which the rod carries without being stiffened.
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
