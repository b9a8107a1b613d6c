//! The ends of springs: their distance, and the frames that turn with them.

use super::plan::JointPlan;
use super::span::span;
use super::turned::{TurnedEnd, wall_at, wrong};
use crate::mechanics::scene::{Scene, Spring, SpringForce};
use crate::mechanics::{JointError, SceneError};

/// Whether the joints, springs and bodies of a scene are valid, as far as that does not depend on
/// its clamps.
///
/// # Errors
/// [`SceneError::Joint`].
pub fn check_joints(scene: &Scene) -> Result<(), SceneError> {
    let plan = JointPlan::new(scene)?;
    for spring in &scene.springs {
        plan.rest_length(scene, spring)?;
        if spring.turning.is_some() {
            plan.turned_ends(scene, spring)?;
        }
    }
    Ok(())
}

impl JointPlan {
    /// Length of a spring without force, m.
    ///
    /// # Errors
    /// [`SceneError::Joint`] if its nodes are missing or coincide, or if it has no direction or
    /// never exerts a force.
    pub(crate) fn rest_length(&self, scene: &Scene, spring: &Spring) -> Result<f64, SceneError> {
        let found = span(scene, &spring.nodes).and_then(|span| {
            if spring.stiffness == 0.0 {
                return Ok(0.0);
            }
            let mut points = self.points.iter();
            if points.any(|point| spring.nodes.iter().all(|node| point.contains(node))) {
                return Err(JointError::OnePoint);
            }
            let rest_length = match spring.rest_length {
                Some(rest_length) => rest_length,
                // Rounding errors of coincident points would otherwise define the direction.
                None if span.is_a_point() => 0.0,
                None => span.distance,
            };
            match spring.only {
                // It is slack at one point, and needs no direction.
                Some(SpringForce::Tension) => Ok(rest_length),
                Some(SpringForce::Compression) if rest_length == 0.0 => {
                    Err(JointError::NeverPushes)
                }
                _ if span.is_a_point() && rest_length > 0.0 => {
                    Err(JointError::NoDirection { rest_length })
                }
                _ => Ok(rest_length),
            }
        });
        found.map_err(|reason| wrong(spring, reason))
    }

    /// Frames with which the ends of a torsional spring turn.
    ///
    /// # Errors
    /// [`SceneError::Joint`] if both ends turn with the same frame.
    pub(crate) fn turned_ends(
        &self,
        scene: &Scene,
        spring: &Spring,
    ) -> Result<[TurnedEnd; 2], SceneError> {
        let ends = spring.nodes.map(|at| {
            let frame = || self.frame_at(at.rod, at.node);
            let wall = wall_at(scene, at);
            wall.unwrap_or_else(|| TurnedEnd::Frame(frame().expect("the plan has a frame there")))
        });
        if ends[0] == ends[1] {
            return Err(wrong(spring, JointError::OneFrame));
        }
        Ok(ends)
    }
}
