//! What makes a scene impossible.

use super::fluid::FluidError;
use super::rod::PlacementError;
use std::fmt;

/// Why a scene cannot be set up, or cannot answer what is asked of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// There is nothing to simulate.
    #[error("the scene has no rods")]
    NoRods,
    /// A rod, or a clamp on it, is impossible.
    #[error("rod `{name}`: {reason}")]
    Rod {
        /// Name of the rod.
        name: String,
        /// What is wrong with it.
        reason: RodError,
    },
    /// A load asks for something that does not exist.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Two bodies overlap as placed.
    #[error(transparent)]
    Overlap(#[from] Overlap),
    /// The fluid, or a rod in it, is beyond its theory.
    #[error(transparent)]
    Fluid(#[from] FluidError),
    /// A joint or body is impossible.
    #[error("joint or body `{name}`: {reason}")]
    Joint {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: JointError,
    },
    /// The scene lacks what a method needs.
    #[error("{0}")]
    Unsuitable(&'static str),
    /// A node cannot be grasped or released, or a load not be scaled.
    #[error("{0}")]
    Intervention(String),
    /// A checkpoint belongs to another scene.
    #[error("the checkpoint does not fit: {0}")]
    Checkpoint(String),
}

/// What is wrong with a rod.
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
    #[error("its natural shape has {natural} nodes, itself {nodes}")]
    NaturalShape {
        /// Nodes of the natural shape.
        natural: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// A clamp at a node that does not exist.
    #[error("a clamp asks for node {node} of {nodes}")]
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
    /// The polyline is no rod.
    #[error(transparent)]
    Placement(#[from] PlacementError),
}

/// What is wrong with a joint or body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JointError {
    /// A node that does not exist.
    #[error("asks for node {node} of {nodes}")]
    NoSuchNode {
        /// The node.
        node: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// It joins a node to itself.
    #[error("joins a node to itself")]
    SameNode,
    /// The nodes are not at one point.
    #[error("its nodes are {distance:.6e} m apart, they must lie at one point")]
    Apart {
        /// Their distance, m.
        distance: f64,
    },
    /// A spring between nodes that are one point.
    #[error("its nodes are one point by other joints, where no spring can act")]
    OnePoint,
    /// A spring between frames that are one.
    #[error(
        "its nodes turn as one, by other joints or because nothing turns them, where no spring can turn them"
    )]
    OneFrame,
    /// A spring without a direction in which to push.
    #[error(
        "its nodes lie at one point, where a spring of rest length {rest_length:e} m pushes in no direction: let the rest length be 0, or place them apart"
    )]
    NoDirection {
        /// Its length without force, m.
        rest_length: f64,
    },
    /// A joint breaks whose force is not known.
    #[error(
        "breaks at a force that is not known, since other joints share its point: only a joint that is alone there can break"
    )]
    Unbreakable,
    /// Other joints hold what it holds.
    #[error("other joints at this point already hold what it holds")]
    Twice,
    /// A hinge between two frames that both hang on hinges.
    #[error("hangs on another hinge at this point: let all hinges there share one rod")]
    HingeOnHinge,
    /// A sliding node that is one point with a node of the rod along which it slides.
    #[error(
        "its first node is joined to the rod along which it should slide: leave out one of the joints"
    )]
    JoinedToRail,
    /// A node that slides along two rods.
    #[error(
        "its first node slides along another rod already: let another node slide, or join two rods there by a ball"
    )]
    SlidesTwice,
    /// A sliding node on a rod along which others slide.
    #[error(
        "its first node is one of those of rod `{rod}`, along which another node slides: what bears a sliding node cannot slide itself"
    )]
    SlidingRail {
        /// Name of that rod.
        rod: String,
    },
    /// A ring that slides along itself.
    #[error("a closed rod cannot slide along itself")]
    OwnRing,
    /// A sliding node that is held.
    #[error(
        "a clamp, or `held`, holds the node of rod `{rod}` that should slide: hold the other rod, and let its nodes be the ones that move"
    )]
    HeldSlide {
        /// Name of the rod.
        rod: String,
    },
    /// Two bodies are welded to each other.
    #[error("is welded to another rigid body: give one body the mass and inertia of both")]
    TwoBodies,
    /// Clamps hold several of its nodes.
    #[error(
        "clamps hold rods `{first}` and `{second}` at this point: let one of them hold it, and the other the frame of its rod alone, `hold = \"frame\"`, beside a ball joint, or nothing beside a rigid one"
    )]
    TwoClamps {
        /// Name of a rod.
        first: String,
        /// Name of another one.
        second: String,
    },
    /// A clamp holds the frame of a node that a joint or body would turn.
    #[error(
        "a clamp holds the frame of rod `{rod}` at this point, which a hinge, a body, a joint that may break or another clamp turns: let the clamp hold the position alone, or clamp each rod without a joint"
    )]
    ClampedFrame {
        /// Name of the rod.
        rod: String,
    },
    /// A rigid joint to a rod that is held.
    #[error(
        "a rod that is held is a rigid obstacle and is joined by its position alone: make the joint a ball"
    )]
    HeldRod,
}

/// What is wrong with a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// A rod that does not exist.
    #[error("a load asks for rod {0}")]
    NoSuchRod(usize),
    /// A node that does not exist.
    #[error("a force asks for node {node} of {nodes}")]
    NoSuchNode {
        /// The node.
        node: usize,
        /// Nodes of the rod.
        nodes: usize,
    },
    /// An edge that does not exist.
    #[error("a moment asks for edge {edge} of {edges}")]
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
    /// Whether that distance itself is forbidden: a barrier is infinite there.
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
