//! Visual feedback: the rest of the path is replanned from the observed slide of the sheet.

use super::gripper_path::GripperPath;
use super::keys::{Feedback, Folding};
use crate::run::Controller;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::random::uniform_numbers;
use rodlab_planning::plan::fold::{Algorithm, FoldPlanner, FoldPose, Sheet};
use serde::{Deserialize, Serialize};

/// Height to which the gripper lifts the edge if replanning fails, in L_gb.
const RISE: f64 = 0.5;

/// Observes the sheet after each part of the path except the last, and replans the next part
/// (thesis Algorithm 5). Relative to the sheet, which has slid by Δx, the gripper is at x_i − Δx;
/// it continues to its planned place x_{i+1}.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct VisualFeedback {
    keys: Feedback,
    seed: u64,
    path: GripperPath,
    /// Ends of the parts: times, s, and originally planned poses.
    ends: Vec<(f64, FoldPose)>,
    /// Index of the next end.
    next: usize,
    /// Clamp of the gripper, and initial x of the free end, m.
    clamp: usize,
    free_end: f64,
    /// Sheet and algorithm of the planner.
    sheet: Sheet,
    algorithm: Algorithm,
}

impl VisualFeedback {
    /// Feedback for a path on a table with friction μ. `clamp` is the gripper's clamp in the
    /// scene.
    pub fn new(
        folding: &Folding,
        keys: Feedback,
        path: &GripperPath,
        clamp: usize,
        friction: f64,
    ) -> Self {
        let last = path.times.len() - 1;
        let ends = (1..=keys.parts).map(|part| {
            let time = path.times[last] * part as f64 / keys.parts as f64;
            let index = path.times.partition_point(|known| *known < time);
            let index = index.min(last);
            (path.times[index], path.poses[index])
        });
        Self {
            keys,
            seed: folding.seed,
            ends: ends.collect(),
            path: path.clone(),
            next: 0,
            clamp,
            free_end: folding.sheet().length,
            sheet: folding.believed().dimensionless(),
            algorithm: folding.algorithm.on(friction),
        }
    }

    /// Observed slide of the sheet, m.
    fn look(&self, simulation: &Simulation) -> f64 {
        let mut number =
            uniform_numbers(self.seed ^ (self.next as u64 + 1).wrapping_mul(0x9e37_79b9));
        // Uniformly distributed, of variance 1.
        let noise = 12f64.sqrt() * (number() - 0.5);
        simulation.positions()[0].x - self.free_end + self.keys.noise * noise
    }

    /// Replans the part after an end. If there is no path, the gripper lifts the edge.
    fn plan(&mut self, end: usize, slid: f64) {
        let planner = FoldPlanner::shared(self.sheet, self.algorithm);
        let index_of = |time: f64| {
            let index = self.path.times.partition_point(|known| *known < time);
            index.min(self.path.times.len() - 1)
        };
        let [from, to] = [end, end + 1].map(|end| index_of(self.ends[end].0));
        let farther = (slid - self.path.slid[from]) / self.path.unit;
        match planner.next_part(self.path.poses[from], farther, self.ends[end + 1].1) {
            Ok(poses) => {
                // The first pose is the same place relative to the sheet, which has slid.
                self.path.poses[from] = poses[0];
                self.path.slid[from] = slid;
                self.path.replace([from, to], &poses, slid);
            }
            Err(_) => {
                self.path.lift_from(from, RISE * self.path.unit);
                self.next = self.ends.len();
            }
        }
    }
}

impl Controller for VisualFeedback {
    fn name(&self) -> &str {
        "visual feedback"
    }

    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError> {
        // Nothing is planned after the last part.
        if self.next + 1 >= self.ends.len()
            || simulation.time() < self.ends[self.next].0 * (1.0 - 1e-12)
        {
            return Ok(());
        }
        let end = self.next;
        let slid = self.look(simulation);
        self.next += 1;
        self.plan(end, slid);
        simulation.move_clamp(self.clamp, self.path.motion());
        Ok(())
    }

    fn next_time(&self) -> f64 {
        let ends = &self.ends[..self.ends.len() - 1];
        ends.get(self.next).map_or(f64::INFINITY, |(time, _)| *time)
    }
}
