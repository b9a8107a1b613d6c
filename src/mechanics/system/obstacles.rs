//! Rigid obstacles: how they move.

use super::System;
use super::clamps::{Turning, list_corners};
use super::events::Event;
use crate::mechanics::contact::ContactObstacle;
use crate::mechanics::rotation::{self, Pose};
use crate::mechanics::scene::{Motion, Obstacle, piecewise_linear, piecewise_turning};
use crate::mechanics::{UnitQuaternion, Vector3};

/// An obstacle that moves.
#[derive(Clone, Debug)]
pub struct MovingObstacle {
    /// Index among all obstacles.
    obstacle: usize,
    /// Fixed point of its rotation, m.
    pivot: Vector3,
    /// Largest distance of a point of it from the pivot, m.
    arm: f64,
    motion: Motion,
}

impl MovingObstacle {
    /// The obstacles of a scene that move.
    pub fn of(obstacles: &[Obstacle]) -> Vec<Self> {
        let moving = obstacles.iter().enumerate();
        moving
            .filter(|(_, obstacle)| obstacle.motion.moves())
            .map(|(index, obstacle)| {
                let vertices = &obstacle.body.vertices;
                let centre = vertices.iter().sum::<Vector3>() / vertices.len() as f64;
                let pivot = obstacle.motion.pivot.unwrap_or(centre);
                let far = |most: f64, vertex: &Vector3| most.max((vertex - pivot).norm());
                Self {
                    obstacle: index,
                    pivot,
                    arm: vertices.iter().fold(0.0, far) + obstacle.body.radius,
                    motion: obstacle.motion.clone(),
                }
            })
            .collect()
    }

    /// Where it is at a time: x(t) = pivot + R(t)(x(0) − pivot) + translation(t).
    fn pose(&self, time: f64) -> Pose {
        let motion = &self.motion;
        let turning = Turning {
            axis: motion.axis.unwrap_or_else(Vector3::z),
            angle: piecewise_linear(&motion.angle, time).unwrap_or(0.0)
                + motion.angular_velocity * time,
            orientation: piecewise_turning(&motion.orientation, time),
        };
        let turned = rotation::from_vector(turning.axis * turning.angle);
        let orientation = turning.orientation.unwrap_or_else(UnitQuaternion::identity);
        let rotation = orientation * turned;
        let translation =
            piecewise_linear(&motion.translation, time).unwrap_or_else(Vector3::zeros);
        Pose {
            rotation,
            translation: self.pivot + translation - rotation * self.pivot,
        }
    }

    /// Adds the corners of its motion to `events`.
    pub fn list_events(&self, events: &mut Vec<Event>) {
        let (motion, arm) = (&self.motion, self.arm);
        list_corners(&motion.translation, |from, to| (to - from).norm(), events);
        list_corners(&motion.angle, |from, to| (to - from).abs() * arm, events);
        list_corners(
            &motion.orientation,
            |from, to| rotation::angle(&from.rotation_to(to)) * arm,
            events,
        );
    }
}

/// Poses of obstacles at a time, s.
pub fn obstacle_poses(obstacles: &[Obstacle], time: f64) -> Vec<Pose> {
    let mut poses = vec![Pose::default(); obstacles.len()];
    for moving in MovingObstacle::of(obstacles) {
        poses[moving.obstacle] = moving.pose(time);
    }
    poses
}

/// The obstacle as contact sees it; `friction` is that of the contact model.
pub fn contact_obstacle(obstacle: &Obstacle, friction: f64) -> ContactObstacle {
    let body = &obstacle.body;
    ContactObstacle {
        vertices: body.vertices.clone(),
        segments: body.segments.clone(),
        faces: body.faces.clone(),
        closed: body.closed,
        hollow: body.hollow,
        radius: body.radius,
        friction: obstacle.friction.unwrap_or(friction),
    }
}

impl System {
    /// Moves the obstacles to where they are at `time`, s.
    pub fn place_obstacles(&mut self, time: f64) {
        let Some(contact) = &mut self.contact else {
            return;
        };
        for moving in &self.moving_obstacles {
            contact.place_obstacle(moving.obstacle, moving.pose(time));
        }
    }

    /// Lets the next step start where the obstacles are.
    pub(super) fn commit_obstacles(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.commit_obstacles();
        }
    }
}
