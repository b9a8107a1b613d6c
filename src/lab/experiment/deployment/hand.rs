//! A gripper that grasps rods at planned places, moves them, and releases them.

use super::tying::{Hold, Part};
use crate::run::Controller;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::scene::Motion;
use rodlab_engine::mechanics::system::Grasp;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Number of nodes next to the ends of a rod that do not count as a strand: another gripper is
/// there, or the rest of the rod is too short.
const BESIDE_ENDS: usize = 2;

/// Grasps rods, one after the other.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Hand {
    name: String,
    tasks: Vec<Task>,
    reach: f64,
    /// Number of tasks that are finished, or whose grasp missed.
    done: usize,
    /// The clamp of the held node.
    clamp: Option<usize>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Task {
    /// Time of the grasp, s, and of the release, if there is one.
    begin: f64,
    end: Option<f64>,
    /// Candidate nodes; the nearest one is grasped.
    nodes: Range<usize>,
    /// Times (s) and places (m).
    places: Vec<(f64, Vector3)>,
    /// Times (s) and orientations; empty for a constant orientation.
    turns: Vec<(f64, UnitQuaternion)>,
}

impl Hand {
    /// The gripper with this number and these tasks. `nodes` are the nodes of the rods of the
    /// scene. Seen from above, it grasps the nearest node if that is within `reach`, m.
    pub fn new(number: usize, holds: &[Hold], nodes: &[Range<usize>], reach: f64) -> Self {
        let task = |hold: &Hold| {
            let Range { start, end } = nodes[hold.rod].clone();
            let poses = || hold.poses.iter();
            let first = poses()
                .next()
                .map_or_else(UnitQuaternion::identity, |pose| pose.2);
            let (nodes, turns) = match hold.part {
                Part::Strand => (
                    start + BESIDE_ENDS..end.saturating_sub(BESIDE_ENDS),
                    Vec::new(),
                ),
                Part::End => {
                    let turns = poses().map(|(time, _, turn)| (*time, turn * first.inverse()));
                    (end.saturating_sub(1)..end, turns.collect())
                }
            };
            Task {
                begin: hold.held[0],
                end: Some(hold.held[1]).filter(|end| end.is_finite()),
                nodes,
                places: poses().map(|(time, place, _)| (*time, *place)).collect(),
                turns,
            }
        };
        Self {
            name: format!("gripper {}", number + 1),
            tasks: holds.iter().map(task).collect(),
            reach,
            done: 0,
            clamp: None,
        }
    }
}

impl Task {
    /// The nearest node within reach of a place.
    fn node_at(&self, place: &Vector3, reach: f64, positions: &[Vector3]) -> Option<usize> {
        let away = |node: &usize| (positions[*node] - place).xy().norm();
        let nodes = self.nodes.clone();
        let nearest = nodes.min_by(|one, other| away(one).total_cmp(&away(other)));
        nearest.filter(|node| away(node) <= reach)
    }

    /// The motion of a node that was grasped at the place `found`.
    fn motion(&self, first: &Vector3, found: &Vector3) -> Motion {
        let ways = self.places.iter().map(|(time, place)| {
            let mut way = place - first;
            // Jitter must not press the rod into the table.
            way.z = way.z.max(0.0);
            (*time, way)
        });
        Motion {
            translation: ways.collect(),
            orientation: self.turns.clone(),
            pivot: Some(*found).filter(|_| !self.turns.is_empty()),
            ..Motion::default()
        }
    }
}

impl Controller for Hand {
    fn name(&self) -> &str {
        &self.name
    }

    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError> {
        let Some(task) = self.tasks.get(self.done) else {
            return Ok(());
        };
        let has_come = |time: f64| simulation.time() >= time * (1.0 - 1e-12);
        if let Some(clamp) = self.clamp {
            if task.end.is_some_and(has_come) {
                simulation.release(clamp)?;
                self.clamp = None;
                self.done += 1;
            }
            return Ok(());
        }
        if !has_come(task.begin) {
            return Ok(());
        }
        let first = task
            .places
            .first()
            .map_or_else(Vector3::zeros, |place| place.1);
        let Some(node) = task.node_at(&first, self.reach, simulation.positions()) else {
            self.done += 1;
            return Ok(());
        };
        let motion = task.motion(&first, &simulation.positions()[node]);
        let grasp = Grasp {
            position: true,
            frame: true,
        };
        let clamp = simulation.grasp(node, grasp)?;
        simulation.move_clamp(clamp, motion);
        self.clamp = Some(clamp);
        Ok(())
    }

    fn next_time(&self) -> f64 {
        let Some(task) = self.tasks.get(self.done) else {
            return f64::INFINITY;
        };
        match self.clamp {
            Some(_) => task.end.unwrap_or(f64::INFINITY),
            None => task.begin,
        }
    }
}
