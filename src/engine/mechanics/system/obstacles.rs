//! Motion of rigid obstacles.

use super::clamps::{Turning, list_motion};
use super::events::Event;
use crate::mechanics::rotation::{self, Pose};
use crate::mechanics::scene::{Motion, Obstacle, piecewise_linear, piecewise_turning};
use crate::mechanics::{UnitQuaternion, Vector3};

/// An obstacle that moves.
#[derive(Clone, Debug)]
pub(crate) struct MovingObstacle {
    /// Index among all obstacles.
    pub obstacle: usize,
    /// Fixed point of the rotation, m.
    pivot: Vector3,
    /// Largest distance of a point of the obstacle from the pivot, m.
    arm: f64,
    motion: Motion,
}

impl MovingObstacle {
    /// The obstacles of a scene that move.
    pub(crate) fn of(obstacles: &[Obstacle]) -> Vec<Self> {
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

    /// Pose at a time: x(t) = pivot + R(t)(x(0) − pivot) + translation(t).
    pub(crate) fn pose(&self, time: f64) -> Pose {
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

    /// Adds the corners of the motion to `events`.
    pub(crate) fn list_events(&self, events: &mut Vec<Event>) {
        list_motion(&self.motion, self.arm, events);
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

#[cfg(test)]
mod tests {
    use super::super::System;
    use super::*;
    use crate::mechanics::contact::{ContactModel, ContactParameters};
    use crate::mechanics::rigid_body::RigidBody;
    use crate::mechanics::rod::STRIDE;
    use crate::mechanics::scene::{RodDescription, Scene};
    use crate::mechanics::test_support::{SOFT_MODELS, contact, obstacle, section};

    const RADIUS: f64 = 1e-2;
    const TOLERANCE: f64 = 1e-4;

    /// A bent rod of six nodes near z = 0. Its middle edge or nodes are nearest to a body below,
    /// or to the wall of a tube around it.
    fn system(body: RigidBody, model: ContactModel, friction: f64) -> System {
        let node = |k: usize| {
            let x = 0.05 * k as f64 - 0.125;
            Vector3::new(x, 0.3 * x * x, 0.8 * x * x)
        };
        let stiffness = section(1.0, [1e-4; 2], 1e-4);
        let nodes = (0..6).map(node).collect();
        let rod = RodDescription::uniform("rod", nodes, stiffness, RADIUS, 0.1);
        System::new(&Scene {
            rods: vec![rod],
            obstacles: vec![obstacle("body", body)],
            contact: Some(ContactParameters {
                friction,
                ..contact(model, TOLERANCE)
            }),
            ..Scene::default()
        })
        .unwrap()
    }

    #[test]
    fn the_jacobian_at_an_obstacle_is_the_derivative_of_the_residual() {
        // The nodes of the middle edge are at this height, and this far from x = 0.
        let (x, height) = (0.025, 0.8 * 0.025 * 0.025);
        let gap = 0.3 * TOLERANCE;
        let below = height - RADIUS - gap;
        let corners = [[-0.2, -0.2, below], [0.2, -0.2, below], [0.0, 0.2, below]];
        let sheet = RigidBody::of_mesh(corners.map(Vector3::from).to_vec(), vec![[0, 1, 2]], false);
        let axis = Vector3::new(0.0, 0.3 * x * x, height + 0.3 - RADIUS - gap);
        let bodies = [
            RigidBody::sphere(Vector3::new(0.0, 0.3 * x * x, below - 0.1), 0.1),
            sheet.unwrap(),
            RigidBody::tube([axis - Vector3::x(), axis + Vector3::x()], 0.3),
        ];
        for body in bodies {
            for model in SOFT_MODELS {
                // Without friction contact is in the band, with friction in elements; at rest
                // there is no friction.
                for friction in [0.0, 0.5] {
                    let mut system = system(body.clone(), model, friction);
                    let unknowns = system.assembly.unknowns.clone();
                    system.linearize(&unknowns, None);
                    let contacts = system.contact().unwrap().contacts();
                    assert!(!contacts.is_empty(), "{body:?} {model:?}");
                    let found = system.dense_matrix();
                    let size = unknowns.len();
                    let mut expected = found.clone();
                    for column in 0..size {
                        if system.assembly.held[column] {
                            continue;
                        }
                        let step = if column % STRIDE == 3 { 1e-6 } else { 1e-8 };
                        let ends = [1.0, -1.0].map(|side| {
                            let mut moved = unknowns.clone();
                            moved[column] += side * step;
                            system.evaluate(&moved, None);
                            system.residual.clone()
                        });
                        for row in (0..size).filter(|row| !system.assembly.held[*row]) {
                            let change = ends[0][row] - ends[1][row];
                            expected[(row, column)] = change / (2.0 * step);
                        }
                    }
                    let error = (&found - &expected).norm() / expected.norm();
                    assert!(error < 1e-5, "{body:?} {model:?} {friction}: {error:e}");
                }
            }
        }
    }
}
