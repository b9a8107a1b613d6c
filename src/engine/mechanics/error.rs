//! Errors of scenes.

use super::fluid::FluidError;
use super::rod::PlacementError;
use std::fmt;

/// Reason why a scene cannot be set up, or is not suitable for a method.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The scene contains no rods.
    #[error("the scene has no rods")]
    NoRods,
    /// A rod, or a clamp on it, is invalid.
    #[error("rod `{name}`: {reason}")]
    Rod {
        /// Name of the rod.
        name: String,
        /// The fault.
        reason: RodError,
    },
    /// A load refers to something that does not exist.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Two bodies overlap as placed.
    #[error(transparent)]
    Overlap(#[from] Overlap),
    /// The fluid, or a rod in it, is outside the range of its theory.
    #[error(transparent)]
    Fluid(#[from] FluidError),
    /// A joint or body is invalid.
    #[error("joint or body `{name}`: {reason}")]
    Joint {
        /// Its name.
        name: String,
        /// The fault.
        reason: JointError,
    },
    /// The nodes of a force defined in code do not exist, are missing, or are too many.
    #[error("force `{0}`: it needs one to four nodes of the scene")]
    Force(String),
    /// A tendon has less than two eyelets, one at a node that does not exist, or no rest length
    /// left when it is taken in.
    #[error(
        "tendon `{0}`: it needs two eyelets or more, at nodes of the scene, and a rest length greater than the length that is taken in"
    )]
    Tendon(String),
    /// A sheath cannot hold its rod.
    #[error("sheath `{name}`: {reason}")]
    Sheath {
        /// Its name.
        name: String,
        /// The field of [`super::scene::Sheath`] that is at fault.
        field: &'static str,
        /// Why.
        reason: String,
    },
    /// The scene is not suitable for the method.
    #[error("{0}")]
    Unsuitable(&'static str),
    /// A node cannot be grasped or released, or a load cannot be scaled.
    #[error("{0}")]
    Intervention(String),
    /// A checkpoint belongs to another scene.
    #[error("the checkpoint does not fit: {0}")]
    Checkpoint(String),
}

