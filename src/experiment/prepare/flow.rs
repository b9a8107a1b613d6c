//! What the flow of a scene is bounded by, and what it leaves out.

use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::Scene;
use crate::mechanics::{Vector3, dynamics::Simulation};
use crate::results::{SeriesRow, Value};
use crate::run::{Finding, Observer, Sample};
use crate::scenario::{Issue, KeyPath, Scenario};
use serde::{Deserialize, Serialize};

/// Height of a centreline over the wall, in radii, below which the drag at the wall is not resolved.
const UNRESOLVED: f64 = 2.0;
/// Distance from a held node, in radii, within which a rod may be nearer: there it is fastened to the wall.
const FASTENED: f64 = 4.0;

/// Chooses the plane that is the wall of the flow. Planes of the experiment come before those of the scenario.
///
/// # Errors
/// Two planes that are walls, and a wall of a fluid that has none.
pub(super) fn wall(scene: &Scene, scenario: &Scenario) -> Result<Option<usize>, Issue> {
    let built = scene.planes.len() - scenario.planes.len();
    let key = |index: usize| KeyPath::from("planes").index(index).key("wall");
    if !matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. })) {
        let mut planes = scenario.planes.iter();
        return match planes.position(|plane| plane.wall == Some(true)) {
            Some(index) => Err(Issue::new(
                key(index),
                "only the fluid of model \"rss\" has walls; take that model, or leave the key out",
            )),
            None => Ok(None),
        };
    }
    let of_scenario = scenario.planes.iter().enumerate();
    let mut walls = (0..built).chain(
        of_scenario
            .filter(|(_, plane)| plane.wall != Some(false))
            .map(|(index, _)| built + index),
    );
    let first = walls.next();
    match walls.next() {
        None => Ok(first),
        Some(second) => Err(Issue::new(
            key(second - built),
            "the flow can have one wall only, since the image of a wall is exact for one plane: set wall = false for all planes \
             but one; the flow then passes through those",
        )),
    }
}

/// What the flow of a scene leaves out without a request to, a sentence each.
pub(super) fn left_out(scene: &Scene, scenario: &Scenario) -> Vec<String> {
    let Some(model) = scene.fluid else {
        return Vec::new();
    };
    let built = scene.planes.len() - scenario.planes.len();
    let is_asked_for = |index: usize| match index.checked_sub(built) {
        Some(own) => scenario.planes[own].wall != Some(false),
        None => true,
    };
    let has_walls = matches!(model, FluidModel::RegularizedStokeslets { .. });
    let planes = (0..scene.planes.len()).filter(|&index| !has_walls && is_asked_for(index));
    let planes = planes.map(|index| {
        format!(
            "plane {index} is not part of the flow: the fluid of model \"resistive\" has no walls; take \"rss\", or set planes.wall = false"
        )
    });
    let obstacles = scene.obstacles.iter().map(|obstacle| {
        format!(
            "obstacle `{}` is not part of the flow: the fluid moves as if it were absent",
            obstacle.name
        )
    });
    planes.chain(obstacles).collect()
}

/// Reports rods that come too near to the wall of the flow.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FlowGuard {
    plane: usize,
    regularization: f64,
    point: Vector3,
    normal: Vector3,
    /// Radius of the rod at each node, m; `None` for nodes that are not watched.
    radii: Vec<Option<f64>>,
    nearest: Option<Near>,
}

/// The smallest height so far that is not resolved.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Near {
    /// Height of the centreline, in radii.
    height: f64,
    /// Time, s.
    time: f64,
}

impl FlowGuard {
    /// For a scene with a fluid and a wall.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
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

    /// What the flow is bounded by, a sentence.
    pub fn wall(&self) -> String {
        format!(
            "plane {} is a no-slip wall (regularization {} radii); drag is not resolved where a rod is less than a radius away from it",
            self.plane, self.regularization
        )
    }

    /// Looks at the rods; returns whether one is too near for the first time.
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

/// Radius at each node, except of held rods and of what is fastened.
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
