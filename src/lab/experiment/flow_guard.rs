//! Checks the distance of the rods of a run from the wall of its flow.

use crate::run::{Finding, Observer, Sample};
use rodlab_engine::mechanics::fluid::FluidModel;
use rodlab_engine::mechanics::scene::Scene;
use rodlab_engine::mechanics::{Vector3, dynamics::Simulation};
use rodlab_files::results::{SeriesRow, Value};
use serde::{Deserialize, Serialize};

/// Height of a centreline above the wall, in radii, below which the drag is not resolved.
const UNRESOLVED: f64 = 2.0;
/// Distance from a held node, in radii, within which a rod may be nearer to the wall, because it
/// is fastened there.
const FASTENED: f64 = 4.0;

/// Reports rods that are too near to the wall of the flow.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FlowGuard {
    plane: usize,
    regularization: f64,
    point: Vector3,
    normal: Vector3,
    /// Radius of the rod at each node, m; `None` for nodes that are not checked.
    radii: Vec<Option<f64>>,
    nearest: Option<Near>,
}

/// The smallest unresolved height so far.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Near {
    /// Height of the centreline, in radii.
    height: f64,
    /// Time, s.
    time: f64,
}

impl FlowGuard {
    /// The guard of a scene with a fluid and a wall; `None` for other scenes.
    pub fn of(scene: &Scene) -> Option<Self> {
        let Some(FluidModel::RegularizedStokeslets { regularization, .. }) = scene.fluid else {
            return None;
        };
        scene.wall.map(|plane| Self {
            plane,
            regularization,
            point: scene.planes[plane].point,
            normal: scene.planes[plane].normal,
            radii: watched_radii(scene),
            nearest: None,
        })
    }

    /// Boundary of the flow, as a sentence.
    pub fn wall(&self) -> String {
        format!(
            "plane {} is a no-slip wall (regularization {} radii); drag is not resolved where a rod is less than a radius away from it",
            self.plane, self.regularization
        )
    }

    /// Checks the rods; returns whether one is too near for the first time.
    fn look(&mut self, simulation: &Simulation) -> bool {
        let heights = (simulation.positions().iter().zip(&self.radii))
            .filter_map(|(x, radius)| Some((x - self.point).dot(&self.normal) / (*radius)?));
        let height = heights.fold(f64::INFINITY, f64::min);
        let bound = self.nearest.map_or(UNRESOLVED, |near| near.height);
        if height >= bound {
            return false;
        }
        let is_first = self.nearest.is_none();
        self.nearest = Some(Near {
            height,
            time: simulation.time(),
        });
        is_first
    }

    fn remark(&self) -> Option<String> {
        let Near { height, time } = self.nearest?;
        Some(format!(
            "at t = {time:.4e} s the gap between a rod and plane {}, the wall of the flow, is {:.3} radii: below one radius the lubrication \
             in the gap is not resolved, and the drag is too small",
            self.plane,
            height - 1.0
        ))
    }
}

/// Radius at each node; `None` for held rods and fastened parts.
fn watched_radii(scene: &Scene) -> Vec<Option<f64>> {
    let mut radii = Vec::new();
    for (index, rod) in scene.rods.iter().enumerate() {
        let held: Vec<Vector3> = (scene.clamps.iter())
            .filter(|clamp| clamp.rod == index && clamp.holds_position)
            .map(|clamp| rod.centreline[clamp.node])
            .collect();
        radii.extend(rod.centreline.iter().map(|x| {
            let near = |other: &Vector3| (x - other).norm() < FASTENED * rod.radius;
            (!rod.held && !held.iter().any(near)).then_some(rod.radius)
        }));
    }
    radii
}

impl Observer for FlowGuard {
    fn name(&self) -> &str {
        "flow"
    }

    fn measure(&mut self, sample: &Sample<'_>, _row: &SeriesRow) -> (Vec<Value>, Finding) {
        if self.look(sample.simulation)
            && let Some(sentence) = self.remark()
        {
            tracing::warn!("{sentence}");
        }
        (Vec::new(), Finding::GoOn)
    }

    fn remarks(&self) -> Vec<String> {
        self.remark().into_iter().collect()
    }
}
