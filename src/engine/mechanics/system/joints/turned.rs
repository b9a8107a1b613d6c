//! Frames that turn with the ends of torsional springs.

use super::span::span;
use crate::mechanics::scene::{RodNode, Scene, Spring};
use crate::mechanics::{JointError, SceneError};

/// Frame with which one end of a torsional spring turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::mechanics::system) enum TurnedEnd {
    /// A frame to which the rod is clamped at the node, by its index.
    Frame(usize),
    /// The clamp that holds the frame of the rod at the node.
    Clamped(RodNode),
    /// A rod at rest.
    Held,
}

/// The frame that turns with a node, unless the node is free.
pub(super) fn wall_at(scene: &Scene, at: RodNode) -> Option<TurnedEnd> {
    let mut clamps = scene.clamps.iter().filter(|clamp| clamp.holds_frame);
    if scene.rods[at.rod].held {
        Some(TurnedEnd::Held)
    } else if clamps.any(|clamp| (clamp.rod, clamp.node) == (at.rod, at.node)) {
        Some(TurnedEnd::Clamped(at))
    } else {
        None
    }
}

/// Nodes at which rods are clamped to frames that springs turn.
///
/// # Errors
/// [`SceneError::Joint`] if the node does not exist.
pub(super) fn turned_nodes(scene: &Scene) -> Result<Vec<RodNode>, SceneError> {
    let mut nodes = Vec::new();
    for spring in scene
        .springs
        .iter()
        .filter(|spring| spring.turning.is_some())
    {
        span(scene, &spring.nodes).map_err(|reason| wrong(spring, reason))?;
        let ends = spring.nodes.into_iter();
        nodes.extend(ends.filter(|at| wall_at(scene, *at).is_none()));
    }
    Ok(nodes)
}

/// Fault of a spring.
pub(super) fn wrong(spring: &Spring, reason: JointError) -> SceneError {
    SceneError::Joint {
        name: spring.name.clone(),
        reason,
    }
}