/// Fault of a rod.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RodError {
    /// Too few nodes for a rod, or for a ring.
    #[error("needs at least {least} nodes, has {nodes}")]
    TooFewNodes {
        /// Nodes that it needs.
        least: usize,
        /// Nodes that it has.
        nodes: usize,
    },
    /// The natural shape has another number of nodes than the rod.
    #[error("its natural shape has {natural} nodes, but the rod has {nodes}")]
    NaturalShape {
        /// Nodes of the natural shape.
        natural: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// The number of sections is not that of the edges.
    #[error("it has {sections} sections, but the rod has {edges} edges")]
    Sections {
        /// Sections given.
        sections: usize,
        /// Edges of the rod.
        edges: usize,
    },
    /// Consistent inertia is for rods with the same section everywhere.
    #[error("its section varies, which needs lumped inertia")]
    ConsistentSections,
    /// A clamp is at a node that does not exist.
    #[error("a clamp names node {node}, but the rod has {nodes} nodes")]
    ClampOutside {
        /// The node.
        node: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// Two clamps at one node.
    #[error("two clamps hold node {node}")]
    TwoClamps {
        /// The node.
        node: usize,
    },
    /// The polyline does not describe a rod.
    #[error(transparent)]
    Placement(#[from] PlacementError),
}

/// Fault of a joint or body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JointError {
    /// A node that does not exist.
    #[error("names node {node}, but the rod has {nodes} nodes")]
    NoSuchNode {
        /// The node.
        node: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// A joint joins a node to itself.
    #[error("joins a node to itself")]
    SameNode,
    /// The nodes are not at one point.
    #[error("its nodes are {distance:.6e} m apart, but must be at one point")]
    Apart {
        /// Distance of the nodes, m.
        distance: f64,
    },
    /// A spring between nodes that are joined in one point.
    #[error(
        "other joints already hold its nodes at one point, so a spring between them has no effect"
    )]
    OnePoint,
    /// A spring between frames that rotate as one.
    #[error("its nodes cannot turn relative to each other, so a spring between them has no effect")]
    OneFrame,
    /// A spring that acts only in compression, of rest length 0.
    #[error(
        "a spring of rest length 0 is never compressed, so `only = \"compression\"` leaves it without force"
    )]
    NeverPushes,
    /// A spring that has no direction in which to push.
    #[error(
        "its nodes are at one point, where a spring of rest length {rest_length:e} m has no direction: set the rest length to 0, or place the nodes apart"
    )]
    NoDirection {
        /// Length of the spring without force, m.
        rest_length: f64,
    },
    /// A breakable joint whose force cannot be determined.
    #[error(
        "cannot break, because other joints share its point and its own force cannot be determined: only a joint that is alone at its point can break"
    )]
    Unbreakable,
    /// Other joints already impose the same constraint.
    #[error("is redundant: other joints at this point already hold the same")]
    Twice,
    /// A hinge between two frames that both rotate on hinges.
    #[error("is connected to another hinge at this point: all hinges there must share one rod")]
    HingeOnHinge,
    /// A sliding node that is joined to a node of the rod along which it slides.
    #[error(
        "its first node is joined to the rod along which it should slide: remove one of the joints"
    )]
    JoinedToRail,
    /// A node that slides along two rods.
    #[error(
        "its first node already slides along another rod: use another node, or join two rods there by a ball joint"
    )]
    SlidesTwice,
    /// A sliding node on a rod along which others slide.
    #[error(
        "its first node belongs to rod `{rod}`, along which another node slides: a node of such a \
         rod cannot itself slide"
    )]
    SlidingRail {
        /// Name of that rod.
        rod: String,
    },
    /// A ring that slides along itself.
    #[error("a closed rod cannot slide along itself")]
    OwnRing,
    /// A node that is joined to a free body and is held otherwise, too.
    #[error(
        "node {node} of rod `{rod}` is joined to this body: no other joint, clamp, slide or body may be there, and no node may slide along its rod"
    )]
    HeldAtBody {
        /// The node.
        node: usize,
        /// Name of the rod.
        rod: String,
    },
    /// A joint of a rod and a free body that slides.
    #[error("a rod cannot slide along a free body: use a ball joint, a hinge or a rigid joint")]
    SlideOnBody,
    /// Two bodies are welded to each other.
    #[error("is welded to another rigid body: give one body the mass and inertia of both")]
    TwoBodies,
    /// Clamps hold several of the joined nodes.
    #[error(
        "clamps hold rods `{first}` and `{second}` at this point: only one clamp may hold the point; at a ball joint, let the other hold the frame of its rod with `hold = \"frame\"`; at a rigid joint, remove it"
    )]
    TwoClamps {
        /// Name of a rod.
        first: String,
        /// Name of another one.
        second: String,
    },
    /// A clamp holds the frame of a node that a joint or body would rotate.
    #[error(
        "a clamp holds the frame of rod `{rod}` at this point, but a hinge, a body, a joint that may break or another clamp turns this frame: let the clamp hold only the position, or clamp each rod without a joint"
    )]
    ClampedFrame {
        /// Name of the rod.
        rod: String,
    },
    /// A rigid joint to a rod that is held.
    #[error(
        "a rod with `held = true` is a rigid obstacle and can be joined only by its position: use a ball joint"
    )]
    HeldRod,
}

/// Fault of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// A rod that does not exist.
    #[error("a load names rod {0}, which does not exist")]
    NoSuchRod(usize),
    /// A node that does not exist.
    #[error("a force names node {node}, but the rod has {nodes} nodes")]
    NoSuchNode {
        /// The node.
        node: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// An edge that does not exist.
    #[error("a moment names edge {edge}, but the rod has {edges} edges")]
    NoSuchEdge {
        /// The edge.
        edge: usize,
        /// Edges of the rod.
        edges: usize,
    },
}

/// Two bodies that are closer than the contact model allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// An edge or node of a rod, in words.
    pub first: String,
    /// An edge of a rod or a plane, in words.
    pub second: String,
    /// Distance of their centrelines, or of the node from the plane, m.
    pub distance: f64,
    /// Least distance allowed, m.
    pub least: f64,
    /// Whether that distance itself is forbidden, because a barrier is infinite there.
    pub exclusive: bool,
}

impl fmt::Display for Overlap {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (meet, allowed) = if self.exclusive {
            ("touch or interpenetrate", "more than")
        } else {
            ("interpenetrate", "at least")
        };
        write!(
            formatter,
            "{} and {} {meet}: distance {:.6e} m, allowed is {allowed} {:.6e} m",
            self.first, self.second, self.distance, self.least
        )
    }
}

impl std::error::Error for Overlap {}
