//! A gripper that takes hold of strands where they should lie, lifts them, and puts them down again.

use crate::mechanics::Vector3;
use crate::mechanics::dynamics::{Simulation, SimulationError};
use crate::mechanics::scene::Motion;
use crate::mechanics::system::Grasp;
use crate::plan::tying::GripperPoses;
use crate::run::Controller;
use serde::{Deserialize, Serialize};

/// Nodes beside the ends of a rod that are not taken hold of: a gripper is there already, or nearly nothing.
const BESIDE_ENDS: usize = 2;

/// Lifts strands of the first rod of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StrandGripper {
    lifts: Vec<Lift>,
    nodes: usize,
    reach: f64,
    /// Lifts that are over, or have missed.
    done: usize,
    /// The clamp of the strand that is held.
    clamp: Option<usize>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Lift {
    held: [f64; 2],
    /// Times (s) and places (m).
    places: Vec<(f64, Vector3)>,
}

impl StrandGripper {
    /// A gripper that follows paths one after the other, each from when it takes hold to when it lets go, s. It takes hold of the
    /// node of a rod of so many `nodes` that is nearest to it, seen from above, if it is within `reach`, m.
    pub fn new(lifts: &[([f64; 2], GripperPoses)], nodes: usize, reach: f64) -> Self {
        let lift = |(held, poses): &([f64; 2], GripperPoses)| Lift {
            held: *held,
            places: poses
                .iter()
                .map(|(time, place, _)| (*time, *place))
                .collect(),
        };
        Self {
            lifts: lifts.iter().map(lift).collect(),
            nodes,
            reach,
            done: 0,
            clamp: None,
        }
    }

    /// The node within reach of a place.
    fn node_at(&self, place: &Vector3, positions: &[Vector3]) -> Option<usize> {
        let inner = BESIDE_ENDS..self.nodes.saturating_sub(BESIDE_ENDS);
        let away = |node: &usize| (positions[*node] - place).xy().norm();
        let nearest = inner.min_by(|one, other| away(one).total_cmp(&away(other)));
        nearest.filter(|node| away(node) <= self.reach)
    }
}

impl Controller for StrandGripper {
    fn name(&self) -> &str {
        "strand gripper"
    }

    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError> {
        let Some(lift) = self.lifts.get(self.done) else {
            return Ok(());
        };
        let [begin, end] = lift.held;
        let has_come = |time: f64| simulation.time() >= time * (1.0 - 1e-12);
        if let Some(clamp) = self.clamp {
            if has_come(end) {
                simulation.release(clamp)?;
                self.clamp = None;
                self.done += 1;
            }
            return Ok(());
        }
        if !has_come(begin) {
            return Ok(());
        }
        let first = lift
            .places
            .first()
            .map_or_else(Vector3::zeros, |place| place.1);
        let Some(node) = self.node_at(&first, simulation.positions()) else {
            self.done += 1;
            return Ok(());
        };
        let motion = Motion {
            translation: lift
                .places
                .iter()
                .map(|(time, place)| {
                    let mut way = place - first;
                    // A hand that trembles does not press the rod into the table.
                    way.z = way.z.max(0.0);
                    (*time, way)
                })
                .collect(),
            ..Motion::default()
        };
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
        let lift = self.lifts.get(self.done);
        lift.map_or(f64::INFINITY, |lift| {
            lift.held[usize::from(self.clamp.is_some())]
        })
    }
}
