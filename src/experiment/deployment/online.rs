//! Online correction: the gripper's path is planned anew from where the rod is seen to lie.

use super::gripper_path::GripperPath;
use super::keys::{Correction, Deployment, Solver};
use super::planned::Planned;
use crate::mechanics::dynamics::{Simulation, SimulationError};
use crate::mechanics::random::uniform_numbers;
use crate::mechanics::scene::Motion;
use crate::mechanics::{UnitQuaternion, Vector3, rotation};
use crate::plan::deployment::{
    DeployedRod, ObservedContact, Scheme, corrected_length, return_curve, trajectory,
};
use crate::plan::pattern::{PatternPoint, Point};
use crate::run::Controller;
use serde::{Deserialize, Serialize};

/// Length of lying rod, in gravito-bending lengths, by which its end is seen.
const WINDOW: f64 = 1.5;
/// Length behind the last place that seems to lie, in gravito-bending lengths, which may have risen already: z = s³/8 there.
const RISEN: f64 = 0.2;
/// Part of the length between two corrections over which the gripper goes over to the new path.
const TRANSITION: f64 = 0.5;
/// Least time between two corrections, s: a hanging rod swings, and answers no sooner.
const LEAST_TIME: f64 = 1.0;
/// Shortest length of return over that between two corrections.
const SHORTEST_RETURN: f64 = 3.0;
/// Largest curvature, over 1/L_gb, by which the rod is bent beside that of its pattern.
const LARGEST_CURVATURE: f64 = 0.3;
/// Seeds of successive observations are this far apart.
const SEED_STEP: u64 = 0x9e37_79b9;

/// Plans the gripper's path anew after each length that has been laid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnlineCorrection {
    keys: Correction,
    seed: u64,
    solver: Solver,
    /// The rod as it is believed to be, and its L_gb at first, m.
    rod: DeployedRod,
    nominal: f64,
    /// How the camera sees the table.
    seen: Planned,
    /// Clamp of the gripper, nodes of the rod, and height below which a node lies, m.
    clamp: usize,
    nodes: usize,
    lying_height: f64,
    /// Times of the poses, s, and the pattern there, as it is seen.
    times: Vec<f64>,
    pattern: Vec<PatternPoint>,
    /// What is aimed at, and the gripper's poses for it.
    aim: Vec<PatternPoint>,
    poses: Vec<(Vector3, UnitQuaternion)>,
    /// Displacement (m) and turn (rad) of the gripper at those times that nobody knows of.
    jitter: Vec<(Vector3, Vector3)>,
    /// The gripper at the start.
    first: (Vector3, UnitQuaternion),
    /// Index of the pose at which the path is planned next.
    next: usize,
    observations: u64,
    last: Option<ObservedContact>,
}

impl OnlineCorrection {
    /// The correction of a path; `clamp` is that of the gripper.
    pub fn new(
        deployment: &Deployment,
        keys: Correction,
        path: &GripperPath,
        clamp: usize,
        lying_height: f64,
    ) -> Self {
        let planned = path.planned.iter();
        let mut correction = Self {
            keys,
            seed: deployment.seed,
            solver: deployment.solver,
            rod: path.seen.rod,
            nominal: path.seen.rod.gravito_bending_length,
            seen: path.seen.clone(),
            clamp,
            nodes: deployment.rod.edges + 1,
            lying_height,
            times: path.laid.iter().map(|(time, _)| *time).collect(),
            aim: path.points.clone(),
            pattern: path.points.clone(),
            poses: planned.map(|pose| (pose.position, pose.rotation)).collect(),
            jitter: path.jitter.clone(),
            first: (path.poses[0].position, path.poses[0].rotation),
            next: 0,
            observations: 0,
            last: None,
        };
        correction.next = correction.after(0);
        correction
    }

    /// Index of the first pose that is `every` further along the pattern, and not too soon.
    fn after(&self, index: usize) -> usize {
        let wanted = self.pattern[index].s + self.keys.every * (1.0 - 1e-9);
        let along = self.pattern.partition_point(|point| point.s < wanted);
        let settled = self.times[index] + LEAST_TIME;
        along.max(self.times.partition_point(|time| *time < settled))
    }

    /// The lying rod as the camera sees it: arc lengths and places, m.
    fn look(&self, positions: &[Vector3]) -> Vec<(f64, Point)> {
        let edge = self.rod.length / (self.nodes - 1) as f64;
        let mut number = uniform_numbers(self.seed ^ self.observations.wrapping_mul(SEED_STEP));
        // Evenly distributed, of variance 1.
        let mut noise = || self.keys.noise * 12f64.sqrt() * (number() - 0.5);
        let lies = |node: &&Vector3| node.z < self.lying_height;
        let lying = positions[..self.nodes].iter().take_while(lies).count();
        let risen = RISEN * self.rod.gravito_bending_length;
        let end = edge * lying.saturating_sub(1) as f64 - risen;
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

    /// Plans anew from pose `index` on, where the rod has been seen to end at `contact`; nothing changes where the pattern
    /// cannot be laid from there.
    fn plan(&mut self, index: usize, contact: &ObservedContact) {
        if let Some(last) = self.last.filter(|last| contact.s > last.s) {
            let aimed = last.carried(&self.aim, contact.s).angle - last.angle;
            let turned = contact.angle - last.angle;
            let turned =
                turned - std::f64::consts::TAU * ((turned - aimed) / std::f64::consts::TAU).round();
            let length = contact.s - last.s;
            self.rod.gravito_bending_length =
                corrected_length(&self.rod, self.nominal, [turned, aimed], length);
        }
        self.last = Some(*contact);
        let here = contact.carried(&self.aim, self.pattern[index].s);
        let next = self.pattern.get(self.next).unwrap_or(&self.pattern[index]);
        let laid = next.s - self.pattern[index].s;
        let curve = return_curve(
            &self.pattern[index..],
            &here,
            self.keys.return_length.max(SHORTEST_RETURN * laid),
            LARGEST_CURVATURE / self.rod.gravito_bending_length,
        );
        let planned = trajectory(&curve, &self.rod, Scheme::Optimal, self.solver.into());
        let Ok(planned) = planned else {
            return;
        };
        let begin = self.pattern[index].s;
        let transition = TRANSITION * self.keys.every;
        let old = self.poses[index..].iter_mut();
        for ((pose, new), point) in old.zip(&planned).zip(&curve) {
            let part = ((point.s - begin) / transition).min(1.0);
            let part = part * part * (3.0 - 2.0 * part);
            pose.0 += part * (new.position - pose.0);
            pose.1 = rotation::from_vector(
                part * rotation::to_vector(&(new.rotation * pose.1.inverse())),
            ) * pose.1;
        }
        self.aim.truncate(index);
        self.aim.extend(curve);
    }

    /// The motion of the gripper, with all that disturbs it.
    fn motion(&self) -> Motion {
        let (place, turn) = self.first;
        let timed = || self.times.iter().zip(self.poses.iter().zip(&self.jitter));
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
        let window = WINDOW * self.rod.gravito_bending_length;
        if let Some(contact) = ObservedContact::of(&lying, window) {
            self.plan(index, &contact);
            simulation.move_clamp(self.clamp, self.motion());
        }
        Ok(())
    }

    fn next_time(&self) -> f64 {
        self.times.get(self.next).copied().unwrap_or(f64::INFINITY)
    }
}
