//! Online correction: replans the gripper's path from the observed position of the rod.

use super::gripper_path::GripperPath;
use super::keys::{Correction, Deployment, Solver};
use super::planned::Planned;
use crate::run::Controller;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::scene::Motion;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use rodlab_engine::random::uniform_numbers;
use rodlab_planning::plan::deployment::{CorrectedPath, ObservedContact};
use rodlab_planning::plan::pattern::Point;
use serde::{Deserialize, Serialize};

/// Least time between two corrections, s: a hanging rod swings, and does not respond faster.
const LEAST_TIME: f64 = 1.0;
/// Difference of the seeds of successive observations.
const SEED_STEP: u64 = 0x9e37_79b9;

/// Replans the gripper's path whenever a given length has been laid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnlineCorrection {
    /// Root mean square error of positions measured by the camera, m, and its seed.
    noise: f64,
    seed: u64,
    solver: Solver,
    /// The path that is followed.
    path: CorrectedPath,
    /// Model of the camera above the table.
    seen: Planned,
    /// Clamp of the gripper, number of nodes of the rod, and height below which a node lies on the
    /// table, m.
    clamp: usize,
    nodes: usize,
    lying_height: f64,
    /// Times of the poses, s.
    times: Vec<f64>,
    /// Unmodelled displacement (m) and rotation (rad) of the gripper at those times.
    jitter: Vec<(Vector3, Vector3)>,
    /// The gripper at the start.
    first: (Vector3, UnitQuaternion),
    /// Index of the pose at which the path is planned next.
    next: usize,
    observations: u64,
}

impl OnlineCorrection {
    /// The correction of a path; `clamp` is the clamp of the gripper.
    pub fn new(
        deployment: &Deployment,
        keys: Correction,
        path: &GripperPath,
        clamp: usize,
        lying_height: f64,
    ) -> Self {
        let planned = path.planned.iter();
        let mut correction = Self {
            noise: keys.noise,
            seed: deployment.seed,
            solver: deployment.solver,
            path: CorrectedPath::new(
                path.seen.rod,
                path.points.clone(),
                planned.map(|pose| (pose.position, pose.rotation)).collect(),
                [keys.every, keys.return_length],
            ),
            seen: path.seen.clone(),
            clamp,
            nodes: deployment.rod.edges + 1,
            lying_height,
            times: path.laid.iter().map(|(time, _)| *time).collect(),
            jitter: path.jitter.clone(),
            first: (path.poses[0].position, path.poses[0].rotation),
            next: 0,
            observations: 0,
        };
        correction.next = correction.after(0);
        correction
    }

    /// Index of the first pose that is `every` further along the pattern, and not too soon.
    fn after(&self, index: usize) -> usize {
        let settled = self.times[index] + LEAST_TIME;
        self.path
            .after(index)
            .max(self.times.partition_point(|time| *time < settled))
    }

    /// The lying rod as the camera measures it: arc lengths and positions, m.
    fn look(&self, positions: &[Vector3]) -> Vec<(f64, Point)> {
        let edge = self.path.rod().length / (self.nodes - 1) as f64;
        let mut number = uniform_numbers(self.seed ^ self.observations.wrapping_mul(SEED_STEP));
        // Uniformly distributed, of variance 1.
        let mut noise = || self.noise * 12f64.sqrt() * (number() - 0.5);
        let lies = |node: &&Vector3| node.z < self.lying_height;
        let lying = positions[..self.nodes].iter().take_while(lies).count();
        let end = edge * lying.saturating_sub(1) as f64 - self.path.risen();
        positions[..lying]
            .iter()
            .enumerate()
            .take_while(|(index, _)| edge * *index as f64 <= end)
            .map(|(index, node)| {
                let place = self.seen.place(Point::new(node.x, node.y));
                (edge * index as f64, place + Point::new(noise(), noise()))
            })
            .collect()
    }

    /// The motion of the gripper with all disturbances.
    fn motion(&self) -> Motion {
        let (place, turn) = self.first;
        let timed = || {
            self.times
                .iter()
                .zip(self.path.poses().iter().zip(&self.jitter))
        };
        Motion {
            translation: timed()
                .map(|(time, (pose, jitter))| (*time, pose.0 + jitter.0 - place))
                .collect(),
            orientation: timed()
                .map(|(time, (pose, jitter))| {
                    let turned = rotation::from_vector(jitter.1) * pose.1;
                    (*time, turned * turn.inverse())
                })
                .collect(),
            pivot: Some(place),
            ..Motion::default()
        }
    }
}

impl Controller for OnlineCorrection {
    fn name(&self) -> &str {
        "online correction"
    }

    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError> {
        let index = self.next;
        if index >= self.times.len() || simulation.time() < self.times[index] * (1.0 - 1e-12) {
            return Ok(());
        }
        self.next = self.after(index);
        self.observations += 1;
        let lying = self.look(simulation.positions());
        if let Some(contact) = ObservedContact::of(&lying, self.path.window()) {
            let grasps = self.solver.into();
            self.path.correct(index, self.next, &contact, grasps);
            simulation.move_clamp(self.clamp, self.motion());
        }
        Ok(())
    }

    fn next_time(&self) -> f64 {
        self.times.get(self.next).copied().unwrap_or(f64::INFINITY)
    }
}
