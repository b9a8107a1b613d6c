//! What joins rods, and what they carry.

use crate::mechanics::Vector3;

/// A node of a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RodNode {
    /// Index of the rod.
    pub rod: usize,
    /// Index of the node along the rod.
    pub node: usize,
}

/// Two nodes, of one rod or of two, that are the same point from time zero on, or begin as one where the first slides along
/// the rod of the second.
///
/// They keep one position, exactly: it is one set of unknowns. Any number of joints may meet at a point.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name by which scenarios and messages call it.
    pub name: String,
    /// The nodes, which are placed at one point.
    pub nodes: [RodNode; 2],
    /// How rods may turn against each other there.
    pub kind: JointKind,
    /// Largest force that it bears, N; only of slides, and of balls that share their point with no other joint.
    pub strength: Option<f64>,
}

/// Two nodes, of one rod or of two, that a spring pulls together and pushes apart; they need not lie at one point.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Name by which scenarios and messages call it.
    pub name: String,
    /// The nodes.
    pub nodes: [RodNode; 2],
    /// Force per lengthening k, N/m.
    pub stiffness: f64,
    /// Length without force, m; `None` is the distance of the nodes as placed.
    pub rest_length: Option<f64>,
    /// Largest force that it bears, pulled or pushed, N.
    pub strength: Option<f64>,
}

/// What a joint leaves free.
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

/// A mass at a node, or a rigid body that is welded to the rod there with its centre of mass at the node.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name by which scenarios and messages call it.
    pub name: String,
    /// Where it is.
    pub at: RodNode,
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia (kg m²) about the two material directors and the tangent of the rod at the node; `None`
    /// for a point mass, which the rod carries without being stiffened.
    pub inertia: Option<[f64; 3]>,
}
